# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""COCO's JSON (https://cocodataset.org/#format-data) with polylines, of which it knows nothing itself.

A polyline is written twice: as `keypoints` (x, y, visible) and as an open `segmentation`. Read are keypoints
where there are any, else every part of the segmentation.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

from lane_dp_ros.review.polylines import AnnotatedImage, Polyline, checked_points, checked_size, short

VISIBLE = 2  # of a keypoint: labelled and visible
Fields = dict[str, Any]


def to_coco(images: Sequence[AnnotatedImage], labels: Sequence[str]) -> str:
    """Return images as the text of a file; `labels` are its categories."""
    categories = [{"id": i + 1, "name": label, "supercategory": "lane"} for i, label in enumerate(labels)]
    ids = {label: i + 1 for i, label in enumerate(labels)}
    entries = [
        {"id": i + 1, "file_name": image.name, "width": image.size[0], "height": image.size[1]}
        for i, image in enumerate(images)
    ]
    lines = [(i + 1, line) for i, image in enumerate(images) for line in image.polylines]
    annotations = [_annotation(n + 1, image, ids[line.label], line) for n, (image, line) in enumerate(lines)]
    content = {"images": entries, "categories": categories, "annotations": annotations}
    return json.dumps(content, indent=1) + "\n"


def from_coco(text: str) -> tuple[AnnotatedImage, ...]:
    """Return the images of a file. Raises ValueError naming image and field."""
    try:
        content = json.loads(text.lstrip("\ufeff"))
    except RecursionError:
        raise ValueError("the JSON is too deep") from None
    except ValueError as error:
        raise ValueError(f"no whole JSON: {str(error)[:100]}") from None
    if not isinstance(content, dict):
        raise ValueError(f"the JSON is {short(content)}, expected an object as COCO has it")
    images = _by_id(content, "images")
    categories = _by_id(content, "categories")
    shapes: dict[object, list[Fields]] = {key: [] for key in images}
    for number, fields in enumerate(_list(content, "annotations")):
        key = _key(fields.get("image_id"))
        if key not in shapes:
            raise ValueError(f"annotation {number + 1}: image_id is {short(key)}, which no image has")
        shapes[key].append(fields)
    return tuple(_image(images[key], shapes[key], categories) for key in images)


def _annotation(number: int, image: int, category: int, line: Polyline) -> Fields:
    xs, ys = zip(*line.points, strict=True)
    left, top = min(xs), min(ys)
    return {
        "id": number,
        "image_id": image,
        "category_id": category,
        "keypoints": [round(v, 2) if i < 2 else VISIBLE for p in line.points for i, v in enumerate((*p, 0))],
        "num_keypoints": len(line.points),
        "segmentation": [[round(value, 2) for point in line.points for value in point]],
        "bbox": [round(v, 2) for v in (left, top, max(xs) - left, max(ys) - top)],
        "area": 0,
        "iscrowd": 0,
        "attributes": dict(line.attributes),
    }


def _list(content: Fields, name: str) -> list[Fields]:
    values = content.get(name)
    if not isinstance(values, list) or not all(isinstance(value, dict) for value in values):
        raise ValueError(f"{name} is {short(values)}, expected a list of objects as COCO has it")
    return values


def _by_id(content: Fields, name: str) -> dict[object, Fields]:
    values = _list(content, name)
    found = {_key(value.get("id")): value for value in values}
    if len(found) < len(values):
        raise ValueError(f"{name}: two have one id")
    return found


def _key(value: object) -> object:
    """Return an id, which may be a number or a text."""
    if not isinstance(value, (int, str)):
        raise ValueError(f"an id is {short(value)}, expected a whole number")
    return value


def _image(fields: Fields, shapes: Sequence[Fields], categories: dict[object, Fields]) -> AnnotatedImage:
    name = fields.get("file_name")
    if not isinstance(name, str) or not name:
        raise ValueError(f"image {short(fields.get('id'))}: file_name is {short(name)}, expected a text")
    where = f"image {short(name)}"
    size = checked_size(fields.get("width"), fields.get("height"), where)
    lines = [
        line
        for i, shape in enumerate(shapes)
        for line in _polylines(shape, size, categories, f"{where}, annotation {i + 1}")
    ]
    drawn = sum(bool(shape.get("keypoints") or shape.get("segmentation")) for shape in shapes)
    return AnnotatedImage(name, size, tuple(lines), len(shapes) - drawn)


def _polylines(
    shape: Fields, size: tuple[int, int], categories: dict[object, Fields], where: str
) -> Iterator[Polyline]:
    category = categories.get(_key(shape.get("category_id")))
    if category is None:
        raise ValueError(f"{where}: category_id is {short(shape.get('category_id'))}, which no category has")
    given = shape.get("attributes", {})
    if not isinstance(given, dict):
        raise ValueError(f"{where}: attributes is {short(given)}, expected an object")
    attributes = {name: str(value) for name, value in given.items()}
    for name, numbers in _parts(shape, where):
        points = checked_points(numbers, size, f"{where}: {name}")
        yield Polyline(str(category.get("name", "")), attributes, points)


def _parts(shape: Fields, where: str) -> Iterator[tuple[str, list[Any]]]:
    """Yield the name of the field and the numbers x, y, x, y, ... of each polyline of an annotation."""
    keypoints, parts = shape.get("keypoints"), shape.get("segmentation")
    if keypoints:
        if not isinstance(keypoints, list) or len(keypoints) % 3:
            raise ValueError(
                f"{where}: keypoints is {short(keypoints)}, expected x, y, visible of each point"
            )
        triples = [keypoints[i : i + 3] for i in range(0, len(keypoints), 3)]
        yield "keypoints", [value for *point, visible in triples if visible for value in point]
    elif parts:
        if not isinstance(parts, list) or not all(isinstance(part, list) for part in parts):
            raise ValueError(f"{where}: segmentation is {short(parts)}, expected lists of x, y (no mask)")
        yield from (("segmentation", part) for part in parts)
