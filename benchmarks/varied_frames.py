# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""How much of the numbers on the labelled frames holds in a mirror and at other exposures.

python benchmarks/varied_frames.py DATA [--jobs N]
DATA: the labelled KITTI frames. Prints the verdicts on them by the default parameters as they are, and as
they could have been taken as well, see varied_pairs.py.
"""

from __future__ import annotations

import argparse
import sys

from command_line import exit_code, parser_of
from study_runner import Judges, labelled_pairs
from varied_pairs import GAMMAS, exposed, mirrored

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.evaluation.text import COLUMNS_OF_FRAMES, table
from lane_dp_ros.tools.parallel import available_cpus


def run(arguments: argparse.Namespace) -> None:
    """Judge the frames in each way, and print."""
    pairs = labelled_pairs(arguments.data, arguments.data / "labels" / "lanes.json")
    ways = {"as they are": pairs, "in a mirror": [mirrored(pair) for pair in pairs]}
    for gamma in GAMMAS:
        ways[f"gamma {gamma:g}"] = [exposed(pair, gamma) for pair in pairs]
        ways[f"in a mirror, gamma {gamma:g}"] = [exposed(mirrored(pair), gamma) for pair in pairs]
    with Judges([pair for way in ways.values() for pair in way], arguments.jobs, alone=True) as judges:
        results = {result.name: result for result in judges.results(DetectorConfig())}
    summaries = {name: summarise(results[pair.name] for pair in way) for name, way in ways.items()}
    print(table("the labelled frames", summaries, COLUMNS_OF_FRAMES))


def main() -> int:
    """Judge and print; 1 for a known error, in one line."""
    parser = parser_of(__doc__)
    parser.add_argument("--jobs", type=int, default=available_cpus(), metavar="N")
    return exit_code(run, parser.parse_args())


if __name__ == "__main__":
    sys.exit(main())
