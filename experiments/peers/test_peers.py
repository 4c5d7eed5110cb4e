"""What the comparison does without GTPyhop: maps, routes, tables, errors."""

from __future__ import annotations

import contextlib
import copy
import io
import json
import os
import tempfile
import unittest
from pathlib import Path
from typing import Any
from unittest import mock

import compare
import comparison
import museum
import ours
import peer
import tables
from failure import Failure
from rows import ROWS
from summary import Summary

SITE = museum.read(compare.MAP)


def reported(planner: str, level: str, number: int = 1, **more: Any) -> dict[str, Any]:
    """A line of `intermezzo experiment replanning`."""
    row = ROWS[number - 1]
    return {
        "row": number,
        "start": row.start,
        "goal": row.goal,
        "interruption": row.interruption,
        "emergency": row.emergency,
        "level": level,
        "planner": planner,
        "median_us": 10.0,
        "p10_us": 9.0,
        "p90_us": 12.0,
        "upkeep_us": 5.0,
        "expanded": 2,
        "evaluated": 3,
        **more,
    }


def both_sides(*, routes: Any = ()) -> comparison.Comparison:
    mine = {
        "replanning": [reported("online", "total")],
        "doors": [],
        "routes": list(routes),
        "machine": {},
    }
    theirs = {
        "measured": [reported("gtpyhop-choosing", "total", median_us=45.0)],
        "routes": [reported("gtpyhop-choosing", "", route_m=70.0)],
        "gtpyhop": "2",
        "python": "CPython",
        "repetitions": 1,
        "copying": 0.5,
    }
    return comparison.compare(SITE, mine, theirs)


def shortest_by_relaxing(start: str) -> dict[str, float]:
    """All distances through open doors, found in another way (Bellman and Ford)."""
    known = {start: 0.0}
    for _ in SITE.place_m:
        for arcs in SITE.arcs_from.values():
            for arc in arcs:
                is_passable = arc.door is None or SITE.open_at_first[arc.door]
                if is_passable and arc.start in known:
                    way = known[arc.start] + arc.length_m
                    known[arc.end] = min(way, known.get(arc.end, way))
    return known


class TheMap(unittest.TestCase):
    def test_it_is_the_papers_museum(self) -> None:
        self.assertEqual(len(SITE.place_m), 40)
        self.assertEqual(sum(map(len, SITE.arcs_from.values())), 2 * 63)
        closed = [door for door, is_open in SITE.open_at_first.items() if not is_open]
        self.assertEqual(closed, ["door6_8"])

    def test_every_row_is_about_places_on_it(self) -> None:
        for row in ROWS:
            arcs = [arc.name for arc in SITE.arcs_from[row.start]]
            self.assertIn(row.interruption, arcs)
            self.assertIn(row.goal, SITE.place_m)
            self.assertIn(row.emergency, SITE.place_m)

    def test_a_door_that_closes_was_on_the_way_and_there_is_another(self) -> None:
        for row in ROWS:
            if row.closes is not None:
                ways = [
                    SITE.shortest_m(row.emergency, row.goal, SITE.doors(closed))
                    for closed in (None, row.closes)
                ]
                self.assertGreater(ways[1] or 0.0, ways[0] or 0.0, row)

    def test_shortest_ways_are_those_found_in_another_way(self) -> None:
        for start in SITE.place_m:
            known = shortest_by_relaxing(start)
            for goal in SITE.place_m:
                found = SITE.shortest_m(start, goal, SITE.open_at_first)
                self.assertIsNotNone(found)
                self.assertAlmostEqual(found or 0.0, known[goal], msg=f"{start} to {goal}")

    def test_behind_closed_doors_there_is_no_way(self) -> None:
        closed = dict.fromkeys(SITE.open_at_first, False)
        self.assertIsNone(SITE.shortest_m("n40", "n1", closed))

    def test_what_does_not_fit_together_is_refused_with_its_place(self) -> None:
        whole = json.loads(compare.MAP.read_text(encoding="utf-8"))

        def edge(text: Any) -> Any:
            return next(one for one in text["features"] if "startid" in one["properties"])

        def door(text: Any) -> Any:
            edges = (one for one in text["features"] if "startid" in one["properties"])
            return next(one for one in edges if "door" in one["properties"]["metadata"])

        faults = {
            "features": lambda text: text.pop("features"),
            "doors": lambda text: text.pop("doors"),
            "properties": lambda text: text["features"][0].pop("properties"),
            "no `area`": lambda text: text["features"][0]["properties"]["metadata"].pop("area"),
            "no point": lambda text: text["features"][0]["geometry"].update(coordinates=["x"]),
            "no node 99": lambda text: edge(text)["properties"].update(endid=99),
            "no `startid`": lambda text: edge(text)["properties"].pop("startid"),
            "a door is where": lambda text: door(text)["properties"]["metadata"].pop("door"),
            "whether": lambda text: text["doors"].clear(),
            "true or false": lambda text: text["doors"]["door1_2"].update(open="yes"),
            "no `door1_2`": lambda text: text["doors"].update(door1_2=None),
            "no `metadata`": lambda text: text["features"][0]["properties"].update(metadata=1),
            "no whole number": lambda text: text["features"][0]["properties"].update(id=[]),
            "no length": lambda text: (
                edge(text)["properties"].pop("cost"),
                edge(text)["properties"]["metadata"].pop("length_m"),
            ),
        }
        for words, spoil in faults.items():
            text = copy.deepcopy(whole)
            spoil(text)
            with self.subTest(words), self.assertRaisesRegex(museum.MapError, words):
                museum.from_geojson(text)
        for nonsense in (None, [], "map", {"features": [None], "doors": {}}):
            with self.subTest(nonsense), self.assertRaises(museum.MapError):
                museum.from_geojson(nonsense)

    def test_a_file_that_is_not_there_is_named(self) -> None:
        with self.assertRaisesRegex(museum.MapError, "nowhere.geojson"):
            museum.read(Path("nowhere.geojson"))


