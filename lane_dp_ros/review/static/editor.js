// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
// Correcting the lines of a frame: what is selected, what each command does to the lines.

const ROLES = ["ego_left", "ego_right", "other"];
const KINDS = ["solid", "dashed", "edge"];
const DETAILS = { ego_left: "left", ego_right: "right", other: "other" };
const NEW_LINES = { ego_left: [[0.3, 0.95], [0.47, 0.6]], ego_right: [[0.7, 0.95], [0.53, 0.6]],
  other: [[0.1, 0.95], [0.42, 0.6]] }; // in widths and heights of the picture
const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const NUDGE = 0.5, FAR_NUDGE = 5; // px

export const isNudge = (key) => key in NUDGES;
const after = (values, value) => values[(values.indexOf(value) + 1) % values.length];

export class Editor {
  /** `save(lines)` is called after every change, with null for a return to the detected lines. */
  constructor(picture, save) {
    this.picture = picture;
    this.save = save;
    this.active = false;
    this.lines = [];
    this.selected = { line: 0, point: -1 };
    picture.svg.addEventListener("pointerdown", (event) => this.#press(event));
    picture.svg.addEventListener("dblclick", (event) => this.#addPointAt(event));
  }

  /** Begin to correct these lines. `namesAround` are the ids by role of the frame before. */
  open(lines, namesAround) {
    this.active = true;
    this.namesAround = namesAround;
    this.selected.line = Math.max(0, lines.findIndex((line) => line.role !== "other"));
    this.load(lines);
  }

  /** Take other lines in, such as those of an undo. */
  load(lines) {
    this.lines = structuredClone(lines);
    this.selected = { line: Math.min(this.selected.line, Math.max(0, lines.length - 1)), point: -1 };
    this.draw();
  }

  close() {
    this.active = false;
    this.selected = { line: 0, point: -1 };
  }

  get line() {
    return this.lines[this.selected.line];
  }

  /** Whether the editor did something with an arrow key: move the selected point. */
  nudge(key, far) {
    const point = this.line?.uv[this.selected.point];
    if (!point || !(key in NUDGES)) return false;
    const [du, dv] = NUDGES[key].map((step) => step * (far ? FAR_NUDGE : NUDGE));
    this.line.uv[this.selected.point] = this.picture.inside([point[0] + du, point[1] + dv]);
    this.#changed();
    return true;
  }

  nextLine() {
    this.selected = { line: (this.selected.line + 1) % Math.max(1, this.lines.length), point: -1 };
    this.draw();
  }

  nextPoint() { this.#stepPoint(1); }
  previousPoint() { this.#stepPoint(-1); }

  role() {
    if (!this.line) return;
    this.#giveRole(this.line, after(ROLES, this.line.role));
    this.#changed();
  }

  kind() {
    if (!this.line) return;
    this.line.kind = after(KINDS, this.line.kind);
    this.#changed();
  }

  sure() {
    if (!this.line) return;
    this.line.sure = !this.line.sure;
    this.#changed();
  }

  /** Add a line of the first role that none has; the person drags it to its place. */
  addLine() {
    const role = ROLES.find((each) => !this.lines.some((line) => line.role === each)) ?? "other";
    const { width, height } = this.picture;
    const uv = NEW_LINES[role].map(([u, v]) => this.picture.inside([u * width, v * height]));
    this.lines.push({ id: this.#newId(role), role, kind: "solid", sure: true, uv });
    this.selected = { line: this.lines.length - 1, point: 0 };
    this.#changed();
  }

  deleteLine() {
    if (!this.line) return;
    this.lines.splice(this.selected.line, 1);
    this.selected = { line: Math.max(0, this.selected.line - 1), point: -1 };
    this.#changed();
  }

  /** Add a point halfway to the next one (from the last point: to the one before). */
  addPoint() {
    if (!this.line) return;
    const uv = this.line.uv;
    const from = Math.min(Math.max(0, this.selected.point), uv.length - 2);
    const [a, b] = [uv[from], uv[from + 1]];
    this.#insertPoint(from + 1, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
  }

  deletePoint() {
    if (!this.line?.uv[this.selected.point] || this.line.uv.length <= 2) return; // two make a line
    this.line.uv.splice(this.selected.point, 1);
    this.selected.point = Math.min(this.selected.point, this.line.uv.length - 1);
    this.#changed();
  }

  detected() { this.save(null); }

  /** Show the lines and, on the buttons, what is selected. */
  draw() {
    if (!this.active) return;
    this.picture.drawLines(this.lines, this.selected);
    const say = (id, text) => { document.getElementById(id).textContent = text; };
    say("role", this.line ? DETAILS[this.line.role] : "–");
    say("kind", this.line ? this.line.kind : "–");
    document.getElementById("sure").setAttribute("aria-pressed", String(this.line?.sure ?? false));
    const count = this.line?.uv.length ?? 0;
    say("point", this.selected.point < 0 ? "no point selected" : `point ${this.selected.point + 1} of ${count}`);
  }

  #changed() {
    this.draw();
    this.save(structuredClone(this.lines));
  }

  #stepPoint(step) {
    const count = this.line?.uv.length ?? 0;
    if (!count) return;
    const from = this.selected.point < 0 && step < 0 ? 0 : this.selected.point;
    this.selected.point = (from + step + count) % count;
    this.draw();
  }

  /** There is one line on each side: who had the role before becomes another. */
  #giveRole(line, role) {
    for (const other of this.lines) if (other !== line && other.role === role) other.role = "other";
    line.role = role;
  }

  /** Return an id that is free here: the one that this role's line had in the frame before, or a new one. */
  #newId(role) {
    const taken = new Set(this.lines.map((line) => line.id));
    const before = role === "other" ? undefined : this.namesAround[role];
    if (before && !taken.has(before)) return before;
    let number = 1;
    while (taken.has(`new${number}`)) number += 1;
    return `new${number}`;
  }

  #insertPoint(index, pixel) {
    this.line.uv.splice(index, 0, this.picture.inside(pixel));
    this.selected.point = index;
    this.#changed();
  }

  #press(event) {
    if (!this.active) return;
    const { point, line } = event.target.dataset;
    if (point !== undefined) this.#drag(event, Number(point));
    else if (line !== undefined && Number(line) !== this.selected.line) {
      this.selected = { line: Number(line), point: -1 };
      this.draw();
    }
  }

