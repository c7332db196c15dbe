# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the plots of docs/results.md from the tables of that page: a number stands there once.

python docs/draw_results.py [DIR]    write the plots to DIR, default docs/_pictures
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt

HERE = Path(__file__).resolve().parent
PICTURES = HERE / "_pictures"
PAGE = HERE / "results.md"
DETECTORS = {"Ours": "#1f77b4", "Ours, paper preset": "#ff9d45", "The baseline": "#9a9a9a"}
NUMBER = r"-|[-+]?\d[\d.]*"  # "-" stands where there is nothing to count
MEASURES = ("precision", "recall", "detection precision")
STYLE = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "svg.hashsalt": "lane_dp_ros"}

Rows = dict[str, tuple[float, ...]]


def section(heading: str) -> str:
    """Return the text below a heading of the page, up to the next one of any level.

    Raises ValueError where the page has no such heading.
    """
    found = re.search(rf"^#+ {re.escape(heading)}\n(.*?)(?=^#+ |\Z)", _page(), re.MULTILINE | re.DOTALL)
    if found is None:
        raise ValueError(f"{PAGE} has no heading {heading!r}")
    return found.group(1)


def text_rows(text: str) -> Rows:
    """Return the numbers of each row of the printed tables in a text, by the row's name; "-" is NaN."""
    rows = re.findall(r"^([a-z][\w/]*) {2,}([-\d.| ]+)$", text, re.MULTILINE)
    return {name: tuple(_number(cell) for cell in cells.replace("|", " ").split()) for name, cells in rows}


def markdown_rows(text: str) -> Rows:
    """Return the numbers of each row of the Markdown tables in a text, by the row's first cell."""
    rows: Rows = {}
    for line in text.splitlines():
        name, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        if cells and all(re.fullmatch(NUMBER, cell) for cell in cells):
            rows[name] = tuple(map(_number, cells))
    return rows


def draw_labelled(path: Path) -> None:
    """Draw three measures of the three detectors on the labelled frames."""
    totals = {name: text_rows(section(name))["total"] for name in DETECTORS}
    figure, ax = plt.subplots(figsize=(7, 2.8))
    for i, (name, row) in enumerate(totals.items()):
        bars = ax.bar(np.arange(3) + 0.26 * (i - 1), row[3:6], 0.24, color=DETECTORS[name], label=name)
        ax.bar_label(bars, fmt="%.2f", padding=1, fontsize=8)
    ax.set_xticks(range(3), MEASURES)
    ax.set(ylim=(0, 1.08), title=f"the labelled KITTI frames: {totals['Ours'][0]:.0f} lines of the own lane")
    ax.legend(frameon=False, loc="upper left", bbox_to_anchor=(1, 1))
    _save(path, figure)


def draw_suite(path: Path) -> None:
    """Draw the precision of the three detectors on each category of the standard suite."""
    rows = text_rows(section("The standard suite of rendered scenes"))
    rows = {
        name: row
        for name, row in rows.items()
        if len(row) == 4 * len(DETECTORS) and name != "total" and np.isfinite(row[3])
    }
    names = sorted(rows, key=lambda name: (-rows[name][3], -rows[name][7], name))
    figure, ax = plt.subplots(figsize=(7, 0.19 * len(names) + 0.9))
    for i, (detector, colour) in reversed(list(enumerate(DETECTORS.items()))):
        values = [rows[name][4 * i + 3] for name in names]
        ax.scatter(values, range(len(names)), s=(46, 34, 24)[i], color=colour, label=detector, zorder=3 - i)
    ax.set_yticks(range(len(names)), names)
    ax.invert_yaxis()
    ax.grid(axis="y", alpha=0.25)
    ax.set(xlabel="lines of the own lane that are right [%], each pair by itself", xlim=(-3, 103))
    ax.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1), ncols=3)
    _save(path, figure)


def draw_ablation(path: Path) -> None:
    """Draw what is lost without each step, on the labelled frames and on the suite."""
    rows = markdown_rows(section("What each step gives"))
    base = rows.pop("none")
    names = sorted(rows, key=lambda name: rows[name][0] - base[0], reverse=True)
    figure, axes = plt.subplots(1, 2, figsize=(8.5, 0.21 * len(names) + 0.9), sharey=True)
    for ax, column, title in zip(axes, (0, 5), ("labelled KITTI frames", "standard suite"), strict=True):
        change = [100 * (rows[name][column] - base[column]) for name in names]
        ax.barh(names, change, color=["#d9534f" if each < 0 else "#5cb85c" for each in change])
        ax.axvline(0, color="0.4", lw=0.8)
        ax.set(title=title, xlabel="change of precision [points]")
    _save(path, figure)


def _page() -> str:
    return PAGE.read_text(encoding="utf-8")


def _number(cell: str) -> float:
    return float("nan") if cell == "-" else float(cell)


def _save(path: Path, figure: plt.Figure) -> None:
    figure.savefig(path, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)


def main(folder: Path = PICTURES) -> None:
    """Draw all."""
    mpl.use("agg")
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        draw_labelled(folder / "results_labelled.svg")
        draw_suite(folder / "results_suite.svg")
        draw_ablation(folder / "results_ablation.svg")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
