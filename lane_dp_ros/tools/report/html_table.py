# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A table as HTML: without columns that hold nothing, with a row named "total" that stands out."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from html import escape
from typing import NamedTuple

NOTHING = ("-", "", "·")  # cells where there is nothing to count


class Marked(NamedTuple):
    """A cell with a class of the style sheet, and the number that it is sorted by."""

    text: str
    style: str = ""
    value: float | None = None


Cell = str | Marked
Rows = Mapping[str, Sequence[Cell]]


def html_table(title: str, heads: Sequence[str], rows: Rows, links: Mapping[str, str] | None = None) -> str:
    """Return a table, or nothing where no cell has anything to tell.

    `heads` are those of the cells, `title` that of the rows' names; a name in `links` leads there, and a
    table with links scrolls in a frame of its own where it is long. Columns without anything in them are left
    out.
    """
    kept = [i for i in range(len(heads)) if any(_text(row[i]) not in NOTHING for row in rows.values())]
    if not kept:
        return ""
    first = next(iter(rows.values()))
    head = _head(title) + "".join(_head(heads[i], first[i]) for i in kept)
    body = "".join(
        f"<tr{' class=total' if name == 'total' else ''}>{_row_head(name, links or {})}"
        + "".join(_cell(row[i]) for i in kept) + "</tr>"
        for name, row in rows.items()
    )  # fmt: skip
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    style = "scroll" if links is None else "scroll long"
    return f'<div class="{style}" tabindex="0">{table}</div>'


def _text(cell: Cell) -> str:
    return cell.text if isinstance(cell, Marked) else cell


def _head(text: str, below: Cell = "") -> str:
    """Return the head of a column, in the style of its first cell."""
    style = f' class="{below.style}"' if isinstance(below, Marked) and below.style else ""
    return f'<th scope="col"{style}>{_broken(text.strip())}</th>'


def _row_head(name: str, links: Mapping[str, str]) -> str:
    text = _broken(name)
    if name in links:
        text = f'<a href="{escape(links[name])}">{text}</a>'
    return f'<th scope="row">{text}</th>'


def _cell(cell: Cell) -> str:
    if isinstance(cell, str):
        return f"<td>{escape(cell)}</td>"
    style = f' class="{cell.style}"' if cell.style else ""
    value = "" if cell.value is None else f' data-value="{cell.value:g}"'
    return f"<td{style}{value}>{escape(cell.text)}</td>"


def _broken(text: str) -> str:
    """Return text for a narrow cell: lines end where it says so, else after / and _ where they must."""
    return re.sub("([/_])", r"\1<wbr>", escape(text)).replace("\n", "<br>")
