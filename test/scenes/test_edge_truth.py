# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The borders of the carriageway in the truth of scenes, and what the truth says of the paint."""

import numpy as np
import pytest

from lane_dp_ros.scenes import Road
from lane_dp_ros.scenes.barriers import Grass
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.road import DASHED, SOLID, UNPAINTED, Line
from lane_dp_ros.scenes.scene import CAMERA, Motion, Scene, render_frame
from lane_dp_ros.scenes.sensor import Sensor
from lane_dp_ros.scenes.structures import Island
from lane_dp_ros.scenes.vehicles import LORRY, Vehicle

pytestmark = pytest.mark.filterwarnings("error")
STRAIGHT = Road(swing=0, pitch=0.0)
GUTTER = Line(width=0.3, colour="concrete")


def labels(scene):
    """The labels of a scene's first frame by their ids."""
    return {label.id: label for label in render_frame(scene, 0, 1).truth.labels}


def edges(scene):
    return {name: label for name, label in labels(scene).items() if label.kind == "edge"}


@pytest.mark.parametrize(
    ("road", "border"),
    [
        (STRAIGHT, "verge"),
        (Road(swing=0, pitch=0.0, kerb=0.14), "kerb"),
        (Road(swing=0, pitch=0.0, kerb=0.14, verge="town"), "kerb"),
        (Road(swing=0, pitch=0.0, strips=((-5.7, GUTTER), (2.2, GUTTER))), "gutter"),
    ],
    ids=["grass", "kerb", "town", "gutter"],
)
def test_an_edge_runs_where_the_asphalt_ends(road, border):
    found = edges(Scene(road, motion=Motion(lateral=0.25)))
    assert list(found) == ["edge_left", "edge_right"]
    for label, x in zip(found.values(), (-5.85 - 0.25, 2.35 - 0.25), strict=True):
        assert (label.border, label.sure, label.painted, label.counts) == (border, True, False, False)
        np.testing.assert_allclose(label.xyz[:, 0], x, atol=1e-6)
        np.testing.assert_allclose(label.xyz[:, 1], 1.65, atol=1e-6)  # the foot of the kerb, not its top
        np.testing.assert_allclose(CAMERA.project(label.xyz)[0], label.uv[0], atol=1e-9)
        assert label.xz[-1, 1] > 40


def test_a_line_on_the_border_keeps_its_label_beside_that_of_the_edge():
    found = labels(Scene(Road(swing=0, pitch=0.0, shoulder=0.2)))
    assert found["line2"].painted and found["line2"].sure
    assert found["edge_right"].xz[0, 0] - found["line2"].xz[0, 0] == pytest.approx(0.2, abs=0.01)


def test_in_the_dark_nobody_is_sure_of_an_edge():
    dark = Light(sky=0.0005)
    found = edges(Scene(STRAIGHT, dark, sensor=Sensor(full_well=900, dark=9.0)))
    assert [label.sure for label in found.values()] == [False, False]


def test_an_edge_ends_where_something_hides_it():
    lorry = Vehicle(15.0, 3.0, LORRY)
    open_road, hidden = (edges(Scene(STRAIGHT, objects=things))["edge_right"] for things in ((), (lorry,)))
    assert open_road.xz[-1, 1] > 40
    assert 14.5 < hidden.xz[-1, 1] < 18  # some of the ground is seen below its rear


def test_an_edge_under_grass_is_not_labelled_there():
    grass = tuple(Grass(2.2 + aside, 0.6, 0.9, seed) for seed, aside in enumerate((0.0, 0.15, 0.3)))
    covered = edges(Scene(STRAIGHT, objects=grass)).get("edge_right")
    assert covered is None or not covered.sure


def test_the_road_ends_at_a_traffic_island_too():
    island = Island(12.0, -1.75, length=10.0, width=1.0)
    found = edges(Scene(STRAIGHT, objects=(island,)))
    assert list(found) == ["edge_left", "edge_right", "island0_right"]  # its other side is behind it
    label = found["island0_right"]
    assert (label.border, label.sure) == ("island", True)
    np.testing.assert_allclose(label.xyz[:, 0], -1.25, atol=1e-6)
    assert label.xyz[[0, -1], 2] == pytest.approx([12, 22], abs=0.6)


def test_the_paint_has_its_colour_and_width_and_edges_have_none():
    yellow = Line("dashed", width=0.12, colour="yellow")
    found = labels(Scene(Road(swing=0, lines=(Line(width=0.25), yellow, SOLID))))
    told = {name: (label.kind, label.colour, label.width) for name, label in found.items()}
    assert told == {
        "line0": ("solid", "white", 0.25),
        "line1": ("dashed", "yellow", 0.12),
        "line2": ("solid", "white", 0.15),
        "edge_left": ("edge", "", None),
        "edge_right": ("edge", "", None),
    }
    assert (found["line0"].border, found["edge_left"].border, found["edge_left"].double) == (
        "",
        "verge",
        None,
    )


@pytest.mark.parametrize(("apart", "double"), [(0.3, True), (0.7, True), (0.8, False)])
def test_two_lines_side_by_side_are_a_double_line(apart, double):
    more = ((-1.75 - apart / 2, SOLID), (-1.75 + apart / 2, DASHED))
    found = labels(Scene(Road(swing=0, lines=(SOLID, UNPAINTED, SOLID), more_lines=more)))
    assert [label.double for label in found.values() if label.painted] == [False, False, double, double]
    assert [found[f"line{i}"].kind for i in (2, 3)] == ["solid", "dashed"]


def test_lines_that_only_cross_or_are_not_seen_are_no_double_line():
    crossing = Line(bend=6.0, bend_at=0.0, bend_over=30.0)
    burnt = Sensor(exposure=9.0)
    far = Road(swing=0, lines=(SOLID, UNPAINTED, SOLID), more_lines=((-1.0, crossing),))
    near = Road(swing=0, lines=(SOLID, UNPAINTED, SOLID), more_lines=((1.45, SOLID),))
    for scene in (Scene(far), Scene(near, sensor=burnt)):
        assert not any(label.double for label in labels(scene).values())
