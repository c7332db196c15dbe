# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The lines of a drive to annotation tools and back: which frame an image is, which line a polyline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import count
from pathlib import PurePosixPath
from typing import cast

from lane_dp_ros.core.types import ego_roles
from lane_dp_ros.messages.errors import one_line
from lane_dp_ros.review.coco_file import from_coco, to_coco
from lane_dp_ros.review.cvat_file import from_cvat, to_cvat
from lane_dp_ros.review.drive import Drive, Frame
from lane_dp_ros.review.judgement import ROLES, Line, lines_from_json, lines_to_json
from lane_dp_ros.review.polylines import CORNER, AnnotatedImage, Polyline, short
from lane_dp_ros.tools.evaluation.truth_file import KINDS, Kind

FORMATS = {"coco": ".json", "cvat": ".xml"}
YES, NO = "true", "false"


def frame_name(drive: Drive, frame: Frame) -> str:
    """Return the name of a frame's picture: DRIVE/000000.jpg, that of the truth with an ending."""
    return f"{drive.name}/{frame.index:06d}.jpg"


def lines_as_text(drive: Drive, lines: Mapping[int, tuple[Line, ...]], form: str) -> str:
    """Return lines by the frame's index as the text of a file. Raises ValueError for another `form`."""
    images = [_as_image(drive, drive.frames[index], each) for index, each in sorted(lines.items())]
    if form == "coco":
        return to_coco(images, ROLES)
    if form == "cvat":
        return to_cvat(images, ROLES, {"kind": KINDS, "sure": (YES, NO), "id": ()})
    raise ValueError(f"format is {short(form)}, expected one of {', '.join(FORMATS)}")


def lines_from_text(drive: Drive, text: str) -> tuple[dict[int, tuple[Line, ...]], int]:
    """Return lines by the frame's index, and how many shapes are left out, none of them a polyline.

    Raises ValueError naming image and field; so does an image that is no frame, or of another size.
    """
    images = from_cvat(text) if text.lstrip("\ufeff \t\r\n").startswith("<") else from_coco(text)
    found: dict[int, tuple[Line, ...]] = {}
    for image in images:
        frame = _frame_of(drive, image)
        if frame.index in found:
            raise ValueError(f"image {short(image.name)} is frame {frame.index + 1}, as one before it")
        found[frame.index] = _as_lines(frame, image)
    if not found:
        raise ValueError("there are no images")
    return found, sum(image.others for image in images)


def _as_image(drive: Drive, frame: Frame, lines: tuple[Line, ...]) -> AnnotatedImage:
    return AnnotatedImage(frame_name(drive, frame), frame.size, tuple(_as_polyline(line) for line in lines))


def _as_polyline(line: Line) -> Polyline:
    attributes = {"kind": line.kind, "sure": YES if line.sure else NO, "id": line.id}
    return Polyline(line.role, attributes, tuple((u + CORNER, v + CORNER) for u, v in line.uv))


def _frame_of(drive: Drive, image: AnnotatedImage) -> Frame:
    """Return the frame of an image: its number is the image's name, without folders and ending."""
    stem = PurePosixPath(image.name.replace("\\", "/")).stem
    index = int(stem) if stem.isascii() and stem.isdecimal() and len(stem) == 6 else -1
    if not 0 <= index < len(drive.frames):
        first, last = (frame_name(drive, drive.frames[i]) for i in (0, -1))
        raise ValueError(f"image {short(image.name)} is no frame: expected {first} to {last}")
    frame = drive.frames[index]
    if image.size != frame.size:
        sizes = ("x".join(map(str, size)) for size in (image.size, frame.size))
        raise ValueError("image {} is {}, its frame {}".format(short(image.name), *sizes))
    return frame


def _as_lines(frame: Frame, image: AnnotatedImage) -> tuple[Line, ...]:
    lines = _with_ids([_as_line(polyline) for polyline in image.polylines])
    roles = [line.role or "other" for line in lines]
    if not any(line.role for line in lines):
        roles = list(ego_roles([_aside(frame, line) for line in lines]))
    try:
        given = tuple(replace(line, role=role) for line, role in zip(lines, roles, strict=True))
        return lines_from_json(lines_to_json(given))
    except ValueError as error:
        raise ValueError(f"image {short(image.name)}: {one_line(error)}") from None


def _with_ids(lines: list[Line]) -> list[Line]:
    """Return lines with ids of their own: a line that was copied in the tool has that of the other."""
    taken = {line.id for line in lines}
    free = (name for i in count() if (name := f"a{i}") not in taken)
    seen: set[str] = set()
    unique = []
    for line in lines:
        name = line.id if line.id and line.id not in seen else next(free)
        seen.add(name)
        unique.append(replace(line, id=name))
    return unique


def _as_line(polyline: Polyline) -> Line:
    """Return a polyline as a line, from near to far, role and id empty where nothing tells them.

    What the attributes do not say the label may: a role, or a kind. Who draws a line is sure of it.
    """
    said = polyline.attributes
    role = said.get("role") or (polyline.label if polyline.label in ROLES else "")
    kind = said.get("kind") or (polyline.label if polyline.label in KINDS else KINDS[0])
    uv = tuple((round(x - CORNER, 2), round(y - CORNER, 2)) for x, y in polyline.points)
    uv = uv if uv[0][1] >= uv[-1][1] else uv[::-1]
    sure = said.get("sure", YES).lower() not in (NO, "0")
    return Line(said.get("id", ""), role, cast("Kind", kind), sure, uv)


def _aside(frame: Frame, line: Line) -> float:
    """Return how far right of the camera a line passes, in camera heights above a flat road."""
    camera, (u, v) = frame.camera, line.uv[0]
    return float((u - camera.cx) / camera.fx / max((v - camera.cy) / camera.fy, 1e-3))
