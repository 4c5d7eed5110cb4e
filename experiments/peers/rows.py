"""The six interruptions of the paper's Table 1, and the same with a door that closes meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Row:
    """A drive from `start` to `goal`, interrupted on `interruption`, that ends up at `emergency`.

    What is measured begins there: the emergency is over, and the way to `goal` is to be known.
    """

    row: int
    start: str
    goal: str
    interruption: str
    emergency: str
    # On the shortest way from there, closed since the interruption.
    closes: str | None = None


PAPER = (
    Row(1, "n40", "n1", "arc59", "n38"),
    Row(2, "n40", "n1", "arc59", "n28"),
    Row(3, "n40", "n1", "arc59", "n29"),
    Row(4, "n1", "n40", "arc5", "n13"),
    Row(5, "n1", "n40", "arc5", "n4"),
    Row(6, "n1", "n40", "arc5", "n12"),
)
_CLOSES = ("door3_5", "door2_4", "door3_5", "door4_6", "door3_5", "door3_5")
ROWS = PAPER + tuple(
    replace(row, row=len(PAPER) + row.row, closes=door) for row, door in zip(PAPER, _CLOSES)
)
