# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""lane_dp evaluate --compare A B --report DIR: one page about what got better and what worse."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from lane_dp_ros.messages.topic_choice import TopicChoice
from lane_dp_ros.tools.evaluation.changes import Comparison, FrameChange
from lane_dp_ros.tools.evaluation.changes_text import (
    change_text,
    difference_text,
    frames_told,
    group_differences,
    total_differences,
)
from lane_dp_ros.tools.evaluation.measures import Difference
from lane_dp_ros.tools.evaluation.scores import FrameScore
from lane_dp_ros.tools.progress import progress
from lane_dp_ros.tools.report.changes_plots import changes_plots
from lane_dp_ros.tools.report.frame_images import FrameImages, frame_images
from lane_dp_ros.tools.report.html_table import Cell, Marked, html_table
from lane_dp_ros.tools.report.page_file import check_report_output, write_page
from lane_dp_ros.tools.report.pictures import image_lines, left_picture, plan

GALLERY, NOT_BETTER = 30, 20  # frames that are shown; no more of them that got no better
SIDE_BYTES = 90_000  # of a picture; there are two to a frame


def write_changes_report(
    comparison: Comparison,
    names: tuple[Path, Path],
    source: Path | None,
    directory: Path,
    topics: TopicChoice | None = None,
) -> Path:
    """Write the page of a comparison to `directory`/index.html, with a progress bar; return its path.

    `names` are the files that were compared; `source` is the bag or folder with the images, None where it is
    not known, `topics` those of a bag's stereo camera. Raises CommandError where the page cannot be written,
    see `check_report_output`.
    """
    check_report_output(directory)
    shown = _shown(comparison)
    places = {change.after.name: place for place, change in enumerate(shown, 1)}
    cards = [""] * len(shown)
    found = _images(source, [change.after for change in shown], topics)
    for result, images in progress(found, len(shown), "frame"):
        i = places[result.name] - 1
        cards[i] = _card(i + 1, shown[i], images)
    return write_page(
        "changes.html",
        directory,
        title=escape(f"{names[0].name} and {names[1].name}"),
        about=f"A is {escape(str(names[0]))}, B is {escape(str(names[1]))}.",
        notes="".join(f"<p>Note: {escape(note)}.</p>" for note in comparison.notes),
        tiles="".join(map(_tile, total_differences(comparison))),
        frames_told=frames_told(comparison),
        frames=_frames(comparison, places),
        plots=changes_plots(comparison),
        cards="\n".join(cards) or "<p>No frame changed.</p>",
        tables=_tables(comparison),
    )


def _shown(comparison: Comparison) -> list[FrameChange]:
    """Return the frames to show: the worst first, then the best, some of both."""
    not_better = [*comparison.worse, *comparison.mixed]
    return [*not_better[:NOT_BETTER], *comparison.better][:GALLERY]


def _images(
    source: Path | None, results: Sequence[FrameScore], topics: TopicChoice | None
) -> Iterator[tuple[FrameScore, FrameImages]]:
    if source is not None and source.exists():
        yield from frame_images(source, results, None, topics)
        return
    where = "" if source is None else f"{source} is not there; "
    note = f"no images: {where}name the bag or folder before --compare"
    yield from ((result, FrameImages(note=note)) for result in results)


def _tile(difference: Difference) -> str:
    """Return a tile of a measure that is told of groups, too; nothing of others."""
    if not difference.measure.by_group:
        return ""
    before, after = difference.texts
    was = f"was {before}" + (f" ({change_text(difference)})" if difference.verdict else "")
    return (
        f'<div class="tile {difference.verdict}"><b>{after}</b><span>{difference.measure.name}</span>'
        f"<small>{was}</small></div>"
    )


def _frames(comparison: Comparison, places: dict[str, int]) -> str:
    """Return the table of all frames that changed; those that are shown lead to their pictures."""
    changes = [*comparison.worse, *comparison.mixed, *comparison.better]
    rows: dict[str, list[Cell]] = {
        change.after.name: [
            Marked(_verdict(change), _style(change), change.gain),
            Marked("; ".join(change.worse) or "-", "prose"),
            Marked("; ".join(change.better) or "-", "prose"),
            Marked(change.after.category or "-", "word"),
        ]
        for change in changes
    }
    links = {name: f"#frame-{place}" for name, place in places.items()}
    return html_table("frame", ["on the whole", "worse", "better", "category"], rows, links)


def _verdict(change: FrameChange) -> str:
    return "better" if change.gain > 0 else "worse" if change.gain < 0 else "both"


def _style(change: FrameChange) -> str:
    return "" if change.gain == 0 else _verdict(change)


def _card(place: int, change: FrameChange, images: FrameImages) -> str:
    """Return a frame as HTML: the pictures of before and after side by side, and what changed in words."""
    note = f'<p class="note">{escape(images.note)}</p>' if images.note else ""
    words = "".join(
        f'<li class="{"false" if gain < 0 else "right"}">{escape(text)}</li>'
        for gain, texts in ((-1, change.worse), (1, change.better))
        for text in texts
    )
    return (
        f'<article class="frame" id="frame-{place}"><header><h3>{place}. {escape(change.after.name)}</h3>'
        f'<span class="badge {"right" if change.gain > 0 else "false"}">{_verdict(change)}</span>'
        f'<span class="category">{escape(change.after.category)}</span></header>{note}'
        f'<div class="pictures sides">{_picture("A", change.before, images)}'
        f'{_picture("B", change.after, images)}</div><div class="words"><ul>{words}</ul></div></article>'
    )


def _picture(title: str, result: FrameScore, images: FrameImages) -> str:
    camera = result.camera or images.camera
    if images.left is None or camera is None:
        return plan(result, title)
    return left_picture(images.left, image_lines(result, camera), title, SIDE_BYTES)


def _tables(comparison: Comparison) -> str:
    total: dict[str, list[Cell]] = {
        difference.measure.name: [
            *difference.texts,
            Marked(change_text(difference) or "-", difference.verdict, difference.change),
        ]
        for difference in total_differences(comparison)
    }
    groups = "".join(
        f"<section><h3>By {title}</h3>{_group_table(title, rows)}</section>"
        for title, rows in group_differences(comparison).items()
    )
    return f"<section><h3>Total</h3>{html_table('measure', ['A', 'B', 'change'], total)}</section>{groups}"


def _group_table(title: str, rows: dict[str, list[Difference]]) -> str:
    heads = [difference.measure.name for difference in next(iter(rows.values()))]
    cells: dict[str, list[Cell]] = {
        name: [Marked(difference_text(each).rstrip(" +!"), each.verdict, each.change) for each in row]
        for name, row in rows.items()
    }
    return html_table(title, heads, cells)
