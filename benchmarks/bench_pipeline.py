# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Measure the whole pipeline stage by stage on one core, and beside the time of a stereo matcher.

python benchmarks/bench_pipeline.py [-o DIR] [--frames N] [--rounds N]
Writes pipeline.md (milliseconds a stage and frames a second, ratios to a matcher) and pipeline.png (stacked
bars). Rendered pairs are always measured, KITTI's where they are: the data folder is $LANE_DP_DATA, else
shared/data beside the repository. The ratios are of the labelled KITTI frames where there are any.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
from command_line import data_folder, exit_code
from matcher_ratio import CameraPair
from matcher_ratio import measure as measure_ratios
from matplotlib.figure import Figure
from study_runner import labelled_pairs

from lane_dp_ros import scenes
from lane_dp_ros.core.config import preset
from lane_dp_ros.core.detector import LaneDetector
from lane_dp_ros.core.geometry.camera import StereoCamera
from lane_dp_ros.core.presets import PRESETS
from lane_dp_ros.core.types import StereoFrame
from lane_dp_ros.tools.datasets.kitti import LAYOUTS, load_pairs
from lane_dp_ros.tools.progress import progress

WANTED_RATE = 20  # frames a second, default preset
WARM_UP = 3  # frames
DIFFERENT_PAIRS = 10  # of each source; they are taken in turn
SEED = 1  # of the rendered road
KITTI = {
    "KITTI stereo 2015": ("kitti-stereo", "kitti_stereo_2015"),
    "KITTI odometry 01": ("kitti-odometry", "kitti_odometry/sequences/01"),
    "KITTI odometry 02": ("kitti-odometry", "kitti_odometry/sequences/02"),
}
RATIO = """The default preset and each matcher (128 disparities; the product's other matcher parameters,
StereoBM with a block of 15) ran one after the other on the same core; medians of the core's time."""
REST = "rest"  # what is between the stages: colour to grey, the result
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Source:
    """Pairs of one camera."""

    name: str
    camera: StereoCamera
    pairs: list[StereoFrame]

    @property
    def kind(self) -> str:
        """What the images are."""
        image = self.pairs[0].left
        return f"{image.shape[1]}x{image.shape[0]} {'grey' if image.ndim == 2 else 'colour'}"


@dataclass
class Timing:
    """What was measured of one preset on one source."""

    source: Source
    preset: str
    seconds: dict[str, list[float]] = field(default_factory=dict)  # of each stage, frame by frame
    whole: list[float] = field(default_factory=list)
    processor: float = 0.0  # seconds of the core that this process had

    @property
    def rate(self) -> float:
        """Frames a second that passed."""
        return len(self.whole) / sum(self.whole)

    @property
    def core_rate(self) -> float:
        """Frames a second of the core's time: what a core does that nobody else uses."""
        return len(self.whole) / self.processor

    def share(self, seconds: list[float]) -> float:
        """Return the part that these seconds are of the whole."""
        return sum(seconds) / sum(self.whole)

    def add(self, frame: StereoFrame) -> None:
        """Detect once, and note how long it took."""
        detector = LaneDetector(self.source.camera, preset(self.preset))
        start, start_processor = time.perf_counter(), time.process_time()
        stages = detector.detect(frame).seconds
        self.whole.append(time.perf_counter() - start)
        self.processor += time.process_time() - start_processor
        for stage, seconds in {**stages, REST: self.whole[-1] - sum(stages.values())}.items():
            self.seconds.setdefault(stage, []).append(seconds)


def stay_on_one_core() -> None:
    """Start again with one thread for numpy's BLAS, which must be told before, and bound to one core."""
    cv2.setNumThreads(1)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # the first often serves the interrupts
    if not ONE_THREAD.items() <= os.environ.items():
        os.execve(sys.executable, sys.orig_argv, {**os.environ, **ONE_THREAD})


def rendered() -> Source:
    """Render pairs of a curved road, as large as KITTI's."""
    frames = scenes.render_sequence(DIFFERENT_PAIRS, 2.0, SEED)
    pairs = [StereoFrame(pair.left, pair.right) for pair in progress(frames, DIFFERENT_PAIRS, "pair")]
    return Source("rendered", scenes.CAMERA, pairs)


