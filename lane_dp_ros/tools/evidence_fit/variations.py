# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Labelled pairs as they could have been taken as well: in a mirror, at another exposure, by another rig."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar, Protocol, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.types import Image, StereoFrame
from lane_dp_ros.tools.evaluation.annotations import Label, LabelledFrame

GAMMAS = (0.7, 1.4)  # brighter and darker: what cameras differ by

Floats = NDArray[np.float64]


class Pair(Protocol):
    """What is varied: a dataclass with a grey frame, its camera, and its labels, if any."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def name(self) -> str:
        """What the pair is called."""

    @property
    def frame(self) -> StereoFrame:
        """Both images, grey."""

    @property
    def camera(self) -> StereoCamera:
        """The camera of the frame."""

    @property
    def truth(self) -> LabelledFrame | None:
        """The labels."""


AnyPair = TypeVar("AnyPair", bound=Pair)


def exposed(pair: AnyPair, gamma: float) -> AnyPair:
    """Return a pair with the grey values 255 (g / 255)^gamma."""
    curve = np.rint(255 * (np.arange(256) / 255) ** gamma).astype(np.uint8)
    frame = StereoFrame(*(np.asarray(cv2.LUT(image, curve), np.uint8) for image in _images(pair)))
    return _renamed(replace(pair, frame=frame), f"gamma {gamma:g}")


def mirrored(pair: AnyPair) -> AnyPair:
    """Return a pair as a mirror shows it: the right camera is the left one, in the picture and in the labels.

    It is another view of the same road, from another place and with another sensor; glare lies elsewhere.
    """
    left, right = _images(pair)
    camera = _mirrored_camera(pair.camera, right.shape[1])
    truth = None if pair.truth is None else _mirrored_truth(pair.truth)
    frame = StereoFrame(_flipped(right), _flipped(left))
    return _renamed(replace(pair, frame=frame, camera=camera, truth=truth), "mirrored")


def resized(pair: AnyPair, scale: float) -> AnyPair:
    """Return a pair as cameras with `scale` times the pixels in a row would have taken it.

    Its labels stay: lanes are told in metres, and judged through the camera of the labels.
    """
    images = _images(pair)
    rows, columns = images[0].shape
    size = round(scale * columns), round(scale * rows)
    method = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    frame = StereoFrame(
        *(cv2.resize(image, size, interpolation=method).astype(np.uint8, copy=False) for image in images)
    )
    across, along = size[0] / columns, size[1] / rows
    camera = replace(
        pair.camera,
        fx=across * pair.camera.fx,
        fy=along * pair.camera.fy,
        cx=across * (pair.camera.cx + 0.5) - 0.5,
        cy=along * (pair.camera.cy + 0.5) - 0.5,
        disparity_offset=across * pair.camera.disparity_offset,
    )
    return _renamed(replace(pair, frame=frame, camera=camera), f"{scale:g} times the size")


def _images(pair: Pair) -> tuple[Image, Image]:
    assert pair.frame.right is not None
    return pair.frame.left, pair.frame.right


def _flipped(image: Image) -> Image:
    return np.ascontiguousarray(image[:, ::-1])


def _mirrored_camera(camera: StereoCamera, width: int) -> StereoCamera:
    right_cx = camera.cx - camera.disparity_offset
    return replace(camera, cx=width - 1 - right_cx, left_translation=(0.0, 0.0, 0.0))


def _mirrored_truth(frame: LabelledFrame) -> LabelledFrame:
    g0, g1, g2, g3 = frame.ground / (1 - frame.ground[3] / 100)  # columns are the right picture's now
    camera = _mirrored_camera(frame.camera, frame.size[0])
    return replace(
        frame,
        camera=camera,
        ground=np.array([g0, g1, g2, -g3]),
        profile=None,
        labels=tuple(_mirrored_label(label, frame, camera) for label in frame.labels),
        ego_left=frame.ego_right,
        ego_right=frame.ego_left,
    )


def _mirrored_label(label: Label, frame: LabelledFrame, camera: StereoCamera) -> Label:
    """Return a label as the mirrored `camera` sees it, by the ground that it lies on."""
    g0, g1, g2, g3 = frame.ground
    m, n = (label.uv.T - [[frame.camera.cx], [frame.camera.cy]]) / 100
    disparity = g0 + g1 * n + g2 * n**2 + g3 * m
    uv = np.column_stack([camera.cx - (100 * m - disparity), label.uv[:, 1]])
    xz = np.column_stack([frame.camera.baseline - label.xz[:, 0], label.xz[:, 1]])
    return replace(label, uv=uv, xz=xz, xyz=None)


def _renamed(pair: AnyPair, how: str) -> AnyPair:
    name = f"{pair.name} ({how})"
    truth = None if pair.truth is None else replace(pair.truth, name=name)
    return replace(pair, name=name, truth=truth)
