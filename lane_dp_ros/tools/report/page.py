# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate --report DIR: one page that needs nothing but itself."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.core.lanes.evidence_model import evidence_model
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.evaluation.causes import Cause, causes
from lane_dp_ros.tools.evaluation.failures import failures, worst_first
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.progress import progress
from lane_dp_ros.tools.report.cards import card
from lane_dp_ros.tools.report.failure_tables import reasons, stages, worst_frames
from lane_dp_ros.tools.report.frame_images import frame_images
from lane_dp_ros.tools.report.page_file import check_report_output, write_page
from lane_dp_ros.tools.report.plots import plots
from lane_dp_ros.tools.report.tables import tables, tiles

GALLERY = 30  # frames


def write_report(
    results: Sequence[FrameScore],
    source: Path,
    directory: Path,
    config: DetectorConfig | None = None,
    topics: TopicChoice | None = None,
) -> Path:
    """Write the page of an evaluation to `directory`/index.html, with a progress bar; return its path.

    `source` is the bag or folder that was judged, from which the worst frames' images come, in a bag from
    `topics`; `config` what the detector looks at them with once more. Raises CommandError where the page
    cannot be written, see `check_report_output`.
    """
    check_report_output(directory)
    worst = worst_first(results)[:GALLERY]
    detector = config or DetectorConfig()
    model = evidence_model(detector.lane_selection.evidence_model)
    cards, lost = [""] * len(worst), [dict[str, Cause]()] * len(worst)
    found = frame_images(source, worst, detector, topics)
    for result, images in progress(found, len(worst), "frame"):
        i = worst.index(result)
        if result.truth and images.camera and images.detection:
            lost[i] = causes(result.truth, images.camera, images.detection, model)
        cards[i] = card(i + 1, result, images, lost[i])
    return write_page(
        "page.html",
        directory,
        **_page_parts(results, source),
        worst=worst_frames(worst, lost),
        stages=stages(worst, lost),
        gallery_size=_gallery_size(results, len(cards)),
        parameters="the detector's default parameters" if config is None else "the parameters given",
        cards="\n".join(cards) or "<p>No frame was judged.</p>",
    )


def _page_parts(results: Sequence[FrameScore], source: Path) -> dict[str, str]:
    total = summarise(results)
    return {
        "title": escape(source.resolve().name),
        "about": f"{total.frames} frames, {total.labels} lines to find, {total.detections} lines published",
        "tiles": tiles(total),
        "tables": tables(results),
        "plots": plots(results),
        "reasons": reasons(results),
    }


def _gallery_size(results: Sequence[FrameScore], shown: int) -> str:
    failing = sum(bool(failures(result)) for result in results)
    if failing > shown:
        return f"{failing} of {len(results)} frames have a failure; these are the {shown} worst."
    rest = f"; the {shown - failing} with the largest error follow" if failing < shown else ""
    return f"{failing} of {len(results)} frames have a failure{rest}."
