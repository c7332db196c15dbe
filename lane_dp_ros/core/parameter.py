# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters that stand once: a dataclass field with its default, unit, range and a sentence."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

Value = bool | int | float | str
ConfigT = TypeVar("ConfigT")


@dataclasses.dataclass(frozen=True)
class Parameter:
    """What is known of one parameter: its name, type, default, unit, range and meaning.

    `name` is dotted (``stage.field``); `minimum` and `maximum` are inclusive; `step` is the
    spacing of the allowed values above `minimum` (0: any); `choices` is empty where any value will do.
    An `expert` parameter is set from files and by fits; ROS tools do not list it unless it is given.
    """

    name: str
    default: Value
    description: str
    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None
    step: int = 0
    choices: tuple[str, ...] = ()
    expert: bool = False

    @property
    def type(self) -> type:
        """The Python type of its values: bool, int, float or str."""
        return type(self.default)

    @property
    def allowed(self) -> str:
        """Return the allowed values in words, empty where there is no bound."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        if self.minimum is None or self.maximum is None:
            return ""
        steps = f" in steps of {self.step}" if self.step else ""
        return f"{self.minimum:g} to {self.maximum:g}{steps}"

    def checked(self, value: Any) -> Value:
        """Return `value` as this parameter's type.

        Raises ValueError, naming the parameter, what came and what would be right.
        """
        if self.type is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, (bool, int, float, str)) or type(value) is not self.type:
            raise ValueError(f"{self.name}: got {value!r}, expected a value of type {self.type.__name__}")
        if (self.choices and value not in self.choices) or not self._in_range(value):
            raise ValueError(f"{self.name}: got {value!r}, expected {self.allowed or 'a finite number'}")
        return value

    def _in_range(self, value: Value) -> bool:
        if isinstance(value, (bool, str)):
            return True
        if not math.isfinite(value):
            return False
        low = self.minimum if self.minimum is not None else -math.inf
        high = self.maximum if self.maximum is not None else math.inf
        return low <= value <= high and not (self.step and (value - low) % self.step)


def parameter(  # noqa: PLR0913 - as many as there are facts of a parameter
    default: Any,
    description: str,
    *,
    unit: str = "",
    limits: tuple[float, float] | None = None,
    step: int = 0,
    choices: tuple[str, ...] = (),
    expert: bool = False,
) -> Any:
    """Declare a dataclass field that is a parameter (see `Parameter`)."""
    minimum, maximum = limits or (None, None)
    spec = Parameter("", default, description, unit, minimum, maximum, step, choices, expert)
    return dataclasses.field(default=default, metadata={"parameter": spec})


@dataclasses.dataclass(frozen=True)
class Parameters:
    """Base of the dataclasses whose fields are parameters: none holds a value out of its range.

    Raises ValueError, naming class and field, what came and what would be right.
    """

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            if "parameter" in field.metadata:
                name = f"{type(self).__name__}.{field.name}"
                spec = dataclasses.replace(field.metadata["parameter"], name=name)
                object.__setattr__(self, field.name, spec.checked(getattr(self, field.name)))


def parameters(config: Any, expert: bool = True) -> dict[str, Parameter]:
    """Return the parameters of a (nested) config by dotted name; defaults are this config's values.

    Without `expert` those marked so are left out.
    """
    return {spec.name: spec for spec in _walk(config, "") if expert or not spec.expert}


def _walk(config: Any, prefix: str) -> Iterator[Parameter]:
    for field in dataclasses.fields(config):
        value = getattr(config, field.name)
        if dataclasses.is_dataclass(value):
            yield from _walk(value, f"{prefix}{field.name}.")
        else:
            yield dataclasses.replace(field.metadata["parameter"], name=prefix + field.name, default=value)


def replaced(config: ConfigT, values: Mapping[str, Any]) -> ConfigT:
    """Return `config` with the named parameters replaced.

    Raises ValueError for an unknown name, a wrong type, a value out of range, or values that do not
    go together; the message names the parameter, what came and what would be right.
    """
    known = parameters(config)
    for name in values:
        if name not in known:
            raise ValueError(f"{name}: no such parameter, expected one of {', '.join(known)}")
    checked = {name: known[name].checked(value) for name, value in values.items()}
    result: ConfigT = _replaced(config, checked)
    return result


def _replaced(config: Any, values: Mapping[str, Value]) -> Any:
    own: dict[str, Any] = {name: value for name, value in values.items() if "." not in name}
    stages = {name.partition(".")[0] for name in values if "." in name}
    for stage in stages:
        inner = {name[len(stage) + 1 :]: v for name, v in values.items() if name.startswith(stage + ".")}
        own[stage] = _replaced(getattr(config, stage), inner)
    return dataclasses.replace(config, **own)


def check_order(config: object, stage: str, lower: str, upper: str) -> None:
    """Raise ValueError unless the field `upper` of a stage's config is more than `lower`."""
    low, high = getattr(config, lower), getattr(config, upper)
    if high <= low:
        raise ValueError(f"{stage}.{upper}: got {high}, expected more than {lower} = {low}")
