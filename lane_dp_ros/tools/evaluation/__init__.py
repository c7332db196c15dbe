# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes judged by labels: annotations and their file, matching, scores, and their sums as text or JSON."""
