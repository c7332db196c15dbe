# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Read a bag, whatever it is stored in, with the rosbags library, without ROS."""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from lane_dp_ros.messages.bag_files import bag_files, say_what_is_missing
from lane_dp_ros.messages.bag_message import typestore
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.recording import Channel, RawMessage, Recording
from lane_dp_ros.messages.storage_file import storage_file
from lane_dp_ros.messages.topic_choice import TopicChoice


class BagReader:
    """A rosbag2 folder, one of its files, or a ROS 1 bag, opened for reading (a context manager).

    What the storage holds counts; metadata.yaml, which may be missing or edited, only names the files.
    Topic names begin with a slash. `choice` is what the user said of the stereo camera's topics.
    Raises CommandError, in one line, for a path that is no bag and for a bag that is damaged.
    """

    def __init__(self, path: Path | str, choice: TopicChoice | None = None) -> None:
        self.path, self.choice = Path(path), choice or TopicChoice()
        typestore()  # says so when rosbags is missing
        files = bag_files(self.path)
        self._recordings: list[Recording] = []
        with ExitStack() as stack:
            for path_of_file in files.paths:
                recording = Recording(storage_file(path_of_file))
                stack.callback(recording.close)
                self._recordings.append(recording)
            self._closing = stack.pop_all()
        held = self.message_count() + sum(recording.left_out for recording in self._recordings)
        say_what_is_missing(self.path, files.counted, held)

    def __enter__(self) -> BagReader:
        return self

    def __exit__(self, *_: object) -> None:
        self._closing.close()

    @property
    def topics(self) -> dict[str, str]:
        """Topic names and their message types."""
        return {channel.topic: channel.type_name for channel in self._channels()}

    def message_count(self, topics: list[str] | None = None) -> int:
        """Return how many messages the named topics hold (all topics without names)."""
        return sum(channel.count for channel in self._channels(topics))

    def offered_qos(self, topic: str) -> list[Any]:
        """Return the offers that were recorded with a topic, as rosbags.interfaces.Qos; may be empty."""
        return list(dict.fromkeys(qos for channel in self._channels([topic]) for qos in channel.qos))

    def raw_messages(
        self, topics: list[str] | None = None, start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RawMessage]:
        """Yield the serialised messages of the named topics (all without names) by recording time.

        With times [ns], those recorded from `start_ns` to before `end_ns`.
        """
        for together in _overlapping(self._recordings):
            read = (each.messages(_named(each, topics), start_ns, end_ns) for each in together)
            yield from heapq.merge(*read, key=lambda raw: raw.time_ns)

    def messages(
        self, topics: list[str] | None = None, start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[tuple[str, int, Any]]:
        """Yield (topic, recording time [ns], message) as `raw_messages` does."""
        for raw in self.raw_messages(topics, start_ns, end_ns):
            try:
                message = typestore().deserialize_cdr(raw.data, raw.type_name)
            except Exception as error:  # broken bytes make rosbags raise almost anything
                where = f"a message on {raw.topic} cannot be read (damaged?)"
                raise CommandError(f"{self.path}: {where}: {one_line(error)}") from error
            yield raw.topic, raw.time_ns, message

    def messages_between(self, topic: str, start_ns: int, end_ns: int) -> Iterator[Any]:
        """Yield the messages of a topic that were recorded from `start_ns` to before `end_ns` [ns]."""
        yield from (message for _, _, message in self.messages([topic], start_ns, end_ns))

    def _channels(self, topics: list[str] | None = None) -> list[Channel]:
        return [channel for recording in self._recordings for channel in _named(recording, topics)]


def _named(recording: Recording, topics: list[str] | None) -> list[Channel]:
    return [channel for channel in recording.channels if topics is None or channel.topic in topics]


def _overlapping(recordings: list[Recording]) -> Iterator[list[Recording]]:
    """Yield the files of a bag by time, those together whose times overlap."""
    together: list[Recording] = []
    end_ns = 0
    for recording in sorted(recordings, key=lambda each: each.start_ns):
        if together and recording.start_ns >= end_ns:
            yield together
            together = []
        together.append(recording)
        end_ns = max(end_ns, recording.end_ns)
    if together:
        yield together
