# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""A page that needs nothing but itself, from the files in static/: written whole, replacing only its like."""

from __future__ import annotations

import os
from contextlib import suppress
from importlib import resources
from pathlib import Path
from string import Template

from lane_dp_ros.messages.errors import CommandError

PAGE = "index.html"
GENERATOR = '<meta name="generator" content="lane_dp evaluate --report">'  # by which an earlier page is known
HEAD_BYTES = 2000  # it stands within
SHARED = {  # what templates take in
    "css": "report.css",
    "legend": "legend.html",
    "dialog": "dialog.html",
    "sorting": "tables.js",
    "enlarging": "pictures.js",
}


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


def write_page(template: str, directory: Path, **parts: str) -> Path:
    """Write a template of static/, filled with `parts`, to `directory`/index.html and return its path.

    The page appears complete or not at all. Raises CommandError where it cannot be written.
    """
    shared = {name: _static_text(file) for name, file in SHARED.items()}
    page = Template(_static_text(template)).substitute(generator=GENERATOR, **shared, **parts)
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


def _static_text(name: str) -> str:
    text = (resources.files("lane_dp_ros.tools.report") / "static" / name).read_text(encoding="utf-8")
    return text.strip()
