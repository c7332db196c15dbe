# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The archives that annotation tools hand out and take: annotations, and the pictures beside them."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from lane_dp_ros.messages.errors import CommandError, one_line

ANNOTATIONS = "annotations.xml"  # of CVAT
LARGEST = 500_000_000  # bytes of annotations


def read_annotations(path: Path) -> str:
    """Return the text of a file of annotations, or of the only one in an archive of them.

    Raises CommandError where it cannot be read.
    """
    try:
        data = _from_zip(path) if zipfile.is_zipfile(path) else path.read_bytes()
        return data.decode("utf-8")
    except UnicodeDecodeError:
        raise CommandError(f"{path} is no text (UTF-8): expected COCO's JSON or CVAT's XML") from None
    except (OSError, RuntimeError, NotImplementedError, zipfile.BadZipFile) as error:
        raise CommandError(f"cannot read {path}: {one_line(error)}") from None


def write_cvat_zip(path: Path, text: str, pictures: Iterable[tuple[str, bytes]]) -> None:
    """Write CVAT's XML and named pictures (JPEG) to an archive. Raises OSError where it cannot be written."""
    with zipfile.ZipFile(path, "x") as archive:
        archive.writestr(ANNOTATIONS, text, zipfile.ZIP_DEFLATED)
        for name, picture in pictures:
            archive.writestr(f"images/{name}", picture)


def _from_zip(path: Path) -> bytes:
    with zipfile.ZipFile(path) as archive:
        found = [
            each for each in archive.infolist() if PurePosixPath(each.filename).suffix in (".xml", ".json")
        ]
        if len(found) != 1:
            names = ", ".join(each.filename for each in found[:5]) or "none"
            raise CommandError(
                f"{path}: expected one file of annotations (.xml, .json) in it, it has {names}"
            )
        with archive.open(found[0]) as file:
            data = file.read(LARGEST + 1)  # what the archive says of its size may be wrong
    if len(data) > LARGEST:
        raise CommandError(f"{path}: {found[0].filename} is larger than {LARGEST} bytes")
    return data
