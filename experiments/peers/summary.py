"""Many measurements of one thing."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Summary:
    """What is said of many measurements: always values that were measured, none in between."""

    median_us: float
    p10_us: float
    p90_us: float

    @staticmethod
    def of(times_us: Iterable[float]) -> Summary:
        """By the nearest rank. There must be at least one."""
        ordered = sorted(times_us)

        def at(part: float) -> float:
            return ordered[max(math.ceil(part * len(ordered)), 1) - 1]

        return Summary(at(0.5), at(0.1), at(0.9))
