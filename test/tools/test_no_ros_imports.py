# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""core/ and tools/ work where ROS is not installed: importing them brings nothing of it along."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
IMPORT_ALL = """
import importlib, pkgutil, sys
import lane_dp_ros.core, lane_dp_ros.tools
for package in (lane_dp_ros.core, lane_dp_ros.tools):
    for module in pkgutil.iter_modules(package.__path__, package.__name__ + "."):
        importlib.import_module(module.name)
roots = {name.partition(".")[0] for name in sys.modules}
ros = [name for name in roots if name.endswith("_msgs") or name.startswith(("rcl", "rosidl", "ament"))]
print(*ros)
print("lane_dp_ros.core.detector" in sys.modules, "lane_dp_ros.tools.demo" in sys.modules)
"""


def test_importing_core_and_tools_imports_no_ros() -> None:
    command = [sys.executable, "-c", IMPORT_ALL]
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert result.stdout.splitlines() == ["", "True True"]
