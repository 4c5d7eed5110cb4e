"""Both sides' figures in one list, whoever measured them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

from failure import Failure
from museum import Museum
from rows import ROWS, Row

OURS = ("online", "naive")
THEIRS = ("gtpyhop-choosing", "gtpyhop-routing")
PLANNERS = OURS + THEIRS
# Until the robot moves: what the parent takes, the child, and both. And the whole way down to the
# last node in one plan, which only a planner without agents makes.
LEVELS = ("parent", "child", "total", "whole")


@dataclass(frozen=True)
class Figure:
    """How long one planner takes in one row at one level, and how much it does for that."""

    row: int
    start: str
    goal: str
    interruption: str
    emergency: str
    level: str
    planner: str
    median_us: float
    p10_us: float
    p90_us: float
    upkeep_us: float
    expanded: int
    evaluated: int
    # The door that has closed meanwhile; only in rows that are not the paper's.
    closes: str | None = None


@dataclass(frozen=True)
class Route:
    """How far the robot goes from the emergency's place to the goal."""

    row: int
    emergency: str
    closes: str | None
    goal: str
    planner: str
    route_m: float | None
    shortest_m: float


@dataclass(frozen=True)
class Comparison:
    """What was measured in one run."""

    figures: list[Figure]
    routes: list[Route]
    remarks: list[str]

    def figure(self, row: int, level: str, planner: str) -> Figure | None:
        """What was measured there, if that was."""
        asked = (row, level, planner)
        found = (one for one in self.figures if (one.row, one.level, one.planner) == asked)
        return next(found, None)

    def route_m(self, row: int, planner: str) -> float | None:
        """The length of the route, if it is known."""
        found = (one.route_m for one in self.routes if (one.row, one.planner) == (row, planner))
        return next(found, None)

    def shortest_m(self, row: int) -> float:
        """The length of the shortest way."""
        return next(one.shortest_m for one in self.routes if one.row == row)

    def json(self) -> dict[str, Any]:
        """For a program."""
        return {
            "experiment": "peers",
            "remarks": self.remarks,
            "tables": {
                "peers": [asdict(one) for one in self.figures],
                "peers_routes": [asdict(one) for one in self.routes],
            },
        }


def compare(site: Museum, ours: Mapping[str, Any], theirs: Mapping[str, Any]) -> Comparison:
    """Raises Failure if the two sides have not measured the same."""
    figures = _figures([*ours["replanning"], *ours["doors"], *theirs["measured"]])
    return Comparison(
        sorted(figures, key=_order),
        list(_routes(site, [*ours["routes"], *theirs["routes"]])),
        _remarks(ours, theirs),
    )


def _figures(measured: Iterable[Mapping[str, Any]]) -> list[Figure]:
    figures = []
    for one in measured:
        try:
            names = [field.name for field in fields(Figure) if field.name not in ("row", "closes")]
            closes = one.get("closes")
            figure = Figure(row=0, closes=closes, **{name: one[name] for name in names})
        except KeyError as missing:
            raise Failure(
                f"a measured row has no {missing}; is intermezzo of another version?"
            ) from missing
        if figure.planner not in PLANNERS or figure.level not in LEVELS:
            raise Failure(f"nothing is known of {figure.planner} at level {figure.level}")
        figures.append(replace(figure, row=_row(one).row))
    return figures


def _row(one: Mapping[str, Any]) -> Row:
    """Which row something was reported of: by what was done, not by its number."""
    names = ("start", "goal", "interruption", "emergency", "closes")
    for row in ROWS:
        if all(getattr(row, name) == one.get(name) for name in names):
            return row
    said = ", ".join(f"{name}: {one.get(name)}" for name in names)
    raise Failure(f"only one side has measured this: {said}")


def _order(figure: Figure) -> tuple[int, int, int]:
    return figure.row, LEVELS.index(figure.level), PLANNERS.index(figure.planner)


def _routes(site: Museum, found: Sequence[Mapping[str, Any]]) -> Iterable[Route]:
    known = {(_row(one).row, one["planner"]): one["route_m"] for one in found}
    for row in ROWS:
        shortest = site.shortest_m(row.emergency, row.goal, site.doors(row.closes))
        if shortest is None:
            raise Failure(f"there is no way from {row.emergency} to {row.goal}")
        for planner in PLANNERS:
            length = known.get((row.row, planner))
            yield Route(row.row, row.emergency, row.closes, row.goal, planner, length, shortest)


def _remarks(ours: Mapping[str, Any], theirs: Mapping[str, Any]) -> list[str]:
    machine = "; ".join(f"{what}: {value}" for what, value in sorted(ours["machine"].items()))
    copying = round(100 * theirs["copying"])
    remarks = [
        f"gtpyhop {theirs['gtpyhop']} on {theirs['python']}, {theirs['repetitions']} repetitions.",
        "Ours is compiled and theirs is interpreted: the ratios are of what a user gets, not of "
        "the algorithms alone. What was expanded and tried tells more about those.",
        f"About {copying} % of GTPyhop's time goes into copying the state, once for every action.",
        "GTPyhop has no upkeep: it forgets, and plans again from the current state.",
    ]
    return [f"Machine: {machine}.", *remarks] if machine else remarks
