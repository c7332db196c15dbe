# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A small drive to judge: five frames, whose lanes are known, and `lane_dp review` at work on it."""

import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.bag import BagWriter, bag_message
from lane_dp_ros.messages.camera import camera_info_to_ros
from lane_dp_ros.messages.image import image_to_ros
from lane_dp_ros.messages.lanes import lanes_to_ros
from lane_dp_ros.messages.stamp import stamp_to_ros
from lane_dp_ros.review.lines_as_truth import Grounds
from lane_dp_ros.review.read_drive import read_drive
from lane_dp_ros.review.review import Review
from lane_dp_ros.review.review_file import ReviewFile
from lane_dp_ros.review.server import ReviewServer
from lane_dp_ros.tools.detection_config import load_config

CAMERA = StereoCamera(fx=200.0, fy=200.0, cx=199.5, cy=60.0, baseline=0.5)
P_LEFT = CAMERA.P_left
P_RIGHT = P_LEFT - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])
SIZE = (200, 400)  # rows, columns
HEIGHT = 1.5  # m of the camera above the flat road
# The roles of the lanes of each frame: the third lacks the right one, the fifth has none.
ROLES = [
    ("ego_left", "ego_right", "other"),
    ("ego_left", "ego_right"),
    ("ego_left",),
    ("ego_left", "ego_right"),
    (),
]
OFFSETS = {"ego_left": -1.8, "ego_right": 1.7, "other": -5.2}  # m
STAMPS = [1_317_000_000_000_000_000 + i * 100_000_000 for i in range(len(ROLES))]


def straight_lane(role: str) -> Lane:
    z = np.arange(4.0, 30.1, 0.5)
    points = np.column_stack([np.full_like(z, OFFSETS[role]), np.full_like(z, HEIGHT), z])
    return Lane(points, 0.9, 0.15, role, 0.0, OFFSETS[role], list(OFFSETS).index(role) + 7)


def header(stamp_ns: int):
    return bag_message("std_msgs/msg/Header", stamp=stamp_to_ros(stamp_ns, bag_message), frame_id="camera")


def lanes_message(stamp_ns: int, roles: tuple[str, ...]):
    return lanes_to_ros(tuple(straight_lane(role) for role in roles), header(stamp_ns), bag_message, 0.5)


def write_images(writer: BagWriter, namespace: str = "") -> None:
    for index, stamp in enumerate(STAMPS):
        for side, P in (("left", P_LEFT), ("right", P_RIGHT)):
            info = camera_info_to_ros(P, SIZE, header(stamp), bag_message)
            writer.write(f"{namespace}/{side}/camera_info", stamp + 5, info)
        image = np.full(SIZE, 60 + 10 * index, np.uint8)
        image[:60] = 200
        writer.write(
            f"{namespace}/left/image_rect", stamp + 7, image_to_ros(image, header(stamp), bag_message)
        )


def write_lanes(writer: BagWriter, namespace: str = "", roles=tuple(ROLES)) -> None:
    for stamp, each in zip(STAMPS, roles, strict=True):
        writer.write(f"{namespace}/lanes", stamp + 9, lanes_message(stamp, each))


@pytest.fixture
def drive_bag(tmp_path) -> Path:
    """Return a bag with left images and lanes, as one records them from a live node."""
    path = tmp_path / "drive.mcap"
    with BagWriter(path) as writer:
        write_images(writer)
        write_lanes(writer)
    return path


@pytest.fixture
def split_bags(tmp_path) -> tuple[Path, Path]:
    """Return a bag with images only and one with their lanes, as lane_dp run makes it; in a namespace."""
    with BagWriter(tmp_path / "images") as writer:
        write_images(writer, "/car")
    with BagWriter(tmp_path / "lanes") as writer:
        write_lanes(writer, "/car")
    return tmp_path / "images", tmp_path / "lanes"


class RunningReview:
    """A process of lane_dp review and the address of its page."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "lane_dp_ros.tools.cli", "review", *arguments, "--port", "0"]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.said = ""
        for line in self._process.stdout:
            self.said += line
            if found := re.search(r"http://127\.0\.0\.1:(\d+)/", line):
                self.url, self.port = found[0], int(found[1])
                return
        raise AssertionError(f"no address was printed: {self.said} {self._process.stderr.read()}")

    def end(self, how: signal.Signals = signal.SIGINT) -> str:
        """End it; return what it said at the end."""
        self._process.send_signal(how)
        out, err = self._process.communicate(timeout=20)
        assert not err, err
        assert self._process.returncode == {signal.SIGINT: 0, signal.SIGTERM: 143, signal.SIGKILL: -9}[how]
        return out

    def kill(self) -> None:
        self._process.kill()
        self._process.communicate()


@pytest.fixture
def start_review() -> Iterator[Callable[..., RunningReview]]:
    """Return a function that starts lane_dp review; what still runs at the end is killed."""
    with ExitStack() as running:

        def start(*arguments: object) -> RunningReview:
            review = RunningReview(*map(str, arguments))
            running.callback(review.kill)
            return review

        yield start


class ServedReview:
    """The server of lane_dp review in a thread: what needs no process of its own starts sooner."""

    def __init__(self, bag: Path) -> None:
        file = ReviewFile(bag.with_name(f"{bag.name}.review.json"))
        drive = read_drive(bag, bag)
        file.use_for(drive.fingerprint)
        self.server = ReviewServer(0)
        self.url, self.port = self.server.url, self.server.server_port
        review = Review(drive, file, Grounds(drive, *load_config("default", None)))
        self._thread = threading.Thread(target=self.server.serve, args=(review,))
        self._thread.start()

    def end(self) -> None:
        self.server.shutdown()
        self._thread.join()
        self.server.server_close()


@pytest.fixture
def served(drive_bag) -> Iterator[ServedReview]:
    """Return the page's server at work on `drive_bag`."""
    review = ServedReview(drive_bag)
    yield review
    review.end()


@contextmanager
def nothing_new_in(folder: Path) -> Iterator[None]:
    before = sorted(folder.rglob("*"))
    yield
    assert sorted(folder.rglob("*")) == before


@pytest.fixture
def refused(tmp_path, capsys) -> Callable[..., str]:
    """Return a function that runs lane_dp review, which must fail, and returns its one line."""
    from lane_dp_ros.tools.cli import main

    def run(*arguments: object) -> str:
        with nothing_new_in(tmp_path):
            assert main(["review", *map(str, arguments), "--jobs", "1"]) == 1
        captured = capsys.readouterr()
        assert captured.out == ""
        (line,) = captured.err.splitlines()
        return line

    return run
