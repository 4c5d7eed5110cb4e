"""Plans the way back after each emergency with GTPyhop, many times. Runs where that is installed.

Writes one JSON object: GTPyhop's version, Python's, and for each row, style and level the times in
microseconds, the work, and the route. `compare.py` is what a person runs.
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import io
import json
import platform
import time
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import gtpyhop

import domain
import museum
from rows import ROWS, Row
from summary import Summary

Plan = list[tuple[Any, ...]]


class NoPlan(Exception):
    """GTPyhop has found nothing."""


@dataclass
class Question:
    """What GTPyhop is asked, over and over."""

    row: Row
    style: str
    level: str
    where: gtpyhop.Domain
    state: gtpyhop.State
    todo: Plan


def main() -> None:
    options = _options()
    # GTPyhop says that it will say nothing.
    with contextlib.redirect_stdout(io.StringIO()):
        gtpyhop.set_verbose_level(0)
        gtpyhop.set_recursive_planning(True)
        found = compare(museum.read(options.map), options.repetitions)
    options.out.write_text(json.dumps(found), encoding="utf-8")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", type=Path, required=True)
    parser.add_argument("--repetitions", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    return parser.parse_args()


def compare(site: museum.Museum, repetitions: int) -> dict[str, Any]:
    """Everything that is found out."""
    domain.lay_out(site)
    domains = {
        (level, style): domain.declare(level, style)
        for level in domain.LEVELS
        for style in domain.STYLES
    }
    questions = [
        question
        for row in ROWS
        for style in domain.STYLES
        for question in _questions(site, row, style, domains)
    ]
    times = _times(questions, repetitions)
    measured = []
    for row in ROWS:
        for style in domain.STYLES:
            asked = {one.level: one for one in questions if (one.row, one.style) == (row, style)}
            measured += _levels(asked, {level: times[id(one)] for level, one in asked.items()})
    return {
        "gtpyhop": version("gtpyhop"),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "repetitions": repetitions,
        "measured": measured,
        "routes": [_route(site, one) for one in questions if one.level == "both"],
        "copying": _copying(questions),
    }


def _questions(
    site: museum.Museum, row: Row, style: str, domains: dict[tuple[str, str], gtpyhop.Domain]
) -> list[Question]:
    """The whole way by areas, then the first of its parts by nodes; and both in one plan."""
    state = domain.state_at(row.emergency, site.doors(row.closes))
    area = Question(row, style, "area", domains["area", style], state, [domain.go(row.goal)])
    node = Question(row, style, "node", domains["node", style], state, plan(area)[:1])
    return [area, node, Question(row, style, "both", domains["both", style], state, area.todo)]


def plan(question: Question) -> Plan:
    """A plan. Raises NoPlan if there is none."""
    gtpyhop.set_current_domain(question.where)
    found = gtpyhop.find_plan(question.state, question.todo)
    if not isinstance(found, list):
        raise NoPlan(f"GTPyhop finds no plan for {question.todo} from {question.row.emergency}")
    return found


def _times(questions: list[Question], repetitions: int) -> dict[int, list[float]]:
    """Microseconds of each plan. All are asked in turn: a slow moment strikes all alike."""
    times: dict[int, list[float]] = {id(question): [] for question in questions}
    warm_up = max(3, repetitions // 10)
    gc.collect()
    gc.disable()
    try:
        for repetition in range(warm_up + repetitions):
            for question in questions:
                gtpyhop.set_current_domain(question.where)
                begun = time.perf_counter_ns()
                gtpyhop.find_plan(question.state, question.todo)
                ended = time.perf_counter_ns()
                if repetition >= warm_up:
                    times[id(question)].append((ended - begun) / 1000)
            # What it logs about every plan it keeps for ever.
            _forget_logs()
            gc.collect(0)
    finally:
        gc.enable()
    return times


def _forget_logs() -> None:
    gtpyhop.get_logger("gtpyhop_global").clear_logs()


def _levels(asked: dict[str, Question], times: dict[str, list[float]]) -> list[dict[str, Any]]:
    """Parent, child, and their sum until the robot moves; and the whole way to the last node."""
    total = [area + node for area, node in zip(times["area"], times["node"])]
    work = {level: _work(question) for level, question in asked.items()}
    both = tuple(one + other for one, other in zip(work["area"], work["node"]))
    return [
        _measured(asked["area"], "parent", times["area"], work["area"]),
        _measured(asked["node"], "child", times["node"], work["node"]),
        _measured(asked["area"], "total", total, both),
        _measured(asked["both"], "whole", times["both"], work["both"]),
    ]


def _measured(
    question: Question, level: str, times: list[float], work: tuple[int, ...]
) -> dict[str, Any]:
    return {
        **asdict(question.row),
        "level": level,
        "planner": f"gtpyhop-{question.style}",
        **asdict(Summary.of(times)),
        "upkeep_us": 0.0,
        "expanded": work[0],
        "evaluated": work[1],
    }


def _work(question: Question) -> tuple[int, int]:
    """Tasks decomposed and actions applied, each time; and methods and actions that were tried."""
    with gtpyhop.PlannerSession(domain=question.where, strategy="recursive_dfs") as session:
        events = session.find_plan(question.state, question.todo, trace=True).trace.events
    tried = [event for event in events if not event.status.endswith("exhausted")]
    taken = ("applied", "idempotent", "method_applicable")
    return sum(event.status in taken for event in tried), len(tried)


def _route(site: museum.Museum, question: Question) -> dict[str, Any]:
    """How far the robot goes."""
    row = question.row
    steps = [step[1:4] for step in plan(question)]
    is_open = site.doors(row.closes)
    return {
        **asdict(row),
        "planner": f"gtpyhop-{question.style}",
        "route_m": site.route_m(row.emergency, row.goal, steps, is_open),
    }


def _copying(questions: list[Question]) -> float:
    """Which part of planning time is spent on copying states, by the median of many plans."""
    spent_ns = 0
    copy = gtpyhop.State.copy

    def timed(state: gtpyhop.State, name: str | None = None) -> gtpyhop.State:
        nonlocal spent_ns
        begun = time.perf_counter_ns()
        copied = copy(state, name)
        spent_ns += time.perf_counter_ns() - begun
        return copied

    parts = []
    gtpyhop.State.copy = timed
    try:
        for question in [question for question in questions if question.level == "both"] * 20:
            spent_ns = 0
            begun = time.perf_counter_ns()
            plan(question)
            parts.append(spent_ns / (time.perf_counter_ns() - begun))
    finally:
        gtpyhop.State.copy = copy
    return sorted(parts)[len(parts) // 2]


if __name__ == "__main__":
    main()
