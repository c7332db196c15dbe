# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Heights along a line, on pairs of grainy ground whose heights are known."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.birdseye.birds_eye import BirdsEyeConfig, birds_eye_view
from lane_dp_ros.core.geometry.disparity_map import DisparityMap
from lane_dp_ros.core.geometry.quadratic_surface import QuadraticSurface
from lane_dp_ros.core.geometry.road_axis import RoadAxis
from lane_dp_ros.core.lanes import evidence as lane_evidence
from lane_dp_ros.core.lanes.candidate import LaneLine
from lane_dp_ros.core.lanes.plane_sweep import PLANES, LineHeights, _seen, line_heights
from lane_dp_ros.core.types import StereoFrame

pytestmark = pytest.mark.filterwarnings("error")

SHAPE = (375, 1242)
LINE = 1.5  # m right of the vehicle
BORDER = 0.25  # m from the line; there its height ends
CENTIMETRE = 0.01
FAR = 18.0  # m; farther heights are not measured


@pytest.fixture(scope="module")
def grainy_pair(camera):
    """Return a function: a pair that shows grainy ground, so high along x = `n` [m] and beside it."""
    surface = QuadraticSurface.plane(camera, 1.65, 0.02)

    def grainy_pair(
        line=0.0,
        left=0.0,
        right=0.0,
        *,
        n=LINE,
        grain=25.0,
        gain=1.0,
        grey=110,
        salt=0.0,
    ):
        rng = np.random.default_rng(0)
        seen = grey + grain * cv2.GaussianBlur(rng.normal(0, 2, SHAPE), (0, 0), 1.2)
        v, u = np.indices(SHAPE, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            x, _ = surface.pixel_to_ground(u, v)
        height = np.where(np.abs(x - n) < BORDER, line, np.where(x < n, left, right))
        disparity = np.maximum(surface.disparity(u, v), 0) * 1.65 / (1.65 - height) + camera.disparity_offset
        other = np.empty(SHAPE)
        for row, (columns, values) in enumerate(zip(u - disparity, seen, strict=True)):
            order = np.argsort(columns, kind="stable")
            other[row] = np.interp(np.arange(SHAPE[1]), columns[order], values[order])
        images = [
            np.clip(image + rng.normal(0, 1, SHAPE), 0, 255).astype(np.uint8)
            for image in (seen, 110 + gain * (other - 110))
        ]
        images[1][rng.random(SHAPE) < salt] = 255
        nothing = DisparityMap.unknown(SHAPE)
        view = birds_eye_view(images[0], nothing, surface, RoadAxis(), BirdsEyeConfig())
        return view, StereoFrame(*images)

    return grainy_pair


def line_along(view, n, first=6.0, last=20.0):
    rows = np.flatnonzero((view.s >= first) & (view.s <= last))[::-1]
    return LaneLine(rows, view.s[rows], np.full(len(rows), n), bend=0.0, score=10.0)


@pytest.fixture(scope="module")
def measured(grainy_pair):
    """Return a function: the heights that such a pair shows along a line at `n` [m]."""

    def measured(*heights, n=LINE, first=6.0, last=20.0, **pair):
        view, frame = grainy_pair(*heights, n=n, **pair)
        (found,) = line_heights([line_along(view, n, first, last)], view, frame)
        return found

    return measured


@pytest.mark.parametrize(
    "heights",
    [
        (0.0, 0.0, 0.0),
        (0.015, 0.015, 0.015),  # the road bulges
        (0.0, 0.0, 0.12),  # a gutter before a kerb
        (0.08, 0.02, 0.13),  # the face of a kerb
        (0.12, 0.12, 0.0),  # its edge
        (-0.04, 0.0, -0.07),  # a ditch
    ],
)
@pytest.mark.parametrize("n", [LINE, -3.4])
def test_heights_are_measured_to_a_centimetre(measured, heights, n):
    found = measured(*heights, n=n)
    assert (found.line, found.left, found.right) == pytest.approx(heights, abs=CENTIMETRE)


@pytest.mark.parametrize("gain", [0.6, 1.6])
def test_another_exposure_of_the_right_camera_changes_nothing(measured, gain):
    found = measured(0.06, 0.0, 0.10, gain=gain)
    assert (found.line, found.left, found.right) == pytest.approx((0.06, 0.0, 0.10), abs=CENTIMETRE)


def test_dead_pixels_change_nothing(measured):
    found = measured(0.06, 0.0, 0.10, salt=0.002)
    assert (found.line, found.left, found.right) == pytest.approx((0.06, 0.0, 0.10), abs=CENTIMETRE)


@pytest.mark.parametrize("height", [0.22, 0.23])
def test_a_rail_as_high_as_the_last_plane_is_not_unknown(measured, height):
    assert measured(line=height).line > 0.2


@pytest.mark.parametrize("height", [0.4, 0.8])
def test_what_stands_on_the_road_has_no_height_that_a_line_could_have(measured, height):
    found = measured(line=height)
    assert np.isnan(found.line)
    assert found.left == pytest.approx(0, abs=CENTIMETRE)


@pytest.mark.parametrize("ground", [{"grain": 0.0}, {"grey": 330, "grain": 12.0}], ids=["bare", "burnt out"])
def test_ground_that_shows_nothing_tells_nothing(measured, ground):
    assert np.isnan(list(vars(measured(**ground)).values())).all()


@pytest.mark.parametrize(("first", "last"), [(6.0, 8.0), (FAR - 2, 30.0), (FAR + 1, 30.0)])
def test_too_little_of_a_line_tells_nothing(measured, first, last):
    assert np.isnan(list(vars(measured(first=first, last=last)).values())).all()


def test_ground_beyond_the_picture_is_not_known(measured):
    found = measured(n=-7.8, last=14.0)  # leaves the picture 9 m ahead
    assert np.isnan(found.left)


def as_array(found):
    return np.array([[each.line, each.left, each.right] for each in found])


PLACES = [(LINE, 6.0, 20.0), (-3.4, 6.0, 12.0), (LINE, 6.0, 8.0), (0.3, 19.0, 30.0), (-7.8, 6.0, 14.0)]


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4), (4, 3, 2, 1, 0), (2, 3), (1, 1, 2, 0)], ids=str)
def test_many_lines_at_once_have_the_heights_that_each_has_by_itself(grainy_pair, order):
    """Among them one that is too short, one too far off, and one that leaves the picture."""
    view, frame = grainy_pair(0.06, 0.0, 0.10)
    lines = [line_along(view, *PLACES[i]) for i in order]
    together = as_array(line_heights(lines, view, frame))
    alone = np.concatenate([as_array(line_heights([line], view, frame)) for line in lines])
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-9)
    assert np.isnan(together[order.index(2)]).all()
    if 0 in order:
        assert together[order.index(0)] == pytest.approx([0.06, 0.0, 0.10], abs=CENTIMETRE)


