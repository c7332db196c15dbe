# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Named categories of scenes: truth on the paint, ground where stereo finds it, the command for them."""

import cv2
import numpy as np
import pytest

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.messages.bag import BagReader
from lane_dp_ros.scenes import CAMERA, SIZE, Road
from lane_dp_ros.scenes.categories import CATEGORIES
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.lane_truth import lane_labels
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.rendering import render
from lane_dp_ros.scenes.road import DASHED, SOLID, UNPAINTED, Line
from lane_dp_ros.scenes.scene import Motion, Scene, render_frame
from lane_dp_ros.scenes.sensor import Sensor, expose
from lane_dp_ros.scenes.suite import Drive, drives
from lane_dp_ros.scenes.view import Pose, View
from lane_dp_ros.tools import cli
from lane_dp_ros.tools.evaluation.truth_file import load_truth

pytestmark = pytest.mark.filterwarnings("error")

GEOMETRIES = {  # categories, and how far [px] off the middle nine in ten rows of paint may look
    "straight": 0.5,
    "tight_curve": 0.5,
    "s_curve": 0.5,
    "crest": 0.5,
    "dip": 0.5,
    "roll": 0.5,
    "shaking_camera": 0.5,
    "motorway": 0.5,
    "yellow_lines": 0.5,
    "merging_lines": 0.5,
    "splitting_lines": 0.5,
    "worn_paint": 4.0,  # what is left of the paint lies on one side of it here, on the other there
}
GREY = cv2.COLOR_BGR2GRAY


def left_view(scene, position=None, seed=1):
    """How the left camera of a scene's first frame stands, what it sees, and its picture."""
    course = Course(scene.road, scene.motion.start if position is None else position)
    view = View(CAMERA, SIZE, course, scene.motion.pose(0.0, scene.road.pitch), 0.0, seed, 0.0)
    light, surface = render(view, scene.light, scene.objects)
    return view, surface, expose(light, view, scene.sensor, np.random.default_rng(seed))


def paint_centres(paint, line, reach=12):
    """Yield (u of the paint's centre, u of the line) in rows where there is one band of paint near it."""
    uv = line[np.argsort(line[:, 1])]
    for v in range(int(uv[0, 1]) + 1, int(uv[-1, 1])):
        u = np.interp(v, uv[:, 1], uv[:, 0])
        if reach < u < SIZE[0] - reach - 1:
            first = round(u) - reach
            window = paint[v, first : first + 2 * reach + 1]
            bands = cv2.connectedComponents((window > 0).astype(np.uint8)[None])[0] - 1
            if window.max() > 0.5 and bands == 1 and not window[0] and not window[-1]:
                yield np.average(np.arange(len(window)), weights=window) + first, u


@pytest.mark.parametrize(("name", "most"), GEOMETRIES.items())
def test_the_truth_lies_on_the_middle_of_the_paint(name, most):
    view, surface, picture = left_view(Drive(name).scene())
    labels, _ = lane_labels(view, surface, picture)
    assert labels
    centres = np.array([pair for label in labels for pair in paint_centres(surface.paint, label.uv)])
    assert len(centres) > 25
    errors = np.abs(centres[:, 0] - centres[:, 1])
    assert np.median(errors) < 0.5 * most
    assert np.percentile(errors, 90) < most


@pytest.mark.parametrize("name", [name for name in CATEGORIES if name.startswith("no_paint")])
def test_a_road_without_paint_has_no_lines(name):
    scene = Drive(name).scene()
    view, surface, picture = left_view(scene)
    assert lane_labels(view, surface, picture) == ((), [None, None])
    assert not surface.paint.any()


@pytest.mark.parametrize(
    ("road", "start"),
    [
        (Road(swing=0), 45.0),
        (Road(swing=0, hill=5.0, hill_length=160), 45.0),
        (Road(swing=0, hill=5.0, hill_length=160), 130.0),
        (Road(swing=0, roll=0.05), 45.0),
        (Road(swing=0, kerb=0.14), 45.0),
    ],
    ids=["flat", "crest", "dip", "roll", "kerb"],
)
def test_a_stereo_matcher_finds_the_ground_where_it_is(road, start):
    scene = Scene(road, motion=Motion(start=start))
    pair = render_frame(scene, 0, 1)
    _, surface, _ = left_view(scene)
    matcher = cv2.StereoSGBM_create(0, 96, 5, 200, 800, mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY)
    found = matcher.compute(cv2.cvtColor(pair.left, GREY), cv2.cvtColor(pair.right, GREY)) / 16.0
    on_road = surface.ground & (np.abs(surface.n) < 5) & (surface.depth < 35) & (found > 0)
    on_road[:, :110] = False  # no partner in the right picture
    errors = found[on_road] - CAMERA.fx * CAMERA.baseline / surface.depth[on_road]
    assert on_road.sum() > 20_000
    assert abs(np.median(errors)) < 0.25
    assert np.median(np.abs(errors)) < 0.3


