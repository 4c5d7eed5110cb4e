"""The map that both sides plan on, and the judge of their routes.

Knows GeoJSON in the shape of `maps/README.md` and nothing of planners, so that it can tell whether
a plan leads where it should and how long the way is.
"""

from __future__ import annotations

import heapq
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


class MapError(Exception):
    """What is wrong with a map, and where."""


class RouteError(Exception):
    """A plan that a robot could not follow."""


@dataclass(frozen=True)
class Arc:
    """A passage in one direction."""

    name: str
    start: str
    end: str
    length_m: float
    door: str | None


@dataclass
class Museum:
    """Nodes with their places and areas, the arcs that leave each, and the doors."""

    place_m: dict[str, tuple[float, float]] = field(default_factory=dict)
    area_of: dict[str, str] = field(default_factory=dict)
    arcs_from: dict[str, list[Arc]] = field(default_factory=dict)
    open_at_first: dict[str, bool] = field(default_factory=dict)

    def doors(self, closed: str | None) -> dict[str, bool]:
        """Which doors are open when one more has closed."""
        return {door: is_open and door != closed for door, is_open in self.open_at_first.items()}

    def straight_m(self, one: str, other: str) -> float:
        """As the crow flies."""
        return math.dist(self.place_m[one], self.place_m[other])

    def arc(self, start: str, end: str, name: str) -> Arc | None:
        """The arc of that name between two nodes."""
        arcs = self.arcs_from.get(start, [])
        return next((arc for arc in arcs if (arc.end, arc.name) == (end, name)), None)

    def shortest_m(self, start: str, goal: str, is_open: Mapping[str, bool]) -> float | None:
        """The length of the shortest way through open doors, if there is one."""
        known = distances(start, lambda node: self.passable(node, is_open))
        return known.get(goal)

    def passable(self, node: str, is_open: Mapping[str, bool]) -> Iterable[tuple[str, float]]:
        """Where one gets to from a node by one arc, and how far that is."""
        for arc in self.arcs_from[node]:
            if arc.door is None or is_open[arc.door]:
                yield arc.end, arc.length_m

    def route_m(
        self,
        start: str,
        goal: str,
        steps: Sequence[tuple[str, str, str]],
        is_open: Mapping[str, bool],
    ) -> float:
        """The length of a route of steps `(from, to, arc)`.

        Raises RouteError where it leaves the map, passes a closed door or ends elsewhere.
        """
        here, length_m = start, 0.0
        for step in steps:
            arc = self.arc(*step)
            if arc is None or step[0] != here:
                raise RouteError(f"{step} is no way on from {here}")
            if arc.door is not None and not is_open[arc.door]:
                raise RouteError(f"{step} leads through {arc.door}, which is closed")
            here, length_m = arc.end, length_m + arc.length_m
        if here != goal:
            raise RouteError(f"the route from {start} ends at {here}, not at {goal}")
        return length_m


def distances(
    start: str, neighbours: Callable[[str], Iterable[tuple[str, float]]]
) -> dict[str, float]:
    """The least distance to every node that can be reached."""
    known: dict[str, float] = {}
    ahead = [(0.0, start)]
    while ahead:
        distance, node = heapq.heappop(ahead)
        if node in known:
            continue
        known[node] = distance
        for other, length in neighbours(node):
            if other not in known:
                heapq.heappush(ahead, (distance + length, other))
    return known


def read(file: Path) -> Museum:
    """Reads a map. Raises MapError if it cannot be read or does not fit together."""
    try:
        return from_geojson(json.loads(file.read_text(encoding="utf-8")))
    except (OSError, ValueError, MapError) as why:
        raise MapError(f"{file}: {why}") from why


def from_geojson(text: Any) -> Museum:
    """A map from what a GeoJSON file says. Raises MapError."""
    museum = Museum()
    names: dict[int, str] = {}
    features = [_Feature(feature) for feature in _list(text, "features")]
    for feature in features:
        if feature.kind == "Point":
            name = str(feature.metadata.get("name", f"n{feature.id}")).lower()
            names[feature.id] = name
            museum.place_m[name] = feature.point()
            museum.area_of[name] = str(feature.need(feature.metadata, "area")).lower()
            museum.arcs_from[name] = []
    doors = _dict(text, "doors")
    for each in doors:
        is_open = _dict(doors, each).get("open")
        if not isinstance(is_open, bool):
            raise MapError(f"{each}: is it open, true or false?")
        museum.open_at_first[each.lower()] = is_open
    edges = [feature for feature in features if feature.kind in ("LineString", "MultiLineString")]
    by_ends = {feature.ends(): feature.id for feature in edges}
    for feature in edges:
        ends = feature.ends()
        start, end = (_of(names, one, feature) for one in ends)
        back = by_ends.get((ends[1], ends[0]), feature.id)
        name = str(feature.metadata.get("name", f"arc{min(feature.id, back)}")).lower()
        door = feature.door()
        if (door is None) != (museum.area_of[start] == museum.area_of[end]):
            raise MapError(f"edge {feature.id}: a door is where two areas meet, and only there")
        if door is not None and door not in museum.open_at_first:
            raise MapError(f"edge {feature.id}: nothing says whether {door} is open")
        museum.arcs_from[start].append(Arc(name, start, end, feature.length_m(), door))
    if not museum.place_m:
        raise MapError("there are no nodes")
    return museum


class _Feature:
    """A feature of the file, asked for what it must have."""

    def __init__(self, feature: Any) -> None:
        self.properties = _dict(feature, "properties")
        self.metadata = _dict({"metadata": {}, **self.properties}, "metadata")
        self.geometry = _dict(feature, "geometry")
        self.kind = self.geometry.get("type")
        self.id = 0
        self.id = self.whole("id")

    def need(self, where: Mapping[str, Any], what: str) -> Any:
        if what not in where:
            raise MapError(f"feature {self.id}: no `{what}`")
        return where[what]

    def whole(self, what: str) -> int:
        number = self.need(self.properties, what)
        if not isinstance(number, int):
            raise MapError(f"feature {self.id}: `{what}` is {number!r}, no whole number")
        return number

    def point(self) -> tuple[float, float]:
        coordinates = self.need(self.geometry, "coordinates")
        try:
            return float(coordinates[0]), float(coordinates[1])
        except (TypeError, ValueError, IndexError) as why:
            raise MapError(f"feature {self.id}: {coordinates} is no point") from why

    def ends(self) -> tuple[int, int]:
        return self.whole("startid"), self.whole("endid")

    def door(self) -> str | None:
        door = self.metadata.get("door")
        return None if door is None else str(door).lower()

    def length_m(self) -> float:
        length = self.metadata.get("length_m", self.properties.get("cost"))
        if not isinstance(length, (int, float)) or length < 0:
            raise MapError(f"edge {self.id}: no length")
        return float(length)


def _dict(where: Any, what: str) -> dict[str, Any]:
    value = where.get(what) if isinstance(where, dict) else None
    if not isinstance(value, dict):
        raise MapError(f"no `{what}`")
    return value


def _list(where: Any, what: str) -> list[Any]:
    value = where.get(what) if isinstance(where, dict) else None
    if not isinstance(value, list):
        raise MapError(f"no `{what}`")
    return value


def _of(names: Mapping[int, str], one: int, edge: _Feature) -> str:
    if one not in names:
        raise MapError(f"edge {edge.id}: there is no node {one}")
    return names[one]
