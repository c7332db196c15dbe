# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The ROS node: rectified stereo images in, lanes out."""

from __future__ import annotations

import signal
import sys
import time
from copy import copy
from functools import partial
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import qos_profile_sensor_data
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions, install_signal_handlers
from rclpy.subscription import Subscription
from rclpy.utilities import ok as ros_is_up
from rclpy.utilities import try_shutdown
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.core.pipeline import FrameResult, LanePipeline
from lane_dp_ros.messages.dds_profile import use_dds_profile
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.pictures import draw_birds_eye, draw_overlay
from lane_dp_ros.messages.stamp import NS_PER_S
from lane_dp_ros.messages.stereo_sync import SIDES, Side, StereoPair, StereoSync
from lane_dp_ros.ros.camera_infos import CameraInfos
from lane_dp_ros.ros.diagnostics import Counts, FrameReport, Health, Level, Topics
from lane_dp_ros.ros.parameters import LiveParameters
from lane_dp_ros.ros.rclpy_message import rclpy_message
from lane_dp_ros.ros.start_errors import START_ERRORS, start_reason
from lane_dp_ros.ros.worker import LatestOnlyWorker

LOG_PERIOD = 5.0  # s; the same complaint is logged no more often
REPORT_PERIOD = 1.0  # s
RIGHT_SILENT_AFTER = 0.5  # s without a right image, then the left ones are worked on alone
EARLY_MAX = 1.0  # s; a pair that waited longer for the first CameraInfo is stale
PUBLISHER_DEPTH = 10
Infos = tuple[CameraInfo, CameraInfo]
RCLError = rclpy_implementation.RCLError


