# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The road over time: held while none is measured, deaf to contradictions, forgotten at jumps of time."""

from dataclasses import replace

import numpy as np
import pytest

from lane_dp_ros.core.geometry.road_surface import geometry
from lane_dp_ros.core.geometry.vertical_curve import VerticalCurve
from lane_dp_ros.core.tracking.road_filter import RoadFilter
from lane_dp_ros.scenes import CAMERA

STEP = 100_000_000  # ns between frames
START = 7_000_000_000
NOMINAL = VerticalCurve.plane(CAMERA, 1.5, 0.0)


def road(height=1.65, pitch=0.01, roll=0.0, curvature=0.0):
    return VerticalCurve.of_geometry(CAMERA, np.array([height, pitch, curvature, roll]))


class Drive:
    """Feeds frames, one every 0.1 s, to a filter."""

    def __init__(self):
        self.filter, self.stamp_ns = RoadFilter(), START

    def see(self, measured, frames=1, nominal=NOMINAL):
        """Return the last of the estimates."""
        for _ in range(frames):
            estimate = self.filter.predict(nominal, self.stamp_ns)(measured)
            self.filter.update(measured)
            self.stamp_ns += STEP
        return estimate


def test_what_is_measured_serves_from_the_first_frame_on():
    drive = Drive()
    for measured in (road(), road(1.66, 0.02)):
        estimate = drive.see(measured)
        assert estimate.surface is measured
        assert (estimate.source, estimate.reason) == ("measured", "")


def test_without_any_road_the_nominal_one_serves():
    estimate = Drive().see(None)
    assert estimate.surface is NOMINAL
    assert estimate.source == "nominal"


def test_the_last_road_serves_for_five_seconds_and_then_the_nominal_one():
    drive = Drive()
    drive.see(road(1.7, 0.02, 0.03, 1e-3), frames=20)
    sources = [drive.see(None).source for _ in range(60)]
    assert sources == ["last"] * 50 + ["nominal"] * 10


def test_the_last_road_is_that_which_was_measured():
    drive = Drive()
    measured = road(1.7, 0.02, 0.03, 1e-3)
    drive.see(measured, frames=20)
    assert drive.see(None).surface.coefficients == pytest.approx(measured.coefficients)


def test_noise_is_averaged_out():
    drive, rng = Drive(), np.random.default_rng(0)
    truth, noise = np.array([1.65, 0.01, 0.0, 0.0]), np.array([0.03, 0.005, 5e-4, 0.01])
    for _ in range(100):
        drive.see(VerticalCurve.of_geometry(CAMERA, truth + rng.normal(0, noise)))
    height, pitch, curvature, roll = np.abs(geometry(drive.see(None).surface) - truth)
    assert pitch < 0.005 and curvature < 5e-4
    assert height < 0.01 and roll < 0.004  # these hardly change and are averaged longer


def uncertain(surface, *deviations):
    """Return the surface as one that was measured with these standard deviations [m, rad, 1/m, rad]."""
    return replace(surface, covariance=np.diag(np.square(deviations)))


@pytest.mark.parametrize("quantity", range(4))
def test_a_noisy_measurement_moves_the_held_road_less(quantity):
    """As a Kalman filter weighs it: ten times the spread of roads, and it hardly counts."""
    step, spread = np.array([0.05, 0.01, 2e-3, 0.01]), np.array([0.03, 0.008, 1.2e-3, 0.008])
    moves = []
    for times in (0, 1, 10):
        drive, other = Drive(), geometry(road())
        drive.see(road(), frames=20)
        other[quantity] += step[quantity]
        drive.see(uncertain(VerticalCurve.of_geometry(CAMERA, other), *(times * spread)))
        held = geometry(drive.see(None).surface)
        moves.append((held[quantity] - geometry(road())[quantity]) / step[quantity])
    exact, noisy, noise = moves
    assert 0.02 < noisy < 0.9 * exact < 0.9
    assert 0 < noise < 0.1 * exact


def test_after_noisy_measurements_an_exact_one_counts_more():
    """The first frame is as uncertain as its measurement."""
    held = []
    for deviation in (0.0, 0.1):
        drive = Drive()
        drive.see(uncertain(road(1.60), deviation, 0, 0, 0))
        drive.see(road(1.70))
        held.append(drive.see(None).surface.camera_height)
    assert held[0] == pytest.approx(1.65, abs=0.005)  # equally good
    assert held[1] > 1.68


