# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A judged frame as JSON and back, lines and labels with it: docs/evaluation.md."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Lane, LaneKind, LaneRole, PaintColour
from lane_dp_ros.tools.evaluation.depth import CURVE_DEPTHS, NO_SURFACE, DepthErrors
from lane_dp_ros.tools.evaluation.lateral import LateralErrors
from lane_dp_ros.tools.evaluation.paint_kinds import PaintComparison
from lane_dp_ros.tools.evaluation.scores import FrameScore, JudgedLine, Match, RoadEdgeScore, Verdict
from lane_dp_ros.tools.evaluation.summary_json import number
from lane_dp_ros.tools.evaluation.truth_file import (
    CAMERA_FIELDS,
    METRE_DIGITS,
    finite_array,
    frame_from_json,
    frame_to_json,
)
from lane_dp_ros.tools.evaluation.tusimple_culane import CULane, TuSimple

Floats = NDArray[np.float64]

TEXT_FIELDS = ("name", "sequence", "category")
NUMBER_FIELDS = {"stamp_ns": int, "unpainted": bool, "latency": float}  # None: not known
ID_FIELDS = ("labels", "ego_labels", "incorrect", "missed")
TUSIMPLE_FIELDS = ("frames", "accuracy_sum", "fp_sum", "fn_sum")
CULANE_FIELDS = ("tp", "fp", "fn")
LANE_NUMBERS = ("confidence", "paint_width", "curvature", "lateral_offset")
CHOICES: dict[str, tuple[str, ...]] = {
    "verdict": get_args(Verdict),
    "role": get_args(LaneRole),
    "kind": get_args(LaneKind),
    "colour": get_args(PaintColour),
}


def score_to_json(result: FrameScore) -> dict[str, Any]:
    """Return a judged frame as what JSON can hold: metres to 0.1 mm, null for what is not known."""
    edges, depth, camera = result.road_edges, result.depth, result.camera
    return {
        **_attributes(result, (*TEXT_FIELDS, *NUMBER_FIELDS)),
        **{name: list(getattr(result, name)) for name in ID_FIELDS},
        "surface_measured": None if depth is None else depth.measured,
        "depth_errors": None if depth is None or not depth.measured else list(map(number, depth.errors)),
        **_lines_to_json(result),
        "road_edges": None if edges is None else {"labels": list(edges.labels), **_lines_to_json(edges)},
        "tusimple": result.tusimple and _attributes(result.tusimple, TUSIMPLE_FIELDS),
        "culane": result.culane and _attributes(result.culane, CULANE_FIELDS),
        "camera": camera
        and {**_attributes(camera, CAMERA_FIELDS), "left_translation": camera.left_translation},
        "truth": result.truth and frame_to_json(result.truth),
    }


def score_from_json(fields: Any) -> FrameScore:
    """Return the judged frame that `score_to_json` wrote.

    Raises KeyError, TypeError or ValueError for anything else.
    """
    told: dict[str, Any] = {
        **{name: str(fields[name]) for name in TEXT_FIELDS},
        **{
            name: None if fields[name] is None else read(fields[name]) for name, read in NUMBER_FIELDS.items()
        },
        **{name: tuple(map(str, fields[name])) for name in ID_FIELDS},
    }
    return FrameScore(
        **told,
        depth=_depth_from_json(fields["surface_measured"], fields["depth_errors"]),
        detections=_detections_from_json(fields),
        matches=_matches_from_json(fields),
        road_edges=_known(fields["road_edges"], _edges_from_json),
        tusimple=_known(fields["tusimple"], _tusimple_from_json),
        culane=_known(fields["culane"], _culane_from_json),
        camera=_known(fields["camera"], _camera_from_json),
        truth=_known(fields["truth"], partial(frame_from_json, str(fields["name"]))),
    )


def _edges_from_json(fields: Any) -> RoadEdgeScore:
    labels = tuple(map(str, fields["labels"]))
    return RoadEdgeScore(_detections_from_json(fields), _matches_from_json(fields), labels)


def _known(value: Any, read: Callable[[Any], Any]) -> Any:
    """Return what `read` makes of a value, None for null."""
    return None if value is None else read(value)


def _attributes(source: object, names: Sequence[str]) -> dict[str, Any]:
    return {name: getattr(source, name) for name in names}


def _tusimple_from_json(fields: Any) -> TuSimple:
    return TuSimple(int(fields["frames"]), *(float(fields[name]) for name in TUSIMPLE_FIELDS[1:]))