def test_pixels_are_seen_where_both_images_show_them_on_every_plane():
    """Of a picture of 10 x 20 px; the right camera sees the lowest plane farthest to the right."""
    u, v = np.array([[5.0, 5.0, 19.0, 19.5, 5.0, 5.0]]), np.array([[0.0, 9.5, 9.0, 9.0, -0.5, 3.0]])
    lowest, highest = u - 1, u - 5
    highest[0, 5] = -0.5  # beyond the left border of the right image, on the highest plane alone
    seen = _seen(u, v, np.stack([lowest, highest]), (10, 20))
    assert seen.tolist() == [[True, False, True, False, False, False]]
    lowest[0, 0] = 19.5  # with the principal point of the right camera far to the right
    assert not _seen(u, v, np.stack([lowest, highest]), (10, 20))[0, 0]


def test_of_no_lines_there_are_no_heights(grainy_pair):
    view, frame = grainy_pair()
    assert line_heights([], view, frame) == []


def test_of_the_left_image_alone_every_height_is_unknown(grainy_pair):
    view, frame = grainy_pair()
    found = line_heights([line_along(view, LINE)] * 2, view, StereoFrame(frame.left))
    assert np.isnan(as_array(found)).all()


def test_the_lines_may_be_more_than_opencv_takes_at_once(grainy_pair):
    """17 planes of 48 rows are 816 a line, those of 41 lines more than 32,767."""
    view, frame = grainy_pair(0.06, 0.0, 0.10)
    found = as_array(line_heights([line_along(view, LINE)] * 41, view, frame))
    np.testing.assert_allclose(found, [[0.06, 0.0, 0.10]] * 41, atol=CENTIMETRE)


@pytest.mark.parametrize(("grain", "known"), [(4.0, True), (0.4, False)])
def test_a_height_that_is_hardly_distinct_is_not_known(measured, grain, known):
    """Faint grain, in noise of 1 grey level."""
    found = measured(grain=grain)
    assert (np.isfinite([found.line, found.left, found.right]) == known).all()


def test_the_left_image_alone_tells_nothing(painted_road, evidence_of):
    found = evidence_of(painted_road().line(1.025))
    assert np.isnan(found.height)
    assert np.isnan(found.kerb_step)


@pytest.mark.parametrize(
    ("n", "ground", "expected"),
    [
        (1.7, (0.01, 0.13), (0.02, 0.10)),  # a kerb on the right: the vehicle is on the left
        (-1.7, (0.01, 0.13), (-0.10, 0.02)),  # on the left, and the vehicle is on the right
        (-1.7, (-0.10, 0.05), (-0.02, 0.13)),  # the other border of a traffic island
        (1.7, (np.nan, 0.02), (0.01, 0.01)),  # the ground on the vehicle's side is not known
        (1.7, (0.02, np.nan), (0.01, np.nan)),
        (1.7, (np.nan, np.nan), (0.03, np.nan)),  # above the road's surface
    ],
)
def test_height_is_above_the_ground_before_the_line_and_the_step_is_behind_it(
    painted_road, evidence_of, monkeypatch, n, ground, expected
):
    monkeypatch.setattr(lane_evidence, "line_heights", lambda *_: [LineHeights(0.03, *ground)])
    found = evidence_of(painted_road().line(n), course=n)
    assert (found.height, found.kerb_step) == pytest.approx(expected, nan_ok=True)


def test_the_planes_reach_from_ditches_to_kerbs():
    assert PLANES[0] <= -0.1 < 0.2 <= PLANES[-1]
