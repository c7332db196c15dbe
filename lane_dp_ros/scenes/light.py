# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The light that falls on a rendered scene, and the air before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes import lamps, shadows, specular
from lane_dp_ros.scenes.objects import SceneObject
from lane_dp_ros.scenes.surface import Surface
from lane_dp_ros.scenes.view import View

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

HAZE = np.array([0.615, 0.597, 0.573], np.float32)  # BGR, linear
SUNLIGHT = np.array([0.90, 0.98, 1.0], np.float32)  # its colour against that of an overcast sky
BLUE_SKY = np.array([1.25, 1.0, 0.86], np.float32)  # the colour of the light in the shade
WET_ALBEDO = 0.5  # what is left of the asphalt's brightness where it is soaked
AUREOLE = (0.004, 0.06)  # half the squares of the angles [rad^2] over which the sky about the sun fades
STREET_SPACING = 30.0  # [m]
LAMP_GLINT = 12.0  # how bright an oncoming vehicle's lamps make a white sheet 1 m before them
RETRO = 3.0  # how much brighter than white cloth glass beads in paint throw one's own light back


@dataclass(frozen=True)
class Light:
    """The light on a scene: daylight under a bright overcast sky if nothing else is said.

    `sky` and `sun`: how bright each makes a white sheet that faces it, 1 as in daylight. `elevation` [deg]
    and `azimuth` [deg] of the sun, clockwise from the road's direction at its start. `leaves` [m]: between
    which two lines right of the road's axis trees shade it. `roughness`: the mean slope of the asphalt's
    facets, 0 for asphalt that does not shine. `wetness` 0 to 1; what a wet road mirrors is drawn out down
    the picture over `streak` [px]. `head_lamps`: how bright one's own make a white sheet 10 m ahead;
    `street_lamps`: those every 30 m one under them.
    `haze_length` [m]: distance over which the air takes 63 % of a thing's colour.
    """

    sky: float = 1.0
    sun: float = 0.0
    elevation: float = 40.0
    azimuth: float = 60.0
    leaves: tuple[float, float] | None = None
    roughness: float = 0.0
    wetness: float = 0.0
    streak: float = 7.0
    head_lamps: float = 0.0
    street_lamps: float = 0.0
    haze_length: float = 350.0

    def towards_sun(self, heading: float) -> Floats:
        """Return the direction (3,) to the sun: right, up, ahead as seen when heading so [rad]."""
        azimuth, elevation = np.deg2rad(self.azimuth) - heading, np.deg2rad(self.elevation)
        flat = np.cos(elevation)
        return np.array([flat * np.sin(azimuth), np.sin(elevation), flat * np.cos(azimuth)])


def shade(surface: Surface, view: View, light: Light, objects: tuple[SceneObject, ...]) -> Singles:
    """Return the light (H, W, 3) BGR, linear, that comes from what each pixel sees; 1 is white in daylight.

    `objects` are those already in `surface`: they throw shadows and may give light.
    """
    sunlit = _sunlit(surface, view, light, objects)
    seen = _albedo(surface, light) * _daylight(surface, view, light, objects, sunlit)
    if light.head_lamps or light.street_lamps:
        seen += _lamplight(surface, view, light, objects)
    seen = _through_air(surface, light, seen)
    if light.wetness > 0:
        specular.mirror(surface, view, seen, objects, light.wetness, light.streak)
    if light.sun > 0:
        _add_aureole(surface, view, light, seen)
    if light.roughness > 0:
        _add_glints(surface, view, light, objects, sunlit, seen)
    return seen


def _sunlit(surface: Surface, view: View, light: Light, objects: tuple[SceneObject, ...]) -> Singles:
    """Return the share (H, W) of sunlight that reaches each pixel through leaves and past things."""
    if light.sun == 0:
        return np.zeros(view.shape, np.float32)
    share = shadows.past_things(surface, view, objects, light.towards_sun)
    if light.leaves is not None:
        share *= shadows.through_leaves(surface, view, light.leaves)
    return share


def _albedo(surface: Surface, light: Light) -> Singles:
    if light.wetness == 0:
        return surface.albedo
    asphalt = surface.ground & (np.abs(surface.n) < 12)
    soaked = np.where(asphalt, 1 - (1 - WET_ALBEDO) * light.wetness * (1 - 0.5 * surface.paint), 1)
    return surface.albedo * soaked[..., None].astype(np.float32)


