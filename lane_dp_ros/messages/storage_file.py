# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The files that bags are stored in: told by their first bytes, and made ready for the rosbags library."""

from __future__ import annotations

import logging
import shutil
import sqlite3
import tempfile
from functools import cache
from pathlib import Path
from typing import Literal, NamedTuple

from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.unpacking import ZSTD_MAGIC, unpacked_file, zstd

Kind = Literal["mcap", "sqlite3", "ros1", "zstd"]

LARGE = 100_000_000  # bytes; a file of more takes longer than a second to copy or unpack

_LOGGER = logging.getLogger(__name__)
_MAGIC: dict[bytes, Kind] = {
    b"\x89MCAP0\r\n": "mcap",
    b"SQLite format 3\0": "sqlite3",
    b"#ROSBAG V2.0": "ros1",
    ZSTD_MAGIC: "zstd",
}
_SUFFIX = {"mcap": ".mcap", "sqlite3": ".db3", "ros1": ".bag"}  # by which rosbags tells them apart
_NO_BAGS = {  # what is no bag, by its first bytes, and what helps
    b"version https://git-lfs": "is a Git LFS pointer, not the file itself: git lfs pull",
    b"#ROSBAG V1": "is a ROS 1 bag of format 1: rosbag fix",
    b"PK\x03\x04": "is a zip archive: unpack it first",
    b"\x1f\x8b": "is packed by gzip: unpack it first",
    b"\xfd7zXZ": "is packed by xz: unpack it first",
    b"7z\xbc\xaf": "is a 7z archive: unpack it first",
    b"<!doctype html": "is a web page: its download went wrong",
    b"<html": "is a web page: its download went wrong",
}
_MENDED_BY = {
    "mcap": "mcap recover {path} -o mended.mcap",
    "sqlite3": "sqlite3 {path} .recover | sqlite3 mended.db3",
    "ros1": "rosbag reindex {path} (ROS 1), or rosbag fix",
}
_UNFINISHED = ("-wal", "-journal")  # files beside an SQLite database whose content belongs to it
_URI_SIGNS = set("#?%")  # rosbags makes an unquoted URI of a database's path


class StorageFile(NamedTuple):
    """A file with messages as it was named, its kind, and the path from which it is read."""

    path: Path
    kind: Kind
    readable: Path


def storage_file(path: Path) -> StorageFile:
    """Return a file made ready to be read: unpacked, with what a recorder that was killed left beside it.

    Raises CommandError for a file that is no bag, naming what it is and what helps.
    """
    kind = file_kind(path)
    if kind == "zstd":
        unpacked = _unpacked(path, path.stat().st_mtime_ns)
        return storage_file(unpacked)._replace(path=path)
    readable = path
    if kind == "sqlite3":
        if any(beside.stat().st_size for beside in _unfinished(path)):
            readable = _finished(path, tuple(each.stat().st_mtime_ns for each in (path, *_unfinished(path))))
        _check_database_size(readable)
    if readable.suffix != _SUFFIX[kind] or (kind == "sqlite3" and _URI_SIGNS & set(str(readable.absolute()))):
        readable = _renamed(readable.absolute(), f"storage{_SUFFIX[kind]}")
    return StorageFile(path, kind, readable)


def file_kind(path: Path) -> Kind:
    """Return what a file is by its first bytes, whatever its name. Raises CommandError for no bag's file."""
    try:
        with path.open("rb") as file:
            head = file.read(64)
    except OSError as error:
        raise CommandError(f"{path} cannot be read: {error.strerror}") from None
    if not head:
        raise CommandError(f"{path} is damaged: it is empty, a recording was expected")
    for magic, kind in _MAGIC.items():
        if head.startswith(magic):
            return kind
    for magic, what in _NO_BAGS.items():
        if head.lstrip().lower().startswith(magic.lower()):
            raise CommandError(f"{path} {what}")
    if any(magic.startswith(head) for magic in _MAGIC):
        raise CommandError(f"{path} is damaged: cut off after {len(head)} bytes")
    raise CommandError(f"{path} is no rosbag2: a bag folder, or a .mcap, .db3 or .bag file was expected")


def damaged(path: Path, kind: Kind, error: BaseException) -> CommandError:
    """Return what to say of a file that cannot be read to its end, with the tool that mends it."""
    mended = _MENDED_BY[kind].format(path=path.name)
    what = "ROS 1 bag that is damaged" if kind == "ros1" else "damaged file"
    return CommandError(f"{path} is a {what} (cut off?): {one_line(error)[:150]}; mend it: {mended}")


@cache  # a folder that is forgotten is removed
def _folder(_path: str, _mtime_ns: object) -> tempfile.TemporaryDirectory[str]:
    """Return a folder for what is made of one file; it is removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="lane_dp_")


def _unpacked(path: Path, mtime_ns: int) -> Path:
    """Return the file that `ros2 bag record --compression-mode file` packed, unpacked once a process."""
    target = Path(_folder(str(path.absolute()), mtime_ns).name, "unpacked")
    if not target.exists():
        _say_that_it_takes_long(path, "unpacked")
        try:
            with target.open("wb") as file:
                unpacked_file(path, file)
        except (OSError, EOFError, ValueError, zstd().ZstdError) as error:
            target.unlink(missing_ok=True)
            what = f"{path} is damaged (cut off?), or too large to unpack into {target.parent.parent}"
            raise CommandError(f"{what}: {one_line(error)}") from None
    return target


def _say_that_it_takes_long(path: Path, what: str) -> None:
    if (size := path.stat().st_size) > LARGE:
        _LOGGER.info("%s is %s first: %.1f GB", path, what, size / 1e9)


def _unfinished(path: Path) -> list[Path]:
    return [each for ending in _UNFINISHED if (each := path.with_name(path.name + ending)).is_file()]


def _finished(path: Path, mtimes_ns: tuple[int, ...]) -> Path:
    """Return a copy of a database that was not closed, with the messages that only its log holds."""
    target = Path(_folder(str(path.absolute()), mtimes_ns).name, "finished.db3")
    if not target.exists():
        _say_that_it_takes_long(path, "copied, as its recorder did not close it")
        try:
            for each in (path, *_unfinished(path)):
                shutil.copyfile(each, target.with_name(target.name + each.name[len(path.name) :]))
            connection = sqlite3.connect(target)
            connection.execute("PRAGMA journal_mode=DELETE").fetchone()
            connection.close()
        except (OSError, sqlite3.Error) as error:
            target.unlink(missing_ok=True)
            raise damaged(path, "sqlite3", error) from None
    return target


def _renamed(path: Path, name: str) -> Path:
    """Return a link to a file, under a name that rosbags takes."""
    link = Path(_folder(str(path), None).name, name)
    if not link.is_symlink():
        link.symlink_to(path)
    return link


def _check_database_size(path: Path) -> None:
    """Raise CommandError when an SQLite file is shorter than its header says.

    SQLite reads a last page that is cut off as if zeros followed: pixels would silently turn black.
    """
    with path.open("rb") as file:
        header = file.read(32)
    page_size, pages = int.from_bytes(header[16:18], "big"), int.from_bytes(header[28:32], "big")
    expected = pages * (65536 if page_size == 1 else page_size)  # the format's way of saying 64 KiB
    if (size := path.stat().st_size) < expected or len(header) < 32:
        raise damaged(path, "sqlite3", ValueError(f"{size} bytes, expected {max(expected, 512)}"))