def read_kitti(name: str, layout: str, folder: Path) -> Source:
    """Read pairs of a KITTI folder, evenly spread over it."""
    sequence = LAYOUTS[layout](folder)
    step = max(1, len(sequence) // DIFFERENT_PAIRS)
    pairs = islice(load_pairs(sequence), 0, step * DIFFERENT_PAIRS, step)
    camera = StereoCamera.from_projections(sequence.P_left, sequence.P_right)
    return Source(name, camera, [StereoFrame(pair.left, pair.right) for pair in pairs])


def sources(root: Path) -> Iterator[Source | str]:
    """Yield what there is to measure, or the line that says what is skipped."""
    for name, (layout, folder) in KITTI.items():
        if (root / folder).is_dir():
            yield read_kitti(name, layout, root / folder)
        else:
            yield f"{name}: skipped, there is no {folder} in the data folder (set LANE_DP_DATA to it)."
    yield rendered()


def measure(timings: list[Timing], frames: int) -> None:
    """Measure all; they take turns, so that whatever else runs on the machine meets them all."""
    for timing in timings:
        for pair in timing.source.pairs[:WARM_UP]:
            Timing(timing.source, timing.preset).add(pair)
    for i in progress(range(frames), frames, "round"):
        for timing in timings:
            timing.add(timing.source.pairs[i % len(timing.source.pairs)])


def ratios(root: Path, rounds: int) -> str:
    """Measure the detector beside full-resolution matchers; return a table."""
    labels = root / "labels" / "lanes.json"
    pairs: list[CameraPair] = []
    if labels.is_file():
        pairs = [(pair.camera, pair.frame) for pair in labelled_pairs(root, labels)]
    else:
        source = rendered()
        pairs = [(source.camera, frame.grey()) for frame in source.pairs]
    what = f"{len(pairs)} {'labelled KITTI' if labels.is_file() else 'rendered'} pairs, {rounds} times each"
    lines = measure_ratios(pairs, rounds).lines()
    return "\n".join(["## Beside a full-resolution stereo matcher", "", *lines, "", f"{what}. {RATIO}"])


def table(timings: list[Timing]) -> Iterator[str]:
    """Yield the table of one preset in markdown, line by line: a stage a line, a source a column."""
    columns = [timing.source for timing in timings]
    yield "| stage | " + " | ".join(f"{source.name}, {source.kind}" for source in columns) + " |"
    yield "|---|" + "---|" * len(columns)
    for stage in timings[0].seconds:
        cells = (cell(timing.seconds.get(stage, [0.0]), timing) for timing in timings)
        yield f"| {stage} | " + " | ".join(cells) + " |"
    yield "| whole frame | " + " | ".join(cell(timing.whole, timing) for timing in timings) + " |"
    yield "| frames/s, as it passed | " + " | ".join(f"{timing.rate:.1f}" for timing in timings) + " |"
    yield "| **frames/s of core time** | " + " | ".join(f"**{t.core_rate:.1f}**" for t in timings) + " |"


def cell(seconds: list[float], timing: Timing) -> str:
    """Return median, 95th percentile and share of the whole time."""
    median, late = 1e3 * np.percentile(seconds, [50, 95])
    return f"{median:.1f} / {late:.1f} / {timing.share(seconds):.0%}"


def report(timings: list[Timing], skipped: list[str]) -> str:
    """Return the tables and what one must know to read them."""
    lines = []
    for name in PRESETS:
        lines += [f"## Preset {name}", "", *table([t for t in timings if t.preset == name]), ""]
    slowest = min((t for t in timings if t.preset == "default"), key=lambda t: t.core_rate)
    had = sum(t.processor for t in timings) / sum(sum(t.whole) for t in timings)
    lines.append(
        f"""\
The default does at least **{slowest.core_rate:.1f} frames/s** on one core ({slowest.source.name}; wanted: {WANTED_RATE}).

Cells: median ms / 95th percentile ms / share of the time. One core: one thread, bound to a core. {len(timings[0].whole)} frames each
after {WARM_UP} to warm up, up to {DIFFERENT_PAIRS} different pairs in turn.
"{REST}": between the stages, such as colour to grey. This process had its core for {had:.0%} of the time; the rest went to
other processes, and is in the milliseconds, but not in the core time.
"""  # noqa: E501 (numbers take the place of expressions)
    )
    return "\n".join([*lines, *skipped])


def draw(timings: list[Timing], path: Path) -> None:
    """Draw a bar for each preset and source, its stages one after the other.

    It is as long as the core's time of a frame: what others do on the machine hardly shows in it.
    """
    figure = Figure(figsize=(9, 1.8 + 0.5 * len(timings)), layout="constrained")
    axes = figure.add_subplot()
    names = [f"{timing.source.name}\n{timing.preset}" for timing in timings]
    end = np.zeros(len(timings))
    for stage in timings[0].seconds:
        lengths = [1e3 / t.core_rate * t.share(t.seconds.get(stage, [0.0])) for t in timings]
        axes.barh(names, lengths, left=end, label=stage.replace("_", " "), height=0.7)
        end += lengths
    wanted = 1e3 / WANTED_RATE
    axes.axvline(wanted, color="black", linestyle=":")
    axes.text(wanted, -0.62, f" {WANTED_RATE} frames/s", va="bottom", fontsize=9)
    ground = {"facecolor": "white", "edgecolor": "none", "pad": 1}  # over the dotted line
    for row, timing in enumerate(timings):
        axes.text(end[row] + 0.6, row, f"{timing.core_rate:.0f} frames/s", va="center", bbox=ground)
    axes.set(
        xlabel="core time of a frame, by the shares of the stages [ms]",
        xlim=(0, max(wanted, end.max()) * 1.25),
    )
    axes.set_ylim(len(timings) - 0.5, -1.0)
    figure.legend(loc="outside upper center", ncols=4, frameon=False)
    figure.savefig(path, dpi=120)


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables, write them and the picture."""
    arguments.output.mkdir(parents=True, exist_ok=True)
    stay_on_one_core()
    root = data_folder()
    there = list(sources(root))
    timings = [Timing(source, name) for name in PRESETS for source in there if isinstance(source, Source)]
    measure(timings, arguments.frames)
    stages = report(timings, [line for line in there if isinstance(line, str)])
    text = f"{stages.rstrip()}\n\n{ratios(root, arguments.rounds)}"
    (arguments.output / "pipeline.md").write_text(f"# The whole pipeline, stage by stage\n\n{text}\n")
    draw(timings, arguments.output / "pipeline.png")
    print(text)


def _count(text: str) -> int:
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError(f"{text}: expected at least 1")
    return count


def main() -> int:
    """Measure and print; 1 for a known error, in one line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("bench"), help="default: bench")
    parser.add_argument(
        "--frames", type=_count, default=30, metavar="N", help="of each preset and source (default: 30)"
    )
    parser.add_argument(
        "--rounds", type=_count, default=3, metavar="N", help="of the ratios to a matcher (default: 3)"
    )
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
