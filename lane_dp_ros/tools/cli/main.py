# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: lane_dp, also ros2 run lane_dp_ros lane_dp."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType

from lane_dp_ros import version
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.missing_library import missing_library
from lane_dp_ros.tools.cli import (
    convert,
    demo,
    dump_config,
    evaluate,
    fit_evidence,
    play,
    review,
    run,
    scenes,
    tables,
    topics,
)
from lane_dp_ros.tools.cli.remarks import remarks_on_stderr

# In the order of --help.
COMMANDS = (
    demo,
    play,
    run,
    topics,
    convert,
    evaluate,
    review,
    tables,
    scenes,
    fit_evidence,
    dump_config,
)
# Exit codes; the last three as the shell has them.
KNOWN_ERROR, INTERRUPTED, BROKEN_PIPE, TERMINATED = 1, 130, 141, 143


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 1 for a known error, which is one line on standard error.

    Wrong usage ends with exit code 2 (SystemExit, from argparse).
    """
    arguments = _parse(list(sys.argv[1:] if argv is None else argv))
    try:
        with _ended_by_sigterm(), remarks_on_stderr():
            arguments.run(arguments)
            print(end="", flush=True)  # an error in writing is told here
    except BrokenPipeError:  # who read the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except (CommandError, ValueError, OSError) as error:
        print(f"lane_dp: {one_line(error)}", file=sys.stderr)
        return KNOWN_ERROR
    except ImportError as error:
        if (error.name or "").startswith("lane_dp_ros"):
            raise  # a fault of ours
        print(f"lane_dp: {missing_library(error)}", file=sys.stderr)
        return KNOWN_ERROR
    except KeyboardInterrupt:
        return INTERRUPTED
    return 0


def _parse(argv: list[str]) -> argparse.Namespace:
    """Return the arguments; what follows --ros-args is ROS's and goes to `ros_args`."""
    split = argv.index("--ros-args") if "--ros-args" in argv else len(argv)
    parser = _parser()
    _complete(parser)
    arguments = parser.parse_args(argv[:split])
    arguments.ros_args = argv[split:]
    if arguments.ros_args and arguments.run is not play.run:
        parser.error("--ros-args goes with play alone")
    return arguments


def _complete(parser: argparse.ArgumentParser) -> None:
    """Answer a shell that asks how a command line goes on: eval "$(register-python-argcomplete lane_dp)"."""
    try:
        import argcomplete
    except ModuleNotFoundError:  # then no shell can ask
        return
    argcomplete.autocomplete(parser)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="lane_dp", description="Stereo lane detection: tools for bags.")
    parser.add_argument("--version", action="version", version=f"lane_dp {version()}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_command(commands)
    return parser


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """Let SIGTERM end the block like an error, so that half-written files and child processes go, too."""

    def end(_signal: int, _frame: FrameType | None) -> None:
        """End the process by an exception."""
        sys.exit(TERMINATED)

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
