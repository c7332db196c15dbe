# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of README.md and the quick start as a reader types them, in each way to install.

    python .ci/docs_test.py {make,pip,colcon} [FILE ...]

The last commit is cloned and installed. Then all fenced blocks without a language, of sh, bash and python are
run, file by file, in one shell that starts in the clone; the first command that fails ends it.
`<this repository>` is this one; the home folder is empty but for ws/src. A comment before a fence says what
its block needs:

    <!-- docs-test: make -->         run only when installed in this way (or in several: make, pip)
    <!-- docs-test: needs ROS -->    run only when installed by colcon; lines whose program is missing are not
    <!-- docs-test: needs data -->   not run: it needs data, a robot, a screen, or more time than a test has

Nodes and launch files are interrupted after a while and must end with 0.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import requires
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FILES = ("README.md", "docs/quick_start.md")
# As README.md has it. Outside of a venv colcon's users have no name lane_dp: ros2 run finds it.
INSTALL = {
    "make": "make\n. .venv/bin/activate",
    "pip": "python3 -m venv venv\n. venv/bin/activate\npip install --quiet .",
    "colcon": "cd ~/ws\ngit clone --quiet $CLONE src/lane_dp_ros\ncolcon build\n. install/setup.bash",
}
ALIAS = 'lane_dp() { ~/ws/install/lane_dp_ros/lib/lane_dp_ros/lane_dp "$@"; }'
WAYS = rf"(?:{'|'.join(INSTALL)})"
MARKER = re.compile(rf"|needs \w[\w ]*|{WAYS}(?:, {WAYS})*")
FENCE = re.compile(
    r"^(?:<!-- docs-test: (?P<marker>.*?) -->\s*\n)?```(?P<language>sh|bash|python|)\n(?P<text>.*?)^```[ ]*$"
    r"|^```\w+\n.*?^```[ ]*$",
    re.MULTILINE | re.DOTALL,
)
STRICT = "set -Eeo pipefail\ntrap 'echo \"failed: $BASH_COMMAND\" >&2' ERR\nshopt -s expand_aliases"
ENDLESS = re.compile(r"ros2 launch |ros2 run lane_dp_ros lane_detector\b")
LIMIT, RUNNING = 400, 10  # s, for all commands; for one that runs until it is interrupted
OURS = (
    "PYTHONPATH",
    "LD_LIBRARY_PATH",
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
    "VIRTUAL_ENV",
    "MAKEFLAGS",
    "MAKELEVEL",
)


@dataclass(frozen=True)
class Block:
    """A fenced block: what its comment says, its language, its text, and the line where that begins."""

    marker: str
    language: str
    text: str
    line: int


def blocks(text: str) -> Iterator[Block]:
    """Yield the blocks of a page that can be run. Raises ValueError for a comment that is not understood."""
    for match in FENCE.finditer(text):
        if match["text"] is None:  # of another language
            continue
        marker, line = match["marker"] or "", text[: match.start("text")].count("\n") + 1
        if not MARKER.fullmatch(marker):
            raise ValueError(f"line {line}: docs-test: {marker}: expected needs ..., or {', '.join(INSTALL)}")
        yield Block(marker, match["language"], match["text"], line)


def chosen(block: Block, way: str, path: str) -> str:
    """Return what is run of a block when installed in this way, programs being looked for in `path`."""
    if block.marker == "needs ROS" and way == "colcon":
        commands = re.sub(r"\\\n", "", block.text).splitlines()
        here = [
            each
            for each in commands
            if shutil.which((shlex.split(each, comments=True) or ["true"])[0], path=path)
        ]
        return "\n".join(map(bounded, here))
    ways = block.marker.split(", ") if block.marker else INSTALL
    return block.text if way in ways else ""


def bounded(command: str) -> str:
    """Return a command; one that runs until Ctrl-C, as a node does, gets that soon, and must end well."""
    runs_on = ENDLESS.match(command) and not re.search(r"--show-args|--help|--version", command)
    return f"timeout --preserve-status --signal=INT {RUNNING} {command}" if runs_on else command


def script(pages: dict[str, list[Block]], way: str, path: str) -> str:
    """Return what bash runs: the installation, then the pages' blocks."""
    lines = [STRICT, _shown(INSTALL[way]), ALIAS if way == "colcon" else ""]
    for name, page in pages.items():
        lines.append("cd $CLONE")
        for block in page:
            if text := chosen(block, way, path).rstrip("\n").replace("<this repository>", "$CLONE"):
                lines.append(f"echo '== {name}:{block.line}'")
                if block.language == "python":
                    lines.append(f"python3 - <<'END_OF_PYTHON'\n{text}\nEND_OF_PYTHON")
                else:
                    lines.append(_shown(text))
    return "\n".join([*lines, "echo '== all of it ran'", ""])


def _shown(commands: str) -> str:
    return f"cat <<'END_OF_COMMANDS'\n{commands}\nEND_OF_COMMANDS\n{commands}"


def environment(home: Path, way: str, python: str) -> dict[str, str]:
    """Return a reader's environment: nothing of ours in it, an empty home, `python3` the one asked for."""
    kept = {
        name: value for name, value in os.environ.items() if name not in OURS or "ROS_DISTRO" in os.environ
    }
    (home / "bin").mkdir()
    found = Path(shutil.which(python) or python).absolute()
    (home / "bin" / "python3").write_text(f'#!/bin/sh\nexec {shlex.quote(str(found))} "$@"\n')
    (home / "bin" / "python3").chmod(0o755)
    folders = [str(home / "bin"), kept["PATH"]]
    if way == "colcon" and "ROS_DISTRO" not in os.environ:
        folders.insert(0, str(_ros_and_colcon(home / "ros", str(found)) / "bin"))
    cache = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    return {
        **kept,
        "HOME": str(home),
        "CLONE": str(home / "lane_dp_ros"),
        "PATH": os.pathsep.join(folders),
        "XDG_CACHE_HOME": cache,
        "PIP_DISABLE_PIP_VERSION_CHECK": "1",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }


def _ros_and_colcon(folder: Path, python: str) -> Path:
    """Return a venv with what a machine with ROS has, and rosbags, which README.md has its reader add."""
    wheels = [
        text.partition(";")[0].strip() for text in requires("lane_dp_ros") or () if text.startswith("ros-")
    ]
    apt = ["argcomplete", "colcon-common-extensions", "opencv-python-headless", "pytest", "pyyaml", "tqdm"]
    subprocess.run([python, "-m", "venv", folder], check=True)
    pip = [folder / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, *wheels, *apt, "rosbags"], check=True)
    return folder


def main() -> int:
    """Run the pages' commands; return 0, or 1 when one failed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("way", choices=INSTALL)
    parser.add_argument("files", nargs="*", default=[name for name in FILES if (ROOT / name).is_file()])
    parser.add_argument("--python", default=sys.executable, help="the reader's python3")
    arguments = parser.parse_args()
    pages = {name: list(blocks((ROOT / name).read_text(encoding="utf-8"))) for name in arguments.files}
    with tempfile.TemporaryDirectory(prefix="docs-test-") as folder:
        home = Path(folder)
        (home / "ws" / "src").mkdir(parents=True)
        variables = environment(home, arguments.way, arguments.python)
        subprocess.run(["git", "clone", "--quiet", ROOT, variables["CLONE"]], check=True)
        text = script(pages, arguments.way, variables["PATH"])
        command = ["timeout", str(LIMIT), "bash", "-c", text]
        return subprocess.run(command, cwd=variables["CLONE"], env=variables, check=False).returncode and 1


if __name__ == "__main__":
    sys.exit(main())
