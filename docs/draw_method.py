# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw what each stage of the method makes of one rendered stereo pair, for docs/method.md.

python docs/draw_method.py [DIR]    write the pictures to DIR, default docs/_pictures
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray

from lane_dp_ros.core.birdseye.edge_map import edge_map
from lane_dp_ros.core.detector import LaneDetection, LaneDetector
from lane_dp_ros.core.lanes.candidate import Candidate
from lane_dp_ros.core.road.arc_vote import _Vote
from lane_dp_ros.core.road.edge_pixels import EdgePixels, edge_pixels
from lane_dp_ros.core.road.road_samples import RoadSamples, road_samples, v_disparity
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.messages.pictures import draw_birds_eye, draw_overlay
from lane_dp_ros.scenes import ScenePair
from lane_dp_ros.scenes.scene import CAMERA
from lane_dp_ros.scenes.suite import Drive

HERE = Path(__file__).resolve().parent
PICTURES = HERE / "_pictures"
CATEGORY, FRAME = "guard_rails", 2
UNKNOWN = (60, 50, 45)  # blue, green, red of a pixel without a disparity
JPEG = [cv2.IMWRITE_JPEG_QUALITY, 88]
LANE, EDGE, REFUSED = "#2fd04a", "#c04fe0", "#ff5a4d"
STYLE = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "savefig.dpi": 110}

Image8 = NDArray[np.uint8]


class Stages:
    """One rendered pair, what the detector makes of it, and a picture of each stage in `folder`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._detector = LaneDetector(CAMERA)
        self._pair: ScenePair = Drive(CATEGORY).render(FRAME)
        self._frame = StereoFrame(self._pair.left, self._pair.right)
        self._grey = self._frame.grey()
        self._found: LaneDetection = self._detector.detect(self._frame)

    def draw(self) -> None:
        """Write the pictures, in the order of the stages."""
        folder = self._folder
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder / "pair.jpg", np.vstack([self._pair.left, self._pair.right]))
        _write(folder / "disparity.jpg", self._coloured_disparity())
        _write(folder / "heights.jpg", self._heights())
        _save(folder / "v_disparity.png", self._v_disparity())
        _save(folder / "vote.png", self._vote())
        _save(folder / "maps.png", self._maps())
        _save(folder / "paths.png", self._paths())
        _save(folder / "candidates.png", self._candidates())
        _write(folder / "overlay.jpg", draw_overlay(self._pair.left, self._lanes, CAMERA))
        _write(folder / "birds_eye.jpg", draw_birds_eye(self._view, self._pair.left, self._lanes))

    @property
    def _view(self) -> Any:
        return self._found.birds_eye

    @property
    def _lanes(self) -> list[Any]:
        found = [*self._found.lanes, *self._found.road_edges]
        return [replace(lane, id=i) for i, lane in enumerate(found)]

    def _coloured_disparity(self) -> Image8:
        disparity = self._found.disparity.full
        known = np.isfinite(disparity)
        scaled = np.where(known, disparity / np.nanmax(disparity) * 255, 0).astype(np.uint8)
        picture = np.asarray(cv2.applyColorMap(scaled, cv2.COLORMAP_TURBO), dtype=np.uint8)
        picture[~known] = UNKNOWN
        return picture

    def _heights(self) -> Image8:
        """Return the left image: green where it lies on the road's surface, red where it stands above."""
        rows, columns = np.indices(self._grey.left.shape, dtype=np.float32)
        with np.errstate(all="ignore"):
            height = self._found.road.height_above(self._found.disparity.full, columns, rows)
        colours = {(90, 200, 60): np.abs(height) < 0.1, (60, 70, 220): (height >= 0.1) & (height < 6)}
        picture = self._pair.left.copy()
        for colour, where in colours.items():
            picture[where] = 0.5 * picture[where] + 0.5 * np.array(colour)
        return picture

    def _v_disparity(self) -> plt.Figure:
        samples = road_samples(
            self._found.disparity, CAMERA, self._detector.config.road_profile.camera_height
        )
        figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.1), width_ratios=(2.2, 1), sharey=True)
        left.imshow(cv2.cvtColor(self._pair.left, cv2.COLOR_BGR2RGB), aspect="auto")
        left.set(xlabel="u [px]", ylabel="v [px]", title="left image")
        _draw_v_disparity(right, samples, self._found)
        return figure

    def _vote(self) -> plt.Figure:
        """Return the edges on the road, and their vote for heading and curvature."""
        config = self._detector.config.vanishing_point
        edges = edge_pixels(self._grey.left, self._found.disparity, self._found.road)
        vote = _Vote(edges, config.heading_max, config.curvature_max)
        figure, (ground, votes) = plt.subplots(1, 2, figsize=(8.5, 3.4), width_ratios=(1, 1.5))
        _draw_edges(ground, edges, self._view.axis)
        extent = (vote.headings[0], vote.headings[-1], vote.curvatures[0], vote.curvatures[-1])
        votes.imshow(np.sqrt(vote._accumulate()), extent=extent, aspect="auto", origin="lower", cmap="magma")
        votes.plot(self._view.axis.heading, self._view.axis.curvature, "o", ms=12, mfc="none", mec="cyan")
        votes.set(
            xlabel="heading [rad]", ylabel="curvature [1/m]", title="votes, and the axis that was taken"
        )
        return figure

    def _maps(self) -> plt.Figure:
        """Return the bird's-eye view, the paint map and the map of borders, side by side."""
        paint = self._found.paint_map
        edges = edge_map(self._view, paint)
        panels = {
            "from above": (self._view.image, "gray"),
            "paint map": (paint.feature, "viridis"),
            "edge map": (edges.feature, "magma"),
        }
        figure, axes = plt.subplots(1, 3, figsize=(8.5, 5.2), sharey=True)
        for ax, (title, (image, colours)) in zip(axes, panels.items(), strict=True):
            ax.imshow(image, extent=self._extent, aspect="equal", cmap=colours)
            ax.set(title=title, xlabel="n [m]")
        axes[0].set_ylabel("s [m]")
        return figure

    def _paths(self) -> plt.Figure:
        figure, (paths, lines) = plt.subplots(1, 2, figsize=(6.6, 5.2), sharey=True)
        for ax in (paths, lines):
            ax.imshow(self._found.paint_map.feature, extent=self._extent, aspect="equal", cmap="gray")
            ax.set(xlabel="n [m]", xlim=self._extent[:2], ylim=self._extent[2:])
        for path in self._found.paths:
            n = self._view.n[0] + path.columns * self._view.resolution[1]
            paths.plot(n, self._view.s[path.rows], lw=1.6)
        for each in self._of_paint:
            lines.plot(each.line.n, each.line.s, lw=1.6)
        paths.set(title="shortest paths", ylabel="s [m]")
        lines.set(title="lines through them")
        return figure

    def _candidates(self) -> plt.Figure:
        """Return every candidate from above, in the colour of what became of it, with its probability."""
        figure, ax = plt.subplots(figsize=(6.6, 5.6))
        ax.imshow(self._view.image, extent=self._extent, aspect="equal", cmap="gray", alpha=0.7)
        for each in self._found.candidates:
            colour, probability = _fate(each)
            ax.plot(each.line.n, each.line.s, color=colour, lw=2 if colour != REFUSED else 1)
            if colour != REFUSED:
                s, n = (values[-1 if colour == LANE else 0] for values in (each.line.s, each.line.n))
                offset = 0.4 if colour == LANE else -1.2  # lanes at their far end, borders at their near one
                ax.text(n, s + offset, f"{probability:.2f}", color=colour, ha="center")
        for colour, name in ((LANE, "lane"), (EDGE, "road edge"), (REFUSED, "refused")):
            ax.plot([], [], color=colour, label=name)
        ax.legend(loc="upper left", bbox_to_anchor=(1.02, 1), frameon=False)
        ax.set(
            xlabel="n [m]", ylabel="s [m]", xlim=self._extent[:2], ylim=(self._extent[2], self._extent[3] + 2)
        )
        return figure

    @property
    def _of_paint(self) -> list[Candidate]:
        return [each for each in self._found.candidates if each.variant == "path"]

    @property
    def _extent(self) -> tuple[float, float, float, float]:
        """Left, right, near and far [m] of the bird's-eye view."""
        n, s = self._view.n, self._view.s
        return float(n[0]), float(n[-1]), float(s[-1]), float(s[0])


