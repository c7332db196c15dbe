# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The ROS node: rectified stereo images in, lanes and road edges out."""

from __future__ import annotations

import signal
import sys
import time
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions, install_signal_handlers
from rclpy.utilities import ok as ros_is_up
from rclpy.utilities import try_shutdown
from visualization_msgs.msg import MarkerArray

from lane_dp_ros.core.pipeline import FrameResult
from lane_dp_ros.messages.dds_profile import use_dds_profile
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.messages.lanes import lanes_to_ros, road_edges_to_ros
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_pipeline import StereoPipeline
from lane_dp_ros.messages.stereo_sync import StereoPair
from lane_dp_ros.ros.diagnostics import Counts, FrameReport, Health, Level
from lane_dp_ros.ros.parameters import LiveParameters
from lane_dp_ros.ros.picture_publisher import PicturePublisher
from lane_dp_ros.ros.publishing import DEPTH, publish
from lane_dp_ros.ros.rclpy_message import rclpy_message
from lane_dp_ros.ros.start_errors import START_ERRORS, start_reason
from lane_dp_ros.ros.stereo_subscriber import Infos, StereoSubscriber
from lane_dp_ros.ros.worker import LatestOnlyWorker

LOG_PERIOD = 5.0  # s; the same complaint is logged no more often
REPORT_PERIOD = 1.0  # s
DEVIATION_DEPTH = 25.0  # m; where it is told how sure the road's depth is


class LaneDetectorNode(Node):
    """Subscribes to a stereo camera and publishes lanes and road edges.

    Callbacks only store what comes; one worker thread converts, detects and publishes, always on the newest
    complete pair, another one draws pictures. Call `destroy_node()` before ROS is shut down: it ends them.
    Raises ValueError when the parameters that it is started with are wrong.
    """

    def __init__(self, **node_options: Any) -> None:
        super().__init__(
            "lane_detector", automatically_declare_parameters_from_overrides=True, **node_options
        )
        self._live = LiveParameters(self, self._on_change)
        self._pipeline = StereoPipeline()
        self._health = Health()
        self._logged: tuple[str, float] = ("", 0.0)
        self._lanes = self.create_publisher(MarkerArray, "lanes", DEPTH)
        self._road_edges = self.create_publisher(MarkerArray, "road_edges", DEPTH)
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", DEPTH)
        config = self._live.node_config
        self._stereo = StereoSubscriber(
            self, config.image_transport, config.sync_tolerance, self._on_pair, self._health.heard
        )
        # Not the node's clock: under use_sim_time that stands still when the input does.
        self.create_timer(REPORT_PERIOD, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._pictures = PicturePublisher(self)
        self._worker = LatestOnlyWorker(self._work)

    def destroy_node(self) -> None:
        """End the worker threads, then the node."""
        self._worker.close()
        self._pictures.close()
        super().destroy_node()

    def _on_change(self, before: NodeConfig, after: NodeConfig) -> None:
        self._stereo.set_tolerance(after.sync_tolerance)
        if after.image_transport != before.image_transport:
            self._stereo.change_transport(after.image_transport)

    def _on_pair(self, pair: StereoPair, infos: Infos, arrived: float) -> None:
        self._worker.offer((pair, infos, arrived))

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
        result = self._pipeline.answer(pair, infos, self._live.detector_config)
        start = time.perf_counter()
        header, lifetime = pair.left.header, self._live.node_config.lane_lifetime
        publish(self, self._lanes, lanes_to_ros(result.lanes, header, rclpy_message, lifetime))
        edges = road_edges_to_ros(result.road_edges, header, rclpy_message, lifetime)
        publish(self, self._road_edges, edges)
        now = time.monotonic()
        seconds = {
            **result.seconds,
            "markers": time.perf_counter() - start,
            "pictures": self._pictures.seconds,
        }
        self._pictures.offer(result, header)
        return _frame_report(result, now, now - arrived, seconds)

    def _report(self) -> None:
        now, sync = time.monotonic(), self._stereo.sync
        counts = Counts(
            sync.matched,
            self._worker.dropped + self._stereo.early_dropped,
            sync.unpaired["left"],
            sync.unpaired["right"],
            sync.alone,
        )
        level, message, values = self._health.summary(now, counts, self._stereo.topics)
        self._log(level, message, now)
        status = DiagnosticStatus(
            level=level.value,
            name=f"{self.get_fully_qualified_name()}: lanes",
            message=message,
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        publish(self, self._diagnostics, array)

    def _log(self, level: Level, message: str, now: float) -> None:
        """Log what is wrong when it changes, else every few seconds."""
        said, when = self._logged
        if level is Level.OK or (message == said and now - when < LOG_PERIOD):
            return
        self._logged = (message, now)
        log = self.get_logger()
        log.error(message) if level is Level.ERROR else log.warning(message)


def _frame_report(result: FrameResult, now: float, latency: float, seconds: dict[str, float]) -> FrameReport:
    detection = result.detection
    road = detection and detection.road_estimate.surface
    return FrameReport(
        time=now,
        latency=latency,
        lanes=len(result.lanes),
        road_edges=len(result.road_edges),
        seconds=seconds,
        camera_height=road.camera_height if road else None,
        pitch=road.pitch if road else None,
        depth_deviation=road.depth_deviation_ahead(DEVIATION_DEPTH) if road else None,
        road_profile=result.road_profile,
        problem=result.problem,
        note=detection.note if detection else "",
        failed=detection is None,
        check=result.check,
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
