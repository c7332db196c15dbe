# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""`lane_dp run` and the node give the same lanes and road edges for the same bag, message by message."""

import time

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.pipeline import LanePipeline
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_bag import StereoBagWriter, StereoImages, find_stereo_topics
from lane_dp_ros.scenes import CAMERA, render_sequence
from lane_dp_ros.tools.datasets.kitti import load_pairs, read_odometry
from lane_dp_ros.tools.offline.detect_bag import detect_bag
from lane_dp_ros.tools.offline.lane_bag import RESOLUTION, LaneBag

FRAME_NS = 100_000_000
P_LEFT = CAMERA.P_left
P_RIGHT = P_LEFT - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])


def stamped(message):
    """The stamp [ns] of a message of markers, and what it tells, whichever library it is read by."""
    told = [
        (m.ns, m.id, m.text, round(m.color.a, 6), m.scale.x, [_in_steps(p) for p in m.points])
        for m in message.markers
    ]
    return stamp_from_ros(message.markers[0].header.stamp), told


def _in_steps(point):
    """A point in the steps to which a bag rounds coordinates."""
    return tuple(round(value / RESOLUTION) for value in (point.x, point.y, point.z))


def offline_lanes(bag, out, jobs):
    """The `lanes` and the `road_edges` that `lane_dp run` writes, by stamp [ns], in order."""
    with BagReader(bag) as reader, BagWriter(out) as writer:
        topics, config = find_stereo_topics(reader), NodeConfig()
        bag = LaneBag(writer, topics.namespace, config.lane_lifetime)
        detect_bag(reader, topics, [bag], (config, DetectorConfig()), jobs)
    with BagReader(out) as reader:
        topics = ("/lanes", "/road_edges")
        return [[stamped(message) for *_, message in reader.messages([topic])] for topic in topics]


def node_lanes(rig, pairs, stamps, P_left, P_right):
    """The same of the node; each pair is sent when the one before is answered."""
    size = pairs[0].left.shape[1], pairs[0].left.shape[0]
    rig.send_infos(P_left.ravel().tolist(), P_right.ravel().tolist(), size)
    for pair in pairs:
        for side, image in (("left", pair.left), ("right", pair.right)):
            if image is not None:
                rig.image_publishers[side].publish(rig.image(image, pair.stamp_ns))
        if pair.stamp_ns in stamps:
            rig.wait(lambda stamp_ns=pair.stamp_ns: rig.answers(stamp_ns))
            rig.edge_answer(pair.stamp_ns)
        else:
            time.sleep(0.2)  # no answer tells that the node has taken it; it keeps five at most
    return [[stamped(message) for message in arrays] for arrays in (rig.arrays, rig.edge_arrays)]


def write_bag(path, pairs, P_left, P_right):
    with BagWriter(path) as writer:
        bag = StereoBagWriter(writer, P_left, P_right)
        for pair in pairs:
            bag.write(pair)


def drive(frames, first_ns=10**9, seed=1):
    """Rendered pairs at 10 Hz."""
    pairs = render_sequence(frames, 10.0, seed)
    return [StereoImages(first_ns + i * FRAME_NS, each.left, each.right) for i, each in enumerate(pairs)]


def turned(pair):
    """The pair of cameras that look elsewhere all of a sudden, by 0.4 rad."""
    moved = np.array([[1, 0, 0.4 * CAMERA.fx], [0, 1, 0]], np.float32)
    size, border = pair.left.shape[1::-1], cv2.BORDER_REPLICATE
    images = (cv2.warpAffine(each, moved, size, borderMode=border) for each in (pair.left, pair.right))
    return StereoImages(pair.stamp_ns, *images)


def axis_jump():
    pairs = drive(8)
    return [turned(pair) if i in (4, 5) else pair for i, pair in enumerate(pairs)]


def lost_right():
    return [
        StereoImages(pair.stamp_ns, pair.left, None if 4 <= i < 12 else pair.right)
        for i, pair in enumerate(drive(14))
    ]


def jump_of_time():
    before = drive(5)
    return before + drive(5, before[-1].stamp_ns + 30 * 10**9)


def test_the_axis_jumps():
    """So far that the one of a moment ago does not explain the pair, and the edges vote before it is time."""
    pipeline = LanePipeline()
    results = [
        pipeline.process(StereoFrame(pair.left, pair.right), CAMERA, pair.stamp_ns, DetectorConfig())
        for pair in axis_jump()
    ]
    assert [i for i, result in enumerate(results) if result.detection.voted] == [0, 3, 4, 7]


DRIVES = {"axis_jump": axis_jump, "lost_right": lost_right, "jump_of_time": jump_of_time}


@pytest.mark.parametrize("name", DRIVES)
def test_rendered_drives(name, tmp_path, make_rig):
    pairs = DRIVES[name]()
    write_bag(tmp_path / "drive", pairs, P_LEFT, P_RIGHT)
    one, two = (offline_lanes(tmp_path / "drive", tmp_path / f"out{jobs}", jobs) for jobs in (1, 2))
    assert one == two
    lanes, _ = one
    found = node_lanes(make_rig(), pairs, {stamp for stamp, _ in lanes}, P_LEFT, P_RIGHT)
    assert found == one
    assert sum(len(markers) > 1 for _, markers in lanes) > len(lanes) / 2  # there are lanes to differ


@pytest.mark.parametrize(("sequence", "frames"), [("01", 51), ("02", 20)])
def test_real_drives(sequence, frames, tmp_path, make_rig, kitti_data):
    drive = read_odometry(kitti_data / "kitti_odometry" / "sequences" / sequence)
    pairs = list(load_pairs(drive))
    assert len(pairs) == frames
    write_bag(tmp_path / "drive", pairs, drive.P_left, drive.P_right)
    one = offline_lanes(tmp_path / "drive", tmp_path / "out", 2)
    stamps = {stamp for stamp, _ in one[0]}
    found = node_lanes(make_rig(), pairs, stamps, drive.P_left, drive.P_right)
    assert [len(messages) for messages in one] == [frames, frames] and found == one
