# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Where bags and other files are written: beside their place first, moved there when they are complete."""

from __future__ import annotations

import glob
import os
import shutil
from pathlib import Path

from lane_dp_ros.messages.bag_files import BESIDE_STORAGE, STORAGE_ENDINGS
from lane_dp_ros.messages.errors import CommandError

_MAGIC = {".mcap": b"\x89MCAP", ".db3": b"SQLite format 3\0"}
_BAG_ENDINGS = (*STORAGE_ENDINGS, *BESIDE_STORAGE)


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
    """Raise CommandError when a bag must not be written to `path`: it is there, or holds more than a bag."""
    if not os.path.lexists(path):
        return
    if not force:
        raise CommandError(f"{path} exists already: choose another name, or add --force to replace it")
    if not is_bag(path):
        raise CommandError(f"{path} is no rosbag2, so --force does not delete it: choose another name")


def check_file_output(path: Path, force: bool) -> None:
    """Raise CommandError when a file must not be written to `path`: it is there, or is a folder."""
    if not os.path.lexists(path):
        return
    if not force:
        raise CommandError(f"{path} exists already: choose another name, or add --force to replace it")
    if not path.is_file():
        raise CommandError(f"{path} is no file, so --force does not delete it: choose another name")


class Staging:
    """A hidden folder beside `path` whose content is moved to `path` when complete.

    What stands at `path` by then is replaced with `force` alone.
    """

    def __init__(self, path: Path, force: bool = False) -> None:
        self.path = path
        self._force = force
        self.folder = path.with_name(f".{path.name}.{os.getpid()}.part")

    def make(self) -> None:
        """Make the folder; those of processes that were killed go. Raises OSError where none can be made."""
        self.discard()  # one that was killed may have had our process id
        for left in self.path.parent.glob(f".{glob.escape(self.path.name)}.*.part"):
            if not _is_alive(left.suffixes[-2][1:]):
                shutil.rmtree(left, ignore_errors=True)
        self.folder.mkdir(parents=True)

    def publish(self, content: Path) -> None:
        """Move `content`, which lies in the folder, to its place; what stood there before goes.

        Raises CommandError where something stands there that was not there at first, unless `force`.
        """
        if os.path.lexists(self.path):
            if not self._force:
                raise CommandError(f"{self.path} was made by somebody else meanwhile: choose another name")
            self.path.rename(self.folder / "replaced")
        content.rename(self.path)
        self.discard()

    def discard(self) -> None:
        """Remove whatever is left."""
        shutil.rmtree(self.folder, ignore_errors=True)


def _is_alive(process: str) -> bool:
    """Whether a process of that number runs; what is no number is left alone as if it did."""
    try:
        os.kill(int(process), 0)
    except (ProcessLookupError, OverflowError):
        return False
    except (ValueError, PermissionError):
        return True
    return True
