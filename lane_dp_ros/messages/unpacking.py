# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Unpack what a bag holds compressed, and no more of it than its header says."""

from __future__ import annotations

import bz2
import importlib
import sys
from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, BinaryIO

ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"  # no CDR message begins with it: its second byte is an encoding, 0 to 11
LARGE_FILE, LARGEST_RATIO = 10**9, 1000  # bytes and times its size that a file may be unpacked to at least
LARGEST_MESSAGE = 1 << 28  # bytes; a message that is packed by itself has no header that says its size


def of_rosbags(name: str) -> Any:
    """Import a library that the rosbags library brings along."""
    return importlib.import_module(name)


def zstd() -> Any:
    """Return the module compression.zstd, or what it is called before Python 3.14."""
    return of_rosbags("compression.zstd" if sys.version_info >= (3, 14) else "backports.zstd")


def unzstd(data: bytes | memoryview, size: int) -> bytes:
    """Return the content of zstd frames, or `size` + 1 bytes of it where it is longer.

    Raises backports' (from Python 3.14 compression.zstd's) ZstdError for damaged frames.
    """
    parts, left = [], size + 1
    while len(data) and left > 0:
        decompressor = zstd().ZstdDecompressor()
        parts.append(decompressor.decompress(data, max_length=left))
        left -= len(parts[-1])
        data = decompressor.unused_data if decompressor.eof else b""
    return b"".join(parts)


def unlz4(data: bytes | memoryview, size: int) -> bytes:
    """Return the content of an LZ4 frame, or `size` + 1 bytes of it where it is longer."""
    return bytes(of_rosbags("lz4.frame").LZ4FrameDecompressor().decompress(data, max_length=size + 1))


def unbz2(data: bytes, size: int) -> bytes:
    """Return the content of a bzip2 stream, or `size` + 1 bytes of it where it is longer."""
    return bz2.BZ2Decompressor().decompress(data, max_length=size + 1)


def unpacked_message(data: bytes | memoryview) -> bytes:
    """Return a message, unpacked if `ros2 bag record --compression-mode message` packed it.

    Raises ValueError for a message of more than 256 MiB.
    """
    if bytes(data[:4]) != ZSTD_MAGIC:
        return bytes(data)
    if len(message := unzstd(data, LARGEST_MESSAGE)) > LARGEST_MESSAGE:
        raise ValueError(f"a message unpacks to more than {LARGEST_MESSAGE} bytes")
    return message


def unpacked_file(packed: Path, file: BinaryIO) -> None:
    """Write the content of a zstd file.

    Raises ValueError where it is more than 1 GB and more than a thousand times as large as the file.
    """
    left = max(LARGE_FILE, LARGEST_RATIO * packed.stat().st_size)
    with zstd().open(packed, "rb") as source:
        while data := source.read(1 << 20):
            if (left := left - len(data)) < 0:
                raise ValueError(f"it unpacks to more than {LARGEST_RATIO} times its size")
            file.write(data)


@lru_cache(maxsize=1)
def bound_unpacking() -> None:
    """Let rosbags unpack no more of an MCAP chunk than its header says; it compares the sizes afterwards.

    A chunk of a ROS 1 bag, whose size rosbags does not look at, may unpack to 256 MiB.
    """
    from rosbags.rosbag1 import reader
    from rosbags.rosbag2 import storage_mcap

    storage_mcap.DECOMPRESSORS.update({"zstd": unzstd, "lz4": unlz4})
    reader.decompressors.update({"bz2": partial(_ros1_chunk, unbz2), "lz4": partial(_ros1_chunk, unlz4)})


def _ros1_chunk(unpack: Callable[[bytes, int], bytes], data: bytes) -> bytes:
    if len(chunk := unpack(data, LARGEST_MESSAGE)) > LARGEST_MESSAGE:
        raise ValueError(f"a chunk unpacks to more than {LARGEST_MESSAGE} bytes")
    return chunk
