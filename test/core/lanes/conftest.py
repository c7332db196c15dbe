# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Colour pictures of painted roads."""

from collections.abc import Callable, Sequence

import cv2
import numpy as np
import pytest

SHAPE = (600, 1242, 3)  # down to the nearest row of a painted road's view
WIDTH = 0.15  # m


@pytest.fixture(scope="session")
def colour_picture() -> Callable[..., np.ndarray]:
    """Return a function: the BGR picture of lines at n [m] of a view, each in a colour, on a road in one."""

    def colour_picture(view, lines: Sequence[tuple[float, Sequence[int]]], road: Sequence[int]) -> np.ndarray:
        picture = np.full(SHAPE, road, np.uint8)
        s = np.linspace(3.5, 36, 100)
        for n, colour in lines:
            left, right = (view.to_pixels(s, np.full(100, n + aside)) for aside in (-WIDTH / 2, WIDTH / 2))
            outline = np.rint(np.vstack([left, right[::-1]]) * 16).astype(np.int32)
            cv2.fillPoly(picture, [outline], [int(level) for level in colour], cv2.LINE_AA, shift=4)
        return picture

    return colour_picture
