# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The known errors of the command line."""

from __future__ import annotations

LONGEST_LINE = 3000  # characters
LONGEST_QUOTE = 40  # characters of what came


class CommandError(Exception):
    """A known error: one line that says what came and what would have been right."""


def one_line(error: BaseException) -> str:
    """Return an exception's message on one line of bounded length, its type where it has none."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= LONGEST_LINE else f"{text[:LONGEST_LINE]} ..."


def reason(error: BaseException) -> str:
    """Return why a file cannot be used, without its name, for a line that has named it."""
    return getattr(error, "strerror", None) or one_line(error)


def quoted(value: object) -> str:
    """Return what came as Python writes it, no more of it than its start."""
    text = repr(value)
    return text if len(text) <= LONGEST_QUOTE else f"{text[:LONGEST_QUOTE]}..."
