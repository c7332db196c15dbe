# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Offline tools: data sets, evaluation, reports, and the command line. Loads without ROS."""
