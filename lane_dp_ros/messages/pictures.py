# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of lanes: over the left image, and in the bird's-eye view.

A lane is drawn as the thin outline of its stripe, with a gap between outline and paint, so that the paint can
be seen and judged; a road edge as a dotted line. The label says role, id, kind and confidence in the colours
that RViz shows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.lanes import lane_colour

Image8 = NDArray[np.uint8]
Floats = NDArray[np.float64]

GAP = 0.05  # m between the paint and the outline
NEAREST = 1.0  # m; nearer points project to anywhere
SUBPIXEL_BITS = 4  # OpenCV's fixed point: 1/16 px
FAR_OUTSIDE = 20000.0  # px; beyond, OpenCV's fixed point overflows
FONT = cv2.FONT_HERSHEY_SIMPLEX
DARK = (20, 20, 20)
GRID = (150, 150, 150)  # grey: no lane has this colour
GRID_STEP = 5.0  # m
PIXELS_PER_METRE = 20.0  # of the bird's-eye picture, the same along and across
MARGIN = 44  # px left of the bird's-eye view, for the distances


def draw_overlay(left_image: Image8, lanes: Iterable[Lane], camera: StereoCamera) -> Image8:
    """Return the left image (H, W) gray or (H, W, 3) BGR as BGR with `lanes`.

    These are lanes and road edges in the left optical frame.
    """
    picture = _bgr(left_image)
    _draw_lanes(picture, lanes, camera.project)
    return picture


def draw_birds_eye(birds_eye: BirdsEyeView, left_image: Image8, lanes: Iterable[Lane]) -> Image8:
    """Return the bird's-eye view of the left image as BGR, 20 px to the metre, with a 5 m grid and `lanes`.

    These are lanes and road edges in the left optical frame. The numbers at the left are metres along the
    road, those at the bottom metres right of the camera's foot.
    """
    per_row, per_column = (metres * PIXELS_PER_METRE for metres in birds_eye.resolution)
    rows, columns = birds_eye.image.shape
    size = (max(1, round(columns * per_column)), max(1, round(rows * per_row)))
    warped = birds_eye.warp(_bgr(left_image))
    view = np.asarray(cv2.resize(warped, size, interpolation=cv2.INTER_LINEAR), dtype=np.uint8)
    _draw_grid_lines(view, birds_eye)

    def to_view(points: Floats) -> Floats:
        """Return the pixels (N, 2) of the view that show points (N, 3) [m] of the left optical frame."""
        # In both worlds whole numbers are the centres, of cells and of pixels.
        return (birds_eye.cells(points) + 0.5) * (per_column, per_row) - 0.5

    _draw_lanes(view, lanes, to_view)
    picture = _with_margin(view)
    for text, centre in _grid_labels(view, birds_eye):
        _draw_text(picture, text, centre, GRID)
    return picture


def _bgr(image: Image8) -> Image8:
    if image.ndim == 3:
        return image.copy()
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), dtype=np.uint8)


def _with_margin(view: Image8) -> Image8:
    picture = np.full((view.shape[0], MARGIN + view.shape[1], 3), DARK, np.uint8)
    picture[:, MARGIN:] = view
    return picture


def _colour(lane: Lane) -> tuple[float, float, float]:
    red, green, blue = lane_colour(lane)
    return 255 * blue, 255 * green, 255 * red


