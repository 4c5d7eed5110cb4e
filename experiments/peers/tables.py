"""A comparison as tables: for a terminal, as Markdown, as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from comparison import LEVELS, OURS, PLANNERS, THEIRS, Comparison, Figure
from rows import ROWS, Row

TITLES = {
    "online": "online",
    "naive": "naive",
    "gtpyhop-choosing": "choosing",
    "gtpyhop-routing": "routing",
}
BASE = OURS[0]


@dataclass(frozen=True)
class Table:
    """Words in rows under a title."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]

    def printed(self) -> str:
        """For a terminal."""
        lines = [self.columns, *self.rows]
        widths = [max(len(line[at]) for line in lines) for at in range(len(self.columns))]
        text = [self.title, ""]
        for line in lines:
            text.append("  ".join(word.rjust(width) for word, width in zip(line, widths)))
        return "\n".join(text)

    def markdown(self) -> str:
        """For a document."""
        lines = [self.columns, ["---"] * len(self.columns), *self.rows]
        return "\n".join([self.title, "", *("| " + " | ".join(line) + " |" for line in lines)])


def all_of(comparison: Comparison) -> list[Table]:
    """The tables, the most important first."""
    return [_times(comparison), _routes(comparison), _work(comparison)]


def printed(comparison: Comparison) -> str:
    """For a terminal."""
    return "\n\n".join([*(table.printed() for table in all_of(comparison)), *comparison.remarks])


def markdown(comparison: Comparison) -> str:
    """For a document."""
    remarks = "\n".join(f"- {remark}" for remark in comparison.remarks)
    texts = [table.markdown() for table in all_of(comparison)]
    return "\n\n".join(["# peers", *texts, remarks]) + "\n"


def as_csv(rows: Sequence[Any]) -> str:
    """One line for each, with the names of its fields above."""
    text = io.StringIO()
    dicts = [asdict(row) for row in rows]
    writer = csv.DictWriter(text, dicts[0].keys(), lineterminator="\n")
    writer.writeheader()
    writer.writerows(dicts)
    return text.getvalue()


def short(value: float | None) -> str:
    """With three digits that say something."""
    if value is None:
        return "–"
    if value == 0 or abs(value) >= 100:
        return f"{value:.0f}"
    return f"{value:.1f}" if abs(value) >= 10 else f"{value:.2f}"


def _times(comparison: Comparison) -> Table:
    against = [f"{TITLES[planner]}/online" for planner in THEIRS]
    rows = []
    for level in LEVELS:
        for row in ROWS:
            figures = [comparison.figure(row.row, level, planner) for planner in PLANNERS]
            # The whole plan goes beside what the agents take until the robot moves.
            base = figures[0] or comparison.figure(row.row, "total", BASE)
            ratios = [_ratio(figure, base) for figure in figures[len(OURS) :]]
            upkeep = base.median_us + base.upkeep_us if base and figures[0] else None
            spreads = [_spread(figure) for figure in figures]
            spreads.insert(1, short(upkeep))
            rows.append([level, f"{row.start}→{row.goal}", _where(row), *spreads, *ratios])
    titles = [TITLES[planner] for planner in PLANNERS]
    titles.insert(1, "+ upkeep")
    return Table(
        "Microseconds until the suspended drive goes on: median (p10–p90). Ours: online, naive; "
        "GTPyhop's: choosing, routing",
        ["level", "drive", "emergency", *titles, *against],
        rows,
    )


def _where(row: Row) -> str:
    return row.emergency if row.closes is None else f"{row.emergency}, {row.closes} closes"


def _spread(figure: Figure | None) -> str:
    if figure is None:
        return "–"
    return f"{short(figure.median_us)} ({short(figure.p10_us)}–{short(figure.p90_us)})"


def _ratio(figure: Figure | None, base: Figure | None) -> str:
    if figure is None or base is None or base.median_us == 0:
        return "–"
    return short(figure.median_us / base.median_us)


def _routes(comparison: Comparison) -> Table:
    rows = []
    for row in ROWS:
        lengths = [comparison.route_m(row.row, planner) for planner in PLANNERS]
        shortest = comparison.shortest_m(row.row)
        rows.append([_where(row), row.goal, *map(short, [shortest, *lengths])])
    titles = [TITLES[planner] for planner in PLANNERS]
    return Table("Metres from there to the goal", ["from", "to", "shortest", *titles], rows)


def _work(comparison: Comparison) -> Table:
    rows = []
    for level in LEVELS:
        for row in ROWS:
            figures = [comparison.figure(row.row, level, planner) for planner in PLANNERS]
            work = ["–" if one is None else f"{one.expanded} ({one.evaluated})" for one in figures]
            rows.append([level, f"{row.start}→{row.goal}", _where(row), *work])
    titles = [TITLES[planner] for planner in PLANNERS]
    return Table(
        "Work: nodes expanded (evaluated); of GTPyhop, tasks decomposed and actions applied "
        "(methods and actions tried)",
        ["level", "drive", "emergency", *titles],
        rows,
    )
