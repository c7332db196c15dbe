# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the scripts share as commands: the labelled frames as their argument, a known error in one line."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from lane_dp_ros.messages.errors import CommandError, one_line

KNOWN_ERRORS = (CommandError, ValueError, OSError)


def parser_of(description: str) -> argparse.ArgumentParser:
    """Return a parser of DATA, the labelled frames, named by the first line of a script's docstring."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    return parser


def data_folder() -> Path:
    """Return the folder of KITTI's data that LANE_DP_DATA names, else shared/data beside the repository."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    return Path(os.environ.get("LANE_DP_DATA", beside))


def add_settings(parser: argparse.ArgumentParser) -> None:
    """Add --set NAME=VALUE, for parameters that are not to have their defaults."""
    parser.add_argument("--set", type=_setting, action="append", default=[], metavar="NAME=VALUE")


def _setting(text: str) -> tuple[str, Any]:
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text} is no NAME=VALUE")
    return name, yaml.safe_load(value)


def exit_code(run: Callable[[argparse.Namespace], None], arguments: argparse.Namespace) -> int:
    """Run a command with its arguments; return 0, or 1 after a known error, said in one line."""
    try:
        run(arguments)
    except KNOWN_ERRORS as error:
        print(one_line(error), file=sys.stderr)
        return 1
    return 0
