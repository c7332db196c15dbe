# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the faces of vehicles look like: paint with what it mirrors, glass, lamps, plates, wheels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.faces import Picture
from lane_dp_ros.scenes.textures import leaves

Singles = NDArray[np.float32]
Colour = tuple[float, float, float]  # BGR, 0 to 255

TEXELS = 96  # per metre
GLASS: Colour = (44.0, 42.0, 38.0)
RUBBER: Colour = (27.0, 26.0, 26.0)
DARK: Colour = (14.0, 14.0, 14.0)
RIM: Colour = (92.0, 90.0, 88.0)
PLATE: Colour = (205.0, 210.0, 212.0)
REAR_LAMP, REAR_LAMP_LIT = (34.0, 28.0, 128.0), (60.0, 50.0, 520.0)
FRONT_LAMP, FRONT_LAMP_LIT = (170.0, 172.0, 172.0), (1300.0, 1400.0, 1450.0)
BOOT, REAR_WINDOW, WINDSCREEN, GRILLE = 1, 2, 5, 7  # strips of a profile, counted from the rear bumper
LAMP_STRIPS = (BOOT, GRILLE)


@dataclass(frozen=True)
class Model:
    """A kind of vehicle, in metres: `profile` (ahead, up), `width`, `wheels` (their s), `radius` of these.

    Windows begin at the `belt`; above it each side leans in by `lean` metres a metre.
    """

    profile: tuple[tuple[float, float], ...]
    width: float
    lean: float
    belt: float
    wheels: tuple[float, float]
    radius: float

    @property
    def length(self) -> float:
        """From bumper to bumper [m]."""
        return max(s for s, _ in self.profile)

    @property
    def height(self) -> float:
        """Of the roof [m]."""
        return max(up for _, up in self.profile)

    def half_width(self, up: float) -> float:
        """Return half the width [m] at this height."""
        return self.width / 2 - self.lean * max(0.0, up - self.belt)


def strip(model: Model, colour: Colour, i: int, lit: bool) -> Picture:
    """Return the picture of the strip between the profile's points i and i + 1."""
    (s0, up0), (s1, up1) = model.profile[i : i + 2]
    image = _painted(colour, model.width, float(np.hypot(s1 - s0, up1 - up0)), seed=i)
    boxy = model.lean == 0
    if i in (REAR_WINDOW, WINDSCREEN) and not (boxy and i == REAR_WINDOW):
        _glaze(image, (0.06, 0.10, 0.94, 0.92))
    elif boxy and i == REAR_WINDOW:
        _doors(image)
    elif i == BOOT:
        _boot(image, lit)
    elif i == GRILLE:
        _front(image, lit)
    elif i in (0, 8):
        image[round(0.62 * len(image)) :, :, :3] = RUBBER
    return Picture.of(image)


@cache
def sides(model: Model, colour: Colour, mirrored: bool) -> tuple[Picture, Picture]:
    """Return the right side below and above the belt, rear on the left; or the left one, `mirrored`."""
    whole = _painted(colour, model.length, model.height, seed=20)
    outline = np.array([(0.08, 0.24), *model.profile, (model.length - 0.1, 0.22)])
    whole[..., 3] = 0
    body = np.zeros(whole.shape[:2], np.uint8)
    cv2.fillPoly(body, [_texels(outline, model)], 1)
    whole[..., 3] = body
    if model.lean > 0:
        _side_windows(whole, model)
    _wheels(whole, model)
    split = round((model.height - model.belt) * TEXELS)
    whole = whole[:, ::-1] if mirrored else whole
    return Picture.of(whole[split:]), Picture.of(whole[:split])


@cache
def underneath(model: Model) -> Picture:
    """Return what is seen below the bumper: two tyres, and the dark between them."""
    image = np.empty((32, 128, 4), np.float32)
    image[:] = (*DARK, 1)
    tyre = round(128 * 0.66 * model.radius / model.width)
    image[:, :tyre, :3] = image[:, -tyre:, :3] = RUBBER
    image[26:, tyre:-tyre, :3] *= 0.7
    return Picture.of(image)


