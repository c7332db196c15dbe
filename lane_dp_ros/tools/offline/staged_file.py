# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A file that appears at its place only when it is complete."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from lane_dp_ros.messages.bag_output import Staging, check_file_output
from lane_dp_ros.messages.errors import CommandError, reason


@contextmanager
def staged_file(path: Path, force: bool = False) -> Iterator[Path]:
    """Open the path under which to write a file that is moved to `path` when the block ends well.

    Raises CommandError when `path` exists (unless `force`, and then only a file is replaced) or cannot be
    written.
    """
    check_file_output(path, force)
    staging = Staging(path, force)
    try:
        with _writable(path):
            staging.make()
        written = staging.folder / path.name
        yield written
        with _writable(path):
            staging.publish(written)
    finally:
        staging.discard()


@contextmanager
def _writable(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise CommandError(f"cannot write {path}: {reason(error)}") from error
