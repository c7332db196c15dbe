# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Runs of rows along a line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def runs_of(rows: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the runs (N, 2) of true rows: the first one of each, and the one after its last."""
    change = np.diff(np.concatenate([[0], rows.astype(int), [0]]))
    return np.flatnonzero(change).reshape(-1, 2)