def test_the_ground_of_a_cross_slope_is_exact():
    """Falling to the right by 0.05 rad, the ground has d = B (y cos p + sin p + x tan roll) fx / h."""
    scene = Scene(Road(swing=0, roll=0.05, pitch=0.02))
    truth = render_frame(scene, 0, 1).truth
    scale = CAMERA.fx * CAMERA.baseline / scene.road.camera_height
    expected = [np.sin(0.02), 100 * np.cos(0.02) / CAMERA.fy, 0, -100 * np.tan(0.05) / CAMERA.fx]
    np.testing.assert_allclose(truth.ground, scale * np.array(expected), atol=0.01)


def test_a_drive_may_begin_before_the_road_does():
    """As the first frames of the suite do at some seeds."""
    truth = render_frame(Scene(Road(swing=0), motion=Motion(start=-1.695)), 0, 1).truth
    assert sum(label.painted for label in truth.labels) == 3


def test_labels_of_a_flat_road_are_where_its_lines_are():
    truth = render_frame(Scene(Road(swing=0, pitch=0.0)), 0, 1).truth
    assert (truth.ego_left, truth.ego_right) == ("line1", "line2")
    assert [label.kind for label in truth.labels] == ["solid", "dashed", "solid", "edge", "edge"]
    for label, x in zip(truth.labels, (-5.25, -1.75, 1.75, -5.85, 2.35), strict=True):
        np.testing.assert_allclose(label.xz[:, 0], x, atol=2e-3)
        assert label.sure and label.takes_part
        np.testing.assert_allclose(truth.on_ground(label.uv), label.xz, atol=1e-6)


def test_the_far_side_of_a_crest_is_hidden():
    scene = Scene(Road(swing=0, hill=6.0, hill_length=120), motion=Motion(start=35.0))
    view, surface, picture = left_view(scene)
    labels, _ = lane_labels(view, surface, picture)
    farthest = max(label.xz[-1, 1] for label in labels)
    assert 18 < surface.depth[surface.ground].max() < 25  # the crest is 25 m ahead
    beyond = view.optical(view.course.points(40.0, 1.75))[0]
    u, v = np.rint(view.pixels(view.course.points(40.0, 1.75))[0]).astype(int)
    assert surface.depth[v, u] < beyond[2] - 3
    assert farthest < 25


def test_a_line_that_ends_is_labelled_to_its_end():
    lines = (SOLID, Line("dashed", end=118.0), SOLID)
    truth = render_frame(Scene(Road(swing=0, lines=lines), motion=Motion(start=100.0)), 0, 1).truth
    dashed = next(label for label in truth.labels if label.kind == "dashed")
    # Dashes of 4 m come every 12 m: the last begins at 108 m and ends at 112 m, 12 m ahead of the camera.
    assert dashed.xz[-1, 1] == pytest.approx(12.0, abs=0.6)


def test_a_line_that_grass_covers_is_not_sure():
    view, surface, picture = left_view(Scene(Road(swing=0)))
    hidden = surface.n < -5.0  # all of the left line but every fourth metre
    surface.paint[hidden & (np.mod(surface.s, 4) > 1)] = 0
    labels, _ = lane_labels(view, surface, picture)
    assert [label.sure for label in labels] == [False, True, True]


@pytest.mark.parametrize("striped", [False, True])
def test_a_line_behind_a_thing_ends_there(striped):
    """Though the thing should bear stripes just where the line would be."""
    view, surface, picture = left_view(Scene(Road(swing=0)))
    rows = np.s_[: int(CAMERA.cy + CAMERA.fy * 1.65 / 15), :]  # as a lorry 15 m ahead would stand
    if not striped:
        surface.paint[rows] = 0
    surface.depth[rows] = 15
    labels, _ = lane_labels(view, surface, picture)
    assert max(label.xz[-1, 1] for label in labels) < 15.5


def test_the_lines_beside_the_vehicle_change_with_the_lane():
    road = Road(swing=0, lane_widths=(3.5,) * 3, lines=(SOLID, DASHED, DASHED, SOLID), driven=1)
    for lateral, egos in ((3.5, ("line2", "line3")), (-3.4, ("line0", "line1"))):
        truth = render_frame(Scene(road, motion=Motion(lateral=lateral)), 0, 1).truth
        assert (truth.ego_left, truth.ego_right) == egos


@pytest.mark.parametrize("pitch", [-0.03, 0.0, 0.03])
def test_what_is_far_ahead_and_as_high_as_the_camera_stands_on_the_horizon(pitch):
    view = View(CAMERA, SIZE, Course(Road(swing=0), 50.0), Pose(pitch=pitch), 0.0, 1, 0.0)
    (_, row), *_ = view.pixels([view.origin + np.array([0, 0, 1e6])])
    assert view.horizon == pytest.approx(row)


