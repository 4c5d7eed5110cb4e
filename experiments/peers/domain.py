"""The museum as somebody would write it for GTPyhop.

Two levels, as in `maps/museum`: areas joined by doors, and nodes joined by arcs. What never
changes is in `rigid`, as in GTPyhop's own examples; a state is where the robot is and which doors
are closed. `go` is a task at the level of areas; `enter` and `approach` are actions there, and
tasks one level down.

GTPyhop searches depth first and takes the first plan it finds, so its plans are as good as the
order in which methods propose. There are two styles:

* `choosing`: the planner chooses. There is a method for the best door (arc), one for the second
  best and so on, by the straight way to it and on to the goal; what was passed is not passed
  again. If one leads nowhere, the planner goes back and tries the next.
* `routing`: the method computes. It asks Dijkstra's algorithm for the shortest way and proposes
  all of it.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable
from typing import Any, Optional

import gtpyhop
from gtpyhop import State

from museum import Arc, Museum, distances

Task = tuple[Any, ...]
Tasks = Optional[list[Task]]
Method = Callable[..., Tasks]

ROBOT = "robot"
STYLES = ("choosing", "routing")
# What a domain plans with: areas; the nodes of one area; both in one plan.
LEVELS = ("area", "node", "both")

rigid = State("rigid")


def lay_out(museum: Museum) -> None:
    """Makes `rigid` from a map."""
    nodes = museum.place_m
    inside = {node: [arc for arc in museum.arcs_from[node] if arc.door is None] for node in nodes}
    rigid.museum = museum
    rigid.area = museum.area_of
    rigid.inside = inside
    rigid.gates = {area: [] for area in museum.area_of.values()}
    for node in nodes:
        gates = [arc for arc in museum.arcs_from[node] if arc.door is not None]
        rigid.gates[museum.area_of[node]].extend(gates)
    # Metres between nodes of one area without leaving it.
    rigid.walk = {
        node: distances(node, lambda one: ((arc.end, arc.length_m) for arc in inside[one]))
        for node in nodes
    }


def state_at(node: str, is_open: dict[str, bool]) -> State:
    """The robot stands at a node. Doors are open unless said to be closed: the state is copied for
    every action, so it should be small."""
    return State(
        "now", loc={ROBOT: node}, closed={door: True for door in is_open if not is_open[door]}
    )


def declare(level: str, style: str) -> gtpyhop.Domain:
    """A domain for a level in a style; it is the current one afterwards."""
    domain = gtpyhop.Domain(f"{level} {style}")
    if level in ("area", "both"):
        on = {"choosing": _ranked(through_a_door, rigid.gates.values()), "routing": [area_by_area]}
        gtpyhop.declare_task_methods("go", already_there, inside_the_area, *on[style])
    if level == "area":
        gtpyhop.declare_actions(enter, approach)
    else:
        on = {
            "choosing": _ranked(one_arc_further, rigid.inside.values()),
            "routing": [node_by_node],
        }
        gtpyhop.declare_task_methods("enter", to_the_door_and_through)
        gtpyhop.declare_task_methods("approach", walk_to)
        gtpyhop.declare_task_methods("reach", already_there, *on[style])
        gtpyhop.declare_actions(move, cross)
    return domain


def go(goal: str) -> Task:
    """The task to be at a node."""
    return ("go", goal, ())


def _ranked(method: Method, choices: Iterable[list[Arc]]) -> list[Method]:
    """As many methods as there are choices anywhere: for the best, the second best …"""

    def at(rank: int) -> Method:
        def ranked(state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
            return method(rank, state, goal, seen)

        ranked.__name__ = f"{method.__name__}_{rank}"
        return ranked

    return [at(rank) for rank in range(max(len(arcs) for arcs in choices))]


# ---- areas -------------------------------------------------------------------------------------


def already_there(state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
    if state.loc[ROBOT] == goal:
        return []
    return None


def inside_the_area(state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
    area = rigid.area[goal]
    if rigid.area[state.loc[ROBOT]] == area and state.loc[ROBOT] != goal:
        return [("approach", goal, area)]
    return None


def through_a_door(rank: int, state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
    here = state.loc[ROBOT]
    area = rigid.area[here]
    if area == rigid.area[goal]:
        return None
    gates = [
        gate
        for gate in rigid.gates[area]
        if gate.door not in state.closed and rigid.area[gate.end] not in seen
    ]
    gate = _best(rank, gates, lambda gate: _straight(here, gate.start) + _by(gate, goal))
    if gate is None:
        return None
    return [("enter", area, rigid.area[gate.end], gate.door), ("go", goal, (*seen, area))]


def area_by_area(state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
    if rigid.area[state.loc[ROBOT]] == rigid.area[goal]:
        return None
    gates = shortest(state.loc[ROBOT], goal, lambda node: _doors_from(state, node, goal))
    if gates is None:
        return None
    doors = [gate for gate in gates if gate is not None]
    enters = [("enter", rigid.area[gate.start], rigid.area[gate.end], gate.door) for gate in doors]
    return [*enters, ("go", goal, ())]


def enter(state: State, area: str, to: str, door: str) -> State | None:
    gate = _gate(area, to, door)
    if rigid.area[state.loc[ROBOT]] == area and door not in state.closed:
        state.loc[ROBOT] = gate.end
        return state
    return None


def approach(state: State, node: str, area: str) -> State | None:
    if rigid.area[state.loc[ROBOT]] == area:
        state.loc[ROBOT] = node
        return state
    return None


# ---- nodes -------------------------------------------------------------------------------------


def to_the_door_and_through(state: State, area: str, to: str, door: str) -> Tasks:
    gate = _gate(area, to, door)
    if rigid.area[state.loc[ROBOT]] == area:
        return [("reach", gate.start, ()), ("cross", gate.start, gate.end, gate.name, door)]
    return None


def walk_to(state: State, node: str, area: str) -> Tasks:
    if rigid.area[state.loc[ROBOT]] == area:
        return [("reach", node, ())]
    return None


def one_arc_further(rank: int, state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
    here = state.loc[ROBOT]
    if here == goal:
        return None
    arcs = [arc for arc in rigid.inside[here] if arc.end not in seen]
    arc = _best(rank, arcs, lambda arc: _by(arc, goal))
    if arc is None:
        return None
    return [("move", here, arc.end, arc.name), ("reach", goal, (*seen, here))]


def node_by_node(state: State, goal: str, seen: tuple[str, ...]) -> Tasks:
    here = state.loc[ROBOT]
    if here == goal:
        return None
    arcs = shortest(
        here, goal, lambda node: ((arc.end, arc.length_m, arc) for arc in rigid.inside[node])
    )
    if arcs is None:
        return None
    return [("move", arc.start, arc.end, arc.name) for arc in arcs if arc is not None]


def move(state: State, start: str, end: str, arc: str) -> State | None:
    if state.loc[ROBOT] == start:
        state.loc[ROBOT] = end
        return state
    return None


def cross(state: State, start: str, end: str, arc: str, door: str) -> State | None:
    if state.loc[ROBOT] == start and door not in state.closed:
        state.loc[ROBOT] = end
        return state
    return None


# ---- what methods ask --------------------------------------------------------------------------


def shortest(
    start: str, goal: str, ways: Callable[[str], Iterable[tuple[str, float, Arc | None]]]
) -> list[Arc | None] | None:
    """The arcs of the shortest way, by Dijkstra's algorithm."""
    known: set[str] = set()
    came: dict[str, tuple[str, Arc | None]] = {}
    least = {start: 0.0}
    ahead = [(0.0, start)]
    while ahead:
        distance, node = heapq.heappop(ahead)
        if node == goal:
            break
        if node in known:
            continue
        known.add(node)
        for other, length, arc in ways(node):
            total = distance + length
            if total < least.get(other, float("inf")):
                least[other] = total
                came[other] = (node, arc)
                heapq.heappush(ahead, (total, other))
    if goal not in least:
        return None
    arcs: list[Arc | None] = []
    node = goal
    while node != start:
        node, arc = came[node]
        arcs.append(arc)
    return arcs[::-1]


def _doors_from(state: State, node: str, goal: str) -> Iterable[tuple[str, float, Arc | None]]:
    """From a node to the far sides of its area's open doors, or to the goal in it."""
    area, walk = rigid.area[node], rigid.walk[node]
    if rigid.area[goal] == area:
        yield goal, walk[goal], None
    for gate in rigid.gates[area]:
        if gate.door not in state.closed:
            yield gate.end, walk[gate.start] + gate.length_m, gate


def _best(rank: int, arcs: list[Arc], cost: Callable[[Arc], float]) -> Arc | None:
    if rank >= len(arcs):
        return None
    return sorted(arcs, key=cost)[rank]


def _straight(one: str, other: str) -> float:
    museum: Museum = rigid.museum
    return museum.straight_m(one, other)


def _by(arc: Arc, goal: str) -> float:
    """Along an arc and straight on to the goal."""
    return arc.length_m + _straight(arc.end, goal)


def _gate(area: str, to: str, door: str) -> Arc:
    gates: list[Arc] = rigid.gates[area]
    return next(gate for gate in gates if gate.door == door and rigid.area[gate.end] == to)
