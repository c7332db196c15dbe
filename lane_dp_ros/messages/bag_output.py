# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where a bag is written: beside its place first, moved there when it is complete."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from lane_dp_ros.messages.bag_files import STORAGE_ENDINGS
from lane_dp_ros.messages.errors import CommandError

_MAGIC = {".mcap": b"\x89MCAP", ".db3": b"SQLite format 3\0"}
_BAG_ENDINGS = (*STORAGE_ENDINGS, ".db3-wal", ".db3-shm")


def is_bag(path: Path) -> bool:
    """Whether `path` is a rosbag2 file, or a folder that holds a rosbag2 and nothing else."""
    if path.is_symlink():
        return False
    if path.is_dir():
        names = sorted(entry.name for entry in path.iterdir() if entry.is_file())
        storages = [name for name in names if name.endswith(_BAG_ENDINGS)]
        others = {entry.name for entry in path.iterdir()} - {"metadata.yaml", *storages}
        return bool(storages) and not others
    magic = _MAGIC.get(path.suffix)
    if magic is None or not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(magic)) == magic


def check_output(path: Path, force: bool) -> None:
    """Raise CommandError when `path` must not be written: it is there, or holds more than a bag."""
    if not os.path.lexists(path):
        return
    if not force:
        raise CommandError(f"{path} exists already: choose another name, or add --force to replace it")
    if not is_bag(path):
        raise CommandError(f"{path} is no rosbag2, so --force does not delete it: choose another name")


class Staging:
    """A hidden folder beside `path` whose content is moved to `path` when complete."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._folder = path.with_name(f".{path.name}.{os.getpid()}.part")
        self.content = self._folder / f"{path.stem}_0"  # the storage file in it will be named as by rosbag2

    def make(self) -> None:
        """Make the folder. Raises OSError where nothing can be written."""
        self.discard()  # one that was killed may have had our process id
        self._folder.mkdir(parents=True)

    def publish(self) -> None:
        """Move the content to its place; what stood there before goes."""
        if os.path.lexists(self.path):
            self.path.rename(self._folder / "replaced")
        self.content.rename(self.path)
        self.discard()

    def discard(self) -> None:
        """Remove whatever is left."""
        shutil.rmtree(self._folder, ignore_errors=True)
