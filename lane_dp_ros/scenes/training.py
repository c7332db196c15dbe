# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Random scenes that mix everything, for fitting a detector: roads, lines, light, distractors, cameras."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.scenes.categories import CATEGORIES
from lane_dp_ros.scenes.category_parts import Rng
from lane_dp_ros.scenes.condition_categories import CONDITION_CATEGORIES
from lane_dp_ros.scenes.distractors import DISTRACTORS
from lane_dp_ros.scenes.objects import SceneObject
from lane_dp_ros.scenes.road import Line, Road
from lane_dp_ros.scenes.scene import CAMERA, FIRST_STAMP_NS, SIZE, Scene, ScenePair, render_frame
from lane_dp_ros.scenes.vehicles import Vehicle

SEPARATOR = "+"  # between the names of what a scene is mixed of
APART_NS = 3_000_000_000  # between two scenes, which have nothing to do with each other
OTHER_LIGHT = 0.4  # share of the roads that get the light, the sensor and the traffic of another category
OTHER_PAINT = 0.6  # share of the roads whose lines get another wear, width and colour
MOST_DISTRACTORS = 3
HEIGHTS, PITCHES = (1.1, 2.2), (-0.01, 0.06)  # [m], [rad] of the camera on the vehicle
FOCAL_LENGTHS, RESOLUTIONS = (0.6, 1.6), (0.5, 1.5)  # of KITTI's
BASELINES, GAMMAS = (0.12, 0.6), (0.7, 1.5)  # [m]; of the tone curve


def training_scenes(count: int, seed: int) -> Iterator[ScenePair]:
    """Render `count` pairs, each of a scene of its own; equal seeds give equal pairs.

    Each pair's `truth` has its `camera` and `size`, which differ from scene to scene, and in `category` the
    names, joined by "+", of all that the scene is mixed of: the category of its road, that of its light where
    it is another, and its distractors. A name of a category is left out by its words: `category.split("+")`.
    """
    return (training_pair(seed, number) for number in range(count))


def training_pair(seed: int, number: int) -> ScenePair:
    """Render pair `number` of `training_scenes`, whichever went before."""
    rng = np.random.default_rng([seed, number])
    scene, category = training_scene(rng)
    world, stamp_ns = int(rng.integers(2**32)), FIRST_STAMP_NS + number * APART_NS
    pair = render_frame(scene, 0, world, stamp_ns, category)
    truth = replace(pair.truth, name=f"training/{number:06d}", sequence="training")
    return replace(pair, truth=truth)


def training_scene(rng: Rng) -> tuple[Scene, str]:
    """Return a random scene, and the names, joined by "+", of what it is mixed of."""
    names = [str(rng.choice(list(CATEGORIES)))]
    scene = CATEGORIES[names[0]](rng)
    if rng.uniform() < OTHER_LIGHT:
        names.append(str(rng.choice(list(CONDITION_CATEGORIES))))
        scene = _under(scene, CONDITION_CATEGORIES[names[-1]](rng))
    road = _repainted(rng, scene.road) if rng.uniform() < OTHER_PAINT else scene.road
    chosen = rng.choice(list(DISTRACTORS), int(rng.integers(MOST_DISTRACTORS + 1)), replace=False)
    for name in map(str, chosen):
        names.append(name)
        road = DISTRACTORS[name](rng, road)
    scene = _with_camera(rng, replace(scene, road=road))
    return scene, SEPARATOR.join(dict.fromkeys(names))


def _under(scene: Scene, other: Scene) -> Scene:
    """Return a scene in the light, by the sensor and with the traffic of another one."""
    ahead = scene.motion.start - other.motion.start
    left, right = scene.road.borders
    traffic: list[SceneObject] = [
        replace(thing, s=thing.s + ahead)
        for thing in other.objects
        if isinstance(thing, Vehicle) and left + 1 < thing.n < right - 1
    ]
    return replace(scene, light=other.light, sensor=other.sensor, objects=(*scene.objects, *traffic))


def _repainted(rng: Rng, road: Road) -> Road:
    """Return a road whose lines are more worn, wider or narrower, some of them yellow."""
    wear, wider = float(rng.uniform(0, 0.5)), float(rng.uniform(0.8, 1.3))
    yellow = rng.uniform() < 0.25

    def again(line: Line) -> Line:
        """Paint a line again."""
        width = float(np.clip(line.width * wider, 0.08, 0.35))
        colour = "yellow" if yellow else line.colour
        return replace(line, width=width, wear=max(line.wear, wear), colour=colour)

    more = tuple((n, again(line)) for n, line in road.more_lines)
    return replace(road, lines=tuple(map(again, road.lines)), more_lines=more)


def _with_camera(rng: Rng, scene: Scene) -> Scene:
    """Return a scene before another stereo camera, at another height and pitch, with another tone curve."""
    resolution, focal = float(rng.uniform(*RESOLUTIONS)), float(rng.uniform(*FOCAL_LENGTHS))
    width, height = (round(resolution * pixels) for pixels in SIZE)
    camera = StereoCamera(
        fx=CAMERA.fx * focal * resolution,
        fy=CAMERA.fy * focal * resolution,
        cx=CAMERA.cx * resolution + float(rng.uniform(-0.02, 0.02)) * width,
        cy=CAMERA.cy * resolution + float(rng.uniform(-0.04, 0.04)) * height,
        baseline=float(rng.uniform(*BASELINES)),
    )
    height_above, pitch = float(rng.uniform(*HEIGHTS)), float(rng.uniform(*PITCHES))
    road = replace(scene.road, camera_height=height_above, pitch=pitch)
    sensor = replace(scene.sensor, gamma=float(rng.uniform(*GAMMAS)))
    return replace(scene, road=road, sensor=sensor, camera=camera, size=(width, height))
