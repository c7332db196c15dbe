# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate --report DIR: one page that needs nothing but itself."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import suppress
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

from lane_dp_ros.core.config import DetectorConfig
from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.evaluation.annotations import LabelledFrame
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.evaluation.summary import summarise
from lane_dp_ros.tools.progress import progress
from lane_dp_ros.tools.report.cards import card
from lane_dp_ros.tools.report.failures import failures, worst_first
from lane_dp_ros.tools.report.frame_images import frame_images
from lane_dp_ros.tools.report.plots import plots
from lane_dp_ros.tools.report.tables import reasons, tables, tiles

PAGE = "index.html"
GENERATOR = '<meta name="generator" content="lane_dp evaluate --report">'  # by which an earlier page is known
HEAD_BYTES = 2000  # it stands within
GALLERY = 30  # frames


def write_report(
    results: Sequence[FrameScore],
    frames: Sequence[LabelledFrame],
    source: Path,
    directory: Path,
    config: DetectorConfig | None = None,
    topics: TopicChoice | None = None,
) -> Path:
    """Write the page of an evaluation to `directory`/index.html, with a progress bar; return its path.

    `frames` is the truth, empty for a road known to have no paint; `source` the bag or folder that was
    judged, from which the worst frames' images come, those of a bag from `topics`; `config` what the detector
    looks at them with once more. Raises CommandError where the page cannot be written, see
    `check_report_output`.
    """
    check_report_output(directory)
    truth = {frame.name: frame for frame in frames}
    worst = [(result, truth.get(result.name)) for result in worst_first(results)[:GALLERY]]
    places = {result.name: place for place, (result, _) in enumerate(worst, 1)}
    cards: dict[int, str] = {}
    found = frame_images(source, worst, config or DetectorConfig(), topics)
    for (result, frame), images in progress(found, len(worst), "frame"):
        place = places[result.name]
        cards[place] = card(place, result, frame, images)
    parameters = "the detector's default parameters" if config is None else "the parameters given"
    page = _page(results, source, [cards[place] for place in sorted(cards)], parameters)
    return write_page(page, directory)


def check_report_output(directory: Path) -> None:
    """Raise CommandError when a report in `directory` would overwrite what is no report."""
    if directory.exists() and not directory.is_dir():
        raise CommandError(f"{directory} is no folder: --report takes the name of one")
    page = directory / PAGE
    if not page.exists():
        return
    with page.open("rb") as file:
        if GENERATOR.encode() not in file.read(HEAD_BYTES):
            raise CommandError(f"{page} exists already and is no report: choose another folder for --report")


def _page(results: Sequence[FrameScore], source: Path, cards: Sequence[str], parameters: str) -> str:
    total = summarise(results)
    name = source.resolve().name
    return Template(static_text("page.html")).substitute(
        generator=GENERATOR,
        title=escape(name),
        about=f"{total.frames} frames, {total.labels} lines to find, {total.detections} lines published",
        css=static_text("report.css"),
        script=static_text("report.js"),
        tiles=tiles(total),
        tables=tables(results),
        plots=plots(results),
        reasons=reasons(results),
        gallery_size=_gallery_size(results, len(cards)),
        parameters=parameters,
        cards="\n".join(cards) or "<p>No frame was judged.</p>",
    )


def _gallery_size(results: Sequence[FrameScore], shown: int) -> str:
    failing = sum(bool(failures(result)) for result in results)
    if failing > shown:
        return f"{failing} of {len(results)} frames have a failure; these are the {shown} worst."
    rest = f"; the {shown - failing} with the largest error follow" if failing < shown else ""
    return f"{failing} of {len(results)} frames have a failure{rest}."


def static_text(name: str) -> str:
    """Return a file of the folder static/."""
    text = (resources.files("lane_dp_ros.tools.report") / "static" / name).read_text(encoding="utf-8")
    return text.strip()


def write_page(page: str, directory: Path) -> Path:
    """Write the page to `directory`/index.html; it appears complete or not at all."""
    path, part = directory / PAGE, directory / f".{PAGE}.{os.getpid()}.part"
    try:
        directory.mkdir(parents=True, exist_ok=True)
        part.write_text(page, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise CommandError(f"cannot write {path}: {error.strerror}") from None
    finally:
        with suppress(OSError):  # where nothing can be written, nothing is left
            part.unlink()
    return path
