# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The file of judgements: written whole at every change, and never by two processes at once."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from lane_dp_ros.messages.errors import CommandError, one_line
from lane_dp_ros.review.judgement import Judgement, judgement_from_json, judgement_to_json

FORMAT = "lane_dp review 1"
KEPT_UNDOS = 200


class ReviewFile:
    """The judgements of a drive, by stamp [ns], and how to undo the last ones.

    Every change is on disk when the call returns; where that fails (OSError) nothing has changed.
    Raises CommandError, and leaves the file alone, when it is damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lanes: str | None = None
        self.judgements: dict[int, Judgement] = {}
        self._undo: list[tuple[int, Judgement]] = []
        if os.path.lexists(path):
            self._load()

    def use_for(self, lanes: str) -> None:
        """Bind the file to the lanes that are judged, by a fingerprint of them.

        Raises CommandError when it was made for others: what was said of those would not hold for these.
        """
        if self._lanes not in (None, lanes):
            raise CommandError(
                f"{self.path} judges other lanes than these (detected anew?): give it the lanes that it was "
                "made with, or begin a file of its own with --review FILE"
            )
        self._lanes = lanes

    def judgement(self, stamp_ns: int) -> Judgement:
        """Return what was said of a frame."""
        return self.judgements.get(stamp_ns, Judgement())

    def change(self, stamp_ns: int, judgement: Judgement) -> None:
        """Take a judgement in."""
        self.change_all({stamp_ns: judgement})

    def change_all(self, judgements: Mapping[int, Judgement]) -> int:
        """Take judgements by stamp in, all or none; return how many are new. Each is undone by itself."""
        new = {stamp: each for stamp, each in judgements.items() if each != self.judgement(stamp)}
        if new:
            undo = [*self._undo, *((stamp, self.judgement(stamp)) for stamp in new)][-KEPT_UNDOS:]
            self._keep({**self.judgements, **new}, undo)
        return len(new)

    def undo(self) -> int | None:
        """Take the last change back; return the stamp of its frame, None when there is none."""
        if not self._undo:
            return None
        stamp_ns, before = self._undo[-1]
        self._keep({**self.judgements, stamp_ns: before}, self._undo[:-1])
        return stamp_ns

    def _keep(self, judgements: dict[int, Judgement], undo: list[tuple[int, Judgement]]) -> None:
        kept = {stamp: each for stamp, each in judgements.items() if each != Judgement()}
        content = {
            "format": FORMAT,
            "lanes": self._lanes,
            "judgements": {str(stamp): judgement_to_json(each) for stamp, each in sorted(kept.items())},
            "undo": [[str(stamp), judgement_to_json(each)] for stamp, each in undo],
        }
        write_safely(self.path, json.dumps(content, indent=1) + "\n")
        self.judgements, self._undo = kept, undo

    def _load(self) -> None:
        try:
            content = json.loads(self.path.read_text())
            self._read(content)
        except OSError as error:
            raise CommandError(f"cannot read {self.path}: {one_line(error)}") from None
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            what = f"{error} is missing" if isinstance(error, KeyError) else one_line(error)
            hint = "repair it, or move it away to begin anew"
            raise CommandError(f"{self.path} is no whole file of judgements: {what}; {hint}") from None

    def _read(self, content: dict[str, Any]) -> None:
        if content["format"] != FORMAT:
            raise ValueError(f"format is {content['format']!r}, expected {FORMAT!r}")
        judgements = content["judgements"].items()
        self.judgements = {int(stamp): judgement_from_json(fields) for stamp, fields in judgements}
        self._undo = [(int(stamp), judgement_from_json(fields)) for stamp, fields in content["undo"]]
        self._lanes = str(content["lanes"])


def write_safely(path: Path, text: str) -> None:
    """Replace a file by one that is wholly on disk: after a power cut there is the old or the new one."""
    beside = path.with_name(f".{path.name}.part")
    try:
        with beside.open("w") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise
    _sync_folder(path.parent)


def _sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other processes from reviewing into the same file, by a lock file beside it.

    The lock is the system's (flock): it ends with the process, however that ends, and a lock file left
    behind is no hindrance. Raises CommandError when another process has it or nothing can be written here.
    """
    lock = path.with_name(f"{path.name}.lock")
    try:
        handle = _lock(lock)
    except BlockingIOError:
        who = lock.read_text().strip() or "another process"
        raise CommandError(f"{path} is being written by {who}: one review at a time") from None
    except OSError as error:
        raise CommandError(
            f"cannot write {path}: {one_line(error)}; --review FILE names another place"
        ) from None
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)  # while it is still ours
        os.close(handle)


def _lock(lock: Path) -> int:
    """Return a handle that holds the lock; the file may be removed by its last owner while we open it."""
    while True:
        handle = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if lock.exists() and os.path.samestat(os.fstat(handle), lock.stat()):
                os.ftruncate(handle, 0)
                os.write(handle, f"process {os.getpid()}\n".encode())
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)
