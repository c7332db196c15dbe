# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The command line: lane_dp, also ros2 run lane_dp_ros lane_dp."""

from __future__ import annotations

import argparse
import importlib
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from types import FrameType, ModuleType

from lane_dp_ros.core.config import PRESETS
from lane_dp_ros.messages.bag import STORAGES, BagReader, BagWriter
from lane_dp_ros.messages.dds_profile import use_dds_profile
from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.messages.node_config import all_parameters
from lane_dp_ros.review import command as review
from lane_dp_ros.scenes import command as scenes
from lane_dp_ros.tools import demo, offline
from lane_dp_ros.tools.datasets import convert, kitti
from lane_dp_ros.tools.evaluation import evaluate, tables
from lane_dp_ros.tools.parallel import available_cpus
from lane_dp_ros.tools.parameter_file import parameter_file

KNOWN_ERROR, INTERRUPTED, TERMINATED = 1, 130, 143  # exit codes; the last two as the shell has them


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 1 for a known error, which is one line on standard error.

    Wrong usage ends with exit code 2 (SystemExit, from argparse).
    """
    arguments = _parse(list(sys.argv[1:] if argv is None else argv))
    try:
        with _ended_by_sigterm():
            arguments.command(arguments)
    except (CommandError, ValueError, OSError) as error:
        print(f"lane_dp: {one_line(error)}", file=sys.stderr)
        return KNOWN_ERROR
    except KeyboardInterrupt:
        return INTERRUPTED
    return 0


def _parse(argv: list[str]) -> argparse.Namespace:
    """Return the arguments; what follows --ros-args is ROS's and goes to `ros_args`."""
    split = argv.index("--ros-args") if "--ros-args" in argv else len(argv)
    parser = _parser()
    arguments = parser.parse_args(argv[:split])
    arguments.ros_args = argv[split:]
    if arguments.ros_args and arguments.command is not _play:
        parser.error("--ros-args goes with play alone")
    return arguments


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="lane_dp", description="Stereo lane detection: tools for bags.")
    parser.add_argument("--version", action="version", version=f"lane_dp {_version()}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for add in (
        _add_demo,
        _add_play,
        _add_run,
        _add_convert,
        _add_evaluate,
        _add_review,
        _add_tables,
        _add_scenes,
        _add_dump_config,
    ):
        add(commands)
    return parser


def _version() -> str:
    try:
        return metadata.version("lane_dp_ros")
    except metadata.PackageNotFoundError:
        return "(run from its source tree)"


def _add_demo(commands: argparse._SubParsersAction) -> None:
    text = "render a road, play it into a running lane_detector, write what it finds"
    command = commands.add_parser("demo", help=text, description=text)
    command.add_argument(
        "-o", "--output", type=Path, default=Path("demo"), metavar="DIR", help="where to write, default: demo"
    )
    _add_rate(command)
    command.set_defaults(command=_demo)


def _demo(arguments: argparse.Namespace) -> None:
    demo.run_demo(arguments.output, _ros_module("detector_session"), arguments.rate)


def _add_rate(command: argparse.ArgumentParser) -> None:
    command.add_argument("--rate", type=_positive, default=1.0, help="speed, 2 is twice as fast; default: 1")


def _add_play(commands: argparse._SubParsersAction) -> None:
    text = "replay a rosbag2 on its topics in real time"
    epilog = "--ros-args ... is passed on to ROS"
    command = commands.add_parser("play", help=text, description=text, epilog=epilog)
    command.add_argument("bag", type=Path, metavar="BAG", help="bag folder, .mcap or .db3 file")
    _add_rate(command)
    command.add_argument("--loop", action="store_true", help="start again at the end, until Ctrl-C")
    command.set_defaults(command=_play)


def _play(arguments: argparse.Namespace) -> None:
    with BagReader(arguments.bag) as reader:
        count = _ros_module("bag_player").play(reader, arguments.rate, arguments.loop, arguments.ros_args)
    print(f"{arguments.bag}: {count} messages played")


