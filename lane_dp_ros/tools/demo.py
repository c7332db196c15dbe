# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The demonstration: a rendered road, through a running node, to lanes and pictures. Needs no data."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros import scenes
from lane_dp_ros.messages.bag import BagReader, BagWriter
from lane_dp_ros.messages.bag_message import typestore
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.image import image_from_ros
from lane_dp_ros.messages.lanes import lanes_from_ros
from lane_dp_ros.messages.stamp import stamp_from_ros
from lane_dp_ros.messages.stereo_bag import StereoBagWriter
from lane_dp_ros.tools.offline.video import video
from lane_dp_ros.tools.progress import progress

FRAMES, RATE, SEED = 30, 10.0, 7  # three seconds of road, at KITTI's rate [Hz]
STRIP = 4  # frames in a picture
NS_PER_MS = 1e6
MARKER_ARRAY = "visualization_msgs/msg/MarkerArray"

Image8 = NDArray[np.uint8]


class SessionModule(Protocol):
    """`lane_dp_ros.ros.demo_session`, which needs ROS and so is handed in."""

    def run_session(self, reader: BagReader, writer: BagWriter, log: Path, rate: float | None) -> Any:
        """Play `reader` into a lane_detector process, `rate` times as fast as it was; record its answers."""


@dataclass(frozen=True)
class Result:
    """What came back, in the order it came."""

    pairs: int
    lanes_per_frame: list[int]
    road_edges: int
    latencies_ms: NDArray[np.float64]
    rate: float

    def __str__(self) -> str:
        lanes, edges = np.mean(self.lanes_per_frame), self.road_edges / len(self.lanes_per_frame)
        median, high = np.percentile(self.latencies_ms, [50, 95])
        return (
            f"{len(self.lanes_per_frame)} of {self.pairs} pairs answered, {lanes:.2f} lanes per frame, "
            f"latency {median:.0f} ms (95 %: {high:.0f} ms), {self.rate:.1f} frames/s, "
            f"{edges:.2f} road edges per frame"
        )


def run_demo(folder: Path, session_module: SessionModule, rate: float | None, command: str) -> None:
    """Render, play, record; write bags, a video and pictures to `folder`; print a summary.

    These are road.mcap, lanes.mcap, lanes.mp4, overlay.png and ipm.png.

    It is played `rate` times as fast as it was driven, None: as fast as this machine keeps up with. `command`
    is how lane_dp is called here, for the commands to try next.

    Raises CommandError when the node does not come up, answers nothing, or finds no lane.
    """
    road, answers, log = folder / "road.mcap", folder / "lanes.mcap", folder / "lane_detector.log"
    with BagWriter(road, force=True) as writer:
        _render(writer)
    how = (
        f"at {RATE * rate:g} Hz"
        if rate
        else "as fast as this machine keeps up with, which a few pairs measure"
    )
    print(f"{road}: {FRAMES} rendered stereo pairs, now played into lane_detector {how}")
    with BagReader(road) as reader, BagWriter(answers, force=True) as writer:
        session = session_module.run_session(reader, writer, log, rate)
        if not session.answers:
            raise CommandError(f"no lanes message came from lane_detector, see {log}")
    _write_strip(answers, "/overlay/image", folder / "overlay.png", np.vstack)
    _write_strip(answers, "/ipm/image", folder / "ipm.png", np.hstack)
    _write_video(answers, "/overlay/image", folder / "lanes.mp4")
    result = _result(session, _count_road_edges(answers))
    print(f"{answers}: played at {RATE * session.rate:.3g} Hz, {result}")
    film, strips = folder / "lanes.mp4", f"{folder / 'overlay.png'}, {folder / 'ipm.png'}"
    print(f"to be looked at: {film} in a video player, {strips}")
    if not any(result.lanes_per_frame):
        raise CommandError(f"lane_detector found no lane on the rendered road, see {folder / 'overlay.png'}")
    print("next, to be typed as they stand:", *_next_commands(command, folder, road), sep="\n  ")


def _next_commands(command: str, folder: Path, road: Path) -> list[str]:
    """Return three commands that go on from here, each with what it does."""
    offline, scenes_folder, report = (_typed(folder / name) for name in ("offline.mcap", "scenes", "report"))
    return [
        f"{command} run {_typed(road)} -o {offline} --force    # the same without ROS",
        f"{command} scenes kerbs night curve -o {scenes_folder} --force    # other roads, with their truth",
        f"{command} evaluate {scenes_folder} --report {report}    # how good, on a page",
    ]


def _typed(path: Path) -> str:
    """Return a path as a shell takes it."""
    return shlex.quote(str(path))


def _render(writer: BagWriter) -> None:
    P_left = scenes.CAMERA.P_left
    P_right = P_left.copy()
    P_right[0, 3] -= scenes.CAMERA.fx * scenes.CAMERA.baseline
    bag = StereoBagWriter(writer, P_left, P_right, camera_height=scenes.Road().camera_height)
    for pair in progress(scenes.render_sequence(FRAMES, RATE, SEED), FRAMES, "pair"):
        bag.write(pair)


def _count_road_edges(bag: Path) -> int:
    with BagReader(bag) as reader:
        return sum(len(lanes_from_ros(message)) for *_, message in reader.messages(["/road_edges"]))


def _result(session: Any, road_edges: int) -> Result:
    messages: list[Any] = [typestore().deserialize_cdr(data, MARKER_ARRAY) for _, data in session.answers]
    arrived_ns = [arrived for arrived, _ in session.answers]
    stamps_ns = [stamp_from_ros(message.markers[0].header.stamp) for message in messages]
    latencies = [a - session.sent_ns[stamp] for a, stamp in zip(arrived_ns, stamps_ns, strict=True)]
    seconds = (arrived_ns[-1] - arrived_ns[0]) / 1e9
    return Result(
        pairs=len(session.sent_ns),
        lanes_per_frame=[len(lanes_from_ros(message)) for message in messages],
        road_edges=road_edges,
        latencies_ms=np.array(latencies) / NS_PER_MS,
        rate=(len(messages) - 1) / seconds if seconds else 0.0,
    )


def _write_strip(bag: Path, topic: str, path: Path, joined: Callable[[list[Image8]], Image8]) -> None:
    """Write a few frames of an image topic, evenly spread, as one picture."""
    with BagReader(bag) as reader:
        count = reader.message_count([topic])
        chosen = set(np.linspace(0, count - 1, min(count, STRIP)).round().astype(int).tolist())
        frames = enumerate(reader.messages([topic]))
        images = [image_from_ros(message) for index, (_, _, message) in frames if index in chosen]
    if not images:
        raise CommandError(f"no {topic} came from lane_detector")
    _, data = cv2.imencode(".png", joined(images))
    path.write_bytes(data.tobytes())


def _write_video(bag: Path, topic: str, path: Path) -> None:
    """Write all frames of an image topic as a video."""
    with BagReader(bag) as reader, video(path, force=True) as film:
        for _, _, message in reader.messages([topic]):
            film.append(stamp_from_ros(message.header.stamp), image_from_ros(message))