class LaneDetectorNode(Node):
    """Subscribes to a stereo camera and publishes lanes.

    Callbacks only store what comes; one worker thread converts, detects and publishes, always on the newest
    complete pair. Call `destroy_node()` before ROS is shut down: it ends that thread.
    Raises ValueError when the parameters that it is started with are wrong.
    """

    def __init__(self, **node_options: Any) -> None:
        super().__init__(
            "lane_detector", automatically_declare_parameters_from_overrides=True, **node_options
        )
        self._live = LiveParameters(self, self._on_change)
        self._sync = StereoSync(
            _nanoseconds(self._live.node_config.sync_tolerance),
            alone_after_ns=_nanoseconds(RIGHT_SILENT_AFTER),
        )
        self._pipeline = LanePipeline()
        self._health = Health()
        self._infos = CameraInfos()
        self._early: tuple[StereoPair, float] | None = None
        self._early_dropped = 0
        self._logged: tuple[str, float] = ("", 0.0)
        self._lanes = self.create_publisher(MarkerArray, "lanes", PUBLISHER_DEPTH)
        self._birds_eye = self.create_publisher(Image, "ipm/image", PUBLISHER_DEPTH)
        self._overlay = self.create_publisher(Image, "overlay/image", PUBLISHER_DEPTH)
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", PUBLISHER_DEPTH)
        # First, so that of what comes at the same time the calibration is taken in before the images.
        self._info_subscriptions = [
            self._subscribe(CameraInfo, f"{side}/camera_info", partial(self._on_info, side)) for side in SIDES
        ]
        self._image_subscriptions: list[Subscription] = []
        self._subscribe_to_images()
        # Not the node's clock: under use_sim_time that stands still when the input does.
        self.create_timer(REPORT_PERIOD, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._worker = LatestOnlyWorker(self._work)

    def destroy_node(self) -> None:
        """End the worker thread, then the node."""
        self._worker.close()
        super().destroy_node()

    def _subscribe_to_images(self) -> None:
        for old in self._image_subscriptions:
            self.destroy_subscription(old)
        self._image_subscriptions = []
        for side in SIDES:
            message, topic = Image, f"{side}/image_rect"
            if self._live.node_config.image_transport == "compressed":
                # As image_transport has it: a remap of the raw topic's name moves the compressed one along.
                message, topic = CompressedImage, self.resolve_topic_name(topic) + "/compressed"
            self._image_subscriptions.append(self._subscribe(message, topic, partial(self._on_image, side)))

    def _subscribe(self, message: Any, topic: str, callback: Any) -> Subscription:
        # A copy, because rclpy writes the overrides into the profile that it is given.
        qos = copy(qos_profile_sensor_data)
        options = QoSOverridingOptions.with_default_policies()
        try:
            return self.create_subscription(message, topic, callback, qos, qos_overriding_options=options)
        except (
            RuntimeError,
            AssertionError,
            AttributeError,
        ) as error:  # what rclpy raises for a bad override
            reason = str(error) or "a value of the wrong type"
            raise ValueError(f"qos_overrides of {topic}: {reason}") from error

    def _on_change(self, before: NodeConfig, after: NodeConfig) -> None:
        self._sync.tolerance_ns = _nanoseconds(after.sync_tolerance)
        if after.image_transport != before.image_transport:
            # Whoever sets the parameter: no subscription may vanish while the executor waits for it.
            if self.executor is not None:
                self.executor.create_task(self._change_transport)
            else:
                self._change_transport()

    def _change_transport(self) -> None:
        self._sync.clear()
        try:
            self._subscribe_to_images()
        except ValueError as error:
            self.get_logger().error(one_line(error))

    def _on_image(self, side: Side, msg: Any) -> None:
        now = time.monotonic()
        self._health.heard(self._image_subscriptions[SIDES.index(side)].topic_name, now)
        stamp = msg.header.stamp
        pair = self._sync.add(side, stamp.sec * NS_PER_S + stamp.nanosec, msg)
        infos = self._infos.both(now)
        if pair is not None and infos is not None:
            self._worker.offer((pair, infos, now))
        elif pair is not None:
            # The first CameraInfo may be a moment behind the first images: the newest pair waits for it.
            self._early_dropped += self._early is not None
            self._early = (pair, now)

    def _on_info(self, side: Side, msg: CameraInfo) -> None:
        now = time.monotonic()
        self._health.heard(self._info_subscriptions[SIDES.index(side)].topic_name, now)
        self._infos.hear(side, msg, now)
        infos = self._infos.both(now)
        if self._early is None or infos is None:
            return
        pair, arrived = self._early
        if now - arrived <= EARLY_MAX:
            self._worker.offer((pair, infos, arrived))
        else:
            self._early_dropped += 1
        self._early = None

    def _work(self, item: tuple[StereoPair, Infos, float]) -> None:
        """Answer a pair; whatever goes wrong with it is reported, and the next pair is answered again."""
        pair, infos, arrived = item
        try:
            report = self._answer(pair, infos, arrived)
        except Exception as error:  # noqa: BLE001 - one bad frame must not end the node
            report = FrameReport(
                time.monotonic(), time.monotonic() - arrived, problem=one_line(error), failed=True
            )
        self._health.answered(report)

    def _answer(self, pair: StereoPair, infos: Infos, arrived: float) -> FrameReport:
        answer = self._pipeline.answer(pair, infos, self._live.detector_config)
        header, lifetime = pair.left.header, self._live.node_config.lane_lifetime
        self._publish(self._lanes, lanes_to_ros(answer.lanes, header, rclpy_message, lifetime))
        now = time.monotonic()
        self._publish_pictures(answer, header)
        return _frame_report(answer, now, now - arrived)

    def _publish_pictures(self, answer: FrameResult, header: Any) -> None:
        """Draw and publish the pictures that somebody looks at."""
        if answer.camera is not None and self._overlay.get_subscription_count():
            picture = draw_overlay(answer.left, answer.lanes, answer.camera)
            self._publish(self._overlay, image_to_ros(picture, header, rclpy_message))
        birds_eye = answer.detection.birds_eye if answer.detection else None
        if birds_eye is not None and self._birds_eye.get_subscription_count():
            picture = draw_birds_eye(birds_eye, answer.left, answer.lanes)
            self._publish(self._birds_eye, image_to_ros(picture, header, rclpy_message))

    def _publish(self, publisher: Publisher, msg: Any) -> None:
        try:
            publisher.publish(msg)
        except RCLError:
            if self.context.ok():  # else ROS was shut down meanwhile, and nobody listens any more
                raise

    def _report(self) -> None:
        now = time.monotonic()
        counts = Counts(
            self._sync.matched,
            self._worker.dropped + self._early_dropped,
            self._sync.unpaired["left"],
            self._sync.unpaired["right"],
            self._sync.alone,
        )
        images, infos = self._image_subscriptions, self._info_subscriptions
        topics = Topics(tuple(s.topic_name for s in images), tuple(s.topic_name for s in infos))
        level, message, values = self._health.summary(now, counts, topics)
        self._log(level, message, now)
        status = DiagnosticStatus(
            level=level.value,
            name=f"{self.get_fully_qualified_name()}: lanes",
            message=message,
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._publish(self._diagnostics, array)

    def _log(self, level: Level, message: str, now: float) -> None:
        """Log what is wrong when it changes, else every few seconds."""
        said, when = self._logged
        if level is Level.OK or (message == said and now - when < LOG_PERIOD):
            return
        self._logged = (message, now)
        log = self.get_logger()
        log.error(message) if level is Level.ERROR else log.warning(message)


def _nanoseconds(seconds: float) -> int:
    return round(seconds * NS_PER_S)


def _frame_report(answer: FrameResult, now: float, latency: float) -> FrameReport:
    detection = answer.detection
    road = detection and detection.road
    return FrameReport(
        time=now,
        latency=latency,
        lanes=len(answer.lanes),
        seconds=detection.seconds if detection else {},
        camera_height=road.camera_height if road else None,
        pitch=road.pitch if road else None,
        road_profile=answer.road_profile,
        problem=answer.problem,
        note=detection.note if detection else "",
        failed=detection is None,
        check=answer.check,
    )


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM; return the exit code, 1 when it could not start."""
    # Signals are rclpy's only once all is built: one in the middle of that would leave ROS half made. Nor
    # must a KeyboardInterrupt break into the end: a terminal and ros2 launch both send SIGINT.
    told_to_end: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda received, _frame: told_to_end.append(received))
    use_dds_profile()  # Fast DDS reads it when the first participant is made
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        node = LaneDetectorNode()
    except START_ERRORS as error:
        try_shutdown()
        return _refusal(error)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    install_signal_handlers(SignalHandlerOptions.ALL)
    try:
        if not told_to_end:
            executor.spin()
    except ExternalShutdownException:
        pass
    except RuntimeError:
        if ros_is_up():
            raise  # else a signal shut ROS down in the middle of a call
    finally:
        executor.shutdown()
        node.destroy_node()
        try_shutdown()
    return 0


def _refusal(error: Exception) -> int:
    """Say in one line why the node does not start; return exit code 1."""
    sys.stderr.write(f"lane_detector: {start_reason(error)}\n")
    return 1


if __name__ == "__main__":
    sys.exit(main())
