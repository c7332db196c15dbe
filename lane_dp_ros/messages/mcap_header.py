# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""MCAP files that other tools wrote in their own way, shown to the rosbags library as it wants them.

Bytes are put in the place of others as the file is read and none is added: each offset stays right.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

_PROFILE, _ROS2 = 17, b"\x04\0\0\0ros2"  # where the profile stands, and how rosbags wants it
_FOOTER = 37  # bytes from the footer to the file's end
_SUMMARY_START = 9  # where the footer says the place of the summary, 8 bytes; 0: there is none
_SCHEMA, _CHANNEL, _CHUNK_INDEX, _STATISTICS = 3, 4, 8, 11  # kinds of records
_ENTRIES = {_CHUNK_INDEX: 32, _STATISTICS: 42}  # where they say how many bytes of entries by channel follow
_LONGEST = 1 << 28  # bytes of a record of the summary
_DATA_END = b"\x0f\x04\0\0\0\0\0\0\0"  # a record that stands before the summary, and its checksum of 4 bytes


def readable_mcap(path: Path) -> Path | _Changed:
    """Return the path of an MCAP file, one that opens with changed bytes where rosbags would refuse the file.

    Tools that merge or filter leave the profile empty: it reads ros2. A summary that does not stand where the
    footer says, or lacks what the specification lets it lack, is left aside: the file is scanned.
    """
    changes = {}
    with path.open("rb") as file:
        head = file.read(_PROFILE + len(_ROS2))
        if head[_PROFILE:] != _ROS2:
            changes[_PROFILE] = _ROS2
        if (start := _summary_start(file)) and not _is_summary(file, start):
            changes[file.seek(0, io.SEEK_END) - _FOOTER + _SUMMARY_START] = bytes(8)
    return _Changed(path, changes) if changes else path


def _summary_start(file: io.BufferedReader) -> int:
    """Return where the footer says that the summary stands, 0 for none or for a file that is cut off."""
    size = file.seek(0, io.SEEK_END)
    if size < _PROFILE + _FOOTER:
        return 0
    file.seek(size - _FOOTER)
    footer = file.read(_FOOTER)
    is_footer = footer.startswith(b"\x02\x14")
    return int.from_bytes(footer[_SUMMARY_START : _SUMMARY_START + 8], "little") if is_footer else 0


def _is_summary(file: io.BufferedReader, start: int) -> bool:
    """Return whether the summary stands there and tells all that rosbags takes from it."""
    before = start - len(_DATA_END) - 4
    if before < 0 or start > file.seek(0, io.SEEK_END):
        return False
    file.seek(before)
    if file.read(len(_DATA_END)) != _DATA_END:
        return False
    file.seek(start)
    told = set()
    for kind, content in _records(file):
        place = _ENTRIES.get(kind)
        if place is None or any(content[place : place + 4]):
            told.add(kind)
    return told >= {_SCHEMA, _CHANNEL, *_ENTRIES}


def _records(file: io.BufferedReader) -> Iterator[tuple[int, bytes]]:
    """Yield kind and content of the records up to the footer."""
    while (head := file.read(9))[:1] not in (b"", b"\x02"):
        yield head[0], file.read(min(int.from_bytes(head[1:], "little"), _LONGEST))


class _Changed:
    """A path, as rosbags takes it, whose file opens with some bytes changed, by their place."""

    def __init__(self, path: Path, changes: dict[int, bytes]) -> None:
        self._path, self._changes = path, changes

    def __getattr__(self, name: str) -> Any:
        return getattr(self._path, name)

    def __str__(self) -> str:
        return str(self._path)

    def open(self, _mode: str = "rb") -> io.BufferedReader:
        """Open for reading bytes."""
        return io.BufferedReader(_ChangedFile(str(self._path), self._changes))


class _ChangedFile(io.FileIO):
    """A file that reads with some bytes changed."""

    def __init__(self, path: str, changes: dict[int, bytes]) -> None:
        super().__init__(path, "r")
        self._changes = changes

    def readinto(self, buffer: Any) -> int:
        """Read as FileIO does, then change what is to be changed."""
        start = self.tell()
        count = super().readinto(buffer) or 0
        view = memoryview(buffer).cast("B")
        for place, data in self._changes.items():
            for i, byte in enumerate(data, start=place - start):
                if 0 <= i < count:
                    view[i] = byte
        return count

    def readall(self) -> bytes:
        """Read to the end by `readinto`."""
        buffer = bytearray(os.fstat(self.fileno()).st_size - self.tell())
        return bytes(buffer[: self.readinto(buffer)])
