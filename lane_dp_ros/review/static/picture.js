// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
// The picture of a frame with its lines drawn over it.

const SVG = "http://www.w3.org/2000/svg";
const ZOOMS = [1, 2, 4];
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
    this.zoom = 1;
    new ResizeObserver(() => this.#sizePoints()).observe(canvas);
  }

  /** Show a loaded <img>, or null, of a size [px]; whole numbers are the centres of pixels, hence the half. */
  show(image, name, [width, height]) {
    this.width = image?.naturalWidth ?? width;
    this.height = image?.naturalHeight ?? height;
    this.svg.setAttribute("viewBox", `-0.5 -0.5 ${this.width} ${this.height}`);
    this.canvas.style.setProperty("--ratio", this.width / this.height);
    this.canvas.replaceChildren(...(image ? [image, this.svg] : [this.svg]));
    if (image) image.alt = name;
  }

  /** Draw detected lanes as the outlines of their stripes; the paint stays visible between them. */
  drawLanes(lanes) {
    this.svg.replaceChildren();
    this.#describe(lanes.map((lane) => lane.role));
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
    for (const zoom of ZOOMS) this.canvas.classList.toggle(`zoom-${zoom}`, zoom === this.zoom && zoom > 1);
    this.scroll.scrollLeft = (this.scroll.scrollWidth - this.scroll.clientWidth) / 2;
    this.scroll.scrollTop = (this.scroll.scrollHeight - this.scroll.clientHeight) * 0.7;
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
