# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Read and write labelled frames: docs/truth_format.md."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.messages.errors import quoted
from lane_dp_ros.tools.evaluation.annotations import COLOURS, KINDS, Kind, Label, LabelledFrame, by_depth

__all__ = ["KINDS", "Kind", "Label", "LabelledFrame", "by_depth", "load_truth", "save_truth"]

Floats = NDArray[np.float64]
_SHAPES = {(4,): "4 numbers", (-1, 2): "[a, b] points", (-1, 3): "[a, b, c] points"}
CAMERA_FIELDS = ("fx", "fy", "cx", "cy", "baseline")
TEXT_FIELDS = ("sequence", "category", "drive", "left", "right", "note")  # of a frame; each may be left out
LARGEST = 1e6  # of any number in a truth
LARGEST_SIZE = 20_000  # px; no camera has more rows or columns
LARGEST_STAMP = 2**63 - 1  # ns
NEAREST = 0.1  # m; no road is nearer to a camera
WIDEST = 2.0  # m; no lane line is wider
PIXEL_DIGITS, METRE_DIGITS = 3, 4  # that are written: no label is better, and the last bits differ by machine


def load_truth(path: Path) -> tuple[LabelledFrame, ...]:
    """Read the labelled frames of a file.

    Raises ValueError naming the line for what is no JSON, else the frame and the field that is wrong.
    """
    try:
        frames = json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=_without_repeats)
    except RecursionError:
        raise ValueError(f"{path} is nested too deep, expected an object of labelled frames") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"{path}, line {error.lineno}, column {error.colno}: no JSON: {error.msg}") from None
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is no JSON: byte {error.start} is not UTF-8") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(frames, dict):
        raise ValueError(f"{path} holds a {type(frames).__name__}, expected an object of labelled frames")
    try:
        return tuple(frame_from_json(name, fields) for name, fields in frames.items())
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def save_truth(frames: Iterable[LabelledFrame], path: Path) -> None:
    """Write labelled frames, a line of the road to a line of the file; equal frames give equal bytes.

    Pixels are rounded to 0.001 px, metres to 0.1 mm. What stood at `path` is replaced at the very end.
    """
    text = "{\n" + ",\n".join(map(_frame_text, frames)) + "\n}\n"
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _frame_text(frame: LabelledFrame) -> str:
    fields = frame_to_json(frame)
    lanes = ",\n  ".join(map(json.dumps, fields.pop("lanes")))
    return f'{json.dumps(frame.name)}: {json.dumps(fields)[:-1]}, "lanes": [\n  {lanes}]}}'


def frame_to_json(frame: LabelledFrame) -> dict[str, Any]:
    """Return the object that the truth holds under the frame's name: `frame_from_json` reads it."""
    camera = frame.camera
    stamp = {} if frame.stamp_ns is None else {"stamp_ns": int(frame.stamp_ns)}
    fields = {
        **stamp,
        **{name: getattr(frame, name) for name in TEXT_FIELDS if getattr(frame, name)},
        **{name: float(getattr(camera, name)) for name in CAMERA_FIELDS},
        "width": int(frame.size[0]),
        "height": int(frame.size[1]),
        "ground": [float(g) for g in frame.ground],
        "ego_left": frame.ego_left,
        "ego_right": frame.ego_right,
    }
    if frame.profile is not None:
        digits = zip((METRE_DIGITS, PIXEL_DIGITS), frame.profile.T, strict=True)
        fields["profile"] = np.column_stack([np.round(each, n) for n, each in digits]).tolist()
    return {**fields, "lanes": [_label_to_json(label) for label in frame.labels]}


def _label_to_json(label: Label) -> dict[str, Any]:
    points = {
        "uv": np.round(label.uv, PIXEL_DIGITS).tolist(),
        "xz": np.round(label.xz, METRE_DIGITS).tolist(),
    }
    if label.xyz is not None:
        points["xyz"] = np.round(label.xyz, METRE_DIGITS).tolist()
    said: dict[str, Any] = {
        name: getattr(label, name) for name in ("colour", "border") if getattr(label, name)
    }
    if label.width is not None:
        said["width"] = round(float(label.width), METRE_DIGITS)
    if label.double is not None:
        said["double"] = bool(label.double)
    return {"id": label.id, "kind": label.kind, "sure": bool(label.sure), **said, **points}


