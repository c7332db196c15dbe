# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the rooms of the package and what they import, as docs/architecture.md shows them.

python docs/draw_imports.py           print the picture (a Mermaid flowchart)
python docs/draw_imports.py --write   put it into docs/architecture.md

An arrow from A to B: something in A imports something in B. Arrows that others imply are left out: where A
imports B and B imports C, it goes without saying that A may see C.
"""

from __future__ import annotations

import ast
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "architecture.md"
BEGIN, END = "```mermaid\n", "```\n"
# From the ground up: what stands together in the picture, and in which frame.
ROOMS: dict[str, tuple[str, ...]] = {
    "core": (
        *("core.parameter", "core.stopwatch", "core.geometry", "core.dp", "core.types", "core.road"),
        *("core.birdseye", "core.lanes", "core.tracking", "core.monitoring", "core.config", "core.search"),
        *("core.detector", "core.pipeline"),
    ),
    "messages": ("messages",),
    "ros": ("ros",),
    "tools": (
        *("tools.progress", "tools.parallel", "tools.parameter_file", "tools.detection_config"),
        *("tools.datasets", "tools.offline"),
        *("tools.evaluation", "tools.evidence_fit", "tools.report", "tools.demo", "tools.cli"),
    ),
    "leaves": ("scenes", "review"),
}
PACKAGE = "lane_dp_ros"

Arrows = dict[str, set[str]]


def room_of(module: str) -> str | None:
    """Return the room that a module is in, None for the package itself and what is not of it."""
    rooms = [room for group in ROOMS.values() for room in group]
    name = module.removeprefix(f"{PACKAGE}.")
    return next((room for room in rooms if name == room or name.startswith(f"{room}.")), None)


def imports_of(path: Path) -> Iterator[str]:
    """Yield the modules of the package that a file imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == PACKAGE:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def arrows() -> Arrows:
    """Return, for each room, the rooms that it imports."""
    found: Arrows = defaultdict(set)
    for path in sorted((ROOT / PACKAGE).rglob("*.py")):
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        here = room_of(module)
        there = {room_of(imported) for imported in imports_of(path)} - {here, None}
        if here is not None:
            found[here] |= {room for room in there if room is not None}
    return found


def without_implied(found: Arrows) -> Arrows:
    """Return the arrows without those that go where others lead as well."""

    def reached(room: str) -> set[str]:
        """Return all rooms that arrows lead to from a room."""
        return found[room].union(*(reached(each) for each in found[room]))

    return {
        room: {each for each in to if not any(each in reached(other) for other in to - {each})}
        for room, to in tuple(found.items())
    }


def picture() -> str:
    """Return the flowchart."""
    lines = ["flowchart TD"]
    for frame, rooms in ROOMS.items():
        lines += [f"  subgraph {frame}_[{frame}]", *(f"    {room}[{room}]" for room in rooms), "  end"]
    kept = without_implied(arrows())
    lines += [f"  {room} --> {each}" for room in sorted(kept) for each in sorted(kept[room])]
    return "\n".join(lines) + "\n"


def with_picture(page: str) -> str:
    """Return the page with the picture as it is now."""
    before, _, rest = page.partition(BEGIN)
    return before + BEGIN + picture() + END + rest.partition(END)[2]


def main() -> None:
    """Print, or write."""
    if "--write" in sys.argv[1:]:
        PAGE.write_text(with_picture(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    else:
        sys.stdout.write(picture())


if __name__ == "__main__":
    main()