def _add_run(commands: argparse._SubParsersAction) -> None:
    text = "detect lanes in every stereo pair of a bag, without ROS, as fast as it goes"
    command = commands.add_parser("run", help=text, description=text)
    command.add_argument("bag", type=Path, metavar="BAG", help="bag folder, .mcap or .db3 file")
    _add_output(command)
    config, preset = "ROS parameter file, as from dump-config", "values that FILE does not give"
    command.add_argument("--config", type=Path, metavar="FILE", help=config)
    command.add_argument("--preset", choices=PRESETS, default="default", help=preset)
    _add_jobs(command)
    command.set_defaults(command=_run)


def _run(arguments: argparse.Namespace) -> None:
    config = offline.load_config(arguments.preset, arguments.config)
    with BagReader(arguments.bag) as reader:
        bag = arguments.bag.resolve()
        if arguments.output.resolve() in (bag, *bag.parents):  # a bag may be given by the file in its folder
            raise CommandError(f"{arguments.output} is the input bag itself: choose another output")
        with BagWriter(arguments.output, force=arguments.force) as writer:
            summary = offline.detect_bag(reader, writer, *config, arguments.jobs)
    print(f"{arguments.output}: {summary}")


def _add_convert(commands: argparse._SubParsersAction) -> None:
    text = "write a data set's folder as a bag with the topics of the node"
    command = commands.add_parser("convert", help=text, description=text)
    command.add_argument("layout", choices=sorted(kitti.LAYOUTS), help="how the folder is laid out")
    command.add_argument("folder", type=Path, metavar="DIR")
    _add_output(command)
    command.add_argument("--storage", choices=STORAGES, default="mcap", help="default: mcap")
    command.add_argument("--jpeg", action="store_true", help="JPEG images on .../image_rect/compressed")
    command.set_defaults(command=_convert)


def _convert(arguments: argparse.Namespace) -> None:
    sequence = kitti.LAYOUTS[arguments.layout](arguments.folder)
    with BagWriter(arguments.output, arguments.storage, arguments.force) as writer:
        convert.convert(sequence, writer, arguments.jpeg)
    sources = f"{sequence.left[0].parent} and {sequence.right[0].parent}"
    print(f"{arguments.output}: {len(sequence)} pairs from {sources}")


def _add_evaluate(commands: argparse._SubParsersAction) -> None:
    _add_jobs(evaluate.add_command(commands))


def _add_review(commands: argparse._SubParsersAction) -> None:
    _add_jobs(review.add_command(commands))


def _add_tables(commands: argparse._SubParsersAction) -> None:
    _add_jobs(tables.add_command(commands))


def _add_scenes(commands: argparse._SubParsersAction) -> None:
    _add_jobs(scenes.add_command(commands))


def _add_dump_config(commands: argparse._SubParsersAction) -> None:
    text = "print every parameter with unit, range and default as a ROS parameter file"
    command = commands.add_parser("dump-config", help=text, description=text)
    command.add_argument("--preset", choices=PRESETS, default="default")
    command.set_defaults(command=_dump_config)


def _dump_config(arguments: argparse.Namespace) -> None:
    print(dumped_config(arguments.preset), end="")


def dumped_config(preset: str) -> str:
    """Return what `lane_dp dump-config --preset PRESET` prints."""
    title = f"Every parameter of lane_detector, preset {preset}: lane_dp dump-config --preset {preset}"
    return parameter_file(all_parameters(preset), all_parameters("default"), title)


def _add_output(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "-o", "--output", type=Path, required=True, metavar="OUT", help="the bag to write, a folder"
    )
    command.add_argument("--force", action="store_true", help="replace OUT if it is a bag")


def _add_jobs(command: argparse.ArgumentParser) -> None:
    cpus = available_cpus()
    text = f"processes that work, default: one a CPU, here {cpus}"
    command.add_argument("--jobs", type=_count, default=cpus, metavar="N", help=text)


def _count(text: str) -> int:
    if not (text.isdecimal() and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{text} is not a whole number > 0")
    return int(text)


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a number > 0")
    return value


def _ros_module(name: str) -> ModuleType:
    """Import a module of lane_dp_ros.ros that needs ROS; the rest of the command line works without."""
    use_dds_profile()
    try:
        return importlib.import_module(f"lane_dp_ros.ros.{name}")
    except ModuleNotFoundError as error:
        raise CommandError(
            f"needs ROS 2 ({error}): source /opt/ros/jazzy/setup.bash, or pip install 'lane_dp_ros[ros]'"
        ) from None


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


if __name__ == "__main__":
    sys.exit(main())
