# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Read and write rosbag2 (MCAP, SQLite) with the rosbags library, without ROS."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from lane_dp_ros.messages.bag_message import bag_message, typestore
from lane_dp_ros.messages.bag_output import Staging, check_output
from lane_dp_ros.messages.errors import CommandError, one_line

__all__ = ["STORAGES", "BagReader", "BagWriter", "RawMessage", "bag_message"]

STORAGES = ("mcap", "sqlite3")


@dataclass(frozen=True)
class RawMessage:
    """A serialised message as it lies in a bag; `time_ns` is when it was recorded."""

    topic: str
    type_name: str
    time_ns: int
    data: bytes


class BagReader:
    """A rosbag2 folder, or a single .mcap or .db3 file, opened for reading (a context manager).

    Raises CommandError, in one line, for a path that is no bag and for a bag that is damaged.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        _check_bag(self.path)
        typestore()  # says so when rosbags is missing
        from rosbags.rosbag2 import Reader

        with _readable(self.path):
            self._reader = Reader(self.path)
            self._reader.open()

    def __enter__(self) -> BagReader:
        return self

    def __exit__(self, *_: object) -> None:
        self._reader.close()

    @property
    def topics(self) -> dict[str, str]:
        """Topic names and their message types."""
        return {connection.topic: connection.msgtype for connection in self._reader.connections}

    def message_count(self, topics: list[str] | None = None) -> int:
        """Return how many messages the named topics hold (all topics without names)."""
        return sum(c.msgcount for c in self._connections(topics))

    def raw_messages(self, topics: list[str] | None = None) -> Iterator[RawMessage]:
        """Yield the serialised messages of the named topics (all without names) by recording time."""
        connections = self._connections(topics)
        if not connections:
            return
        count = 0
        with _readable(self.path):
            for connection, time_ns, data in self._reader.messages(connections):
                count += 1
                yield RawMessage(connection.topic, connection.msgtype, time_ns, bytes(data))
        if count < (expected := self.message_count(topics)):
            raise CommandError(f"{self.path} is damaged: {count} of {expected} messages could be read")

    def messages(self, topics: list[str] | None = None) -> Iterator[tuple[str, int, Any]]:
        """Yield (topic, recording time [ns], message) of the named topics by recording time."""
        for raw in self.raw_messages(topics):
            with _readable(self.path):
                message = typestore().deserialize_cdr(raw.data, raw.type_name)
            yield raw.topic, raw.time_ns, message

    def messages_between(self, topic: str, start_ns: int, end_ns: int) -> Iterator[Any]:
        """Yield the messages of a topic that were recorded from `start_ns` to before `end_ns` [ns]."""
        if connections := self._connections([topic]):
            with _readable(self.path):
                found = self._reader.messages(connections, start=start_ns, stop=end_ns)
                yield from (typestore().deserialize_cdr(data, kind.msgtype) for kind, _, data in found)

    def _connections(self, topics: list[str] | None) -> list[Any]:
        return [c for c in self._reader.connections if topics is None or c.topic in topics]


class BagWriter:
    """A new rosbag2 (a context manager): a folder, or one file where `path` ends in .mcap.

    It appears at `path` only when the block ends well: no half-written bag is ever left there. The chunks of
    an MCAP are compressed by zstd.
    Raises CommandError when `path` exists (unless `force`, and then only a bag is replaced) or
    cannot be written.
    """

    def __init__(self, path: Path | str, storage: str = "mcap", force: bool = False) -> None:
        typestore()  # says so when rosbags is missing
        self.path = Path(path)
        self._storage, self._force = storage, force
        check_output(self.path, force)
        if storage == "sqlite3" and set("#?%") & set(str(self.path)):  # rosbags makes an unquoted URI of it
            raise CommandError(f"cannot write {self.path}: an SQLite bag's path must be free of #, ? and %")
        self._connections: dict[str, Any] = {}

    def __enter__(self) -> BagWriter:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

        plugin = StoragePlugin[self._storage.upper()]
        self._staging = Staging(self.path, self._force)
        try:
            with _writable(self.path):
                self._staging.make()
                folder = self._staging.folder / f"{self.path.stem}_0"  # names its storage as rosbag2 does
                self._writer = Writer(folder, version=9, storage_plugin=plugin)
                if self._storage == "mcap":
                    self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
                self._writer.open()
        except BaseException:  # an interruption, too
            self._staging.discard()
            raise
        return self

    def write(self, topic: str, time_ns: int, message: Any, latched: bool = False) -> None:
        """Append a message made by `bag_message`.

        A `latched` topic is one whose last message those get who come later, as of /tf_static.
        """
        type_name = message.__msgtype__
        data = bytes(typestore().serialize_cdr(message, type_name))
        self.write_raw(RawMessage(topic, type_name, time_ns, data), latched)

    def write_raw(self, raw: RawMessage, latched: bool = False) -> None:
        """Append a serialised message."""
        with _writable(self.path):
            if raw.topic not in self._connections:
                self._connections[raw.topic] = self._writer.add_connection(
                    raw.topic,
                    raw.type_name,
                    typestore=typestore(),
                    offered_qos_profiles=[_latched()] if latched else [],
                )
            self._writer.write(self._connections[raw.topic], raw.time_ns, raw.data)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            with _writable(self.path):
                self._writer.__exit__(kind, error, trace)
                if kind is None:
                    self._staging.publish(self._content())
        finally:
            self._staging.discard()

    def _content(self) -> Path:
        """Return what was written: the folder, or the one file in it that is asked for."""
        folder, one_file = self._writer.path, self._storage == "mcap" and self.path.suffix == ".mcap"
        return next(folder.glob("*.mcap")) if one_file else folder


def _check_bag(path: Path) -> None:
    if not path.exists():
        raise CommandError(f"{path}: no such bag")
    if path.is_dir() and not (path / "metadata.yaml").is_file():
        raise CommandError(f"{path} is no rosbag2: a folder with metadata.yaml was expected")
    if path.is_file() and path.suffix not in (".mcap", ".db3"):
        raise CommandError(f"{path} is no rosbag2: a bag folder, or a .mcap or .db3 file was expected")
    for database in path.glob("*.db3") if path.is_dir() else [path]:
        _check_database_size(database)


def _check_database_size(path: Path) -> None:
    """Raise CommandError when an SQLite file is shorter than its header says.

    SQLite reads a last page that is cut off as if zeros followed: pixels would silently turn black.
    """
    with path.open("rb") as file:
        header = file.read(32)
    if len(header) < 32 or not header.startswith(b"SQLite format 3"):
        return
    page_size, pages = int.from_bytes(header[16:18], "big"), int.from_bytes(header[28:32], "big")
    expected = pages * (65536 if page_size == 1 else page_size)  # the format's way of saying 64 KiB
    if (size := path.stat().st_size) < expected:
        raise CommandError(f"{path} is damaged: {size} bytes, expected {expected} (cut off?)")


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    # Broken bytes make rosbags, its SQLite and its decompressors raise almost anything (struct.error,
    # TypeError, apsw.Error ...); only their calls stand in this block.
    try:
        yield
    except Exception as error:
        raise CommandError(f"{path} cannot be read (damaged or cut off?): {one_line(error)}") from error


def _latched() -> Any:
    """Return the QoS of a topic that is published once: reliable and transient local."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    ever = QosTime(2147483647, 4294967295)
    reliable, local = QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL
    automatic = QosLiveliness.AUTOMATIC
    return Qos(QosHistory.KEEP_LAST, 1, reliable, local, ever, ever, automatic, ever, False)


@contextmanager
def _writable(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        raise CommandError(f"cannot write {path}: {one_line(error)}") from error
