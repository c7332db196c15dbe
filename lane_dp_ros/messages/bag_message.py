# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""ROS messages without ROS: built, serialised and read by the rosbags library."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


@lru_cache(maxsize=1)
def typestore() -> Typestore:
    """Return Jazzy's message types."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def bag_message(type_name: str, **fields: Any) -> Any:
    """Return a message, e.g. bag_message("std_msgs/msg/Header", frame_id="map").

    Fields that are not named get their defaults, recursively. Arrays of numbers may come as arrays of
    any shape, lists or tuples. Raises TypeError for a field that the type does not have.
    """
    store = typestore()
    kinds = dict(store.fielddefs[type_name][1])
    if unknown := fields.keys() - kinds.keys():
        raise TypeError(f"{type_name} has no field {', '.join(sorted(unknown))}")
    values = {
        name: _converted(kind, fields[name]) if name in fields else _default(type_name, name, kind)
        for name, kind in kinds.items()
    }
    return store.types[type_name](**values)


def _default(type_name: str, name: str, kind: Any) -> Any:
    if type_name == "geometry_msgs/msg/Quaternion" and name == "w":
        return 1.0  # the one default in a .msg file that is needed here; the typestore drops them
    node, detail = kind
    if node.name == "BASE":
        return {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}.get(detail[0], 0)
    if node.name == "NAME":
        return bag_message(detail)
    element, length = detail
    count = length if node.name == "ARRAY" else 0  # a sequence's number is its upper bound
    if _is_number(element):
        return np.zeros(count, dtype=_dtype(element))
    return [_default("", "", element) for _ in range(count)]


def _converted(kind: Any, value: Any) -> Any:
    node, detail = kind
    if node.name not in ("ARRAY", "SEQUENCE"):
        return value
    element = detail[0]
    if _is_number(element):
        return np.ascontiguousarray(value, dtype=_dtype(element)).reshape(-1)
    return list(value)


def _is_number(kind: Any) -> bool:
    node, detail = kind
    return node.name == "BASE" and detail[0] != "string"


def _dtype(kind: Any) -> np.dtype[Any]:
    name = kind[1][0]
    return np.dtype("uint8" if name in ("octet", "byte", "char") else name)
