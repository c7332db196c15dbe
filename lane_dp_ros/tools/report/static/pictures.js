// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
"use strict";

const figures = [...document.querySelectorAll(".pictures figure")];
const dialog = document.getElementById("large");
let current = 0;

function show(index) {
  current = (index + figures.length) % figures.length;
  const figure = figures[current];
  const copy = figure.cloneNode(true);
  for (const name of ["tabindex", "role", "aria-label"]) copy.removeAttribute(name);
  const title = figure.closest(".frame").querySelector("h3").textContent;
  dialog.querySelector("p").textContent = title;
  dialog.querySelector("div").replaceChildren(copy);
  if (!dialog.open) dialog.showModal();
}

figures.forEach((figure, index) => {
  figure.addEventListener("click", () => show(index));
  figure.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") {
      event.preventDefault();
      show(index);
    }
  });
});

document.getElementById("previous").addEventListener("click", () => show(current - 1));
document.getElementById("next").addEventListener("click", () => show(current + 1));
document.getElementById("close").addEventListener("click", () => dialog.close());
dialog.addEventListener("keydown", (event) => {
  if (event.key === "ArrowLeft") show(current - 1);
  if (event.key === "ArrowRight") show(current + 1);
});
dialog.addEventListener("close", () => {
  dialog.querySelector("div").replaceChildren();
  figures[current].focus();
});

for (const what of ["labels", "lanes", "paths"]) {
  const box = document.getElementById(`show-${what}`);
  const apply = () => document.body.classList.toggle(`hide-${what}`, !box.checked);
  box.addEventListener("change", apply);
  apply();
}