def test_a_camera_that_looks_aside_keeps_the_truth_on_the_road():
    course = Course(Road(swing=0, lines=(SOLID, UNPAINTED, SOLID)), 50.0)
    view = View(CAMERA, SIZE, course, Pose(lateral=0.4, pitch=0.03, yaw=0.1), 0.0, 1, 0.0)
    light, surface = render(view, Light(), ())
    labels, _ = lane_labels(view, surface, expose(light, view, Sensor(), np.random.default_rng(1)))
    for label, n in zip(labels, (-5.25, 1.75), strict=True):
        x, z = label.xz.T
        across = x * np.cos(0.1) + z * np.sin(0.1)  # the picture's axis points 0.1 rad right of the road
        np.testing.assert_allclose(across, n - 0.4, atol=0.02)


def test_every_category_has_a_scene_that_is_its_own():
    seeds = {drive.world_seed for drive in drives(tuple(CATEGORIES))}
    assert len(seeds) == len(CATEGORIES)
    for name in CATEGORIES:
        assert Drive(name).scene() == Drive(name).scene()


def test_a_suite_is_written_read_and_made_again(tmp_path, capsys):
    arguments = ["scenes", "stop_line", "crest", "--frames", "1", "--jobs", "1", "-o"]
    for name in ("a", "b"):
        assert cli.main([*arguments, str(tmp_path / name)]) == 0
    assert "2 pairs of 2 categories" in capsys.readouterr().out
    assert (tmp_path / "a/truth.json").read_bytes() == (tmp_path / "b/truth.json").read_bytes()
    bags = []
    for name in ("a", "b"):
        with BagReader(tmp_path / name / "scenes.mcap") as reader:
            bags.append([(raw.topic, raw.time_ns, raw.data) for raw in reader.raw_messages()])
    assert bags[0] == bags[1]
    assert {topic for topic, _, _ in bags[0]} == {
        f"/{side}/{name}" for side in ("left", "right") for name in ("image_rect", "camera_info")
    }
    frames = load_truth(tmp_path / "a/truth.json")
    assert [frame.name for frame in frames] == ["stop_line/00", "crest/00"]
    assert [frame.category for frame in frames] == ["stop_line", "crest"]
    stamps = [frame.stamp_ns for frame in frames]
    assert set(stamps) == {time_ns for _, time_ns, _ in bags[0]}
    assert stamps[1] - stamps[0] > 2_000_000_000
    assert isinstance(frames[0].camera, StereoCamera)


def test_another_seed_is_another_world():
    a, b = (Drive("curve", seed=seed).render(0) for seed in (0, 1))
    assert np.mean(a.left != b.left) > 0.5
    assert not np.array_equal(a.truth.labels[0].uv, b.truth.labels[0].uv)


def test_lines_keep_their_ids_along_a_drive():
    pairs = [Drive("s_curve").render(i) for i in (0, 2)]
    assert pairs[1].stamp_ns - pairs[0].stamp_ns == 200_000_000
    for pair in pairs:
        ids = {label.id for label in pair.truth.labels}
        assert ids == {"line0", "line1", "line2", "edge_left", "edge_right"}


def failure(capsys, *arguments):
    assert cli.main(["scenes", *map(str, arguments)]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


def test_what_cannot_be_done_is_one_line(tmp_path, capsys):
    assert "no scenes of category 'strait': did you mean straight?" in failure(
        capsys, "strait", "-o", tmp_path
    )
    assert "--list names them all" in failure(capsys, "xyz", "-o", tmp_path)
    assert "name categories" in failure(capsys, "-o", tmp_path)
    assert "brings its own categories" in failure(capsys, "crest", "--suite", "standard", "-o", tmp_path)


def test_what_is_there_is_not_replaced_without_being_told(tmp_path, capsys):
    (tmp_path / "truth.json").write_text("mine")
    assert "truth.json exists already" in failure(capsys, "crest", "-o", tmp_path)
    (tmp_path / "sheet.png").write_text("mine")
    assert "sheet.png exists already" in failure(capsys, "crest", "--sheet", tmp_path / "sheet.png")
    assert {path.read_text() for path in tmp_path.iterdir()} == {"mine"}


def test_a_sheet_shows_each_category(tmp_path, capsys):
    path = tmp_path / "sheet.png"
    assert cli.main(["scenes", "zebra", "no_paint_kerbs", "arrows", "--sheet", str(path), "--jobs", "1"]) == 0
    sheet = cv2.imread(str(path))
    assert sheet.shape[0] > 2 * 200 and sheet.shape[1] > 1200
    assert "3 categories" in capsys.readouterr().out


def test_the_list_names_every_category(capsys):
    assert cli.main(["scenes", "--list"]) == 0
    assert capsys.readouterr().out.split() == list(CATEGORIES)
