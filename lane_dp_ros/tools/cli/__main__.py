# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""python -m lane_dp_ros.tools.cli."""

import sys

from lane_dp_ros.tools.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
