# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""docs/troubleshooting.md has an entry for each message that the node can say, and for no other."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CODE = ROOT / "lane_dp_ros"
PAGE = ROOT / "docs" / "troubleshooting.md"
HOLE = "…"  # stands for a value
MIN_WORDS = 3  # fewer are a name or a key; in a verdict, none is

NODE = "lane_dp_ros.ros.lane_detector_node"
# What goes wrong is raised; what is seen of the road and the calibration is told by these.
TELLING = ("core/monitoring/*.py", "core/detector.py", "core/pipeline.py", "core/tracking/road_filter.py")
# A caller's mistake that the node does not make: arrays of a wrong shape, a preset of another name.
OF_THE_LIBRARY = ("core/dp/", "core/config.py", "core/types.py")


def template(node: ast.AST) -> str:
    """Return a string with a hole for each value that is put into it, empty for what is no string."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(template(part) if isinstance(part, ast.Constant) else HOLE for part in node.values)
    return ""


def files(*patterns: str) -> Iterator[tuple[str, ast.Module]]:
    for path in sorted({path for pattern in patterns for path in CODE.glob(pattern)}):
        name = path.relative_to(CODE).as_posix()
        if not name.startswith(OF_THE_LIBRARY):
            yield name, ast.parse(path.read_text(encoding="utf-8"))


def imported(module: str, found: set[Path]) -> set[Path]:
    """Add to `found` the file of a module of the package, and those of all that it imports."""
    path = ROOT.joinpath(*module.split(".")).with_suffix(".py")
    if path in found or not path.exists():
        return found
    found.add(path)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("lane_dp_ros"):
            for name in [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]:
                imported(name, found)
    return found


def without_writers(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the nodes of a file but for those of `x_to_ros`, which get what the node itself has made."""
    for part in tree.body:
        if not (isinstance(part, ast.FunctionDef) and part.name.endswith("_to_ros")):
            yield from ast.walk(part)


def raised() -> set[str]:
    """Return the messages of all ValueErrors in what the node imports."""
    of_the_node = {path.relative_to(CODE).as_posix() for path in imported(NODE, set())}
    return {
        template(node.exc.args[0])
        for name, tree in files("**/*.py")
        if name in of_the_node
        for node in without_writers(tree)
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)
        if getattr(node.exc.func, "id", "") == "ValueError"
    }


def sentences(tree: ast.AST, min_words: int = MIN_WORDS) -> set[str]:
    """Return the strings of so many words in some code that are no docstrings, no parts of others."""
    found = [node for node in ast.walk(tree) if isinstance(node, (ast.Constant, ast.JoinedStr))]
    documentation = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    parts = {id(part) for node in found if isinstance(node, ast.JoinedStr) for part in ast.walk(node)}
    alone = [
        node
        for node in found
        if id(node) not in documentation and (isinstance(node, ast.JoinedStr) or id(node) not in parts)
    ]
    return {text for text in map(template, alone) if len(re.findall(r"[A-Za-z']{2,}", text)) >= min_words}


def told() -> set[str]:
    """Return what the detector, the monitors and the summary of /diagnostics can say."""
    found = {each for _, tree in files(*TELLING) for each in sentences(tree)}
    [(_, diagnostics)] = files("ros/diagnostics.py")
    verdicts = [
        node
        for node in ast.walk(diagnostics)
        if isinstance(node, ast.FunctionDef) and node.name in ("_verdict", "_troubles")
    ]
    assert len(verdicts) == 2
    return (found - raised()).union(*(sentences(each, min_words=2) for each in verdicts))


def entries() -> list[str]:
    """Return the messages of the page's tables."""
    return re.findall(r"^\| `([^`]+)` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_messages_are_found_in_the_code():
    assert "images are …, their CameraInfo says …, expected equal sizes" in raised()
    assert "A frame failed: …" in told()
    assert any("left and right swapped" in message for message in told())


def test_each_message_of_the_node_has_an_entry():
    assert sorted(raised() | told()) == sorted(entries())


def test_no_message_has_two_entries():
    assert len(entries()) == len(set(entries()))
