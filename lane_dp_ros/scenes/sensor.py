# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What lens and sensor make of the light: blur, flare, exposure, noise, grey levels."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.scenes.view import View

Singles = NDArray[np.float32]
Bytes = NDArray[np.uint8]

BRIGHTEST = 30.0  # light that no lens flare exceeds: a lamp is a few pixels small
FLARE_SIZE = (3.0, 22.0)  # [px] sigmas of the halo close about a light, and of the veil
FLARE_SCALE = 4  # the halo is worked out this much coarser
METERED_ROWS = 0.45  # share of the picture's height above which exposure metering does not look


@dataclass(frozen=True)
class Sensor:
    """A camera's lens and sensor.

    `blur` [px] is the standard deviation of the lens's blur, `shake` [px] how far the picture moves down
    while it is taken; `flare` the share of light that the lens scatters; `vignette` the share that is lost in
    the corners. `exposure` multiplies the light; `metering` sets it instead so that the lower part of the
    picture has this mean (1 is white). The right camera takes `right_gain` times as much. `full_well`
    [electrons] are in a white pixel, and `dark` [electrons] is the noise of reading one. Grey levels go with
    the light's root, raised to the power of `gamma` by the tone curve: above 1 middle tones are darker.
    `jpeg` 1 to 100 is the quality of a compression that the picture went through.
    """

    blur: float = 0.55
    shake: float = 0.0
    flare: float = 0.0
    vignette: float = 0.30
    exposure: float = 1.0
    metering: float | None = None
    gamma: float = 1.0
    right_gain: float = 1.0
    full_well: float = 7000.0
    dark: float = 14.0
    jpeg: int | None = None


def expose(light: Singles, view: View, sensor: Sensor, rng: np.random.Generator) -> Bytes:
    """Return the picture (H, W, 3) BGR of the light (H, W, 3), linear; white in daylight (1) becomes 255.

    `view` tells which camera it is (`view.eye` > 0: the right one).
    """
    gain = _exposure(light, sensor) * (sensor.right_gain if view.eye > 0 else 1.0)
    caught = _through_lens(np.float32(gain) * light, sensor) * _vignette(light.shape, sensor.vignette)
    electrons = np.float32(sensor.full_well)
    spread = np.sqrt(np.maximum(caught, 0) * electrons + np.float32(sensor.dark**2)) / electrons
    caught += spread * rng.standard_normal(light.shape, dtype=np.float32)
    image = np.rint(255 * np.sqrt(np.clip(caught, 0, 1)) ** np.float32(sensor.gamma)).astype(np.uint8)
    return image if sensor.jpeg is None else _compressed(image, sensor.jpeg)


def _exposure(light: Singles, sensor: Sensor) -> float:
    if sensor.metering is None:
        return sensor.exposure
    metered = light[round(METERED_ROWS * len(light)) :]
    return sensor.metering / max(float(np.minimum(metered, 2).mean()), 1e-4)


def _through_lens(light: Singles, sensor: Sensor) -> Singles:
    """Return the light blurred by lens and shaking, and scattered about what is very bright."""
    if sensor.flare > 0:
        light = light * np.float32(1 - sensor.flare) + np.float32(sensor.flare) * _scattered(light)
    blurred = cv2.GaussianBlur(light, (0, 0), sensor.blur) if sensor.blur > 0 else light
    if sensor.shake >= 1:
        blurred = cv2.blur(blurred, (1, round(sensor.shake) + 1))
    return np.asarray(blurred, np.float32)


def _scattered(light: Singles) -> Singles:
    """Return the light as it would be if the lens scattered all of it."""
    height, width = light.shape[:2]
    coarse = (width // FLARE_SCALE, height // FLARE_SCALE)
    small = cv2.resize(np.minimum(light, BRIGHTEST), coarse, interpolation=cv2.INTER_AREA)
    halos = [cv2.GaussianBlur(small, (0, 0), sigma) for sigma in FLARE_SIZE]
    return np.asarray(cv2.resize(np.mean(np.stack(halos), axis=0), (width, height)), np.float32)


def _vignette(shape: tuple[int, ...], lost: float) -> Singles:
    u, v = (np.linspace(-1, 1, size, dtype=np.float32) for size in (shape[1], shape[0]))
    return np.asarray(1 - np.float32(lost / 2) * (u[None] ** 2 + v[:, None] ** 2), np.float32)[..., None]


def _compressed(image: Bytes, quality: int) -> Bytes:
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), np.uint8)
