# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the node promises, on a rendered road: see docs/topics.md."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from diagnostic_msgs.msg import KeyValue
from rclpy.parameter import Parameter
from rclpy.qos import QoSReliabilityPolicy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.image import image_from_ros
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.scenes import CAMERA, SIZE

OK, WARN = b"\x00", b"\x01"


def test_lanes_are_what_the_interface_promises(rig):
    rig.send_infos()
    stamp_ns = rig.send()
    lanes = rig.answer(stamp_ns)
    (array,) = rig.answers(stamp_ns)
    assert all(marker.header == rig.header(stamp_ns) for marker in array.markers)
    assert sorted(lane.role for lane in lanes)[:2] == ["ego_left", "ego_right"]
    for marker, lane in zip(array.markers[1:], lanes, strict=True):
        assert 0 < marker.color.a <= 1 and 0.05 < marker.scale.x < 0.5
        assert marker.lifetime.sec + marker.lifetime.nanosec / 1e9 == 0.5
        steps = np.diff(lane.points, axis=0)
        assert np.all(steps[:, 2] > 0) and np.linalg.norm(steps, axis=1).max() <= 0.5
        u, v = CAMERA.project(lane.points).T
        assert np.all((u >= 0) & (u < SIZE[0]) & (v > CAMERA.cy) & (v < SIZE[1]))


def seen_road_edges(monkeypatch, *offsets):
    """Have the detector see road edges at offsets [m] on the rendered road."""
    z, detect = np.arange(6.0, 25.0, 0.25), LaneDetector.detect
    edges = tuple(
        Lane(
            np.column_stack([np.full_like(z, x), np.full_like(z, 1.65), z]),
            0.75,
            0.0,
            "other",
            0.0,
            x,
            kind="edge",
        )
        for x in offsets
    )
    monkeypatch.setattr(LaneDetector, "detect", lambda *a: replace(detect(*a), road_edges=edges))


def test_road_edges_are_what_the_interface_promises(rig, monkeypatch):
    seen_road_edges(monkeypatch, -4.2, 4.2, 7.0)
    rig.send_infos()
    ids = []
    for _ in range(2):
        stamp_ns = rig.send()
        array = rig.edge_answer(stamp_ns)
        assert all(marker.header == rig.header(stamp_ns) for marker in array.markers)
        namespaces = [marker.ns for marker in array.markers[1:]]
        assert namespaces == ["road_edge_left", "road_edge_right", "road_edge"]
        for marker, edge in zip(array.markers[1:], lanes_from_ros(array), strict=True):
            assert edge.kind == "edge" and marker.type == marker.LINE_STRIP and marker.scale.x > 0
            assert marker.color.a == 0.75
            assert marker.lifetime.sec + marker.lifetime.nanosec / 1e9 == 0.5
        ids.append([marker.id for marker in array.markers[1:]])
        assert {"ego_left", "ego_right"} <= {lane.role for lane in rig.answer(stamp_ns)}
    assert ids[0] == ids[1] and len(set(ids[0])) == 3
    rig.wait(lambda: any(KeyValue(key="road edges", value="3") in status.values for status in rig.statuses))
    assert {status.level for status in rig.statuses} == {OK}


def test_every_pair_is_answered_on_road_edges_too_also_with_none(rig, monkeypatch):
    seen_road_edges(monkeypatch)
    rig.send_infos()
    stamps = [rig.send()]
    rig.edge_answer(stamps[0])
    stamps.append(rig.send())
    arrays = [rig.edge_answer(stamp_ns) for stamp_ns in stamps]
    assert [len(array.markers) for array in arrays] == [1, 1]
    assert [array.markers[0].header for array in arrays] == [rig.header(stamp_ns) for stamp_ns in stamps]
    assert len(rig.edge_arrays) == len(rig.arrays) == 2


def test_the_same_line_keeps_its_id(rig):
    rig.send_infos()
    first, second = (rig.answer(rig.send()) for _ in range(2))
    assert {lane.id: lane.role for lane in first} == {lane.id: lane.role for lane in second}
    assert len({lane.id for lane in first}) == len(first) > 1


def test_every_pair_is_answered_once_in_order_when_they_come_one_by_one(rig):
    rig.send_infos()
    stamps = []
    for _ in range(10):
        stamps.append(rig.send())
        rig.answer(stamps[-1])
    headers = [array.markers[0].header.stamp for array in rig.arrays]
    assert [stamp.sec * 10**9 + stamp.nanosec for stamp in headers] == stamps


def test_a_burst_is_not_queued_the_newest_pair_is_answered(rig):
    rig.assert_lives()
    stamps = [rig.send() for _ in range(5)]  # no more than the subscription keeps
    assert rig.answer(stamps[-1])
    values = rig.diagnosis("pairs are dropped", WARN)
    assert int(values["pairs matched"]) == 6
    assert int(values["pairs dropped"]) == 6 - len(rig.arrays) > 0
    rig.assert_one_answer_each()


def test_stamps_within_the_tolerance_pair_and_the_left_header_is_kept(rig, scene_pair):
    rig.send_infos()
    stamp_ns = rig.next_stamp()
    rig.image_publishers["right"].publish(rig.image(scene_pair[1], stamp_ns - 4_000_000))
    rig.image_publishers["left"].publish(rig.image(scene_pair[0], stamp_ns))
    assert rig.answer(stamp_ns)


