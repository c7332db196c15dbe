# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What each step of the default pipeline gives: the numbers without it, or with a plainer one in its place.

python benchmarks/ablation.py DATA SUITE [--jobs N]
DATA: the labelled KITTI frames, with all of odometry 06, which has no paint. SUITE: a folder that
`lane_dp scenes --suite standard` wrote. Prints a table in Markdown; docs/results.md has one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from command_line import KNOWN_ERRORS, exit_code, parser_of
from study_runner import UNPAINTED, Judges, kitti_pairs, labelled_pairs, patched

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_map import PaintMap, PaintMapConfig, build_paint_map
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.plane_sweep import LineHeights
from lane_dp_ros.core.parameter import replaced
from lane_dp_ros.tools.datasets.convert import progress
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.evaluation.text import Column, cell
from lane_dp_ros.tools.parallel import available_cpus
from lane_dp_ros.tools.progress import progress

CORE = "lane_dp_ros.core"
SELECTION = f"{CORE}.lanes.selection"
ANY = 1e9  # a limit that nothing exceeds
TEXTURE = 5.0  # grey levels: that of ordinary asphalt


def straight_ahead(_edges: RoadEdges, _config: object) -> RoadAxis:
    """Take the road to run where the camera looks."""
    return RoadAxis()


def even_texture(view: BirdsEyeView) -> np.ndarray[Any, Any]:
    """Take all ground for equally rough."""
    return np.full(view.image.shape, TEXTURE, np.float32)


def yes(*_: object) -> bool:
    """Accept every line."""
    return True


def graph_of_left(view: BirdsEyeView, config: PaintMapConfig, *_: object) -> PaintMap:
    """Look for paint in the left image alone."""
    return build_paint_map(view, config)


def as_it_is(line: LaneLine, *_: object) -> LaneLine:
    """Take a line as it is."""
    return line


def nothing(*_: object) -> None:
    """Have no second look, no half line."""


def no_heights(*_: object) -> LineHeights:
    """Know no heights."""
    return LineHeights()


def no_lines(*_: object) -> list[LaneLine]:
    """Find no faint lines."""
    return []


def unfiltered(_pipeline: object, answer: Any, *_: object) -> Any:
    """Take each pair's own road."""
    return replace(answer, road_profile="measured")


@dataclass(frozen=True)
class Ablation:
    """One change to the default pipeline: parameters, and names of modules that are replaced."""

    change: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    patches: Mapping[str, Any] = field(default_factory=dict)


ABLATIONS = (
    Ablation("none"),
    Ablation("disparity at full resolution", {"disparity.downscale": 1}),
    Ablation("bushes and walls count in the v-disparity, too", patches={
        f"{CORE}.road.road_profile.STANDING": ANY}),
    Ablation("road without cross slope", {"road_profile.roll": False}),
    Ablation("road profile of each pair by itself", patches={
        "lane_dp_ros.core.pipeline.LanePipeline._on_road": unfiltered}),
    Ablation("no straightening: road straight ahead", patches={
        f"{CORE}.detector.road_axis": straight_ahead}),
    Ablation("the paper's dense vanishing point", {"vanishing_point.method": "dense"}),
    Ablation("direction by sum h instead of sum h^3", patches={
        f"{CORE}.road.arc_vanishing_point.SHARPNESS": 1}),
    Ablation("no axis refinement by the paint", patches={
        f"{CORE}.detector.turned_axis": nothing}),
    Ablation("one sample for each cell, not the mean over it", patches={
        f"{CORE}.birdseye.birds_eye.SAMPLES": (1, 1)}),
    Ablation("paint looked for in the left image alone", patches={
        f"{CORE}.lanes.search.build_paint_map": graph_of_left}),
    Ablation("no height mask", {"birds_eye.height_tolerance": 1.0}),
    Ablation("the paper's feature: edges and grey", {"paint_map.feature": "edges_and_grey"}),
    Ablation("no texture normalisation", patches={f"{CORE}.birdseye.paint_map.road_texture": even_texture}),
    Ablation("one paint width (0.15 m)", patches={f"{CORE}.birdseye.paint_map.PAINT_WIDTHS": (0.15,)}),
    Ablation("the paper's Algorithm 2, bottom to top", {"path_search.free_ends": False}),
    Ablation("no memory of slope: bends cost nothing", patches={f"{CORE}.lanes.path_search.BEND_COST": 0.0}),
    Ablation("slope costs nothing", patches={f"{CORE}.lanes.path_search.SLOPE_COST": 0.0}),
    Ablation("one pass of the path search", patches={f"{CORE}.lanes.path_search.FREE_PASSES": 1}),
    Ablation("suppression of +-1 m", {"path_search.suppression": 1.0}),
    Ablation("the paper's parabola by RANSAC", {"lane_model.model": "parabola"}),
    Ablation("robust parabola instead of cubic", patches={f"{CORE}.lanes.line_fit.CUBIC_LENGTH": ANY}),
    Ablation("dashes not followed over gaps", patches={f"{CORE}.lanes.search.extend_line": as_it_is}),
    Ablation("lines not ended at stop lines", patches={f"{CORE}.lanes.search.end_at_stop_line": as_it_is}),
    Ablation("the near half of a refused line is not kept", patches={
        f"{CORE}.lanes.search.near_half": nothing}),
    Ablation("no heights along lines", patches={f"{CORE}.lanes.evidence.line_heights": no_heights}),
    Ablation("no height test", {"lane_selection.height_max": 1.0}),
    Ablation("no test of the greatest width", {"lane_selection.paint_width_max": 1.0}),
    Ablation("no wide-band test", patches={f"{SELECTION}.WIDE_BAND_RATIO_MAX": ANY}),
    Ablation("no contrast test", {"lane_selection.contrast_min": -1.0}),
    Ablation("contrast alone counts, in glare, too", patches={f"{SELECTION}.SATURATION_CONTRAST_MIN": ANY}),
    Ablation("no signs of kerbs", patches={f"{SELECTION}.KERB_CONTRAST": -ANY}),
    Ablation("kerbs: no step test", patches={f"{SELECTION}.KERB_STEP": ANY}),
    Ablation("kerbs: no width test", patches={f"{SELECTION}.KERB_WIDTH": ANY}),
    Ablation("rails: no test for narrow pale stripes", patches={f"{SELECTION}.RAIL_WIDTH": 0.0}),
    Ablation("kerbs: no height test", patches={f"{SELECTION}.KERB_HEIGHT": ANY}),
    Ablation("kerbs: no brightness test", patches={f"{SELECTION}.KERB_BRIGHTNESS": -ANY}),
    Ablation("kerbs: signs count for dashes, too", patches={f"{SELECTION}.UNBROKEN": 0.0}),
    Ablation("no slope test", {"lane_selection.slope_max": 1.0}),
    Ablation("slope test no laxer in bends", patches={f"{SELECTION}.SLOPE_PER_BEND": 0.0}),
    Ablation("lines may pass beside their paint", patches={f"{SELECTION}.OFF_PAINT_FRACTION_MAX": ANY}),
    Ablation("no texture test", {"lane_selection.texture_max": 1.0}),
    Ablation("no test of the beginning", {"lane_selection.start_max": 100.0}),
    Ablation("no mid-lane rule", patches={
        f"{SELECTION}.STRONG": 0.0, f"{SELECTION}.LONG_PIECE": 0.0}),
    Ablation("mid-lane rule: dashes do not count", patches={f"{SELECTION}.DASHES": ANY}),
    Ablation("weak lines need no partner", {"lane_selection.score_alone": 0.5}, {
        f"{SELECTION}.UNKNOWN_HEIGHT": 0.0}),
    Ablation("unknown height asks for no more paint", patches={f"{SELECTION}.UNKNOWN_HEIGHT": 0.0}),
    Ablation("no tests at all, only 4 m of paint", {
        "lane_selection.score_min": 4.0, "lane_selection.score_alone": 4.0,
    }, {
        f"{CORE}.lanes.search.is_paint": yes, f"{CORE}.lanes.search.parallel_lines": no_lines,
        f"{SELECTION}.STRONG": 0.0, f"{SELECTION}.LONG_PIECE": 0.0,
        f"{SELECTION}.UNKNOWN_HEIGHT": 0.0,
    }),
    Ablation("no second look for parallel lines", patches={f"{CORE}.lanes.search.parallel_lines": no_lines}),
    Ablation("no tracker", {"tracking.enabled": False}),
    Ablation("short losses not bridged", {"tracking.coast_time": 0.0}),
)  # fmt: skip

