# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Write rosbag2 (MCAP, SQLite) with the rosbags library, without ROS; `BagReader` reads it."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

from lane_dp_ros.messages.bag_message import bag_message, typestore
from lane_dp_ros.messages.bag_output import Staging, check_output
from lane_dp_ros.messages.bag_reader import BagReader
from lane_dp_ros.messages.errors import CommandError, reason
from lane_dp_ros.messages.recording import RawMessage, latched_qos

__all__ = ["STORAGES", "BagReader", "BagWriter", "RawMessage", "bag_message"]

STORAGES = ("mcap", "sqlite3")


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
                    offered_qos_profiles=[latched_qos()] if latched else [],
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


@contextmanager
def _writable(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        raise CommandError(f"cannot write {path}: {reason(error)}") from error