@pytest.mark.parametrize(
    ("deviation", "height", "source"),
    [
        (0.0, 1.78, "measured"),  # 5 * 0.03 m
        (0.0, 1.82, "last"),
        (0.0225, 1.82, "measured"),  # 5 * 0.0375 m
        (0.0225, 1.86, "last"),
        (0.2, 1.84, "measured"),  # 5 * sqrt(2) * 0.03 m: to be still less sure opens the gate no farther
        (0.2, 1.88, "last"),
    ],
)
def test_an_uncertain_road_is_gated_later(deviation, height, source):
    drive = Drive()
    drive.see(road(), frames=20)
    assert drive.see(uncertain(road(height), deviation, 0, 0, 0)).source == source


def test_pitch_is_followed_at_once_and_height_slowly():
    drive = Drive()
    drive.see(road(1.65, 0.01), frames=50)
    drive.see(road(1.70, 0.03), frames=5)
    height, pitch, *_ = geometry(drive.see(None).surface)
    assert pitch > 0.025
    assert height < 1.67


@pytest.mark.parametrize(
    ("other", "reason"),
    [
        (road(height=1.9), "camera height 1.9 m after 1.65"),
        (road(pitch=0.08), "pitch 0.08 rad after 0.01"),
        (road(roll=-0.06), "roll -0.06 rad after 0"),
        (road(curvature=6e-3), "vertical curvature 0.006 1/m after 0"),
    ],
)
def test_what_contradicts_the_road_so_far_is_not_used(other, reason):
    drive = Drive()
    drive.see(road(), frames=20)
    estimate = drive.see(other)
    assert estimate.source == "last"
    assert estimate.reason.startswith(reason)
    assert estimate.surface.coefficients == pytest.approx(road().coefficients)
    assert drive.see(road()).source == "measured"


def test_a_road_that_insists_for_a_second_is_believed():
    """The first frame was wrong, not all that came after it."""
    drive = Drive()
    drive.see(road(1.3))
    sources = [drive.see(road(1.65)).source for _ in range(15)]
    assert sources == ["last"] * 10 + ["measured"] * 5


def test_roads_that_contradict_one_another_are_not_believed():
    """A right picture that stands still beside a left one that moves."""
    drive = Drive()
    drive.see(road(), frames=20)
    heights = [1.3, 1.9, 2.2, 1.45] * 10
    assert {drive.see(road(height)).source for height in heights} == {"last"}


def test_a_road_that_agrees_in_between_ends_the_insisting():
    drive = Drive()
    drive.see(road(1.65), frames=20)
    for _ in range(4):
        assert {drive.see(road(1.9)).source for _ in range(8)} == {"last"}
        assert drive.see(road(1.65)).source == "measured"


@pytest.mark.parametrize("jump_ns", [-STEP, 1_100_000_000])
def test_a_jump_of_time_forgets(jump_ns):
    drive = Drive()
    drive.see(road(), frames=20)
    drive.stamp_ns += jump_ns - STEP
    assert drive.see(None).source == "nominal"


def test_another_calibration_forgets():
    drive = Drive()
    drive.see(road(), frames=20)
    other = VerticalCurve.plane(replace(CAMERA, baseline=0.3), 1.5, 0.0)
    estimate = drive.see(None, nominal=other)
    assert estimate.surface is other
    assert estimate.source == "nominal"


def test_asking_the_gate_changes_nothing():
    """Whatever it is asked, however often, and whether or not it was asked at all."""
    asked, silent = Drive(), Drive()
    for drive in (asked, silent):
        drive.see(road(), frames=20)
    gate = asked.filter.predict(NOMINAL, asked.stamp_ns)
    silent.filter.predict(NOMINAL, silent.stamp_ns)
    measured = [road(1.9), None, road(1.66), road(pitch=0.08), road(1.9)]
    first = [gate(each) for each in measured]
    assert [gate(each) for each in measured] == first
    assert [each.source for each in first] == ["last", "last", "measured", "last", "last"]
    for drive in (asked, silent):
        drive.filter.update(road(1.66))
        drive.stamp_ns += STEP
    assert asked.see(None) == silent.see(None)


def test_the_same_stamp_twice_is_no_jump_of_time():
    drive = Drive()
    drive.see(road(), frames=20)
    drive.stamp_ns -= STEP
    assert drive.see(road(1.7)).source == "measured"
