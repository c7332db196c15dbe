# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The pictures of a frame: small JPEGs as data URIs, and over them labels, lanes and paths as SVG."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.detector import LaneDetection
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.lanes.candidate import LanePath
from lane_dp_ros.messages.image import Image8
from lane_dp_ros.tools.evaluation.annotations import Label
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine, LineScores
from lane_dp_ros.tools.report.figure import Line, data_uri, figure
from lane_dp_ros.tools.report.frame_images import FrameImages

Floats = NDArray[np.float64]

LEFT_BYTES, ROAD_BYTES = 150_000, 60_000  # of a picture; 30 frames then make a page of about 10 MB
LEFT_WIDTH = 1242  # px; wider images are made smaller
PIXELS_PER_METRE = 20.0  # of the views from above
NEAREST = 1.0  # m; nearer points project to anywhere
UNSEEN = (96, 84, 76)  # BGR of cells without road
DISTANCES = (10, 20, 30)  # m, that are marked in the views from above
PLAN = (-7.5, 7.5, 4.0, 34.0)  # m, right and ahead: what is drawn from above where there is no image

# In words and as a class of the style sheet: what became of a label, or of a published line.
LABEL_STATES = ("found", "missed", "incorrect", "not-found", "not-judged")
LANE_STATES = {
    "match": "right", "false": "false", "duplicate": "duplicate", "ignored": "ignored", "beyond": "ignored",
}  # fmt: skip


def label_state(label: Label, result: FrameScore) -> str:
    """Return what became of a label, one of LABEL_STATES."""
    if label.id in result.missed:
        return "missed"
    if label.id in result.incorrect:
        return "incorrect"
    judged = judged_with(label, result)
    if any(match.label == label.id for match in judged.matches):
        return "found"
    return "not-found" if label.id in judged.labels else "not-judged"


def judged_with(label: Label, result: FrameScore) -> LineScores:
    """Return what a label was compared with: an edge with the road edges where there are any, else lanes."""
    return result if label.painted or result.road_edges is None else result.road_edges


def pictures(result: FrameScore, images: FrameImages) -> str:
    """Return the frame's pictures as HTML: the left image, the road from above, the cost with its paths.

    Where there is no view from above, labels and lines are drawn without one.
    """
    camera = result.camera or images.camera
    if images.left is None or camera is None:
        return plan(result)
    lines = image_lines(result, camera)
    left = left_picture(images.left, lines)
    if images.detection is None or images.detection.birds_eye is None:
        return left + plan(result)
    return left + "".join(_views_from_above(images.left, images.detection, lines))


def image_lines(result: FrameScore, camera: StereoCamera) -> list[Line]:
    """Return labels and published lines in pixels of the left image."""
    labels = result.truth.labels if result.truth else ()
    return [
        *(Line(label.uv, f"label {label_state(label, result)}", label.id) for label in labels),
        *(_lane_line(d, style, camera.project(_ahead(d.lane.points))) for style, d in _published(result)),
    ]


def _published(result: FrameScore) -> Iterator[tuple[str, JudgedLine]]:
    """Yield the lanes and the road edges of a frame, each with its class of the style sheet."""
    yield from (("lane", detection) for detection in result.detections)
    if result.road_edges is not None:
        yield from (("road-edge", detection) for detection in result.road_edges.detections)


def _lane_line(detection: JudgedLine, style: str, points: Floats) -> Line:
    name = f"{'edge ' if style == 'road-edge' else ''}{detection.lane.confidence:.2f}"
    return Line(points, f"{style} {LANE_STATES[detection.verdict]}", name)


def _ahead(points: Floats) -> Floats:
    return points[points[:, 2] > NEAREST]


