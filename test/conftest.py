# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Fixtures for every test: a domain of its own for what talks to ROS, rendered and tiny bags, a browser."""

# ruff: noqa: E402
import fcntl
import hashlib
import os
import pickle
import shutil
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings


def claimed_domain() -> int:
    """Return a ROS domain that no other run of tests on this machine has, until this process ends."""
    for number in (1 + (os.getpid() + i) % 101 for i in range(101)):  # the ports of more are not ROS's alone
        try:
            lock = os.open(f"{tempfile.gettempdir()}/lane_dp_ros_test_domain_{number}", os.O_CREAT, 0o644)
        except OSError:  # another user's
            continue
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # the system's: it ends with this process
        except BlockingIOError:
            os.close(lock)
        else:
            return number
    raise RuntimeError("every ROS domain is in use")


# Before any ROS import: neither runs side by side nor the workers of one, which inherit the run's, may hear
# one another; what is started as a process inherits the worker's. Fields of messages are checked.
if "ROS_DOMAIN_ID" not in os.environ or "PYTEST_XDIST_WORKER" in os.environ:
    os.environ["ROS_DOMAIN_ID"] = str(claimed_domain())
os.environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")

# The same examples in every run: what a property finds, it finds where it is written.
settings.register_profile("lane_dp_ros", derandomize=True, database=None, deadline=None)
settings.load_profile("lane_dp_ros")

from lane_dp_ros.messages.bag import BagWriter
from lane_dp_ros.messages.stereo_bag import StereoBagWriter, StereoImages
from lane_dp_ros.scenes import CAMERA, ScenePair, render_sequence

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
)
VIOLATIONS = (
    "document.addEventListener('securitypolicyviolation', (e) => console.error('CSP', e.violatedDirective))"
)
P_LEFT = CAMERA.P_left
P_RIGHT = P_LEFT - np.array([[0, 0, 0, CAMERA.fx * CAMERA.baseline], [0] * 4, [0] * 4])


@pytest.fixture(scope="session")
def rendered(tmp_path_factory) -> Callable[..., Any]:
    """Return a function: what `render(*arguments)` gives, worked out once for all workers of this session."""
    folder = tmp_path_factory.getbasetemp()
    folder = folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder

    def rendered(render: Callable[..., Any], *arguments: Any) -> Any:
        key = hashlib.sha256(pickle.dumps((render.__qualname__, arguments))).hexdigest()
        kept = folder / f"{key}.rendered"
        if not kept.exists():
            part = folder / f"{key}.{os.getpid()}.part"
            result = render(*arguments)
            part.write_bytes(pickle.dumps(list(result) if isinstance(result, Iterator) else result))
            part.replace(kept)
        return pickle.loads(kept.read_bytes())

    return rendered


@pytest.fixture(scope="session")
def scene_pairs(rendered) -> list[ScenePair]:
    """Three rendered pairs of a road with lanes, 0.1 s apart."""
    return rendered(render_sequence, 3, 10.0, 1)


@pytest.fixture
def write_stereo_bag(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes pairs to a bag; the camera may be another one."""

    def write(
        pairs: list, name: str = "stereo", jpeg: bool = False, storage: str = "mcap", P_right=P_RIGHT
    ) -> Path:
        with BagWriter(tmp_path / name, storage) as writer:
            bag = StereoBagWriter(writer, P_LEFT, P_right, jpeg)
            for pair in pairs:
                bag.write(pair)
        return tmp_path / name

    return write


@pytest.fixture
def small_pairs() -> list[StereoImages]:
    """Five pairs of small gray pictures, 20 ms apart; their grey says which one it is."""
    images = [np.full((60, 80), 10 * i, np.uint8) for i in range(5)]
    return [StereoImages(10**9 + i * 20_000_000, image, image + 1) for i, image in enumerate(images)]


def installed(*names: str) -> str:
    """Return the path of the first of these programs that there is."""
    found = next((path for name in names if (path := shutil.which(name))), None)
    return found or pytest.skip(f"no {names[0]}: apt-get install chromium chromium-driver")


@pytest.fixture(scope="module")
def browser(tmp_path_factory) -> Iterator:
    """Return a headless Chromium with an empty profile."""
    reason = "pages are driven by selenium: pip install selenium"
    webdriver = pytest.importorskip("selenium.webdriver", reason=reason)
    programs = installed("chromium", "chromium-browser", "google-chrome"), installed("chromedriver")
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    log = str(tmp_path_factory.mktemp("driver") / "log")
    # A temporary folder of its own: what Chromium leaves behind goes with the test's.
    environment = {**os.environ, "TMPDIR": str(tmp_path_factory.mktemp("tmp"))}
    service = webdriver.ChromeService(programs[1], log_output=log, env=environment)
    driver = webdriver.Chrome(options=options, service=service)
    driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": VIOLATIONS})
    yield driver
    driver.quit()


@pytest.fixture(scope="session")
def kitti_data() -> Path:
    """Return the folder of kitti_odometry/, kitti_stereo_2015/ and labels/; skip where there is none."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    root = Path(os.environ.get("LANE_DP_DATA", beside))
    if not (root / "labels" / "lanes.json").is_file():
        pytest.skip(
            f"no labelled KITTI frames in {root}: set LANE_DP_DATA to the folder that holds labels/lanes.json"
        )
    return root