def _outline(lane: Lane) -> Floats:
    """Return the points (N, 3) around the lane's stripe: up its left side and back on its right."""
    points = _ahead(lane.points)
    along = np.gradient(points[:, [0, 2]], axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    offset = np.zeros_like(points)
    offset[:, 0], offset[:, 2] = along[:, 1], -along[:, 0]  # to the right, on the ground
    offset *= lane.paint_width / 2 + GAP
    return np.vstack([points - offset, (points + offset)[::-1]])


def _ahead(points: Floats) -> Floats:
    return points[points[:, 2] > NEAREST]


def _draw_lanes(picture: Image8, lanes: Iterable[Lane], to_pixels: Callable[[Floats], Floats]) -> None:
    """Draw road edges, lanes and, above them all, labels, those of the lanes last.

    `to_pixels` takes points (N, 3) to the picture (N, 2).
    """
    drawable = [lane for lane in lanes if np.count_nonzero(lane.points[:, 2] > NEAREST) >= 2]
    drawable.sort(key=lambda lane: lane.kind != "edge")
    for lane in drawable:
        if lane.kind == "edge":
            _draw_dots(picture, _shown(to_pixels(_ahead(lane.points))), _colour(lane))
        else:
            _draw_outline(picture, _shown(to_pixels(_outline(lane))), _colour(lane))
    for lane in drawable:
        _draw_label(picture, _shown(to_pixels(_ahead(lane.points))), lane)


def _shown(pixels: Floats) -> Floats:
    """Return the pixels (N, 2) without those of points that no picture shows, as beyond a bend's centre."""
    return pixels[np.isfinite(pixels).all(axis=1)]


def _draw_outline(picture: Image8, pixels: Floats, colour: tuple[float, float, float]) -> None:
    cv2.polylines(picture, [_fixed(pixels)], True, colour, _thickness(picture), cv2.LINE_AA, SUBPIXEL_BITS)


def _draw_dots(picture: Image8, pixels: Floats, colour: tuple[float, float, float]) -> None:
    """Draw every other step of a line, whose points (N, 2) are at most 0.5 m apart."""
    steps = [_fixed(pixels[i : i + 2]) for i in range(0, len(pixels) - 1, 2)]
    cv2.polylines(picture, steps, False, colour, _thickness(picture), cv2.LINE_AA, SUBPIXEL_BITS)


def _fixed(pixels: Floats) -> NDArray[np.int32]:
    """Return pixels (N, 2) as OpenCV draws parts of them."""
    fixed = np.clip(pixels, -FAR_OUTSIDE, FAR_OUTSIDE) * 2**SUBPIXEL_BITS
    return np.rint(fixed).astype(np.int32).reshape(-1, 1, 2)


def _thickness(picture: Image8) -> int:
    return max(1, round(picture.shape[1] / 1500))


def _draw_label(picture: Image8, pixels: Floats, lane: Lane) -> None:
    """Write what is known of `lane` where it comes into the picture."""
    rows, columns = picture.shape[:2]
    inside = np.all((pixels >= 0) & (pixels < (columns, rows)), axis=1)
    if inside.any():
        name = ("edge " if lane.kind == "edge" else "") + lane.role.replace("ego_", "")
        identity = f"{lane.id}" if lane.id >= 0 else ""
        kind = "" if lane.kind == "edge" else " ".join(filter(None, (lane.colour, lane.kind)))
        text = " ".join(filter(None, (name, identity, kind, f"{lane.confidence:.2f}")))
        _draw_text(picture, text, pixels[inside][0], _colour(lane))


def _draw_text(picture: Image8, text: str, centre: Floats, colour: tuple[float, float, float]) -> None:
    """Write `text` on a dark patch near `centre`, wholly inside the picture where it fits."""
    scale = min(0.45, max(0.3, picture.shape[1] / 2800))
    (width, height), baseline = cv2.getTextSize(text, FONT, scale, 1)
    rows, columns = picture.shape[:2]
    x = int(np.clip(centre[0] - width / 2, 2, max(2, columns - width - 3)))
    y = int(np.clip(centre[1] + height + 4, height + 2, max(height + 2, rows - baseline - 2)))
    cv2.rectangle(picture, (x - 2, y - height - 2), (x + width + 2, y + baseline), DARK, cv2.FILLED)
    cv2.putText(picture, text, (x, y), FONT, scale, colour, 1, cv2.LINE_AA)


def _draw_grid_lines(view: Image8, birds_eye: BirdsEyeView) -> None:
    """Draw the lines of whole 5 m along the road and right of the camera's foot, faintly."""
    rows, columns = view.shape[:2]
    steps_s, steps_n = _grid(view, birds_eye)
    faint = view.copy()
    for _, row in steps_s:
        cv2.line(faint, (0, row), (columns, row), GRID, 1)
    for _, column in steps_n:
        cv2.line(faint, (column, 0), (column, rows), GRID, 1)
    cv2.addWeighted(faint, 0.35, view, 0.65, 0, dst=view)


def _grid_labels(view: Image8, birds_eye: BirdsEyeView) -> list[tuple[str, Floats]]:
    """Return the texts of the grid lines and where they go in the picture with its margin."""
    steps_s, steps_n = _grid(view, birds_eye)
    ahead = [(f"{s:g} m", np.array([MARGIN / 2, row - 8.0])) for s, row in steps_s]
    across = [(f"{n:g}", np.array([MARGIN + column, float(view.shape[0])])) for n, column in steps_n]
    return ahead + across


def _grid(view: Image8, birds_eye: BirdsEyeView) -> tuple[list[tuple[float, int]], list[tuple[float, int]]]:
    """Return the whole steps of s with their rows, and those of n with their columns."""
    per_row, per_column = birds_eye.resolution
    near, left = birds_eye.s[-1] - per_row / 2, birds_eye.n[0] - per_column / 2
    steps_s, steps_n = _whole_steps(near, birds_eye.s[0]), _whole_steps(left, birds_eye.n[-1])
    last = view.shape[0] - 1
    return (
        [(s, last - round((s - near) * PIXELS_PER_METRE)) for s in steps_s],
        [(n, round((n - left) * PIXELS_PER_METRE)) for n in steps_n],
    )


def _whole_steps(low: float, high: float) -> list[float]:
    steps = np.arange(np.ceil(low / GRID_STEP), np.floor(high / GRID_STEP) + 1) * GRID_STEP
    return [float(step) for step in steps]
