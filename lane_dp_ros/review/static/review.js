// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
// The page: frames, verdicts, keys, the table.

import { get, picture as loadPicture, post, prefetch } from "/api.js";
import { Editor, isNudge } from "/editor.js";
import { exportLines, exportTruth, importLines } from "/files.js";
import { Picture } from "/picture.js";

const SIDES = ["left", "right"];
const VERDICTS = ["correct", "incorrect", "missed", "none"];
const KEYS = { ArrowLeft: "previous", ArrowRight: "next", Home: "first", End: "last", n: "unjudged", u: "undo",
  l: "toggle", z: "zoom", e: "edit", " ": "correct" };
const EDIT_KEYS = { o: "nextLine", r: "role", k: "kind", s: "sure", a: "addLine", x: "deleteLine", p: "addPoint",
  d: "deletePoint", Delete: "deletePoint", ",": "previousPoint", ".": "nextPoint", Escape: "edit",
  PageUp: "previous", PageDown: "next" };
// By their place on the keyboard: a French one has digits only with Shift.
const VERDICT_KEYS = { Digit1: ["left", 0], Digit2: ["left", 1], Digit3: ["left", 2], Digit4: ["left", 3],
  Digit7: ["right", 0], Digit8: ["right", 1], Digit9: ["right", 2], Digit0: ["right", 3] };

const byId = (id) => document.getElementById(id);
const picture = new Picture(byId("scroll"), byId("canvas"));
const editor = new Editor(picture, saveLines);
let drive; // name, frames (verdicts of each), table, file
let frame; // the present one
let linesVisible = true;

// One thing after the other: keys that come faster than the disk must each meet the frame they were meant for.
let last = Promise.resolve();
function inTurn(action) {
  last = last.then(action).catch((error) => say(error.message, true));
  return last;
}

function say(text, wrong = false) {
  byId("status").textContent = text;
  byId("status").classList.toggle("wrong", wrong);
}

// ---- frames

async function show(index) {
  const shown = loadPicture(index).catch((error) => error); // a frame without its picture is still a frame
  const [data, image] = await Promise.all([get(`/api/frames/${index}`), shown]);
  const moved = frame?.index !== index;
  frame = data;
  picture.show(image instanceof Error ? null : image, `left image of frame ${index + 1}`, frame.size);
  if (moved) setEditing(false);
  else if (editor.active) editor.load(frame.lines);
  draw();
  const around = [index - 1, index, index + 1, index + 2];
  prefetch(around.filter((each) => each >= 0 && each < drive.frames.length));
  if (image instanceof Error) throw image;
}

/** Show what is judged: what was detected, also where it was corrected since. */
function draw() {
  if (editor.active) editor.draw();
  else picture.drawLanes(frame.lanes.filter((lane) => lane.role !== "other"));
  picture.setVisible(linesVisible);
  byId("number").value = frame.index + 1;
  byId("edit-text").textContent = frame.corrected ? "Corrected lines" : "Correct lines";
  for (const side of SIDES) drawSide(side);
  drawProgress();
}

function drawSide(side) {
  const verdict = frame.verdicts[side];
  const drawn = wasDetected(side);
  for (const button of document.querySelectorAll(`[data-side=${side}] button`)) {
    button.setAttribute("aria-pressed", String(button.dataset.verdict === verdict));
    button.disabled = !drawn && ["correct", "incorrect"].includes(button.dataset.verdict);
  }
  byId(`${side}-note`).textContent = drawn ? "" : "(none detected)";
}

function drawProgress() {
  const judged = drive.frames.filter(isJudged).length;
  byId("progress").max = drive.frames.length;
  byId("progress").value = judged;
  byId("progress-text").textContent = `${judged} of ${drive.frames.length} frames judged`;
  const { total, incorrect, missed, precision } = drive.table;
  const shown = precision === null ? "–" : `${(100 * precision).toFixed(1)} %`;
  Object.entries({ total, incorrect, missed, precision: shown }).forEach(([id, value]) => {
    byId(id).textContent = value;
  });
}

const isJudged = (verdicts) => SIDES.every((side) => verdicts[side] !== null);
const wasDetected = (side) => frame.lanes.some((lane) => lane.role === `ego_${side}`);

/** Return the next frame that lacks a verdict, from after the present one on and round again; -1: none. */
function nextUnjudged() {
  const count = drive.frames.length;
  const order = drive.frames.map((_, step) => (frame.index + 1 + step) % count);
  return order.find((index) => !isJudged(drive.frames[index])) ?? -1;
}

const goTo = (index) => (index >= 0 && index < drive.frames.length ? show(index) : undefined);

// ---- verdicts

async function judge(verdicts) {
  const wasJudged = isJudged(frame.verdicts);
  take(await post(`/api/frames/${frame.index}/verdicts`, verdicts));
  const said = SIDES.filter((side) => frame.verdicts[side]).map((side) => `${side} ${frame.verdicts[side]}`);
  say(`Frame ${frame.index + 1}: ${said.join(", ").replaceAll("none", "no marking")}. Saved.`);
  if (!wasJudged && isJudged(frame.verdicts)) await goOn();
}

async function goOn() {
  const index = nextUnjudged();
  if (index >= 0) await show(index);
  else say(`All ${drive.frames.length} frames are judged.`);
}

