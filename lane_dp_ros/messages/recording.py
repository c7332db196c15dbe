# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""One file of a bag opened by the rosbags library: its topics, and its messages as ROS 2 has them."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from lane_dp_ros.messages.bag_message import typestore
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.mcap_header import readable_mcap
from lane_dp_ros.messages.storage_file import StorageFile, damaged
from lane_dp_ros.messages.unpacking import bound_unpacking, unpacked_message

_LOGGER = logging.getLogger(__name__)

Convert = Callable[[bytes], bytes]


@dataclass(frozen=True)
class RawMessage:
    """A serialised message (CDR) as it lies in a bag; `time_ns` is when it was recorded."""

    topic: str
    type_name: str
    time_ns: int
    data: bytes


@dataclass(frozen=True, eq=False)
class Channel:
    """A topic of one file: its type, messages and recorded offers (rosbags.interfaces.Qos).

    `convert` makes ROS 2's CDR of what lies in the file, `connection` is how rosbags knows it.
    """

    topic: str
    type_name: str
    count: int
    qos: tuple[Any, ...]
    convert: Convert
    connection: Any


class Recording:
    """A storage file of a rosbag2, or a ROS 1 bag, opened for reading.

    Topics that are not serialised as ROS 2 does it, or whose ROS 1 type ROS 2 has not, are left out:
    `left_out` messages.
    Raises CommandError, in one line, for a file that is damaged.
    """

    def __init__(self, file: StorageFile) -> None:
        self.file = file
        with self._readable():
            self._reader = _opened(file)
            self.channels = tuple(_channels(self._reader.connections, file.kind == "ros1"))
            self.left_out = self._reader.message_count - sum(channel.count for channel in self.channels)
            self.start_ns, self.end_ns = self._reader.start_time, self._reader.end_time

    def close(self) -> None:
        """Close the file."""
        self._reader.close()

    def messages(
        self, channels: Sequence[Channel], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RawMessage]:
        """Yield the messages of some of `channels` by recording time, `start_ns` <= time < `end_ns` [ns].

        An MCAP file without an index is read in the order in which it was written.
        """
        if not channels:
            return
        by_id = {channel.connection.id: channel for channel in channels}
        count = 0
        with self._readable():
            for connection, time_ns, data in self._read([c.connection for c in channels], start_ns, end_ns):
                channel, count = by_id[connection.id], count + 1
                yield RawMessage(channel.topic, channel.type_name, time_ns, channel.convert(data))
        expected = sum(channel.count for channel in channels)
        if start_ns is None and end_ns is None and count < expected:
            raise damaged(
                self.file.path, self.file.kind, ValueError(f"{count} of {expected} messages could be read")
            )

    def _read(self, connections: list[Any], start_ns: int | None, end_ns: int | None) -> Iterator[Any]:
        if self.file.kind == "mcap" and not self._reader.storage.chunks:
            yield from self._reader.storage.messages_scan(connections, start_ns, end_ns)
        else:
            yield from self._reader.messages(connections, start_ns, end_ns)

    @contextmanager
    def _readable(self) -> Iterator[None]:
        # Broken bytes make rosbags, its SQLite and its decompressors raise almost anything (struct.error,
        # TypeError, apsw.Error ...).
        try:
            yield
        except CommandError:
            raise
        except Exception as error:
            raise damaged(self.file.path, self.file.kind, error) from error


def _opened(file: StorageFile) -> Any:
    from rosbags import rosbag1, rosbag2

    bound_unpacking()
    if file.kind == "ros1":
        reader: Any = rosbag1.Reader(file.readable)
    else:
        reader = rosbag2.Reader(readable_mcap(file.readable) if file.kind == "mcap" else file.readable)
    try:
        reader.open()
    except KeyError as error:  # an encoding of schemas that is none of ROS 2's
        what = f"holds topics of another kind than ROS 2's ({error}): take them out, by mcap filter"
        raise CommandError(f"{file.path} {what}") from None
    return reader


def _channels(connections: Sequence[Any], is_ros1: bool) -> Iterator[Channel]:
    from rosbags.typesys.msg import normalize_msgtype

    for each in connections:
        name = f"/{each.topic.lstrip('/')}"  # some writers leave the slash away
        if is_ros1:
            if each.msgtype in typestore().types:
                qos = (latched_qos(),) if each.ext.latching else ()
                yield Channel(name, each.msgtype, each.msgcount, qos, _from_ros1(each), each)
        elif each.ext.serialization_format == "cdr":
            qos = tuple(each.ext.offered_qos_profiles)
            # Some writers leave /msg/ away.
            kind = normalize_msgtype(each.msgtype) if each.msgtype.count("/") == 1 else each.msgtype
            yield Channel(name, kind, each.msgcount, qos, unpacked_message, each)
        else:
            _LOGGER.warning(
                "%s is left out: serialised as %s, not as cdr", name, each.ext.serialization_format
            )


def _from_ros1(connection: Any) -> Convert:
    """Return what makes CDR of a ROS 1 topic's messages, by the definition that its bag brings along."""
    from rosbags.convert.converter import migrate_bytes
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    kind, ros1 = connection.msgtype, get_typestore(Stores.EMPTY)
    ros1.register(get_types_from_msg(connection.msgdef.data, kind))
    cache: dict[str, object] = {}
    migrate = partial(migrate_bytes, ros1, typestore(), kind, kind, cache)
    return lambda data: bytes(migrate(data, src_is2=False, dst_is2=True))


def latched_qos() -> Any:
    """Return the QoS (rosbags.interfaces.Qos) of a topic that is published once."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    ever = QosTime(2147483647, 4294967295)
    reliable, local = QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL
    return Qos(QosHistory.KEEP_LAST, 1, reliable, local, ever, ever, QosLiveliness.AUTOMATIC, ever, False)