def test_pictures_are_drawn_while_somebody_looks(rig, scene_pair):
    rig.assert_lives()
    pictures = {"ipm/image": [], "overlay/image": []}
    listened = [rig.listen(Image, topic, got.append) for topic, got in pictures.items()]
    rig.wait(lambda: all(subscription.get_publisher_count() for subscription in listened))
    header = rig.header(rig.send())
    # The pair before may have been drawn late, for this very listener.
    rig.wait(lambda: all(got and got[-1].header == header for got in pictures.values()))
    assert {got[-1].encoding for got in pictures.values()} == {"bgr8"}
    overlay = image_from_ros(pictures["overlay/image"][-1])
    changed = np.any(overlay != scene_pair[0], axis=2)
    assert overlay.shape == scene_pair[0].shape and 0 < changed.mean() < 0.2


def test_diagnostics_tell_how_it_goes(rig):
    rig.assert_lives()
    values = rig.diagnosis("lanes in the last frame", OK)
    assert float(values["camera height [m]"]) == pytest.approx(1.65, abs=0.05)
    assert 0 < float(values["latency mean [ms]"]) <= float(values["latency p95 [ms]"])
    assert float(values["stage disparity [ms]"]) > 0
    assert (values["pairs matched"], values["pairs dropped"]) == ("1", "0")
    assert int(values["lanes"]) >= 2 and values["silent topics"] == values["last problem"] == ""
    assert rig.statuses[0].name == "/lane_detector: lanes"


def test_it_works_in_a_namespace(make_rig):
    rig = make_rig(namespace="/car")
    rig.assert_lives()
    rig.diagnosis("lanes in the last frame", OK)
    assert {status.name for status in rig.statuses} == {"/car/lane_detector: lanes"}


def test_topics_can_be_remapped(make_rig):
    rig = make_rig(cli_args=["--ros-args", "-r", "left/image_rect:=cameras/l", "-r", "lanes:=found"])
    rig.assert_lives()
    assert rig.node.count_subscribers("/cameras/l") == rig.node.count_publishers("/found") == 1
    rig.node.set_parameters([Parameter("image_transport", value="compressed")])
    rig.wait(lambda: rig.node.count_subscribers("/cameras/l/compressed") == 1)


def test_camera_info_beside_remapped_images_is_taken_before_the_nodes_own(make_rig):
    remaps = [f"{side}/image_rect:=cameras/{side}/image" for side in ("left", "right")]
    rig = make_rig(cli_args=["--ros-args", "-r", remaps[0], "-r", remaps[1]])
    own = rig.info_publishers
    rig.info_publishers = {
        side: rig.other.create_publisher(CameraInfo, f"cameras/{side}/camera_info", 10) for side in own
    }
    rig.wait_for_subscriptions([*own.values(), *rig.info_publishers.values()])
    rig.assert_lives()  # by the CameraInfo beside the images
    for _ in range(3):
        for publisher in own.values():
            publisher.publish(CameraInfo(width=10, height=10))  # another camera's
        assert rig.answer(rig.send())


def test_use_sim_time_without_a_clock_still_answers_and_reports(make_rig):
    rig = make_rig(parameter_overrides=[Parameter("use_sim_time", value=True)])
    rig.assert_lives()
    rig.diagnosis("lanes in the last frame", OK)


def test_qos_of_each_subscription_can_be_overridden(make_rig):
    name = "qos_overrides./left/image_rect.subscription.reliability"
    rig = make_rig(parameter_overrides=[Parameter(name, value="reliable")])
    reliability = {
        topic: rig.node.get_subscriptions_info_by_topic(topic)[0].qos_profile.reliability
        for topic in ("/left/image_rect", "/right/image_rect")
    }
    assert reliability == {
        "/left/image_rect": QoSReliabilityPolicy.RELIABLE,
        "/right/image_rect": QoSReliabilityPolicy.BEST_EFFORT,
    }
    rig.assert_lives()


def compressed_publishers(rig):
    publishers = {
        side: rig.other.create_publisher(CompressedImage, f"{side}/image_rect/compressed", 10)
        for side in ("left", "right")
    }
    rig.wait_for_subscriptions(publishers.values())
    return publishers


@pytest.mark.parametrize("extension", [".jpg", ".png"])
def test_compressed_images_and_changing_over_while_running(rig, scene_pair, extension):
    rig.assert_lives()
    (result,) = rig.node.set_parameters([Parameter("image_transport", value="compressed")])
    assert result.successful
    publishers = compressed_publishers(rig)
    rig.wait(lambda: not rig.image_publishers["left"].get_subscription_count())
    stamp_ns = rig.next_stamp()
    for publisher, image in zip(publishers.values(), scene_pair, strict=True):
        data = cv2.imencode(extension, image)[1].tobytes()
        publisher.publish(CompressedImage(header=rig.header(stamp_ns), format=extension[1:], data=data))
    assert len(rig.answer(stamp_ns)) >= 2
    rig.node.set_parameters([Parameter("image_transport", value="raw")])
    rig.wait_for_subscriptions(rig.image_publishers.values())
    rig.assert_lives()
