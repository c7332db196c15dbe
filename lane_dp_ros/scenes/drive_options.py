# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a command line offers of drives through scenes, and where they are written. Needs no library."""

BAG, TRUTH = "scenes.mcap", "truth.json"
SUITES = ("standard",)  # every category, in the order of the table
FRAMES, RATE = 5, 10.0  # of a drive; [Hz]