/** Every line that is drawn and not judged yet is correct. */
async function correct() {
  const open = SIDES.filter((side) => frame.verdicts[side] === null);
  const drawn = open.filter(wasDetected);
  if (drawn.length) await judge(Object.fromEntries(drawn.map((side) => [side, "correct"])));
  else if (open.length) say(`No line was detected ${open.join(" and ")}: missed, or no marking?`);
  else await goOn();
}

async function undo() {
  const answer = await post("/api/undo");
  if (answer.index === null) return say("There is nothing to undo.");
  take(answer);
  await show(answer.index);
  return say(`Undone: the last change, of frame ${answer.index + 1}. Saved.`);
}

/** Take in what the server says of a frame after a change. */
function take({ index, verdicts, table }) {
  drive.frames[index] = verdicts;
  drive.table = table;
  if (index === frame.index) frame.verdicts = verdicts;
  draw();
}

// ---- correcting lines

async function setEditing(on) {
  byId("editor").hidden = !on;
  byId("edit").setAttribute("aria-pressed", String(on));
  if (!on) return editor.close();
  const before = frame.index ? (await get(`/api/frames/${frame.index - 1}`)).lines : [];
  setVisible(true);
  return editor.open(frame.lines, Object.fromEntries(before.map((line) => [line.role, line.id])));
}

function saveLines(lines) {
  const { index } = frame; // now, not when its turn comes
  inTurn(async () => {
    const answer = await post(`/api/frames/${index}/lines`, lines);
    if (index === frame.index && lines) Object.assign(frame, { lines, corrected: true });
    take(answer);
    if (index !== frame.index) return;
    if (lines === null) await show(index);
    say(`Frame ${index + 1}: ${lines === null ? "back to the detected lines" : "lines corrected"}. Saved.`);
  });
}

/** Take in what was imported: any frame may have changed. */
async function imported() {
  drive = await get("/api/drive");
  await show(frame.index);
}

// ---- buttons and keys

function setVisible(visible) {
  linesVisible = visible;
  picture.setVisible(visible);
  byId("toggle").setAttribute("aria-pressed", String(visible));
}

function zoom() {
  picture.nextZoom();
  drawZoom();
}

function drawZoom() {
  byId("zoom").textContent = picture.zoomName;
}

async function edit() {
  await setEditing(!editor.active);
  draw();
}

const ACTIONS = {
  previous: () => goTo(frame.index - 1),
  next: () => goTo(frame.index + 1),
  first: () => goTo(0),
  last: () => goTo(drive.frames.length - 1),
  unjudged: goOn,
  undo,
  toggle: () => setVisible(!linesVisible),
  zoom,
  edit,
  correct,
  export: exportTruth,
  exportCoco: () => exportLines("coco"),
  exportCvat: () => exportLines("cvat"),
  import: () => byId("file").click(),
};

const run = (name) => (name in ACTIONS ? ACTIONS[name]() : editor[name]());

document.addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (!button || button.disabled) return;
  if (button.dataset.do) inTurn(() => run(button.dataset.do));
  else inTurn(() => judge({ [button.closest("fieldset").dataset.side]: button.dataset.verdict }));
  if (event.detail) button.blur(); // a pointer's click must not keep Space for the button
});

document.addEventListener("keydown", (event) => {
  const { target, code, shiftKey } = event;
  const control = event.ctrlKey || event.metaKey;
  if (target instanceof HTMLInputElement || event.altKey || (control && event.key !== "z")) return;
  const key = control ? "u" : event.key.length > 1 ? event.key : event.key.toLowerCase();
  if (key === " " && target.closest("button")) return; // presses the button
  const ours = code in VERDICT_KEYS || key in KEYS || (editor.active && (key in EDIT_KEYS || isNudge(key)));
  if (ours) event.preventDefault();
  const judges = code in VERDICT_KEYS || key === " ";
  if (event.repeat && judges) return; // a key held down must not judge frames that nobody has seen
  inTurn(() => act(key, code, shiftKey));
});

/** Do what a key stands for by the time its turn has come. */
function act(key, code, shift) {
  if (code in VERDICT_KEYS) {
    const [side, index] = VERDICT_KEYS[code];
    return judge({ [side]: VERDICTS[index] });
  }
  if (editor.active && editor.nudge(key, shift)) return undefined;
  if (editor.active && key in EDIT_KEYS) return run(EDIT_KEYS[key]);
  return key in KEYS ? run(KEYS[key]) : undefined;
}

byId("file").addEventListener("change", ({ target }) => {
  const [file] = target.files;
  if (file) inTurn(() => importLines(file).then(imported));
  target.value = ""; // the same file may be chosen again
});

byId("number").addEventListener("change", ({ target }) => {
  inTurn(() => goTo(Math.min(Math.max(1, Math.round(target.value)), drive.frames.length) - 1));
  target.blur();
});

drawZoom();
inTurn(async () => {
  drive = await get("/api/drive");
  document.title = `${drive.name} · lane review`;
  byId("drive").textContent = drive.name;
  byId("sequence").textContent = drive.name;
  byId("file").textContent = drive.file;
  byId("count").textContent = `of ${drive.frames.length}`;
  byId("number").max = drive.frames.length;
  const first = drive.frames.findIndex((verdicts) => !isJudged(verdicts));
  say(first < 0 ? `All ${drive.frames.length} frames are judged.` : "");
  await show(Math.max(0, first));
});
