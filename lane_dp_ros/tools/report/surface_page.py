# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate --surface DIR --report DIR: one page about the depth of the road's surface alone."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.report.page_file import check_report_output, write_page
from lane_dp_ros.tools.report.plots import surface_plots
from lane_dp_ros.tools.report.tables import depth_table, frames_by_depth_error


def write_surface_report(results: Sequence[FrameScore], source: Path, directory: Path) -> Path:
    """Write the page of an evaluation of surfaces to `directory`/index.html and return its path.

    Raises CommandError where the page cannot be written, see `check_report_output`.
    """
    check_report_output(directory)
    missing = sum(result.depth is not None and not result.depth.measured for result in results)
    return write_page(
        "surface.html",
        directory,
        title=escape(source.resolve().name),
        about=f"{len(results)} frames, {missing} of them without a surface",
        table=depth_table(results),
        plots=surface_plots(results),
        frames=frames_by_depth_error(results),
    )
