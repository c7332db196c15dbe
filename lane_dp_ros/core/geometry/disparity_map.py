# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The disparity of the left image, held at the resolution at which it was matched."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class DisparityMap:
    """The disparity [px] of an image of `shape` (H, W), matched at a lower resolution from row `first` on.

    `matched` (h, w) float32 holds the disparities in pixels of the whole image, NaN where there is no match,
    of cells with a side of `cell` [px]. A pixel has the disparity of the cell it lies in; where an image
    is no multiple of cells, those at its right and lower border have that of the last one. Rows above `first`
    have none.
    """

    shape: tuple[int, int]
    first: int
    matched: NDArray[np.float32]
    cell: int = 1

    @classmethod
    def unknown(cls, shape: tuple[int, int]) -> DisparityMap:
        """Return the map of an image (H, W) nothing of which was matched."""
        return cls(shape, 0, np.full((1, 1), np.nan, np.float32))

    def at(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.float32]:
        """Return the disparity [px] of pixels (N,), NaN where there is none."""
        height, width = self.matched.shape
        row = np.minimum((rows - self.first) // self.cell, height - 1)
        column = np.minimum(columns // self.cell, width - 1)
        found = self.matched.ravel().take(row * width + column, mode="clip")
        above = rows < self.first
        if np.any(above):
            found = np.where(above, np.float32(np.nan), found)
        return np.asarray(found, dtype=np.float32)

    def nearest(self, u: NDArray[np.float32], v: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the disparity [px] of the pixels nearest to (u, v), arrays of one shape; NaN for none."""
        return self.at(np.rint(v).astype(np.intp), np.rint(u).astype(np.intp))

    @cached_property
    def centres(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The pixels u (w,) and v (h,) in the middle of the cells' columns and rows."""
        height, width = self.matched.shape
        u = (np.arange(width) + 0.5) * self.cell - 0.5
        v = (np.arange(height) + 0.5) * self.cell + self.first - 0.5
        return u.astype(np.float32), v.astype(np.float32)

    @cached_property
    def full(self) -> NDArray[np.float32]:
        """The disparity (H, W) [px] of every pixel, NaN where there is none."""
        return self.at(np.arange(self.shape[0])[:, None], np.arange(self.shape[1])[None])
