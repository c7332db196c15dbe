// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
"use strict";

// A click on the head of a column sorts the table by it: numbers from the largest down at first, words from A on.
// The total stays at the end, and what is no number below all that are.
function numberOf(cell) {
  if (cell.dataset.value) return Number(cell.dataset.value);
  const text = cell.textContent.trim();
  return text === "·" ? 0 : Number(text || NaN);
}

function sortBy(table, column) {
  const body = table.tBodies[0];
  const rows = [...body.rows].filter((row) => !row.classList.contains("total"));
  const cells = new Map(rows.map((row) => [row, row.cells[column]]));
  const numbers = new Map(rows.map((row) => [row, numberOf(cells.get(row))]));
  const isNumeric = rows.some((row) => !Number.isNaN(numbers.get(row)));
  const head = table.tHead.rows[0].cells[column];
  const first = isNumeric ? "descending" : "ascending";
  const other = isNumeric ? "ascending" : "descending";
  const order = head.ariaSort === first ? other : first;
  const sign = order === "ascending" ? 1 : -1;
  rows.sort((a, b) => {
    if (!isNumeric) return sign * cells.get(a).textContent.localeCompare(cells.get(b).textContent, "en", { numeric: true });
    const [x, y] = [numbers.get(a), numbers.get(b)];
    return Number.isNaN(x) - Number.isNaN(y) || sign * (x - y) || 0;
  });
  for (const each of table.tHead.rows[0].cells) each.ariaSort = each === head ? order : "none";
  body.prepend(...rows);
}

for (const table of document.querySelectorAll("table")) {
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    head.tabIndex = 0;
    head.ariaSort = "none";
    head.addEventListener("click", () => sortBy(table, column));
    head.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") {
        event.preventDefault();
        sortBy(table, column);
      }
    });
  });
}
