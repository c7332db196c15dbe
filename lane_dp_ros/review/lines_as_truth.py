# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Corrected lines as truth: on which ground they lie, and which frames are known well enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_surface import RoadSurface
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.node_config import NodeConfig
from lane_dp_ros.messages.stereo_pipeline import detect_alone
from lane_dp_ros.messages.stereo_sync import StereoPair
from lane_dp_ros.review.drive import Drive, Frame
from lane_dp_ros.review.judgement import SIDES, Judgement, Line
from lane_dp_ros.tools.evaluation.truth_file import Label, LabelledFrame, by_depth

Floats = NDArray[np.float64]

NEAREST = 1.0  # m; nearer points project to anywhere
STEP = 2.0  # px between the points that are written of a line drawn with few
SIMPLE = 0.5  # px by which the points that one drags may leave the detected line
FARTHEST = 80.0  # m; beyond, a pixel is metres long
GROUND_ASIDE, GROUND_AHEAD = np.linspace(-6, 6, 7), np.linspace(5, 35, 31)  # m; where a ground is fitted


class Known(NamedTuple):
    """A frame as truth, or None and why it cannot be."""

    frame: LabelledFrame | None
    problem: str


@dataclass
class Grounds:
    """The road's surface of frames, detected when first asked for."""

    drive: Drive
    node: NodeConfig
    detector: DetectorConfig

    def __post_init__(self) -> None:
        self._known: dict[int, QuadraticSurface | None] = {}

    def of(self, frame: Frame) -> QuadraticSurface | None:
        """Return the road surface that is detected, else the one through the lanes, else None."""
        if frame.stamp_ns not in self._known:
            self._known[frame.stamp_ns] = self._detected(frame) or ground_through(frame.lanes, frame.camera)
        return self._known[frame.stamp_ns]

    def _detected(self, frame: Frame) -> QuadraticSurface | None:
        right = self.drive.right_message(frame, round(self.node.sync_tolerance * 1e9))
        if right is None or "right" not in frame.infos:
            return None
        pair = StereoPair(self.drive.left_message(frame), right, frame.stamp_ns)
        infos = frame.infos["left"], frame.infos["right"]
        _, found = detect_alone(pair, infos, self.detector)
        return None if found is None or found.road is None else as_ground(found.road)


def ground_through(lanes: tuple[Lane, ...], camera: StereoCamera) -> QuadraticSurface | None:
    """Return the surface d = g0 + g1 n + g2 n^2 + g3 m nearest to the points of lanes, None without lanes.

    One line alone tells nothing of the cross slope: that is taken as zero.
    """
    if not lanes:
        return None
    points = np.vstack([lane.points for lane in lanes])
    points = points[points[:, 2] > NEAREST]
    u, v = camera.project(points).T
    disparity = camera.fx * camera.baseline / (points[:, 2] + camera.left_translation[2])
    return _nearest_ground(camera, u, v, disparity, 4 if len(lanes) > 1 else 3)


def as_ground(surface: RoadSurface) -> QuadraticSurface | None:
    """Return the ground of the truth format nearest to a measured surface, as a scene's truth has it."""
    x, z = (each.ravel() for each in np.meshgrid(GROUND_ASIDE, GROUND_AHEAD))
    u, v = surface.ground_to_pixel(x, z)
    return _nearest_ground(surface.camera, u, v, surface.disparity(u, v), 4)


def _nearest_ground(
    camera: StereoCamera, u: Floats, v: Floats, disparity: Floats, terms: int
) -> QuadraticSurface | None:
    """Return the quadratic nearest to disparities (N,) [px] at pixels, of its first `terms` coefficients."""
    columns = QuadraticSurface(camera, (0.0, 0.0, 0.0, 0.0)).linearised(u, v)[1][:terms].T
    if len(columns) < 2 * terms:
        return None
    fitted = np.linalg.lstsq(columns, disparity, rcond=None)[0].tolist()
    b0, b1, b2, b3 = (*fitted, 0.0)[:4]
    return QuadraticSurface(camera, (b0, b1, b2, b3))


def image_points(lane: Lane, camera: StereoCamera) -> Floats:
    """Return the points (N, 2) [px] of a lane in the left image, from near to far."""
    return camera.project(lane.points[lane.points[:, 2] > NEAREST])


