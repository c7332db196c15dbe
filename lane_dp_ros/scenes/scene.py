# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Render a stereo camera's drive along a road whose lane lines are known exactly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.scenes.course import Course
from lane_dp_ros.scenes.edge_truth import edge_labels
from lane_dp_ros.scenes.lane_truth import lane_labels
from lane_dp_ros.scenes.light import Light
from lane_dp_ros.scenes.objects import SceneObject
from lane_dp_ros.scenes.rendering import render
from lane_dp_ros.scenes.road import Road
from lane_dp_ros.scenes.road_ahead import profile_ahead
from lane_dp_ros.scenes.seen_part import fitted_ground
from lane_dp_ros.scenes.sensor import Sensor, expose
from lane_dp_ros.scenes.view import Pose, View
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame

CAMERA = StereoCamera(fx=721.5, fy=721.5, cx=609.6, cy=172.9, baseline=0.54)  # much like KITTI's
SIZE = (1242, 375)  # width, height [px]
SPEED = 15.0  # [m/s]
FIRST_STAMP_NS = 1_000_000_000
TRUTH_AHEAD = 40.0  # [m] over which the lane lines are given
TRUTH_STEP = 0.5  # [m]


@dataclass(frozen=True)
class Motion:
    """How the vehicle drives: from `start` [m] at `speed` [m/s], with a picture every 1 / `rate` [s].

    It keeps `lateral` [m] right of the road's axis, and sways about it by +-`sway` [m]. The camera nods by
    +-`nod` [rad] about the road's pitch and turns by +-`turn` [rad], each at a rhythm of its own.
    """

    start: float = 0.0
    speed: float = SPEED
    rate: float = 10.0
    lateral: float = 0.0
    sway: float = 0.0
    nod: float = 0.0
    turn: float = 0.0

    def position(self, time: float) -> float:
        """Return how far along the road [m] the vehicle is after `time` [s]."""
        return self.start + self.speed * time

    def pose(self, time: float, pitch: float) -> Pose:
        """Return how the camera stands after `time` [s]; `pitch` [rad] is that of the car at rest."""
        lateral = self.lateral + self.sway * np.sin(2 * np.pi * 0.4 * time)
        nod, turn = self.nod * np.sin(2 * np.pi * 1.3 * time), self.turn * np.sin(2 * np.pi * 0.7 * time + 1)
        return Pose(float(lateral), float(pitch + nod), float(turn))


@dataclass(frozen=True)
class Scene:
    """A road, the light on it, what stands and drives there, the stereo camera, and the vehicle's drive.

    `size` [px] is the pictures' width and height; the camera's height and pitch are the road's.
    """

    road: Road = field(default_factory=Road)
    light: Light = field(default_factory=Light)
    objects: tuple[SceneObject, ...] = ()
    sensor: Sensor = field(default_factory=Sensor)
    motion: Motion = field(default_factory=Motion)
    camera: StereoCamera = CAMERA
    size: tuple[int, int] = SIZE


@dataclass(frozen=True)
class ScenePair:
    """A rendered pair: BGR images (H, W, 3), and the lane lines that lie in the left one.

    `lanes`: the exact centre lines (N, 3) [m] of the paint, in the left optical frame, from left to right,
    each from near to far with points every 0.5 m, dashes bridged; `truth`: what a careful person can see of
    them. They are there to judge a detector by, never to help it.
    """

    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    stamp_ns: int
    lanes: tuple[NDArray[np.float64], ...]
    truth: LabelledFrame


def render_sequence(frames: int, rate: float, seed: int) -> Iterator[ScenePair]:
    """Drive along a curved road at 15 m/s and render `frames` pairs, `rate` of them a second."""
    rng = np.random.default_rng(seed)
    road = Road(curvature=rng.uniform(-0.002, 0.002))
    scene = Scene(road, motion=Motion(start=rng.uniform(0, 1000), rate=rate))
    return (render_frame(scene, i, seed) for i in range(frames))


def render_pair(road: Road, position: float, seed: int, stamp_ns: int = FIRST_STAMP_NS) -> ScenePair:
    """Render what the camera sees `position` metres along the road; equal arguments give equal pictures."""
    return render_frame(Scene(road, motion=Motion(start=position)), 0, seed, stamp_ns)


def render_frame(
    scene: Scene, index: int, seed: int, first_stamp_ns: int = FIRST_STAMP_NS, category: str = "road"
) -> ScenePair:
    """Render pair number `index` of the drive through a scene; equal arguments give equal pictures."""
    time = index / scene.motion.rate
    course = Course(scene.road, scene.motion.position(time))
    pose = scene.motion.pose(time, scene.road.pitch)
    millimetres = round(course.position * 1000) % 2**32  # a position may be negative, a seed may not
    noise = np.random.default_rng([seed, index, millimetres])
    eyes = (0.0, scene.camera.baseline)
    views = [View(scene.camera, scene.size, course, pose, eye, seed, time) for eye in eyes]
    lights, surfaces = zip(*(render(view, scene.light, scene.objects) for view in views), strict=True)
    left, right = (
        expose(light, view, scene.sensor, noise) for light, view in zip(lights, views, strict=True)
    )
    labels, egos = lane_labels(views[0], surfaces[0], left)
    edges = edge_labels(views[0], surfaces[0], left, scene.objects)
    stamp_ns = first_stamp_ns + round(time * 1e9)
    truth = LabelledFrame(
        name=f"{category}/{index:02d}",
        camera=scene.camera,
        size=scene.size,
        ground=fitted_ground(views[0], surfaces[0]),
        labels=(*labels, *edges),
        ego_left=egos[0],
        ego_right=egos[1],
        stamp_ns=stamp_ns,
        category=category,
        profile=profile_ahead(views[0]),
    )
    return ScenePair(left, right, stamp_ns, _lane_lines(views[0]), truth)


def _lane_lines(view: View) -> tuple[NDArray[np.float64], ...]:
    s = np.arange(0.0, TRUTH_AHEAD, TRUTH_STEP)
    along = s + view.course.position
    grounds = (view.course.points(s, n + line.aside(along)) for n, line in view.road.placed_lines)
    lines = (_in_picture(view, view.optical(points)) for points in grounds)
    return tuple(line for line in lines if len(line) > 1)


def _in_picture(view: View, points: NDArray[np.float64]) -> NDArray[np.float64]:
    points = points[points[:, 2] > 1]
    uv = view.camera.project(points)
    return points[np.all((uv >= 0) & (uv <= np.array(view.size) - 1), axis=1)]