def _draw_v_disparity(ax: Any, samples: RoadSamples | None, found: LaneDetection) -> None:
    """Draw the histogram of the disparities of each row, and the surface straight ahead."""
    assert samples is not None and found.road is not None
    bin_size = samples.resolution
    shape = int(samples.row.max()) + 1, int(samples.d.max() / bin_size) + 1
    histogram = v_disparity(samples.row[samples.lies], samples.d[samples.lies] / bin_size, shape)
    rows = samples.row_v[: shape[0]]
    extent = (0, shape[1] * bin_size, rows[-1], rows[0])
    ax.imshow(np.sqrt(histogram), extent=extent, aspect="auto", cmap="magma")
    ax.plot(found.road.disparity(np.full(len(rows), CAMERA.cx), rows), rows, color="cyan", lw=1.2)
    ax.set(xlabel="disparity [px]", title="v-disparity, and the road in it")


def _draw_edges(ax: Any, edges: EdgePixels, axis: Any) -> None:
    """Draw edges on the ground as short strokes, and the axis that they vote for."""
    along = 0.25 * np.stack([np.sin(edges.heading), np.cos(edges.heading)])
    foot = np.stack([edges.x, edges.z])
    ax.plot(*np.stack([foot - along, foot + along], axis=1), color="0.4", lw=0.5)
    ax.plot(*axis.to_ground(np.linspace(0, 35, 50), np.zeros(50)), color="tab:cyan", lw=2)
    ax.set(xlabel="x [m]", ylabel="z [m]", title="edges on the ground", xlim=(-10, 10), ylim=(0, 36))


def _fate(candidate: Candidate) -> tuple[str, float]:
    """Return the colour of what became of a candidate, and how probable that is."""
    paint, border = candidate.probability
    if candidate.is_edge:
        return EDGE, border
    return (REFUSED, paint) if candidate.refusal else (LANE, paint)


def _write(path: Path, picture: Image8) -> None:
    if not cv2.imwrite(str(path), picture, JPEG):
        raise OSError(f"{path} could not be written")


def _save(path: Path, figure: plt.Figure) -> None:
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)


def main(folder: Path = PICTURES) -> None:
    """Draw all."""
    cv2.setNumThreads(1)
    mpl.use("agg")
    with mpl.rc_context(STYLE):
        Stages(folder).draw()


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
