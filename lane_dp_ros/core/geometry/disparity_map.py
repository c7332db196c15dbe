# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The disparity of the left image, held at the resolution at which it was matched."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

EPSILON = 1e-9  # cells; keeps a pixel on the border of a cell in it, whatever its product rounds to


@dataclass(frozen=True, eq=False)
class DisparityMap:
    """The disparity [px] of an image of `shape` (H, W), matched at a lower resolution from row `first` on.

    `matched` (h, w) float32 holds the disparities in pixels of the whole image, NaN where there is no match;
    a pixel has the disparity of the cell that it lies in. Rows above `first` have none.
    """

    shape: tuple[int, int]
    first: int
    matched: NDArray[np.float32]

    @classmethod
    def unknown(cls, shape: tuple[int, int]) -> DisparityMap:
        """Return the map of an image (H, W) nothing of which was matched."""
        return cls(shape, 0, np.full((1, 1), np.nan, np.float32))

    def at(self, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.float32]:
        """Return the disparity [px] of pixels (N,), NaN where there is none."""
        height, width = self.matched.shape
        scale = height / max(self.shape[0] - self.first, 1), width / max(self.shape[1], 1)
        row = ((rows - self.first) * scale[0] + EPSILON).astype(np.intp)
        cells = row * width + (columns * scale[1] + EPSILON).astype(np.intp)
        found = self.matched.ravel().take(cells, mode="clip")
        above = rows < self.first
        if np.any(above):
            found = np.where(above, np.float32(np.nan), found)
        return np.asarray(found, dtype=np.float32)

    def nearest(self, u: NDArray[np.float32], v: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the disparity [px] of the pixels nearest to (u, v), arrays of one shape; NaN for none."""
        return self.at(np.rint(v), np.rint(u))

    @property
    def cell_size(self) -> tuple[float, float]:
        """Width and height [px] of a cell."""
        height, width = self.matched.shape
        return self.shape[1] / width, (self.shape[0] - self.first) / height

    @cached_property
    def centres(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The pixels u (w,) and v (h,) in the middle of the cells' columns and rows."""
        (height, width), (across, along) = self.matched.shape, self.cell_size
        u = (np.arange(width) + 0.5) * across - 0.5
        v = (np.arange(height) + 0.5) * along + self.first - 0.5
        return u.astype(np.float32), v.astype(np.float32)

    @cached_property
    def full(self) -> NDArray[np.float32]:
        """The disparity (H, W) [px] of every pixel, NaN where there is none."""
        return self.at(np.arange(self.shape[0])[:, None], np.arange(self.shape[1])[None])
