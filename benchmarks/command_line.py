# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the scripts share as commands: the labelled frames as their argument, a known error in one line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from lane_dp_ros.messages.errors import CommandError, one_line

KNOWN_ERRORS = (CommandError, ValueError, OSError)


def parser_of(description: str) -> argparse.ArgumentParser:
    """Return a parser of DATA, the labelled frames, named by the first line of a script's docstring."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA")
    return parser


def exit_code(
    run: Callable[[argparse.Namespace], None],
    arguments: argparse.Namespace,
    known: tuple[type[Exception], ...] = KNOWN_ERRORS,
) -> int:
    """Run a command with its arguments; return 0, or 1 after a known error, said in one line."""
    try:
        run(arguments)
    except known as error:
        print(one_line(error), file=sys.stderr)
        return 1
    return 0