class Routes(unittest.TestCase):
    def length_m(self, *steps: tuple[str, str, str], goal: str = "n1") -> float:
        return SITE.route_m("n28", goal, steps, SITE.open_at_first)

    def test_a_route_is_as_long_as_its_arcs(self) -> None:
        steps = [
            ("n28", "n26", "arc45"),
            ("n26", "n16", "arc27"),
            ("n16", "n14", "arc25"),
            ("n14", "n7", "arc13"),
            ("n7", "n5", "arc10"),
            ("n5", "n1", "arc4"),
        ]
        arcs = [SITE.arc(*step) for step in steps]
        lengths = [arc.length_m for arc in arcs if arc is not None]
        self.assertEqual(len(lengths), len(steps))
        self.assertAlmostEqual(self.length_m(*steps), sum(lengths))
        self.assertAlmostEqual(sum(lengths), shortest_by_relaxing("n28")["n1"])

    def test_one_that_no_robot_could_follow_is_refused(self) -> None:
        with self.assertRaisesRegex(museum.RouteError, "no way on"):
            self.length_m(("n28", "n1", "arc45"))
        with self.assertRaisesRegex(museum.RouteError, "no way on"):
            self.length_m(("n26", "n16", "arc27"))
        with self.assertRaisesRegex(museum.RouteError, "ends at n26"):
            self.length_m(("n28", "n26", "arc45"))
        staff = next(
            arc for arcs in SITE.arcs_from.values() for arc in arcs if arc.door == "door6_8"
        )
        step = (staff.start, staff.end, staff.name)
        with self.assertRaisesRegex(museum.RouteError, "door6_8, which is closed"):
            SITE.route_m(staff.start, staff.end, [step], SITE.open_at_first)


