# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""Unpack what a bag holds compressed, and no more of it than its header says."""

from __future__ import annotations

import importlib
import sys
from functools import lru_cache
from typing import Any

ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"  # no CDR message begins with it: its second byte is an encoding, 0 to 11
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


def unpacked_message(data: bytes | memoryview) -> bytes:
    """Return a message, unpacked if `ros2 bag record --compression-mode message` packed it.

    Raises ValueError for a message of more than 256 MiB.
    """
    if bytes(data[:4]) != ZSTD_MAGIC:
        return bytes(data)
    if len(message := unzstd(data, LARGEST_MESSAGE)) > LARGEST_MESSAGE:
        raise ValueError(f"a message unpacks to more than {LARGEST_MESSAGE} bytes")
    return message


@lru_cache(maxsize=1)
def bound_unpacking() -> None:
    """Let rosbags unpack no more of an MCAP chunk than its header says; it compares the sizes afterwards."""
    from rosbags.rosbag2 import storage_mcap

    storage_mcap.DECOMPRESSORS.update({"zstd": unzstd, "lz4": unlz4})
