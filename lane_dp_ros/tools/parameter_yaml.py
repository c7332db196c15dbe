# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The YAML of ROS parameter files, its scalars read as ROS reads them."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from typing import Any

from lane_dp_ros.messages.errors import CommandError, reason

LARGEST_FILE = 1_000_000  # bytes; every parameter of every node of a vehicle takes a hundredth of it
DEEPEST = 50  # levels of nesting

_SCALARS = {  # as libyaml's plain scalars are read by rcl_yaml_param_parser
    "bool": r"y|Y|yes|Yes|YES|n|N|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF",
    "int": r"[-+]?(?:0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)",
    "float": r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
    "null": r"~|null|Null|NULL|",
}


def load_yaml(path: Path) -> Any:
    """Return the content of a parameter file.

    Raises CommandError, in one line, for a file that cannot be read, is no YAML, is larger or nested deeper
    than parameters are, or has aliases, which ROS refuses, too.
    """
    import yaml  # only this needs it

    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
        if len(data) > LARGEST_FILE:
            raise CommandError(f"{path} has more than {LARGEST_FILE} bytes, a parameter file was expected")
        return yaml.load(data.decode("utf-8-sig"), _loader())
    except (OSError, yaml.YAMLError, ValueError, LookupError, TypeError, RecursionError) as error:
        raise CommandError(f"{path} cannot be read: {reason(error)[:200]}") from None


@lru_cache(maxsize=1)
def _loader() -> Any:
    """Return the loader's class; yaml is imported where it is needed only."""
    import yaml

    class RosLoader(yaml.SafeLoader):
        """Reads scalars as ROS does, and refuses what it refuses."""

        yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012 - yaml's own way
        bool_values = {**yaml.SafeLoader.bool_values, "y": True, "n": False}  # noqa: RUF012 - the same
        depth = 0

        def compose_node(self, parent: Any, index: Any) -> Any:
            """Compose a node that is no alias and not too deep."""
            if self.check_event(yaml.AliasEvent):
                raise yaml.MarkedYAMLError(
                    problem="ROS takes no aliases", problem_mark=self.peek_event().start_mark
                )
            if self.depth > DEEPEST:
                raise yaml.YAMLError(f"nested deeper than {DEEPEST} levels")
            self.depth += 1
            node = super().compose_node(parent, index)
            self.depth -= 1
            return node

    for kind, pattern in _SCALARS.items():
        RosLoader.add_implicit_resolver(f"tag:yaml.org,2002:{kind}", re.compile(f"^(?:{pattern})$"), None)
    return RosLoader
