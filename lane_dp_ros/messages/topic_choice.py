# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What a user said of the topics of the stereo camera in a bag."""

from __future__ import annotations

from dataclasses import dataclass

from lane_dp_ros.messages.stereo_sync import Side

OPTIONS = "--left TOPIC --right TOPIC (--left-info, --right-info), or --camera PREFIX"


@dataclass(frozen=True)
class TopicChoice:
    """Topics by name, as far as they were named; `camera` is what the camera's topics begin with."""

    left: str | None = None
    right: str | None = None
    left_info: str | None = None
    right_info: str | None = None
    camera: str | None = None

    def image(self, side: Side) -> str | None:
        """Return the topic of a side's images, with its slash, None where it was not named."""
        return with_slash(self.left if side == "left" else self.right)

    def info(self, side: Side) -> str | None:
        """Return the topic of a side's CameraInfo, with its slash, None where it was not named."""
        return with_slash(self.left_info if side == "left" else self.right_info)

    @property
    def prefix(self) -> str:
        """What the topics of the camera begin with, a slash at least."""
        return with_slash(self.camera) or "/"


def with_slash(topic: str | None) -> str | None:
    """Return a topic's name as bags have it."""
    return None if topic is None else f"/{topic.lstrip('/')}"
