# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What is really on the road: the lane lines of labelled frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import PaintColour

Floats = NDArray[np.float64]
Kind = Literal["solid", "dashed", "edge"]  # edge: the border of a road without paint
KINDS: tuple[str, ...] = get_args(Kind)
COLOURS: tuple[str, ...] = get_args(PaintColour)

JUDGED_DEPTHS = (6.0, 25.0)  # m; nearer the camera sees no road, farther a hand-made label is not sure enough
MIN_LABEL_LENGTH = 3.0  # m within the judged depths
SAMPLE_STEP = 0.5  # m of depth


@dataclass(frozen=True, eq=False)
class Label:
    """One line: `uv` (N, 2) [px] in the left image, `xz` (M, 2) [m] right and ahead on the frame's ground.

    Both run along the centre of the paint; `xz` with rising z. `id` stays the same along a sequence.
    `sure` is False where a careful person could not tell whether, or where exactly, there is a line.
    `xyz` (K, 3) [m], where it is known, are its exact points in the left optical frame, with rising z.
    The rest is None or empty where it is not known: `colour` and `width` [m] of the paint; `double`, whether
    it is one of two lines side by side, which are both labelled; `border`, what ends the road at an edge.
    """

    id: str
    kind: Kind
    sure: bool
    uv: Floats
    xz: Floats
    xyz: Floats | None = None
    colour: PaintColour = ""
    width: float | None = None
    double: bool | None = None
    border: str = ""

    @property
    def painted(self) -> bool:
        """Whether it is a lane marking, not the border of a road without paint."""
        return self.kind != "edge"

    @property
    def counts(self) -> bool:
        """Whether a detector has to find it: painted, sure, and long enough within the judged depths."""
        return self.painted and self.sure and self.takes_part

    @property
    def takes_part(self) -> bool:
        """Whether enough of it lies within the judged depths for a detection to match it."""
        start, end = self._judged
        return end - start >= MIN_LABEL_LENGTH - 1e-9

    @property
    def samples(self) -> Floats:
        """Return points (M, 2), every 0.5 m of depth, within the judged depths where the label takes part."""
        start, end = self._judged if self.takes_part else (self.xz[0, 1], self.xz[-1, 1])
        z = np.arange(start, end + 1e-9, SAMPLE_STEP)
        return np.column_stack([np.interp(z, self.xz[:, 1], self.xz[:, 0]), z])

    @property
    def in_space(self) -> Floats:
        """Return points (x, z) (N, 2) [m] of it in the world: the exact ones, else those on the ground."""
        return self.xz if self.xyz is None else self.xyz[:, [0, 2]]

    @property
    def _judged(self) -> tuple[float, float]:
        low, high = JUDGED_DEPTHS
        return max(low, float(self.xz[0, 1])), min(high, float(self.xz[-1, 1]))


@dataclass(frozen=True, eq=False)
class LabelledFrame:
    """A labelled pair: its camera, ground, lines, and the ids of the lines left and right of the vehicle.

    `ground` (4,) gives the road's disparity [px]: g0 + g1 n + g2 n^2 + g3 m with n = (v - cy) / 100,
    m = (u - cx) / 100. `camera` is the labels' own: its frame is centred on the left camera.
    `size` [px] is the images' width and height. A frame of a bag has `stamp_ns`, one of loose images has the
    paths `left` and `right` below a data folder. `sequence` defaults to the folders of the name; `drive` is
    the road that it belongs to where the sequence holds several. `profile` (N, 2), where it is known, tells
    what no quadratic can: for rising depths z [m] the exact row v [px] of the road straight ahead, at u = cx.
    """

    name: str
    camera: StereoCamera
    size: tuple[int, int]
    ground: Floats
    labels: tuple[Label, ...]
    ego_left: str | None = None
    ego_right: str | None = None
    stamp_ns: int | None = None
    left: str = ""
    right: str = ""
    sequence: str = ""
    category: str = ""
    drive: str = ""
    note: str = ""
    profile: Floats | None = None

    def __post_init__(self) -> None:
        if not self.sequence:
            folders = self.name.rpartition("/")[0].replace("/sequences", "")
            object.__setattr__(self, "sequence", folders or ".")

    @property
    def ego_ids(self) -> tuple[str, ...]:
        """The ids of the lines left and right of the vehicle, where there are any."""
        return tuple(side for side in (self.ego_left, self.ego_right) if side is not None)

    def rows_ahead(self, depths: ArrayLike) -> Floats:
        """Return the rows v (N,) [px], at u = cx, in which the road has the `depths` (N,) [m].

        By the exact profile where it is known, else by the ground. NaN outside the image, beyond the profile,
        and where the ground has no such depth.
        """
        z = np.asarray(depths, dtype=np.float64)
        rows = self._rows_of_ground(z) if self.profile is None else _rows_of_profile(self.profile, z)
        width, height = self.size
        with np.errstate(invalid="ignore"):
            inside = (rows >= 0) & (rows <= height - 1) & (0 <= self.camera.cx <= width - 1)
        return np.where(inside, rows, np.nan)

    def _rows_of_ground(self, z: Floats) -> Floats:
        """Return the root of the quadratic on the road's side."""
        camera, (g0, g1, g2, _) = self.camera, self.ground
        c = g0 - camera.fx * camera.baseline / z
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(camera.cy - 100 * 2 * c / (g1 + np.sqrt(g1 * g1 - 4 * g2 * c)))

    def on_ground(self, pixels: ArrayLike) -> Floats:
        """Return (x, z) [m] of pixels (N, 2) on the label's ground, without those above the horizon."""
        uv = np.asarray(pixels, dtype=np.float64).reshape(-1, 2)
        camera, (g0, g1, g2, g3) = self.camera, self.ground
        m, n = (uv[:, 0] - camera.cx) / 100, (uv[:, 1] - camera.cy) / 100
        disparity = g0 + g1 * n + g2 * n**2 + g3 * m
        below = disparity > 0
        z = camera.fx * camera.baseline / disparity[below]
        return np.column_stack([(uv[below, 0] - camera.cx) * z / camera.fx, z])


def by_depth(points: Floats) -> Floats:
    """Return points (x, z) (N, 2) or (x, y, z) (N, 3), sorted by z."""
    return points[np.argsort(points[:, -1], kind="stable")]


def _rows_of_profile(profile: Floats, z: Floats) -> Floats:
    """Return the rows between those of a profile (N, 2); on a flat road they are linear in 1 / z."""
    known, rows = profile[::-1].T
    return np.interp(1 / z, 1 / known, rows, left=np.nan, right=np.nan)