def left_picture(
    left: Image8, lines: Iterable[Line], title: str = "Left image", limit: int = LEFT_BYTES
) -> str:
    """Return the left image with lines over it as HTML, the picture in at most `limit` bytes."""
    height, width = left.shape[:2]
    small = min(1.0, LEFT_WIDTH / width)
    size = (max(1, round(width * small)), max(1, round(height * small)))
    picture = np.asarray(cv2.resize(left, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    return figure("left", title, (width, height), data_uri(picture, limit), lines)


def _views_from_above(left: Image8, detection: LaneDetection, lines: Sequence[Line]) -> list[str]:
    view = detection.birds_eye
    assert view is not None
    size, seen = _extent(view), [replace(line, points=_on_road(view, line.points)) for line in lines]
    marks = [(f"{s} m", (view.s[0] - s) / (view.s[0] - view.s[-1])) for s in DISTANCES]
    road = data_uri(_from_above(view, left), ROAD_BYTES)
    parts = [figure("above", "From above", size, road, seen, marks)]
    if detection.paint_map is not None:
        cost = data_uri(_cost_picture(view, detection), ROAD_BYTES)
        paths = [Line(_path(view, path), "path") for path in detection.paths]
        failed = [replace(line, name="") for line in seen if line.is_failure]
        title = f"Cost, {len(paths)} path{'s' if len(paths) != 1 else ''}"
        parts.append(figure("above cost", title, size, cost, [*paths, *failed], marks))
    return parts


def _extent(view: BirdsEyeView) -> tuple[float, float]:
    """Return width and height [m] of a bird's-eye view."""
    (rows, columns), (per_row, per_column) = view.image.shape, view.resolution
    return columns * per_column, rows * per_row


def _on_road(view: BirdsEyeView, pixels: Floats) -> Floats:
    """Return pixels (N, 2) of the left image in metres right of and below the view's upper left corner."""
    s, n = view.axis.from_ground(*view.ipm_plane.pixel_to_ground(pixels[:, 0], pixels[:, 1]))
    per_row, per_column = view.resolution
    return np.column_stack([n - view.n[0] + per_column / 2, view.s[0] + per_row / 2 - s])


def _path(view: BirdsEyeView, path: LanePath) -> Floats:
    per_row, per_column = view.resolution
    return np.column_stack([(path.columns + 0.5) * per_column, (path.rows + 0.5) * per_row])


def _from_above(view: BirdsEyeView, left: Image8) -> Image8:
    """Return the road at 20 px to the metre: finer along the road than the detector needs it."""
    width, height = _extent(view)
    rows, columns = round(height * PIXELS_PER_METRE), round(width * PIXELS_PER_METRE)
    s = view.s[0] + view.resolution[0] / 2 - (np.arange(rows) + 0.5) / PIXELS_PER_METRE
    n = view.n[0] - view.resolution[1] / 2 + (np.arange(columns) + 0.5) / PIXELS_PER_METRE
    grid_s, grid_n = np.meshgrid(s, n, indexing="ij")
    pixels = view.to_pixels(grid_s.ravel(), grid_n.ravel()).astype(np.float32).reshape(rows, columns, 2)
    return np.asarray(cv2.remap(left, pixels[..., 0], pixels[..., 1], cv2.INTER_LINEAR), dtype=np.uint8)


def _cost_picture(view: BirdsEyeView, detection: LaneDetection) -> Image8:
    """Return the cost, black 0, white 1, UNSEEN where no road is seen."""
    assert detection.paint_map is not None
    grey = np.rint(np.clip(detection.paint_map.cost, 0, 1) * 255).astype(np.uint8)
    picture = cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR)
    picture[~detection.paint_map.seen] = UNSEEN
    width, height = _extent(view)
    size = (round(width * PIXELS_PER_METRE), round(height * PIXELS_PER_METRE))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_NEAREST), dtype=np.uint8)


def plan(result: FrameScore, title: str = "From above") -> str:
    """Return labels and lines from above, without any image."""
    left, right, near, far = PLAN

    def place(xz: Floats) -> Floats:
        """Return where (x, z) (N, 2) [m] lies in the plan [m], from its upper left corner."""
        return np.column_stack([xz[:, 0] - left, far - xz[:, 1]])

    labels = [
        Line(place(label.xz), f"label {label_state(label, result)}", label.id)
        for label in (result.truth.labels if result.truth else ())
    ]
    lanes = [_lane_line(d, style, place(_ahead(d.lane.points)[:, [0, 2]])) for style, d in _published(result)]
    marks = [(f"{z} m", (far - z) / (far - near)) for z in DISTANCES]
    return figure("above plan", title, (right - left, far - near), "", [*labels, *lanes], marks)
