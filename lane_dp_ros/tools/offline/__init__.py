# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Lanes in every stereo pair of a bag, offline: the answers, and the files that are made of them."""
