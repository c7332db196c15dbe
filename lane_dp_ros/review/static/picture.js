// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
// The picture of a frame with its lines drawn over it.

const SVG = "http://www.w3.org/2000/svg";
const LANES = "lanes"; // a zoom: as near as the lanes allow
const ZOOMS = [1, 2, 4, LANES];
const NEAREST = 8; // times the whole picture
const NEAR_PART = 0.15; // of a line: what is there is wide and plain, and leads past the screen
const AROUND = 0.08; // of the screen, beside the lanes
const ROAD = [0.35, 0.5, 0.65, 0.85]; // of the picture: in view, too, so that a missed line is seen
const PHONE = "(max-width: 600px)";
const POINT_RADIUS = 7; // px of the screen

export function element(name, attributes = {}) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

export class Picture {
  constructor(scroll, canvas) {
    this.scroll = scroll;
    this.canvas = canvas;
    this.svg = element("svg", { role: "img" });
    this.zoom = matchMedia(PHONE).matches ? LANES : 1;
    this.lanes = [];
    new ResizeObserver(() => this.#sizePoints()).observe(canvas);
  }

  /** Show a loaded <img>, or null, of a size [px]; whole numbers are the centres of pixels, hence the half. */
  show(image, name, [width, height]) {
    this.width = image?.naturalWidth ?? width;
    this.height = image?.naturalHeight ?? height;
    this.svg.setAttribute("viewBox", `-0.5 -0.5 ${this.width} ${this.height}`);
    this.scroll.style.setProperty("--ratio", this.width / this.height);
    this.canvas.replaceChildren(...(image ? [image, this.svg] : [this.svg]));
    if (image) image.alt = name;
  }

  /** Draw detected lanes as the outlines of their stripes; the paint stays visible between them. */
  drawLanes(lanes) {
    this.svg.replaceChildren();
    this.#describe(lanes.map((lane) => lane.role));
    this.lanes = lanes;
    if (this.zoom === LANES) this.#zoomToLanes();
    for (const { role, points } of lanes) {
      const right = points.map(([u, v, half]) => [u + half, v]);
      const left = points.map(([u, v, half]) => [u - half, v]).reverse();
      this.svg.append(element("polygon", { class: `lane ${role}`, points: [...right, ...left].join(" ") }));
    }
  }

  /** Draw lines as they were corrected by hand; the points of the selected one, `selected` (line, point), too. */
  drawLines(lines, selected) {
    this.svg.replaceChildren();
    this.#describe(lines.map((line) => line.role));
    lines.forEach((line, index) => this.#drawLine(line, index, index === selected.line));
    lines[selected.line]?.uv.forEach(([u, v], index) => this.#drawPoint(u, v, index, index === selected.point));
    this.#sizePoints();
  }

  /** Hide or show what is drawn. */
  setVisible(visible) {
    this.svg.classList.toggle("hidden", !visible);
  }

  /** Zoom to the next step; the middle of the road, below the picture's middle, stays in view. */
  nextZoom() {
    this.zoom = ZOOMS[(ZOOMS.indexOf(this.zoom) + 1) % ZOOMS.length];
    if (this.zoom === LANES) return this.#zoomToLanes();
    return this.#zoomTo(this.zoom, 0.5, 0.65);
  }

  get zoomName() {
    return this.zoom === LANES ? LANES : `${this.zoom}×`;
  }

  /** Show the lanes' far part as large as it fits. */
  #zoomToLanes() {
    const far = this.lanes.flatMap(({ points }) => points.slice(Math.floor(points.length * NEAR_PART)));
    const us = [ROAD[0], ROAD[2], ...far.map(([u]) => u / this.width)];
    const vs = [ROAD[1], ROAD[3], ...far.map(([, v]) => v / this.height)];
    const box = [Math.min(...us), Math.min(...vs), Math.max(...us), Math.max(...vs)];
    this.#zoomTo(1, 0.5, 0.5); // whose size the nearer one is a multiple of
    const { width, height } = this.canvas.getBoundingClientRect();
    const room = 1 - 2 * AROUND;
    const fits = [(room * this.scroll.clientWidth) / (width * (box[2] - box[0])),
      (room * this.scroll.clientHeight) / (height * (box[3] - box[1]))];
    const zoom = Math.min(Math.max(1, Math.min(...fits)), NEAREST);
    this.#zoomTo(zoom, (box[0] + box[2]) / 2, (box[1] + box[3]) / 2);
  }

  /** Zoom by a factor, with a place of the picture (in its widths and heights) in the middle. */
  #zoomTo(factor, across, down) {
    this.canvas.style.setProperty("--zoom", factor);
    const { width, height } = this.canvas.getBoundingClientRect();
    this.scroll.scrollLeft = across * width - this.scroll.clientWidth / 2;
    this.scroll.scrollTop = down * height - this.scroll.clientHeight / 2;
  }

  /** Return the pixel [u, v] of the image under a pointer, within the image. */
  pixelAt(event) {
    const box = this.svg.getBoundingClientRect();
    const u = ((event.clientX - box.left) / box.width) * this.width - 0.5;
    const v = ((event.clientY - box.top) / box.height) * this.height - 0.5;
    return this.inside([u, v]);
  }

  /** Return a pixel moved into the image, to a tenth. */
  inside([u, v]) {
    const clamp = (value, size) => Math.round(10 * Math.min(Math.max(value, 0), size - 1)) / 10;
    return [clamp(u, this.width), clamp(v, this.height)];
  }

  #drawLine(line, index, isSelected) {
    const classes = ["line", line.role, isSelected ? "selected" : "", line.sure ? "" : "unsure"];
    this.svg.append(element("polyline", { class: classes.join(" "), points: line.uv.join(" ") }));
    // Wide and invisible: a line must be easy to hit.
    this.svg.append(element("polyline", { class: "grip", points: line.uv.join(" "), "data-line": index }));
  }

  #drawPoint(u, v, index, isSelected) {
    const classes = isSelected ? "point selected" : "point";
    this.svg.append(element("circle", { class: classes, cx: u, cy: v, "data-point": index }));
  }

  /** Keep the points' size on the screen the same at every zoom. */
  #sizePoints() {
    const width = this.svg.getBoundingClientRect().width;
    if (!width) return;
    const radius = (POINT_RADIUS * this.width) / width;
    for (const point of this.svg.querySelectorAll(".point")) point.setAttribute("r", radius);
  }

  #describe(roles) {
    const names = roles.map((role) => role.replace("ego_", "")).join(", ");
    this.svg.setAttribute("aria-label", names ? `lines drawn: ${names}` : "no lines drawn");
  }
}
