# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks and says, as JSON's types: the review of one drive."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from lane_dp_ros.core.types import Lane
from lane_dp_ros.messages.pictures import GAP
from lane_dp_ros.review.drive import Drive, Frame
from lane_dp_ros.review.exchange import FORMATS, frame_name, lines_as_text, lines_from_text
from lane_dp_ros.review.judgement import (
    SIDES,
    Judgement,
    Line,
    Table,
    lines_from_json,
    lines_to_json,
    table_of,
    verdict_from_json,
)
from lane_dp_ros.review.lines_as_truth import NEAREST, Grounds, detected_lines, image_points, known
from lane_dp_ros.review.review_file import ReviewFile
from lane_dp_ros.tools.evaluation.truth_file import LabelledFrame, save_truth

JPEG_QUALITY = 95


@dataclass
class Review:
    """A drive and what was said of it; safe to be called from several threads.

    The methods take and return JSON's types. They raise ValueError, or LookupError for a frame that is not
    there, when the page asks what cannot be, and OSError when a change cannot be saved.
    """

    drive: Drive
    file: ReviewFile
    grounds: Grounds
    _lock: threading.RLock = field(default_factory=threading.RLock)

    @property
    def table(self) -> Table:
        """The paper's table of what was judged so far."""
        return table_of(self._judgement(frame) for frame in self.drive.frames)

    def overview(self) -> dict[str, Any]:
        """Return the drive's name, the verdicts of every frame, and the table."""
        with self._lock:
            verdicts = [self._verdicts(frame) for frame in self.drive.frames]
            file = str(self.file.path)
            return {"name": self.drive.name, "frames": verdicts, "table": self._table(), "file": file}

    def frame(self, index: int) -> dict[str, Any]:
        """Return a frame's stamp, verdicts, detected lanes, and its lines to be corrected."""
        frame = self._frame(index)
        return {
            "index": index,
            "size": list(frame.size),
            "stamp": f"{frame.stamp_ns / 1e9:.3f}",
            "verdicts": self._verdicts(frame),
            "lanes": [_drawn(lane, frame) for lane in frame.lanes],
            "lines": lines_to_json(self._lines(frame)),
            "corrected": self._judgement(frame).lines is not None,
        }

    def picture(self, index: int) -> bytes:
        """Return a frame's left image as JPEG."""
        image = self.drive.image(self._frame(index))
        return bytes(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1])

    def pictures(self) -> Iterator[tuple[str, bytes]]:
        """Yield name and picture, as JPEG, of every frame that has a picture that can be read."""
        for frame in self.drive.frames:
            with suppress(ValueError):
                yield frame_name(self.drive, frame), self.picture(frame.index)

    def judge(self, index: int, verdicts: Any) -> dict[str, Any]:
        """Take verdicts in, of one side or of both at once: {"left": "correct"}."""
        frame = self._frame(index)
        if not isinstance(verdicts, dict) or not verdicts or not verdicts.keys() <= set(SIDES):
            raise ValueError(f"verdicts are {verdicts!r}, expected an object of left, right or both")
        said: dict[str, Any] = {side: verdict_from_json(value) for side, value in verdicts.items()}
        roles = {lane.role for lane in frame.lanes}
        for side, verdict in said.items():
            if f"ego_{side}" not in roles and verdict in ("correct", "incorrect"):
                raise ValueError(f"no line was detected {side}: it was missed, or there is no marking")
        with self._lock:
            return self._change(frame, replace(self._judgement(frame), **said))

    def correct(self, index: int, lines: Any) -> dict[str, Any]:
        """Take a frame's corrected lines in; None returns to the detected ones."""
        frame = self._frame(index)
        parsed = None if lines is None else lines_from_json(lines)
        with self._lock:
            return self._change(frame, replace(self._judgement(frame), lines=parsed))

    def undo(self) -> dict[str, Any]:
        """Take the last change back; "index" is None when there was none."""
        with self._lock:
            stamp = self.file.undo()
            changed = next((frame for frame in self.drive.frames if frame.stamp_ns == stamp), None)
            return {"index": None} if changed is None else self._said_of(changed)

    def truth(self) -> tuple[tuple[LabelledFrame, ...], dict[int, str]]:
        """Return the frames that are known, and why the other ones that were judged are not, by index."""
        frames, problems = [], {}
        for frame in self.drive.frames:
            if (judgement := self._judgement(frame)) != Judgement():
                found = known(self.drive, frame, judgement, self.grounds)
                if found.frame is None:
                    problems[frame.index] = found.problem
                else:
                    frames.append(found.frame)
        return tuple(frames), problems

    def export(self) -> dict[str, Any]:
        """Return the truth as the text of a file, its name, and what was left out and why."""
        frames, problems = self.truth()
        left_out = [f"frame {index + 1}: {problem}" for index, problem in problems.items()]
        with tempfile.TemporaryDirectory() as folder:
            save_truth(frames, path := Path(folder) / f"{self.drive.name}.truth.json")
            return {"name": path.name, "text": path.read_text(), "frames": len(frames), "left_out": left_out}

    def export_lines(self, form: str) -> dict[str, Any]:
        """Return the lines of every frame, corrected or as detected, as the text of a file and its name."""
        with self._lock:
            lines = {frame.index: self._lines(frame) for frame in self.drive.frames}
        text = lines_as_text(self.drive, lines, form)
        return {"name": f"{self.drive.name}.{form}{FORMATS[form]}", "text": text, "frames": len(lines)}

    def import_lines(self, text: Any) -> dict[str, Any]:
        """Take the lines of an annotation tool's file in, all or none of them.

        An image of the file that has none has no lines; what is no image of it stays as it is. So does a
        frame whose lines are the same.
        """
        if not isinstance(text, str):
            raise ValueError("expected the text of a file")
        found, left_out = lines_from_text(self.drive, text)
        with self._lock:
            changes = {
                frame.stamp_ns: replace(self._judgement(frame), lines=found[frame.index])
                for frame in self.drive.frames
                if frame.index in found and found[frame.index] != self._lines(frame)
            }
            return {"images": len(found), "changed": self.file.change_all(changes), "left_out": left_out}

    def _lines(self, frame: Frame) -> tuple[Line, ...]:
        """Return the lines of a frame: as corrected, else as detected."""
        judgement = self._judgement(frame)
        return detected_lines(frame) if judgement.lines is None else judgement.lines

    def _frame(self, index: int) -> Frame:
        if not 0 <= index < len(self.drive.frames):
            raise LookupError(f"frame {index} is not there: 0 to {len(self.drive.frames) - 1} are")
        return self.drive.frames[index]

    def _judgement(self, frame: Frame) -> Judgement:
        return self.file.judgement(frame.stamp_ns)

    def _verdicts(self, frame: Frame) -> dict[str, str | None]:
        judgement = self._judgement(frame)
        return {side: getattr(judgement, side) for side in SIDES}

    def _change(self, frame: Frame, judgement: Judgement) -> dict[str, Any]:
        self.file.change(frame.stamp_ns, judgement)
        return self._said_of(frame)

    def _said_of(self, frame: Frame) -> dict[str, Any]:
        return {"index": frame.index, "verdicts": self._verdicts(frame), "table": self._table()}

    def _table(self) -> dict[str, Any]:
        table = self.table
        return {
            "total": table.total,
            "incorrect": table.incorrect,
            "missed": table.missed,
            "precision": table.precision,
        }


def _drawn(lane: Lane, frame: Frame) -> dict[str, Any]:
    """Return a lane's points [u, v, half width] in px: a gap is left between the paint and its outline."""
    depth = lane.points[lane.points[:, 2] > NEAREST, 2]
    half = frame.camera.fx * (lane.paint_width / 2 + GAP) / depth
    points = np.column_stack([image_points(lane, frame.camera), half])
    return {"role": lane.role, "confidence": lane.confidence, "points": np.round(points, 2).tolist()}
