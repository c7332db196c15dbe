# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What was found in the pairs of a bag, in a few lines."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field

from lane_dp_ros.core.pipeline import FrameResult


@dataclass
class Summary:
    """What was found, as text by `str()`."""

    lanes_per_pair: list[int] = field(default_factory=list)
    road_edges: int = 0
    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    problems: Counter[str] = field(default_factory=Counter)
    doubts: int = 0  # pairs after which the pictures or their calibration were thought to be wrong
    complaint: str = ""  # the last reason
    unpaired: int = 0
    elapsed: float = 0.0
    jobs: int = 1

    def add(self, answer: FrameResult | str) -> None:
        """Count one pair, or the reason why it could not be read."""
        if isinstance(answer, str):
            self.problems[answer] += 1
            return
        self.lanes_per_pair.append(len(answer.lanes))
        self.road_edges += len(answer.road_edges)
        if answer.problem:
            self.problems[answer.problem] += 1
        if answer.check.complaint:
            self.doubts, self.complaint = self.doubts + 1, answer.check.complaint
        if answer.detection is not None:
            for stage, seconds in answer.seconds.items():
                self.seconds[stage].append(seconds)

    def __str__(self) -> str:
        pairs, lanes = len(self.lanes_per_pair), sum(self.lanes_per_pair)
        empty = self.lanes_per_pair.count(0)
        lines = [
            f"{pairs} pairs, {lanes / pairs:.2f} lanes per pair, {empty} pairs without lanes",
            f"{self.road_edges / pairs:.2f} road edges per pair",
        ]
        if self.unpaired:
            lines.append(f"{self.unpaired} images without a partner")
        lines += [f"  {count} x {problem}" for problem, count in self.problems.most_common(5)]
        lines += [f"  {self.doubts} x {self.complaint}"] if self.complaint else []
        milliseconds = {stage: 1e3 * sum(s) / len(s) for stage, s in self.seconds.items()}
        stages = ", ".join(f"{stage} {value:.1f}" for stage, value in milliseconds.items())
        lines.append(f"{sum(milliseconds.values()):.1f} ms a pair: {stages}")
        processes = "1 process" if self.jobs == 1 else f"{self.jobs} processes"
        lines.append(f"{pairs / self.elapsed:.1f} pairs/s, {processes}")
        return "\n".join(lines)
