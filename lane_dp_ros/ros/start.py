# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The executable lane_detector: starts the node, or says in one line what is missing."""

from __future__ import annotations

import sys

from lane_dp_ros.messages.missing_library import missing_library


def main() -> int:
    """Run the node until SIGINT or SIGTERM; return the exit code, 1 when it could not start."""
    try:
        from lane_dp_ros.ros.lane_detector_node import main as run_node
    except ImportError as error:
        if (error.name or "").startswith("lane_dp_ros"):
            raise  # a fault of ours
        sys.stderr.write(f"lane_detector: {missing_library(error)}\n")
        return 1
    return run_node()


if __name__ == "__main__":
    sys.exit(main())
