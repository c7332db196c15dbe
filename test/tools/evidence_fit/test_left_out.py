# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What is left out of a fit is seen by none of what is fitted; each frame is left out once."""

import pytest

from lane_dp_ros.core.detector import LaneDetection
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evidence_fit.collecting import Collected, FrameSource, KnownPair
from lane_dp_ros.tools.evidence_fit.examples import example
from lane_dp_ros.tools.evidence_fit.left_out import FOLDS, SCENES, folds


def nothing() -> KnownPair:
    raise AssertionError("no frame is loaded to leave it out")


def collected(drive: str, category: str = "", variations: int = 0) -> Collected:
    truth = LabelledFrame("a/b", None, (2, 2), [0, 0, 0, 0], (), category=category)
    examples = [example("a/b", drive, LaneDetection(), truth, True) for _ in range(1 + variations)]
    return Collected(FrameSource(drive, nothing), tuple(examples))


def test_each_drive_is_left_out_whole():
    frames = [collected("a"), collected("b"), collected("a"), collected("b")]
    drives, categories = folds(frames)
    assert [sorted(fold.unseen) for fold in drives] == [[0, 2], [1, 3]]
    assert [sorted(fold.judged) for fold in drives] == [[0, 2], [1, 3]]
    assert categories == []


def test_many_drives_share_a_fit_but_never_lie_in_two():
    frames = [collected(f"drive {i % 20}") for i in range(60)]
    drives, _ = folds(frames)
    assert len(drives) == FOLDS == 8
    assert sorted(i for fold in drives for i in fold.judged) == list(range(60))
    for fold in drives:
        assert fold.unseen == set(fold.judged)
        assert {frames[i].drive for i in fold.unseen}.isdisjoint(
            frames[i].drive for i in range(60) if i not in fold.unseen
        )


def test_a_scene_is_judged_by_a_model_that_saw_nothing_of_its_category():
    frames = [
        collected(SCENES, "kerbs+wet"),
        collected(SCENES, "wet"),
        collected(SCENES, "night+kerbs"),
        collected("real"),
    ]
    _, categories = folds(frames)
    assert {fold.judged: fold.unseen for fold in categories} == {
        (0,): {0, 2},
        (1,): {0, 1},
        (2,): {2},
    }


def test_a_single_drive_without_scenes_is_refused():
    with pytest.raises(CommandError, match="'a': label another one"):
        folds([collected("a"), collected("a")])


def test_a_real_frame_counts_most():
    assert collected("a", variations=2).weights == (1.0, 0.25, 0.25)
    assert collected(SCENES, "kerbs").weights == (0.3,)
