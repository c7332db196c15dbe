# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The executable lane_detector: starts the node, or says in one line what is missing."""

from __future__ import annotations

import signal
import sys

from lane_dp_ros.messages.missing_library import missing_library

SIGNALS = (signal.SIGINT, signal.SIGTERM)


def main() -> int:
    """Run the node until SIGINT or SIGTERM; return the exit code, 1 when it could not start."""
    # Loading ROS takes a moment, in which a signal must end this in silence, too.
    told_to_end: list[int] = []
    for number in SIGNALS:
        signal.signal(number, lambda received, _frame: told_to_end.append(received))
    try:
        from lane_dp_ros.ros.lane_detector_node import main as run_node

        return 0 if told_to_end else run_node()
    except ImportError as error:
        if (error.name or "").startswith("lane_dp_ros"):
            raise  # a fault of ours
        sys.stderr.write(f"lane_detector: {missing_library(error)}\n")
        return 1
    finally:
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)  # a second one must not break into the end


if __name__ == "__main__":
    sys.exit(main())
