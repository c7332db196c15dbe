# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The two numbers that make a model as sure of drives that it never saw as it may be."""

import math
from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.lanes.candidate import LaneEvidence
from lane_dp_ros.core.lanes.evidence_model import PAIRS, EvidenceModel, Term
from lane_dp_ros.core.lanes.neighbours import Neighbours
from lane_dp_ros.tools.evidence_fit.calibration import calibrated, calibration
from lane_dp_ros.tools.evidence_fit.examples import Example

FLAT = Term(np.array([0.0, 1.0]), np.zeros(2))
PAINT_ONLY, NO_PAINT = (True, False, False), (False, False, True)


def model(paint: float = 0.0) -> EvidenceModel:
    """A model that knows nothing but how frequent paint is."""
    return EvidenceModel(
        {"paint": paint, "edge": -50.0}, {"paint": {}, "edge": {}}, dict.fromkeys(PAIRS, FLAT), {}
    )


def frame(*may_be: tuple[bool, bool, bool]) -> Example:
    """A frame with a single candidate."""
    evidence = LaneEvidence(length=20.0, start=5.0, slope=0.0, score=8.0)
    alone = Neighbours(np.zeros((1, 1)), np.zeros((1, 1)), np.array([True]))
    found = ((0,),) if may_be[0][0] else ()
    return Example("a", "b", "", (evidence,), alone, np.array(may_be), found)


@pytest.mark.parametrize("paint", [-1.0, 0.0, 0.5])
def test_as_much_is_added_as_the_frequency_of_paint_says(paint):
    """Of 80 unseen candidates 60 are paint: log-odds ln 3, whatever the model thought."""
    unseen = [(frame(PAINT_ONLY), model(paint))] * 60 + [(frame(NO_PAINT), model(paint))] * 20
    added = calibration(unseen)
    assert paint + added[0] == pytest.approx(math.log(3), abs=0.03)  # the ridge holds it back a little
    assert calibrated(model(paint), added).start["paint"] == pytest.approx(paint + added[0])


def test_few_frames_do_not_make_a_model_certain():
    assert 0 < calibration([(frame(PAINT_ONLY), model())])[0] <= 3.0


def test_a_border_without_paint_says_nothing_of_paint():
    border = frame(NO_PAINT)
    border = replace(border, evidence=(replace(border.evidence[0], score=math.nan),))
    assert calibration([(border, model())] * 50)[0] == pytest.approx(0, abs=1e-6)


def test_frames_without_candidates_add_nothing():
    empty = Example("a", "b", "", (), Neighbours.of([]), np.empty((0, 3), bool), ())
    np.testing.assert_array_equal(calibration([(empty, model())]), [0, 0])


def test_road_edges_stay_as_probable_as_they_were_fitted():
    border = frame((False, False, True))
    likely = replace(model(), start={"paint": -50.0, "edge": 2.0})
    assert calibration([(border, likely)] * 50)[1] == 0
