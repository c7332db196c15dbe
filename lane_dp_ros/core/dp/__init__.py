# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Dynamic programming on row-by-row graphs, and robust fits."""
