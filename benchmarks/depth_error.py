# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the depth error over distance of several evaluations in one picture: before and after a change.

python benchmarks/depth_error.py before=before.json after=after.json -o depth_error.svg
The files are what `lane_dp evaluate --json` writes, with --surface or by labels; up to four.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from command_line import exit_code

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.tools.evaluation.depth import DepthCurve
from lane_dp_ros.tools.evaluation.json_file import FORMAT
from lane_dp_ros.tools.report.chart import Chart
from lane_dp_ros.tools.report.depth_plot import SERIES, depth_chart

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")  # Okabe and Ito's
CSS = (
    "svg { background: #fff; font: 12px sans-serif; } text { fill: #444; } .value { font-weight: bold; } "
    ".grid { stroke: #ddd; } .axis, .tick { stroke: #666; } .series { fill: none; stroke-width: 2; } "
    ".ideal { fill: none; stroke: #666; stroke-dasharray: 3 4; } .band { opacity: .2; } "
) + " ".join(
    f".series.{style} {{ stroke: {colour}; }} .band.{style}, .value.{style} {{ fill: {colour}; }}"
    for style, colour in zip(SERIES, COLOURS, strict=True)
)


def curve_of(path: Path) -> DepthCurve:
    """Return the depth errors over distance of a file's total.

    Raises CommandError for a file that is no evaluation, or one in which no surface was judged.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CommandError(f"{path} cannot be read as JSON: {error}") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise CommandError(f"{path} is no evaluation, expected what lane_dp evaluate --json writes")
    points = content.get("total", {}).get("depth", {}).get("curve", [])
    if not any(point["frames"] for point in points):
        raise CommandError(f"{path} has no depth errors: no surface was judged there")
    depths, bias, low, high = (_column(points, key) for key in ("depth", "bias", "low", "high"))
    return DepthCurve(depths, bias, low, high, np.array([point["frames"] for point in points]))


def _column(points: Sequence[Mapping[str, Any]], key: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return a number of each point, NaN where there is none."""
    return np.array([point[key] for point in points], dtype=np.float64)


def picture(curves: Mapping[str, DepthCurve]) -> str:
    """Return the curves as an SVG file; above are their names and the largest number of frames."""
    chart: Chart = depth_chart(list(curves.values()))
    for i, (style, (name, curve)) in enumerate(zip(SERIES, curves.items(), strict=False)):
        x = chart.x.low + (i + 0.5) / len(curves) * (chart.x.high - chart.x.low)
        chart.text(x, chart.y.high, f"{name} ({int(curve.counts.max())})", f"value {style}", lift=8)
    return chart.document(CSS)


def named_file(text: str) -> tuple[str, Path]:
    """Return name and path of an argument NAME=FILE."""
    name, equals, path = text.partition("=")
    if not (name and equals and path):
        raise argparse.ArgumentTypeError(f"{text} is no NAME=FILE")
    return name, Path(path)


def main() -> int:
    """Draw; 1 for a known error, in one line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("evaluations", nargs="+", type=named_file, metavar="NAME=FILE")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE.svg")
    return exit_code(run, parser.parse_args())


def run(arguments: argparse.Namespace) -> None:
    """Read the files, write the picture."""
    curves = {name: curve_of(path) for name, path in arguments.evaluations}
    if len(curves) < len(arguments.evaluations):
        raise CommandError("two evaluations bear the same name, expected names of their own")
    arguments.output.write_text(picture(curves), encoding="utf-8")
    print(f"{arguments.output}: {', '.join(curves)}")


if __name__ == "__main__":
    sys.exit(main())