def _daylight(
    surface: Surface, view: View, light: Light, objects: tuple[SceneObject, ...], sunlit: Singles
) -> Singles:
    """Return how brightly (H, W, 3) sun and sky light each pixel."""
    sky = np.float32(light.sky) * (np.float32(0.65) + np.float32(0.35) * surface.normal[..., 1])
    sky *= shadows.open_sky(surface, view, objects)
    if light.sun == 0:
        return sky[..., None]
    towards = light.towards_sun(view_heading(view)).astype(np.float32)
    sun = np.float32(light.sun) * np.clip(surface.normal @ towards, 0, 1) * sunlit
    return np.asarray(sky[..., None] * BLUE_SKY + sun[..., None] * SUNLIGHT, np.float32)


def _lamplight(surface: Surface, view: View, light: Light, objects: tuple[SceneObject, ...]) -> Singles:
    """Return the light (H, W, 3) of lamps that comes back from each pixel."""
    own = np.float32(light.head_lamps) * lamps.own_lamps(surface, view)
    facing = np.clip(-surface.normal[..., 2], 0, 1)
    back = np.where(surface.ground, 0.35 + np.float32(RETRO) * surface.paint, 0.3 + 0.7 * facing)
    seen = (own * back)[..., None] * lamps.WARM
    seen += lamps.oncoming_lamps(surface, view, objects)[..., None] * lamps.WARM
    if light.street_lamps > 0:
        pools = np.float32(light.street_lamps) * lamps.street_lamps(surface, STREET_SPACING)
        seen += pools[..., None] * lamps.SODIUM
    return np.asarray(seen * surface.albedo, np.float32)


def _through_air(surface: Surface, light: Light, seen: Singles) -> Singles:
    """Return what is left of the light after its way to the camera, with the air's own."""
    sky = np.isinf(surface.depth)
    day = np.float32(light.sky + 0.4 * light.sun)
    clear = np.exp(-surface.depth / np.float32(light.haze_length))[..., None]
    seen *= np.where(sky[..., None], 1, clear)
    seen += day * HAZE * (1 - clear) * ~sky[..., None]
    seen += surface.emission * np.float32(light.sky + 0.6 * light.sun) + surface.lamps
    return seen


def _add_glints(
    surface: Surface,
    view: View,
    light: Light,
    objects: tuple[SceneObject, ...],
    sunlit: Singles,
    seen: Singles,
) -> None:
    """Add what sun and lamps mirror in the asphalt towards the camera."""
    rows = specular.ground_rows(surface)
    if rows.stop <= rows.start:
        return
    ground = surface.ground[rows]
    if light.sun > 0:
        towards = light.towards_sun(view_heading(view)).astype(np.float32)
        share = specular.sun_glint(surface, view, rows, towards, light.roughness) * sunlit[rows]
        seen[rows] += (np.float32(light.sun) * share * ground)[..., None] * SUNLIGHT
    for vehicle, place in lamps.lamps_towards(view, objects):
        share = specular.lamp_glint(surface, view, rows, place.astype(np.float32), light.roughness)
        seen[rows] += (np.float32(LAMP_GLINT * vehicle.lamps) * share * ground)[..., None] * lamps.WARM


def _add_aureole(surface: Surface, view: View, light: Light, seen: Singles) -> None:
    """Add the bright sky about the sun."""
    towards = light.towards_sun(view_heading(view)).astype(np.float32)
    rows = slice(0, int(np.flatnonzero(np.isinf(surface.depth).any(axis=1)).max(initial=-1)) + 1)
    rays = view.rays[rows]
    away = 1 - rays @ towards / np.linalg.norm(rays, axis=-1)  # half the squared angle from the sun
    near, wide = (np.exp(-away / np.float32(size)) for size in AUREOLE)
    glow = np.float32(light.sun) * (4 * near + np.float32(0.6) * wide)
    seen[rows] += np.where(np.isinf(surface.depth[rows]), glow, 0)[..., None] * SUNLIGHT


def view_heading(view: View) -> float:
    """Return the direction [rad] of the road where the vehicle is, clockwise from that at its start."""
    return float(view.road.heading(np.array([view.course.position]))[0])
