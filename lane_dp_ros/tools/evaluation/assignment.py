# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Detected lines on the labels' ground: their distances to labels, and their one-to-one assignment.

A detection is projected into the left image, and each pixel is taken from there to (x, z), metres right and
ahead on the label's ground, so that a small error of the road plane is not counted twice.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame, by_depth
from lane_dp_ros.tools.evaluation.lateral import lateral_errors
from lane_dp_ros.tools.evaluation.paint_kinds import compare_paint
from lane_dp_ros.tools.evaluation.scores import Match

Floats = NDArray[np.float64]

END_SLACK = 0.25  # m by which a detection may fall short of a sample and still cover it
MIN_COVERAGE = 0.7  # share of a label's samples
MAX_MEAN_ERROR = 0.20  # m
MAX_ERROR_90 = 0.40  # m, 90th percentile
LABELLED_ASIDE = 9.0  # m; mean distance to the side, beyond which nothing is labelled
JITTER_DEPTH = 10.0  # m


@dataclass(frozen=True, eq=False)
class ProjectedLine:
    """A detected line, its `pixels` (N, 2) in the left image, and (x, z) (M, 2) [m] on the label's ground."""

    lane: Lane
    pixels: Floats
    on_ground: Floats

    @property
    def far_aside(self) -> bool:
        """Whether it runs, on average, more than 9 m to the side, where nothing is labelled."""
        return len(self.on_ground) > 0 and float(np.mean(np.abs(self.on_ground[:, 0]))) > LABELLED_ASIDE


def project(frame: LabelledFrame, lanes: Iterable[Lane], camera: StereoCamera) -> list[ProjectedLine]:
    """Return lanes, in the left optical frame of `camera`, on the ground of a labelled frame."""
    lanes = tuple(lanes)
    pixels = [_in_image(lane, camera) for lane in lanes]
    return [
        ProjectedLine(lane, uv, by_depth(frame.on_ground(uv))) for lane, uv in zip(lanes, pixels, strict=True)
    ]


def _in_image(lane: Lane, camera: StereoCamera) -> Floats:
    """Return the pixels (N, 2) of a lane; points behind the camera drop out."""
    points = np.asarray(lane.points, dtype=np.float64).reshape(-1, 3)
    return camera.project(points[points[:, 2] + camera.left_translation[2] > 0])


def assign(
    labels: Sequence[Label], lines: Sequence[ProjectedLine], camera: StereoCamera, sought: Collection[str]
) -> tuple[Match, ...]:
    """Return the matches, one to one, the smallest mean error first; `sought` are the ids that count."""
    candidates = [
        (label, i, depths, errors)
        for label in labels
        for i, line in enumerate(lines)
        for depths, errors in [_errors(label, line)]
        if _fits(label, errors)
    ]
    matches: dict[str, Match] = {}
    taken: set[int] = set()
    for label, i, depths, errors in sorted(candidates, key=lambda candidate: float(np.mean(candidate[3]))):
        if label.id not in matches and i not in taken:
            taken.add(i)
            matches[label.id] = Match(
                label=label.id,
                detection=i,
                counts=label.id in sought,
                depths=depths,
                errors=errors,
                position=_position(lines[i].on_ground),
                label_position=_position(label.xz),
                in_space=lateral_errors(label, lines[i].lane, camera),
                paint=compare_paint(label, lines[i].lane),
            )
    return tuple(matches.values())


def nearest(labels: Iterable[Label], line: ProjectedLine) -> float:
    """Return the mean lateral distance [m] to the nearest of the labels, inf without any."""
    return min((distance(label, line) for label in labels), default=np.inf)


def distance(label: Label, line: ProjectedLine) -> float:
    """Return the mean lateral distance [m] over the samples that the line covers, inf if it covers none."""
    _, errors = _errors(label, line)
    return float(np.mean(errors)) if len(errors) else np.inf


def coverage(label: Label, line: ProjectedLine) -> float:
    """Return the share of a label's samples that a line covers."""
    return len(_errors(label, line)[1]) / len(label.samples)


def _fits(label: Label, errors: Floats) -> bool:
    """Whether a line with these lateral errors [m] at the samples that it covers matches a label."""
    return (
        label.takes_part
        and len(errors) >= MIN_COVERAGE * len(label.samples)
        and bool(np.mean(errors) <= MAX_MEAN_ERROR and np.percentile(errors, 90) <= MAX_ERROR_90)
    )


def _errors(label: Label, line: ProjectedLine) -> tuple[Floats, Floats]:
    """Return z and |x of the line - x of the label| [m] at the label's samples that the line covers."""
    points = line.on_ground
    if len(points) == 0:
        return np.empty(0), np.empty(0)
    x, z = label.samples.T
    covered = (z >= points[0, 1] - END_SLACK) & (z <= points[-1, 1] + END_SLACK)
    return z[covered], np.abs(np.interp(z[covered], points[:, 1], points[:, 0]) - x[covered])


def _position(points: Floats) -> float | None:
    """Return x [m] of points (N, 2) at 10 m of depth, None where they do not reach."""
    reaches = points[0, 1] <= JITTER_DEPTH <= points[-1, 1]
    return float(np.interp(JITTER_DEPTH, points[:, 1], points[:, 0])) if reaches else None