  /** Let a point follow the pointer; it is saved when the pointer lets go. */
  #drag(event, index) {
    event.preventDefault();
    this.selected.point = index;
    this.draw();
    const { svg } = this.picture;
    svg.setPointerCapture(event.pointerId);
    // Grabbed at its rim, the point must not jump.
    const [u, v] = this.picture.pixelAt(event);
    const grabbed = [this.line.uv[index][0] - u, this.line.uv[index][1] - v];
    let moved = false;
    const move = (at) => {
      const [toU, toV] = this.picture.pixelAt(at);
      this.line.uv[index] = this.picture.inside([toU + grabbed[0], toV + grabbed[1]]);
      moved = true;
      this.draw();
    };
    const end = () => {
      svg.removeEventListener("pointermove", move);
      svg.removeEventListener("pointerup", end);
      svg.removeEventListener("pointercancel", end);
      if (moved) this.#changed();
    };
    svg.addEventListener("pointermove", move);
    svg.addEventListener("pointerup", end);
    svg.addEventListener("pointercancel", end);
  }

  #addPointAt(event) {
    if (!this.active || event.target.dataset.line === undefined) return;
    this.selected.line = Number(event.target.dataset.line);
    const pixel = this.picture.pixelAt(event);
    this.#insertPoint(nearestSegment(this.line.uv, pixel) + 1, pixel);
  }
}

/** Return the index of the polyline's segment that is nearest to a pixel. */
function nearestSegment(uv, [u, v]) {
  const distances = uv.slice(1).map((b, index) => {
    const a = uv[index];
    const [du, dv] = [b[0] - a[0], b[1] - a[1]];
    const along = ((u - a[0]) * du + (v - a[1]) * dv) / (du * du + dv * dv || 1);
    const at = Math.min(Math.max(along, 0), 1);
    return Math.hypot(u - a[0] - at * du, v - a[1] - at * dv);
  });
  return distances.indexOf(Math.min(...distances));
}