def simplified(pixels: Floats) -> Floats:
    """Return the few points (N, 2) [px] that keep a line to half a pixel."""
    if len(pixels) < 3:
        return pixels
    kept = cv2.approxPolyDP(pixels.astype(np.float32).reshape(-1, 1, 2), SIMPLE, False)
    return np.asarray(kept, dtype=np.float64).reshape(-1, 2)


def detected_lines(frame: Frame) -> tuple[Line, ...]:
    """Return a frame's detected lanes as lines to be corrected; the two closest count as sure.

    No detection says whether a line is dashed: all are solid until a person says otherwise.
    """
    camera, lines, ids = frame.camera, [], [lane.id for lane in frame.lanes]
    for number, lane in enumerate(frame.lanes):
        pixels = simplified(image_points(lane, camera))
        if len(pixels) >= 2:
            unique = lane.id >= 0 and ids.count(lane.id) == 1
            points = tuple((round(float(u), 2), round(float(v), 2)) for u, v in pixels)
            name = str(lane.id) if unique else f"d{number}"
            lines.append(Line(name, lane.role, "solid", lane.role != "other", points))
    return tuple(lines)


def known(drive: Drive, frame: Frame, judgement: Judgement, grounds: Grounds) -> Known:
    """Return the truth of a frame, where both sides are judged and every line there is is drawn.

    Lines that a person corrected are taken as they are. Of a frame that needed no correction, the closest
    two are sure; nobody looked at the others, so that they are not.
    """
    lines = detected_lines(frame) if judgement.lines is None else judgement.lines
    if problem := _unknown(judgement, {line.role for line in lines}):
        return Known(None, problem)
    if (ground := grounds.of(frame)) is None:
        return Known(None, "no road surface: neither a stereo pair nor lanes tell it")
    kept = [line for line in lines if line.role not in _denied(judgement)]
    labels = [label for line in kept if (label := _label(line, ground)) is not None]
    if len(labels) < len(kept):
        return Known(None, "a line lies above the horizon")
    return Known(_labelled(drive, frame, tuple(kept), tuple(labels), ground), "")


def _denied(judgement: Judgement) -> set[str]:
    """Return the roles of detected lines where a person sees no marking."""
    return {f"ego_{side}" for side in SIDES if judgement.lines is None and getattr(judgement, side) == "none"}


def _unknown(judgement: Judgement, roles: set[str]) -> str:
    """Return why the lines of a frame are not known."""
    if not judgement.complete:
        return "not judged yet"
    for side in SIDES:
        verdict = getattr(judgement, side)
        drawn = f"ego_{side}" in roles and (judgement.lines is not None or verdict == "correct")
        if verdict != "none" and not drawn:
            return f"{side} is {verdict}, but the true line is not drawn"
    return ""


def _label(line: Line, ground: QuadraticSurface) -> Label | None:
    """Return a line as a label; None when it has no two points on the ground."""
    uv = _dense(np.array(line.uv))
    x, z = ground.pixel_to_ground(uv[:, 0], uv[:, 1])
    on_ground = np.isfinite(z) & (z > NEAREST) & (z < FARTHEST)
    if np.count_nonzero(on_ground) < 2:
        return None
    xz = by_depth(np.column_stack([x, z])[on_ground])
    return Label(line.id, line.kind, line.sure, uv[on_ground], xz)


def _dense(uv: Floats) -> Floats:
    """Return the points of a polyline at most `STEP` apart."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(uv, axis=0).T))])
    inner = np.linspace(0, length[-1], max(2, int(np.ceil(length[-1] / STEP)) + 1))
    at = np.union1d(length, inner)
    return np.column_stack([np.interp(at, length, uv[:, 0]), np.interp(at, length, uv[:, 1])])


def _labelled(
    drive: Drive, frame: Frame, lines: tuple[Line, ...], labels: tuple[Label, ...], ground: QuadraticSurface
) -> LabelledFrame:
    camera = ground.camera
    egos = {line.role: line.id for line in lines}
    return LabelledFrame(
        name=f"{drive.name}/{frame.index:06d}",
        camera=StereoCamera(camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline),
        size=frame.size,
        ground=np.array(ground.coefficients),
        labels=labels,
        ego_left=egos.get("ego_left"),
        ego_right=egos.get("ego_right"),
        stamp_ns=frame.stamp_ns,
    )
