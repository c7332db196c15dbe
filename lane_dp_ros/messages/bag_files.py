# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a bag: named by its metadata.yaml, or whatever lies in its folder."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from lane_dp_ros.messages.errors import CommandError
from lane_dp_ros.messages.unpacking import of_rosbags

STORAGE_ENDINGS = (".mcap", ".db3", ".mcap.zstd", ".db3.zstd")
BESIDE_STORAGE = (".db3-wal", ".db3-shm", ".db3-journal")  # what an SQLite recorder that was killed leaves
METADATA = "metadata.yaml"

_LOGGER = logging.getLogger(__name__)


class BagFiles(NamedTuple):
    """The files in which a bag is stored; `counted` are its messages by metadata.yaml, None: not said."""

    paths: list[Path]
    counted: int | None = None


def bag_files(path: Path) -> BagFiles:
    """Return the files in which a bag is stored: the path itself, or those in its folder.

    A file that metadata.yaml names and that is gone is warned of. Raises CommandError for a path that is no
    bag, or of whose files none is there.
    """
    if not path.exists():
        raise CommandError(f"{path}: no such bag")
    if path.is_file():
        return BagFiles([path])
    information = _information(path)
    count = information.get("message_count")
    counted = count if isinstance(count, int) else None
    there = sorted((each for each in path.iterdir() if _is_storage(each)), key=_numbered)
    named = [path / name for name in _named_files(information)]
    missing = [each.name for each in named if each not in there]
    if named and not missing:
        return BagFiles(named, counted)
    if not there:
        raise _no_bag(path, missing)
    if not named and len(_stems(there)) > 1:
        raise CommandError(f"{path} holds several bags and no {METADATA}: name one of {_few(there)}")
    if missing:
        _LOGGER.warning("%s: %s names %s, not there; reading %s", path, METADATA, _few(missing), _few(there))
    return BagFiles(there, counted)


def looks_like_bag(path: Path) -> bool:
    """Return whether a path is a bag's folder, or a file named like a bag's; it may still be damaged.

    A folder without metadata.yaml is one when the files of one recording are all that it holds.
    """
    if path.is_file():
        return _is_storage(path) or path.suffix == ".bag"
    if not path.is_dir():
        return False
    there = [each for each in path.iterdir() if not each.name.startswith(".")]
    alone = all(_is_storage(each) or each.name.endswith(BESIDE_STORAGE) for each in there)
    return (path / METADATA).is_file() or (alone and len(_stems(filter(_is_storage, there))) == 1)


def say_what_is_missing(path: Path, counted: int | None, count: int) -> None:
    """Warn of messages that metadata.yaml counts and that the storage does not hold."""
    if counted is not None and counted > count:
        text = "%s: %s counts %d messages, its files hold %d: %d are missing"
        _LOGGER.warning(text, path, METADATA, counted, count, counted - count)


def _is_storage(path: Path) -> bool:
    return path.name.endswith(STORAGE_ENDINGS) and path.is_file() and not path.name.startswith(".")


def _stems(paths: Iterable[Path]) -> set[str]:
    """Return the names of recordings: the files of a split one are NAME_0.mcap, NAME_1.mcap and so on."""
    return {re.sub(r"(_\d+)?\..*", "", path.name) for path in paths}


def _numbered(path: Path) -> list[Any]:
    """Return a key that sorts bag_10 after bag_9."""
    return [
        (part.isdecimal(), int(part) if part.isdecimal() else part) for part in re.split(r"(\d+)", path.name)
    ]


def _named_files(information: dict[str, Any]) -> list[str]:
    names = information.get("relative_file_paths")
    return [PurePath(str(name)).name for name in names] if isinstance(names, list) else []


def _information(folder: Path) -> dict[str, Any]:
    """Return what metadata.yaml says, nothing where it is missing."""
    path = folder / METADATA
    return _parsed(path, path.stat().st_mtime_ns) if path.is_file() else {}


@lru_cache(maxsize=8)  # a review opens its bag anew for each picture
def _parsed(path: Path, _mtime_ns: int) -> dict[str, Any]:
    try:
        document = (
            of_rosbags("ruamel.yaml").YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
        )
        information = document["rosbag2_bagfile_information"]
        return dict(information)
    except Exception:  # noqa: BLE001 - what a YAML reader raises for odd text is without bound
        _LOGGER.warning("%s cannot be read, its bag is read without it", path)
        return {}


def _no_bag(folder: Path, missing: list[str]) -> CommandError:
    if missing:
        return CommandError(f"{folder} is damaged: {METADATA} names {_few(missing)}, of which none is there")
    bags = sorted(each for each in folder.iterdir() if looks_like_bag(each))
    if bags:
        return CommandError(f"{folder} is no bag but holds {_few(bags)}: name one of them")
    wanted = f"{METADATA} or a storage file (.mcap, .db3) was expected in it"
    return CommandError(f"{folder} is no rosbag2: {wanted}")


def _few(paths: list[Any]) -> str:
    """Return the first names of a list."""
    names = [PurePath(each).name for each in paths]
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
