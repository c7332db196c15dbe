# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Versions of this project, as git revisions or folders, and the lanes that they find in a bag.

A version is driven by its command `lane_dp` alone, run from its own tree: whatever else of it may have moved.
"""

from __future__ import annotations

import hashlib
import io
import os
import re
import subprocess
import sys
import tarfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np

from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.answers import FrameAnswer
from lane_dp_ros.tools.evaluation.recorded_lanes import lanes_topic, recorded_answers

HERE = Path(__file__).resolve().parents[1]
# Says so where another copy of the package, an installed one, comes first.
START = """
import sys
from pathlib import Path
from {module} import {function} as main
if not Path(sys.modules[main.__module__].__file__).resolve().is_relative_to({root!r}):
    sys.exit("{module} is not that of " + {root!r})
sys.exit(main())
"""


@dataclass(frozen=True, eq=False)
class Version:
    """A tree of the project, and the folder that keeps its answers."""

    root: Path
    answers: Path

    def lane_dp(self, *arguments: str | Path) -> None:
        """Run its command lane_dp. Raises CommandError with the last line that a failing one prints."""
        module, function = entry_point(self.root)
        code = START.format(module=module, function=function, root=str(self.root))
        path = os.pathsep.join(filter(None, [str(self.root), os.environ.get("PYTHONPATH")]))
        ended = subprocess.run(
            [sys.executable, "-c", code, *map(str, arguments)],
            cwd=self.root,
            env={**os.environ, "PYTHONPATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
        if ended.returncode:
            raise CommandError(f"lane_dp {arguments[0]} of {self.root}: {_last_line(ended.stderr)}")

    def lanes_in(self, bag: Path, preset: str) -> dict[int, FrameAnswer]:
        """Return its answers to the pairs of a bag, by stamp [ns]; they are worked out once and kept."""
        kept = self.answers / f"{preset}-{fingerprint(sorted(bag.glob('*.mcap')))}"
        if not kept.exists():
            self.answers.mkdir(parents=True, exist_ok=True)
            with TemporaryDirectory() as folder:
                self.lane_dp("run", bag, "-o", Path(folder) / "out", "--preset", preset)
                _keep_lanes(Path(folder) / "out", kept)
        with BagReader(kept) as reader:
            return recorded_answers(reader, _lanes_topic(reader)).answers


@contextmanager
def version(name: str, cache: Path) -> Iterator[Version]:
    """Open a version by its git revision or its folder.

    The answers of a commit are kept in `cache`, those of a folder with changes only as long as the block
    lasts. Raises CommandError for what is neither revision nor folder.
    """
    with TemporaryDirectory() as temporary:
        root = Path(name).resolve() if Path(name).is_dir() else Path(temporary) / "tree"
        if Path(name).is_dir():
            commit = clean_commit(root)
        else:
            commit = _git(HERE, "rev-parse", "--verify", f"{name}^{{commit}}").decode().strip()
            _extract(commit, root)
        kept = f"{commit}-numpy-{np.__version__}-opencv-{cv2.__version__}"
        yield Version(root, cache / "answers" / kept if commit else Path(temporary) / "answers")


def clean_commit(root: Path) -> str | None:
    """Return the commit that a folder is a checkout of, None where it has changes, or is none at all."""
    try:
        top = Path(_git(root, "rev-parse", "--show-toplevel").decode().strip())
        if top.resolve() != root or _git(root, "status", "--porcelain"):
            return None
        return _git(root, "rev-parse", "HEAD").decode().strip()
    except CommandError:
        return None


def entry_point(root: Path) -> tuple[str, str]:
    """Return module and function of the command lane_dp, as the tree's setup.py names them."""
    setup = root / "setup.py"
    text = setup.read_text(encoding="utf-8") if setup.is_file() else ""
    found = re.search(r"""["']lane_dp\s*=\s*([\w.]+):(\w+)["']""", text)
    if found is None:
        raise CommandError(f"{setup} names no command 'lane_dp = module:function'")
    return found[1], found[2]


def fingerprint(files: Iterable[Path]) -> str:
    """Return what tells files of other names or content apart, as 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]


def _extract(commit: str, folder: Path) -> None:
    with tarfile.open(fileobj=io.BytesIO(_git(HERE, "archive", "--format=tar", commit))) as archive:
        archive.extractall(folder, filter="data")


def _git(folder: Path, *arguments: str) -> bytes:
    ended = subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True, check=False)
    if ended.returncode:
        raise CommandError(f"git {' '.join(arguments)}: {_last_line(ended.stderr.decode())}")
    return ended.stdout


def _last_line(text: str) -> str:
    return next(reversed(text.strip().splitlines()), "it failed without a word")


def _keep_lanes(bag: Path, kept: Path) -> None:
    """Copy the lanes and the cameras; the pictures of a run are a hundred times as large."""
    with BagReader(bag) as reader:
        topic = _lanes_topic(reader)
        infos = [f"{topic.removesuffix('lanes')}{side}/camera_info" for side in ("left", "right")]
        with BagWriter(kept) as writer:
            for message in reader.raw_messages([topic, *infos]):
                writer.write_raw(message)


def _lanes_topic(reader: BagReader) -> str:
    topic = lanes_topic(reader)
    if topic is None:
        raise CommandError(f"{reader.path} has no lanes")
    return topic
