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
from command_line import exit_code, parser_of
from study_runner import UNPAINTED, Judges, kitti_pairs, labelled_pairs, replacing

from lane_dp_ros.core import search
from lane_dp_ros.core.birdseye import birds_eye, paint_map
from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeView
from lane_dp_ros.core.birdseye.paint_map import BandsPaintMap, PaintMap
from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.lanes import evidence, line_fit
from lane_dp_ros.core.lanes.candidate import Candidate, LaneLine
from lane_dp_ros.core.lanes.edge_lines import EdgeLineSearch
from lane_dp_ros.core.lanes.evidence_model import CLASSES
from lane_dp_ros.core.lanes.neighbours import Neighbours
from lane_dp_ros.core.lanes.plane_sweep import LineHeights
from lane_dp_ros.core.lanes.scoring import EvidenceScoring
from lane_dp_ros.core.parameter import Value, parameters, replaced
from lane_dp_ros.core.road import arc_vote, road_profile, road_samples, vanishing_point
from lane_dp_ros.core.road.direct_alignment import Alignment
from lane_dp_ros.core.tracking.road_filter import RoadFilter
from lane_dp_ros.core.types import RoadGate, as_measured
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.evaluation.text import Column, cell
from lane_dp_ros.tools.parallel import available_cpus
from lane_dp_ros.tools.progress import progress

ANY = 1e9  # a limit that nothing exceeds
METRES = 4.0  # net metres of paint, as likely a line as none
TEXTURE = 5.0  # grey levels: that of ordinary asphalt
SPECS = parameters(DetectorConfig())
BUILD = BandsPaintMap.build


def straight_ahead(*_: object) -> RoadAxis:
    """Take the road to run where the camera looks."""
    return RoadAxis()


def each_by_itself(*_: object) -> RoadGate:
    """Take each pair's own road."""
    return as_measured


def even_texture(view: BirdsEyeView) -> np.ndarray[Any, Any]:
    """Take all ground for equally rough."""
    return np.full(view.image.shape, TEXTURE, np.float32)


def of_left_image(builder: BandsPaintMap, view: BirdsEyeView, *_: object) -> PaintMap:
    """Look for paint in the left image alone."""
    return BUILD(builder, view)


def as_matched(surface: VerticalCurve, *_: object) -> Alignment:
    """Take a surface as the disparity tells it."""
    return Alignment(surface)


def as_it_is(line: LaneLine, *_: object) -> LaneLine:
    """Take a line as it is."""
    return line


def no_half(*_: object) -> None:
    """Have no half line."""


def no_heights(lines: Sequence[LaneLine], *_: object) -> list[LineHeights]:
    """Know no heights."""
    return [LineHeights()] * len(lines)


def no_lines(*_: object) -> list[LaneLine]:
    """Find no lines."""
    return []


def by_themselves(neighbours: Neighbours, *_: object) -> np.ndarray[Any, Any]:
    """Have no two lines speak for or against one another."""
    return np.zeros((*neighbours.gap.shape, len(CLASSES), len(CLASSES)))


def by_metres(_: EvidenceScoring, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Take for paint what has some metres of it, and nothing for a border."""
    return [replace(each, log_odds=(each.score - METRES, -np.inf)) for each in candidates]


def highest(*names: str) -> dict[str, Value]:
    """Return the greatest value that each of these parameters may have."""
    return {name: SPECS[name].type(SPECS[name].maximum) for name in names}


@dataclass(frozen=True)
class Ablation:
    """One change to the default pipeline: parameters, and names replaced where these do not reach."""

    change: str
    parameters: Mapping[str, Value] = field(default_factory=dict)
    patches: Mapping[str, Any] = field(default_factory=dict)


ABLATIONS = (
    Ablation("none"),
    Ablation("bushes and walls count in the v-disparity, too", patches=replacing(road_samples, STANDING=ANY)),
    Ablation("the paper's quadratic road, without cross slope", {"road_profile.model": "quadratic"}),
    Ablation("road surface by the disparity alone", patches=replacing(road_profile, aligned=as_matched)),
    Ablation("road profile of each pair by itself", patches=replacing(RoadFilter, predict=each_by_itself)),
    Ablation(
        "no straightening: road straight ahead",
        patches=replacing(vanishing_point, arc_of_edges=straight_ahead),
    ),
    Ablation("the paper's dense vanishing point", {"vanishing_point.method": "dense"}),
    Ablation("direction by sum h instead of sum h^3", patches=replacing(arc_vote, SHARPNESS=1)),
    Ablation("no axis refinement by the paint", highest("axis_refinement.slope_min")),
    Ablation("one sample for each cell, not the mean over it", patches=replacing(birds_eye, SAMPLES=(1, 1))),
    Ablation(
        "paint looked for in the left image alone", patches=replacing(BandsPaintMap, build=of_left_image)
    ),
    Ablation("no height mask", highest("birds_eye.height_tolerance")),
    Ablation("the paper's feature: edges and grey", {"paint_map.feature": "edges_and_grey"}),
    Ablation("no texture normalisation", patches=replacing(paint_map, road_texture=even_texture)),
    Ablation("one paint width (0.15 m)", patches=replacing(paint_map, PAINT_WIDTHS=(0.15,))),
    Ablation("the paper's Algorithm 2, bottom to top", {"path_search.free_ends": False}),
    Ablation("no memory of slope: bends cost nothing", {"path_search.bend_cost": 0.0}),
    Ablation("slope costs nothing", {"path_search.slope_cost": 0.0}),
    Ablation("one pass of the path search", {"path_search.passes": 1}),
    Ablation("suppression of +-1 m", {"path_search.suppression": 1.0}),
    Ablation("the paper's parabola by RANSAC", {"lane_model.model": "parabola"}),
    Ablation("robust parabola instead of cubic", patches=replacing(line_fit, CUBIC_LENGTH=ANY)),
    Ablation("dashes not followed over gaps", patches=replacing(search, extend_line=as_it_is)),
    Ablation("lines not ended at stop lines", highest("stop_line.unpainted_min")),
    Ablation("the near half of a refused line is not kept", patches=replacing(search, near_half=no_half)),
    Ablation("no heights along lines", patches=replacing(evidence, line_heights=no_heights)),
    Ablation("lines judged each by itself", patches=replacing(Neighbours, log_odds=by_themselves)),
    Ablation(
        "no borders of the carriageway among the candidates", patches=replacing(EdgeLineSearch, find=no_lines)
    ),
    Ablation(
        "no evidence but metres of paint: 4 m make a line",
        patches=replacing(EvidenceScoring, scored=by_metres),
    ),
    Ablation("paint as high above the road as it likes", highest("lane_selection.height_max")),
    Ablation("paint as broad as it likes", highest("lane_selection.paint_width_max")),
    Ablation("paint as bright beside as on it", highest("lane_selection.wide_band_ratio_max")),
    Ablation("no second look for parallel lines", patches=replacing(search, parallel_lines=no_lines)),
    Ablation("no tracker", {"tracking.enabled": False}),
    Ablation("short losses not bridged", {"tracking.coast_time": 0.0}),
)

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
    """Raise ValueError for a parameter that is gone, or a value that it may not have."""
    for ablation in ablations:
        replaced(DetectorConfig(), ablation.parameters)


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
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