QUALITY = (
    Column("", "precision", "paper_precision"),
    Column("", "recall", "lane_recall"),
    Column("", "det. precision", "detection_precision"),
    Column("", "error m", "localisation_error"),
)
GROUPS = {
    "labelled frames": QUALITY,
    "06": (Column("", "lines", "false_lanes", "d"),),
    "suite": (
        *QUALITY,
        Column("", "false lanes", "false_lanes", "d"),
        Column("", "jitter m", "jitter", ".4f"),
        Column("", "id switches", "id_switches", "d"),
    ),
}


def check(ablations: Sequence[Ablation]) -> None:
    """Raise ValueError or AttributeError for a parameter or a name that is gone."""
    for ablation in ablations:
        replaced(DetectorConfig(), ablation.parameters)
        with patched(ablation.patches):
            pass


def row(ablation: Ablation, results: Sequence[FrameScore], kitti: frozenset[str]) -> str:
    """Return a line of the table; `kitti` names the labelled frames."""
    groups = (
        [r for r in results if r.name in kitti and r.sequence != UNPAINTED],
        [r for r in results if r.sequence == UNPAINTED],
        [r for r in results if r.name not in kitti],
    )
    cells = [
        cell(summarise(group), column)
        for group, columns in zip(groups, GROUPS.values(), strict=True)
        for column in columns
    ]
    return f"| {' | '.join([ablation.change, *cells])} |"


def heads() -> str:
    """Return the first two lines of the table."""
    titles = [f"{group}: {column.bottom}" for group, columns in GROUPS.items() for column in columns]
    return f"| change | {' | '.join(titles)} |\n|---{'|---' * len(titles)}|"


def run(arguments: argparse.Namespace) -> None:
    """Judge every change, and print a line for each."""
    chosen = [each for each in ABLATIONS if arguments.only.lower() in each.change or each.change == "none"]
    check(chosen)
    kitti = kitti_pairs(arguments.data)
    scenes = labelled_pairs(arguments.suite, arguments.suite / "truth.json")
    names = frozenset(pair.name for pair in kitti)
    rows = [heads()]
    with Judges([*kitti, *scenes], arguments.jobs) as judges:
        for ablation in progress(iter(chosen), len(chosen), "change"):
            results = judges.results(replaced(DetectorConfig(), ablation.parameters), ablation.patches)
            rows.append(row(ablation, results, names))
    print(*rows, sep="\n")


def main() -> int:
    """Judge and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("suite", type=Path, metavar="SUITE")
    parser.add_argument("--only", default="", metavar="TEXT", help="changes with this in their name")
    parser.add_argument("--jobs", type=int, default=available_cpus(), metavar="N")
    return exit_code(run, parser.parse_args(), (*KNOWN_ERRORS, AttributeError))


if __name__ == "__main__":
    sys.exit(main())