class Comparing(unittest.TestCase):
    def test_both_sides_stand_beside_each_other(self) -> None:
        text = tables.printed(both_sides())
        self.assertRegex(
            text, r"total +n40→n1 +n38 +10.0 \(9.00–12.0\) +15.0 +– +45.0 \(.*\) +– +4.50"
        )

    def test_lengths_are_beside_the_shortest_that_there_is(self) -> None:
        compared = both_sides(routes=[reported("online", "", route_m=62.5)])
        shortest = shortest_by_relaxing("n38")["n1"]
        self.assertAlmostEqual(compared.shortest_m(1), shortest)
        lengths = [compared.route_m(1, planner) for planner in comparison.PLANNERS]
        self.assertEqual(lengths, [62.5, None, 70.0, None])

    def test_csv_has_the_columns_of_the_other_experiments(self) -> None:
        head = tables.as_csv(both_sides().figures).splitlines()[0]
        self.assertEqual(
            head,
            "row,start,goal,interruption,emergency,level,planner,"
            "median_us,p10_us,p90_us,upkeep_us,expanded,evaluated,closes",
        )

    def test_rows_that_are_not_the_same_are_not_compared(self) -> None:
        mine = {"doors": [], "routes": [], "machine": {}}
        theirs = {"measured": [], "routes": []}
        incomplete = reported("online", "total")
        del incomplete["p90_us"]
        wrong = {
            "n39": reported("online", "total", emergency="n39"),
            "door9_9": reported("online", "total", closes="door9_9"),
            "p90_us": incomplete,
            "psychic": reported("psychic", "total"),
        }
        for words, row in wrong.items():
            with self.subTest(words), self.assertRaisesRegex(Failure, words):
                comparison.compare(SITE, {**mine, "replanning": [row]}, theirs)

    def test_a_report_without_the_table_is_refused(self) -> None:
        for report in (None, [], {}, {"tables": {}}, {"tables": {"replanning": 1}}):
            with self.subTest(report), self.assertRaisesRegex(Failure, "no table `replanning`"):
                ours.tables(report)

    def test_every_figure_is_one_of_those_measured(self) -> None:
        summary = Summary.of(range(100, 0, -1))
        self.assertEqual((summary.p10_us, summary.median_us, summary.p90_us), (10, 50, 90))
        self.assertEqual(Summary.of([7.0]), Summary(7.0, 7.0, 7.0))


class TheCommand(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_with(self, *arguments: str) -> tuple[int, str]:
        """Exit code and error output, GTPyhop being taken for installed."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            with mock.patch.object(peer, "environment", return_value=Path("python")):
                try:
                    code = compare.main(list(arguments))
                except SystemExit as ended:
                    code = int(str(ended.code))
        return code, said.getvalue()

    def script(self, text: str) -> str:
        file = self.folder / "intermezzo"
        file.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
        file.chmod(0o755)
        return str(file)

    def test_wrong_options_are_usage(self) -> None:
        for number in ("0", "-1", "x", "1e9", "10000000"):
            code, said = self.run_with("--repetitions", number)
            self.assertEqual(code, 2)
            self.assertIn("--repetitions", said)

    def test_an_intermezzo_that_is_not_there_is_named(self) -> None:
        code, said = self.run_with("--intermezzo", str(self.folder / "nothing"))
        self.assertEqual(code, 1)
        self.assertRegex(said, "error: cannot run .*nothing: No such file")

    def test_an_intermezzo_that_fails_is_an_error(self) -> None:
        code, said = self.run_with("--intermezzo", self.script("exit 3"))
        self.assertEqual(code, 1)
        self.assertIn("has failed (3)", said)

    def test_an_intermezzo_that_says_something_else_is_an_error(self) -> None:
        code, said = self.run_with("--intermezzo", self.script("echo nonsense"))
        self.assertEqual(code, 1)
        self.assertIn("has not printed JSON", said)

    def test_a_folder_that_cannot_be_written_is_an_error(self) -> None:
        file = self.folder / "file"
        file.touch()
        with self.assertRaisesRegex(Failure, "cannot write to"):
            compare._write(both_sides(), file)

    def test_everything_is_written(self) -> None:
        compare._write(both_sides(), self.folder / "out")
        written = sorted(file.name for file in (self.folder / "out").iterdir())
        self.assertEqual(written, ["peers.csv", "peers.json", "peers.md", "peers_routes.csv"])
        found = json.loads((self.folder / "out" / "peers.json").read_text(encoding="utf-8"))
        self.assertEqual(found["tables"]["peers"][0]["planner"], "online")

    def test_without_a_network_it_is_said_what_is_missing(self) -> None:
        with mock.patch.dict(os.environ, {"PIP_NO_INDEX": "1"}):
            with contextlib.redirect_stderr(io.StringIO()):
                for _ in range(2):
                    # What could not be installed once is not taken for installed the next time.
                    with self.assertRaisesRegex(Failure, "cannot install gtpyhop.*network"):
                        peer.environment(self.folder / "venv")


if __name__ == "__main__":
    unittest.main()
