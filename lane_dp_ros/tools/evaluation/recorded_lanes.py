# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lanes and road edges that a bag carries, as they were recorded."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.messages.camera import camera_from_ros
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_sync import SIDES, Side
from lane_dp_ros.messages.stereo_topics import IMAGES, StereoTopics, find_stereo_topics
from lane_dp_ros.tools.evaluation.answers import BagAnswers, FrameAnswer
from lane_dp_ros.tools.evaluation.image_arrivals import image_arrivals

MARKERS = "visualization_msgs/msg/MarkerArray"
ROAD_EDGES = "road_edges"  # the topic beside that of the lanes


def lanes_topic(reader: BagReader) -> str | None:
    """Return the topic of recorded lanes, in whatever namespace, None without.

    Raises CommandError when there are several.
    """
    topics = [t for t, kind in reader.topics.items() if kind == MARKERS and t.rpartition("/")[2] == "lanes"]
    found = sorted(topic for topic in topics if reader.message_count([topic]))
    if len(found) > 1:
        raise CommandError(f"{reader.path} has several topics of lanes: {', '.join(found)}, expected one")
    return found[0] if found else None


def recorded_answers(reader: BagReader, topic: str) -> BagAnswers:
    """Return the lanes that a bag carries; of two answers to one stamp (a bag played twice) the first.

    The road edges are those of the topic `road_edges` beside that of the lanes, where the bag has it.
    The latency of an answer is the time from the recording of its image pair to its own: one recorder, one
    clock. It is not known for a bag without the images, or one that was written offline.
    Raises CommandError for lanes with points that are not finite numbers.
    """
    namespace = topic.rpartition("/")[0]
    images = _stereo_topics(reader)
    camera = _camera(reader, namespace, images)
    arrivals = image_arrivals(reader, _image_topics(reader, namespace, images))
    road_edges = _recorded_edges(reader, f"{namespace}/{ROAD_EDGES}")
    answers: dict[int, FrameAnswer] = {}
    repeated = 0
    for time_ns, stamp_ns, lanes in _recorded(reader, topic):
        if stamp_ns in answers:
            repeated += 1
            continue
        waited = time_ns - arrivals.get(stamp_ns, time_ns)
        edges = None if road_edges is None else road_edges.get(stamp_ns, ())
        answers[stamp_ns] = FrameAnswer(lanes, camera, waited / 1e9 if waited > 0 else None, road_edges=edges)
    notes = (f"{repeated} more answers to stamps that had one: the first is judged",) if repeated else ()
    return BagAnswers(answers, frozenset(answers) | frozenset(arrivals), notes)


def _recorded_edges(reader: BagReader, topic: str) -> dict[int, tuple[Lane, ...]] | None:
    """Return the road edges of a topic by stamp [ns], None for a bag without it; of two answers the first."""
    if topic not in reader.topics:
        return None
    edges: dict[int, tuple[Lane, ...]] = {}
    for _, stamp_ns, lanes in _recorded(reader, topic):
        edges.setdefault(stamp_ns, lanes)
    return edges


def _recorded(reader: BagReader, topic: str) -> Iterator[tuple[int, int, tuple[Lane, ...]]]:
    """Yield time [ns] of the recording, stamp [ns] and lines of each message on a topic of markers."""
    for _, time_ns, message in reader.messages([topic]):
        if not message.markers:
            raise CommandError(f"{reader.path}: a message on {topic} has no marker, so no stamp")
        yield time_ns, stamp_from_ros(message.markers[0].header.stamp), _lanes(reader, topic, message)


def _lanes(reader: BagReader, topic: str, message: Any) -> tuple[Lane, ...]:
    for marker in message.markers:
        points = np.array([[p.x, p.y, p.z] for p in marker.points], dtype=np.float64)
        if not np.all(np.isfinite([*points.ravel(), marker.color.a])):
            where = f"{topic}, stamp {stamp_from_ros(marker.header.stamp)} ns, marker {marker.ns} {marker.id}"
            raise CommandError(f"{reader.path}: {where} holds values that are not finite numbers (NaN?)")
    return lanes_from_ros(message)


def _stereo_topics(reader: BagReader) -> StereoTopics | None:
    """Return the topics of the images that were recorded with the lanes, None without them."""
    try:
        return find_stereo_topics(reader)
    except CommandError:
        return None


def _image_topics(reader: BagReader, namespace: str, images: StereoTopics | None) -> dict[Side, list[str]]:
    """Return the topics of the images beside the lanes, raw and compressed, or else of the stereo camera."""
    beside: dict[Side, list[str]] = {
        side: [f"{namespace}/{side}/{name}" for name in IMAGES] for side in SIDES
    }
    if images is None or reader.message_count(beside["left"]):
        return beside
    return {side: [image] for side, image in images.images.items()}


def _camera(reader: BagReader, namespace: str, images: StereoTopics | None) -> StereoCamera | None:
    """Return the camera of the CameraInfos beside the lanes, or of the images'; None without them."""
    infos = [_first(reader, f"{namespace}/{side}/camera_info") for side in SIDES]
    if None in infos and images is not None:
        infos = [_first(reader, images.infos[side]) for side in SIDES]
    return None if None in infos else camera_from_ros(*infos)


def _first(reader: BagReader, topic: str) -> Any | None:
    return next((message for _, _, message in reader.messages([topic])), None)
