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
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.recording import RawMessage

__all__ = ["STORAGES", "BagReader", "BagWriter", "RawMessage", "bag_message"]

STORAGES = ("mcap", "sqlite3")


class BagWriter:
    """A new rosbag2 folder (a context manager).

    It appears at `path` only when the block ends well: no half-written bag is ever left there.
    Raises CommandError when `path` exists (unless `force`, and then only a bag is replaced) or
    cannot be written.
    """

    def __init__(self, path: Path | str, storage: str = "mcap", force: bool = False) -> None:
        typestore()  # says so when rosbags is missing
        self.path = Path(path)
        self._storage = storage
        check_output(self.path, force)
        if storage == "sqlite3" and set("#?%") & set(str(self.path)):  # rosbags makes an unquoted URI of it
            raise CommandError(f"cannot write {self.path}: an SQLite bag's path must be free of #, ? and %")
        self._connections: dict[str, Any] = {}

    def __enter__(self) -> BagWriter:
        from rosbags.rosbag2 import StoragePlugin, Writer

        plugin = StoragePlugin[self._storage.upper()]
        self._staging = Staging(self.path)
        try:
            with _writable(self.path):
                self._staging.make()
                self._writer = Writer(self._staging.content, version=9, storage_plugin=plugin)
                self._writer.open()
        except BaseException:  # an interruption, too
            self._staging.discard()
            raise
        return self

    def write(self, topic: str, time_ns: int, message: Any) -> None:
        """Append a message made by `bag_message`."""
        type_name = message.__msgtype__
        data = bytes(typestore().serialize_cdr(message, type_name))
        self.write_raw(RawMessage(topic, type_name, time_ns, data))

    def write_raw(self, raw: RawMessage) -> None:
        """Append a serialised message."""
        with _writable(self.path):
            if raw.topic not in self._connections:
                self._connections[raw.topic] = self._writer.add_connection(
                    raw.topic, raw.type_name, typestore=typestore()
                )
            self._writer.write(self._connections[raw.topic], raw.time_ns, raw.data)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            with _writable(self.path):
                self._writer.__exit__(kind, error, trace)
                if kind is None:
                    self._staging.publish()
        finally:
            self._staging.discard()


@contextmanager
def _writable(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        raise CommandError(f"cannot write {path}: {one_line(error)}") from error