def _without_repeats(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """Return the object of these pairs; JSON would silently keep the last of two frames of one name."""
    fields = dict(pairs)
    if len(fields) < len(pairs):
        names = [name for name, _ in pairs]
        repeated = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{repeated!r} stands twice in one object")
    return fields


def frame_from_json(name: str, fields: Any) -> LabelledFrame:
    """Return the frame of a JSON object. Raises ValueError naming the frame and what is wrong in it."""
    try:
        frame = LabelledFrame(
            name=name,
            camera=_camera(fields),
            size=(_whole(fields, "width", LARGEST_SIZE), _whole(fields, "height", LARGEST_SIZE)),
            ground=finite_array(fields["ground"], (4,), "ground"),
            labels=tuple(map(_label, fields["lanes"])),
            stamp_ns=None if fields.get("stamp_ns") is None else _whole(fields, "stamp_ns", LARGEST_STAMP),
            profile=_profile(fields),
            **{side: fields[side] for side in ("ego_left", "ego_right")},
            **{name: str(fields.get(name, "")) for name in TEXT_FIELDS},
        )
        _check_ids(frame)
    except KeyError as error:
        raise ValueError(f"frame {name!r} lacks the field {error}") from None
    except (TypeError, AttributeError, ValueError, RecursionError) as error:
        raise ValueError(f"frame {quoted(name)}: {error}") from None
    return frame


def _camera(fields: dict[str, Any]) -> StereoCamera:
    fx, fy, cx, cy, baseline = (_number(fields[key], key) for key in CAMERA_FIELDS)
    return StereoCamera(fx, fy, cx, cy, baseline)


def _whole(fields: dict[str, Any], key: str, largest: int) -> int:
    """Return a field that is a whole number. Raises ValueError naming it."""
    value = fields[key]
    try:
        if not 0 <= value <= largest or int(value) != value:
            raise ValueError
        return int(value)
    except (TypeError, ValueError):
        raise ValueError(f"{key} is {quoted(value)}, expected a whole number from 0 to {largest}") from None


def _number(value: Any, what: str) -> float:
    try:
        if not abs(number := float(value)) <= LARGEST:
            raise ValueError
        return number
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{what} is {quoted(value)}, expected a number of at most {LARGEST:.0e}") from None


def _label(fields: dict[str, Any]) -> Label:
    identity, kind = str(fields["id"]), fields["kind"]
    where = f"line {quoted(identity)}"
    if kind not in KINDS:
        raise ValueError(f"{where} is of kind {quoted(kind)}, expected one of {', '.join(KINDS)}")
    uv, xz = (finite_array(fields[key], (-1, 2), f"{where}: {key}") for key in ("uv", "xz"))
    if len(xz) < 2:
        raise ValueError(f"{where}: xz has {len(xz)} points, expected at least 2")
    xyz = None if fields.get("xyz") is None else finite_array(fields["xyz"], (-1, 3), f"{where}: xyz")
    if xyz is not None and len(xyz) < 2:
        raise ValueError(f"{where}: xyz has {len(xyz)} points, expected at least 2")
    exact = None if xyz is None else by_depth(xyz)
    return Label(identity, kind, bool(fields["sure"]), uv, by_depth(xz), exact, **_paint(fields, where))


def _paint(fields: dict[str, Any], where: str) -> dict[str, Any]:
    """Return what a line's object says of its paint, or of the border that it is; all may be missing."""
    colour, width, double = (fields.get(name) for name in ("colour", "width", "double"))
    if colour is not None and colour not in COLOURS:
        raise ValueError(f"{where}: colour is {quoted(colour)}, expected white or yellow")
    if width is not None and not 0 < (width := _number(width, f"{where}: width")) <= WIDEST:
        raise ValueError(f"{where}: width is {width:.4g}, expected more than 0 and at most {WIDEST:g} m")
    if double not in (None, True, False):
        raise ValueError(f"{where}: double is {quoted(double)}, expected true or false")
    return {
        "colour": colour or "",
        "width": width,
        "double": double,
        "border": str(fields.get("border") or ""),
    }


def _profile(fields: dict[str, Any]) -> Floats | None:
    """Return the exact rows (N, 2) of the road straight ahead, None for a file that does not know them."""
    if fields.get("profile") is None:
        return None
    profile = finite_array(fields["profile"], (-1, 2), "profile")
    if len(profile) < 2 or profile[0, 0] < NEAREST or not np.all(np.diff(profile[:, 0]) > 0):
        raise ValueError("profile is no list of at least 2 points [z, v] with rising z >= 0.1")
    return profile


def finite_array(values: Any, shape: tuple[int, ...], what: str) -> Floats:
    """Return numbers from JSON as an array of a shape, one of (4,), (-1, 2) and (-1, 3).

    Raises ValueError that begins with `what` for anything else, and for what is not finite or far too large.
    """
    try:
        given = np.array(values, dtype=np.float64)
        if given.ndim != len(shape) or given.shape[-1] != shape[-1]:
            raise ValueError
        numbers = given.reshape(shape)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{what} is no list of {_SHAPES[shape]}") from None
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{what} holds values that are not finite numbers (NaN?)")
    if np.any(np.abs(numbers) > LARGEST):
        raise ValueError(f"{what} holds values of more than {LARGEST:.0e}, expected metres and pixels")
    return numbers


def _check_ids(frame: LabelledFrame) -> None:
    ids = [label.id for label in frame.labels]
    if repeated := sorted({identity for identity in ids if ids.count(identity) > 1}):
        raise ValueError(f"two lines have the id {quoted(repeated[0])}")
    if unknown := [identity for identity in frame.ego_ids if identity not in ids]:
        raise ValueError(f"ego line {quoted(unknown[0])} is none of the lines {', '.join(ids) or '(none)'}")
