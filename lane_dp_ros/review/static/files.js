// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
// Files of lines: downloaded, and chosen to be imported.

import { post } from "/api.js";

const byId = (id) => document.getElementById(id);

function say(text, details = []) {
  byId("exported").textContent = text;
  byId("left-out").replaceChildren(...details.map((reason) => {
    const item = document.createElement("li");
    item.textContent = reason;
    return item;
  }));
}

function download({ name, text }) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: name.endsWith(".xml") ? "application/xml" : "application/json" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export async function exportTruth() {
  say("Exporting: the road's surface of every frame is found…");
  const answer = await post("/api/export");
  download(answer);
  const rest = answer.left_out.length ? `; left out: ${answer.left_out.length}` : "";
  say(`${answer.name}: ${answer.frames} frames${rest}`, answer.left_out);
}

/** Download the lines of every frame, corrected or as detected, for an annotation tool: "coco" or "cvat". */
export async function exportLines(form) {
  const answer = await post(`/api/export/${form}`);
  download(answer);
  say(`${answer.name}: ${answer.frames} frames`);
}

/** Have the lines of a file replace those of its frames. */
export async function importLines(file) {
  try {
    const answer = await post("/api/import", await file.text());
    const rest = answer.left_out ? `; left out: ${answer.left_out} shapes that are no polylines` : "";
    say(`${file.name}: ${answer.images} images, lines of ${answer.changed} frames changed${rest}`);
  } catch (error) {
    say("");
    throw new Error(`${file.name}: ${error.message}`);
  }
}
