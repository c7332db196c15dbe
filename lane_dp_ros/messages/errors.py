# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The known errors of the command line."""

from __future__ import annotations


class CommandError(Exception):
    """A known error: one line that says what came and what would have been right."""


def one_line(error: BaseException) -> str:
    """Return an exception's message on one line, its type where it has none."""
    return " ".join(str(error).split()) or type(error).__name__
