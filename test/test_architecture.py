# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""docs/architecture.md shows the package as it is."""

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "architecture.md"


@pytest.fixture(scope="module")
def draw():
    return runpy.run_path(str(ROOT / "docs" / "draw_imports.py"))


def test_the_picture_is_that_of_the_imports(draw):
    text = PAGE.read_text(encoding="utf-8")
    assert draw["with_picture"](text) == text, "python docs/draw_imports.py --write"


def test_every_folder_with_code_is_in_the_picture(draw):
    folders = {path.parent.relative_to(ROOT) for path in (ROOT / "lane_dp_ros").rglob("*.py")}
    modules = {".".join(folder.parts) for folder in folders}
    of_no_room = {module for module in modules if draw["room_of"](module) is None}
    assert of_no_room == {"lane_dp_ros", "lane_dp_ros.core", "lane_dp_ros.tools"}


def test_no_arrow_runs_back(draw):
    """Each room imports rooms that are no deeper in what they import."""
    found = draw["arrows"]()
    assert found["core.pipeline"] >= {"core.detector"} and "messages" not in found["core.pipeline"]
    for room, there in found.items():
        assert not any(room in found[each] for each in there), room


def test_arrows_that_others_imply_are_left_out(draw):
    assert draw["without_implied"]({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == {
        "a": {"b"},
        "b": {"c"},
        "c": set(),
    }


def test_every_file_that_the_page_names_exists():
    text = PAGE.read_text(encoding="utf-8").partition("## The walk of an image")[2]
    names = re.findall(r"`((?:core|messages|ros|tools|scenes|config)/[a-z_/]+(?:\.[a-z]+)?/?)`", text)
    assert len(names) > 20
    for name in names:
        assert (ROOT / "lane_dp_ros" / name).exists() or (ROOT / name).exists(), name
