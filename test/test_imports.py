# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""All but ros/ works where ROS is not installed: importing it brings nothing of ROS along."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
IMPORT_ALL = """
import importlib, pkgutil, sys
import lane_dp_ros
def fail(name):
    raise
for module in pkgutil.walk_packages(lane_dp_ros.__path__, "lane_dp_ros.", onerror=fail):
    if not (module.name + ".").startswith("lane_dp_ros.ros."):
        importlib.import_module(module.name)
        print(module.name)
print(*{name.partition(".")[0] for name in sys.modules}, file=sys.stderr)
"""


def test_everything_but_ros_imports_without_ros() -> None:
    command = [sys.executable, "-c", IMPORT_ALL]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    names = set(result.stdout.split())
    files = {
        path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".")
        for path in (ROOT / "lane_dp_ros").glob("*/**/*.py")
        if path.name != "__init__.py" and path.parent.name != "ros"
    }
    assert files <= names, "walked over all of them"
    roots = set(result.stderr.split())
    assert "numpy" in roots
    assert not {
        name for name in roots if name.endswith("_msgs") or name.startswith(("rcl", "rosidl", "ament"))
    }