def _painted(colour: Colour, width: float, height: float, seed: int) -> Singles:
    """Return coachwork (h, w, 4): paint that mirrors the sky above and the road below, and a little dirt."""
    h, w = max(4, round(height * TEXELS)), max(4, round(width * TEXELS))
    down = np.linspace(0, 1, h, dtype=np.float32)[:, None]
    mirrored = 1.16 - 0.34 * down + 0.10 * np.exp(-(((down - 0.3) / 0.12) ** 2))
    rough = cv2.resize(np.roll(leaves(), 37 * seed, 0)[: max(2, h // 3), : max(2, w // 3)], (w, h))
    light = (mirrored * (1 + 0.035 * rough))[..., None]
    image = np.empty((h, w, 4), np.float32)
    image[..., :3] = light * np.array(colour, np.float32) + 8 * light
    image[..., 3] = 1
    return image


def _box(image: Singles, box: tuple[float, float, float, float]) -> Singles:
    """Return the part of a picture from (left, top) to (right, bottom), each 0 to 1."""
    h, w = image.shape[:2]
    left, top, right, bottom = box
    return image[round(top * h) : round(bottom * h), round(left * w) : round(right * w)]


def _glaze(image: Singles, box: tuple[float, float, float, float]) -> None:
    """Put in a window: dark, with the sky's reflection above and the head rests behind it."""
    pane = _box(image, box)
    h, w = pane.shape[:2]
    down = np.linspace(0, 1, h, dtype=np.float32)[:, None]
    tops = 0.40 + 0.10 * cv2.resize(leaves()[:1, :96:8], (w, 1), interpolation=cv2.INTER_CUBIC)
    sky = np.clip((tops - down) * 4, 0, 1)[..., None]
    pane[..., :3] = np.array(GLASS, np.float32) * (1 - sky) + np.array((120, 112, 100), np.float32) * sky
    for u in (0.27, 0.73):
        cv2.ellipse(pane, (round(u * w), round(0.78 * h)), (round(0.07 * w), round(0.25 * h)), 0, 0, 360,
                    (24, 24, 24, 1), -1)  # fmt: skip


def _boot(image: Singles, lit: bool) -> None:
    lamp = REAR_LAMP_LIT if lit else REAR_LAMP
    for left, right in ((0.01, 0.17), (0.83, 0.99)):
        _box(image, (left, 0.12, right, 0.58))[..., :3] = lamp
        _box(image, (left, 0.40, right, 0.46))[..., :3] = (150, 150, 165)
    _box(image, (0.35, 0.52, 0.65, 0.80))[..., :3] = PLATE
    for k in range(7):
        _box(image, (0.37 + 0.037 * k, 0.58, 0.39 + 0.037 * k, 0.74))[..., :3] = (40, 40, 40)


def _front(image: Singles, lit: bool) -> None:
    _box(image, (0.28, 0.30, 0.72, 0.85))[..., :3] = RUBBER
    for left, right in ((0.04, 0.22), (0.78, 0.96)):
        _box(image, (left, 0.15, right, 0.75))[..., :3] = FRONT_LAMP_LIT if lit else FRONT_LAMP


def _doors(image: Singles) -> None:
    """Draw a lorry's rear doors, with their bars and hinges."""
    for u in (0.015, 0.495, 0.97):
        _box(image, (u, 0, u + 0.015, 1))[..., :3] *= 0.45
    for u in (0.2, 0.36, 0.62, 0.78):
        _box(image, (u, 0.02, u + 0.012, 0.98))[..., :3] = RIM
    _box(image, (0, 0.96, 1, 1))[..., :3] = (40, 40, 130)


def _texels(points: NDArray[np.float64], model: Model) -> NDArray[np.int32]:
    return np.rint((np.array(points) * (1, -1) + (0, model.height)) * TEXELS).astype(np.int32)


def _side_windows(whole: Singles, model: Model) -> None:
    """Cut the cabin's outline smaller and glaze it, but for the pillars and the doors' gaps."""
    rear, rail, front, screen = (np.array(model.profile[i]) for i in (2, 3, 5, 6))
    low, high = model.belt + 0.03, model.height - 0.11
    points = [(rear[0] + 0.35, low), (rail[0] + 0.22, high), (front[0], high), (screen[0] - 0.18, low)]
    pane = np.zeros(whole.shape[:2], np.uint8)
    cv2.fillConvexPoly(pane, _texels(np.array(points), model), 1)
    middle = (rail[0] + front[0]) / 2
    for s in (middle, middle + 0.05, rear[0] + 0.72):
        column = round(s * TEXELS)
        pane[:, column - 3 : column + 3] = 0
    whole[pane > 0, :3] = GLASS
    shine = pane.astype(bool) & (np.arange(whole.shape[0])[:, None] < 0.24 * TEXELS)
    whole[shine, :3] = (92, 88, 80)
    for s in (middle + 0.02, screen[0] - 0.1, rear[0] + 0.75):  # the doors' gaps
        gap = whole[round((model.height - model.belt) * TEXELS) : round((model.height - 0.3) * TEXELS)]
        gap[:, round(s * TEXELS) : round(s * TEXELS) + 2, :3] *= 0.4


def _wheels(whole: Singles, model: Model) -> None:
    for s in model.wheels:
        centre = tuple(int(t) for t in _texels(np.array([(s, model.radius)]), model)[0])
        for radius, colour in ((1.16, DARK), (1.0, RUBBER), (0.66, RIM), (0.2, RUBBER)):
            cv2.circle(whole, centre, round(radius * model.radius * TEXELS), (*colour, 1), -1)
        for spoke in range(5):
            angle = 2 * np.pi * spoke / 5
            tip = np.array(centre) + 0.6 * model.radius * TEXELS * np.array([np.cos(angle), np.sin(angle)])
            cv2.line(whole, centre, tuple(int(t) for t in tip), (*RUBBER, 1), 5)