def _culane_from_json(fields: Any) -> CULane:
    return CULane(*(int(fields[name]) for name in CULANE_FIELDS))


def _camera_from_json(fields: Any) -> StereoCamera:
    fx, fy, cx, cy, baseline = (float(fields[name]) for name in CAMERA_FIELDS)
    x, y, z = map(float, fields["left_translation"])
    return StereoCamera(fx, fy, cx, cy, baseline, left_translation=(x, y, z))


def _depth_from_json(measured: bool | None, errors: Any) -> DepthErrors | None:
    if errors is None:
        return None if measured is None else NO_SURFACE
    if len(errors) != len(CURVE_DEPTHS):
        raise ValueError(f"{len(errors)} depth_errors, expected {len(CURVE_DEPTHS)}")
    return DepthErrors(tuple(map(_or_nan, errors)))


def _or_nan(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def _lines_to_json(scores: FrameScore | RoadEdgeScore) -> dict[str, Any]:
    return {
        "matches": [_match_to_json(match) for match in scores.matches],
        "detections": [_detection_to_json(detection) for detection in scores.detections],
    }


def _detection_to_json(detection: JudgedLine) -> dict[str, Any]:
    lane = detection.lane
    return {
        **_attributes(lane, ("id", "role", "kind", "colour")),
        **{name: number(float(getattr(lane, name))) for name in LANE_NUMBERS},
        "sides": None if lane.sides is None else list(lane.sides),
        **_attributes(detection, ("verdict", "strict_verdict", "label", "beside_edge")),
        "points": np.round(lane.points, METRE_DIGITS).tolist(),
    }


def _detections_from_json(fields: Any) -> tuple[JudgedLine, ...]:
    return tuple(map(_detection_from_json, fields["detections"]))


def _detection_from_json(fields: Any) -> JudgedLine:
    for name, choices in CHOICES.items():
        if fields[name] not in choices:
            raise ValueError(
                f"{name} is {repr(fields[name])[:40]}, expected one of {', '.join(filter(None, choices))}"
            )
    told: dict[str, Any] = {
        **{name: _or_nan(fields[name]) for name in LANE_NUMBERS},
        **{name: fields[name] for name in ("role", "kind", "colour")},
        "sides": _known(fields["sides"], tuple),
    }
    lane = Lane(finite_array(fields["points"], (-1, 3), "points"), id=int(fields["id"]), **told)
    return JudgedLine(lane, fields["verdict"], fields["label"], bool(fields["beside_edge"]))


def _match_to_json(match: Match) -> dict[str, Any]:
    return {
        **_attributes(match, ("label", "detection", "counts", "error")),
        "error_near": match.near,
        "error_far": match.far,
        "error_3d_near": match.in_space.near,
        "error_3d_far": match.in_space.far,
        **_attributes(match, ("position", "label_position")),
        "errors": _samples_to_json(match.depths, match.errors),
        "errors_3d": _samples_to_json(match.in_space.depths, match.in_space.errors),
        "paint": None if match.paint is None else list(match.paint),
    }


def _matches_from_json(fields: Any) -> tuple[Match, ...]:
    matches = tuple(map(_match_from_json, fields["matches"]))
    for match in matches:
        if not 0 <= match.detection < len(fields["detections"]):
            raise ValueError(f"a match with detection {match.detection} of {len(fields['detections'])}")
    return matches


def _match_from_json(fields: Any) -> Match:
    in_space = LateralErrors(*_samples_from_json(fields["errors_3d"], "errors_3d"))
    return Match(
        str(fields["label"]),
        int(fields["detection"]),
        bool(fields["counts"]),
        *_samples_from_json(fields["errors"], "errors"),
        position=_known(fields["position"], float),
        label_position=_known(fields["label_position"], float),
        in_space=in_space,
        paint=_known(fields["paint"], lambda words: PaintComparison(*map(str, words))),
    )


def _samples_to_json(depths: Floats, errors: Floats) -> list[list[float]]:
    return np.round(np.column_stack([depths, errors]), METRE_DIGITS).tolist()


def _samples_from_json(samples: Any, what: str) -> tuple[Floats, Floats]:
    """Return depths (N,) and errors (N,) [m] of pairs [depth, error]."""
    pairs = finite_array(samples, (-1, 2), what) if samples else np.empty((0, 2))
    return pairs[:, 0], pairs[:, 1]
