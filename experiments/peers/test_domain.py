"""What the domains for GTPyhop plan. Skipped where GTPyhop is not installed."""

from __future__ import annotations

import contextlib
import io
import unittest

try:
    with contextlib.redirect_stdout(io.StringIO()):
        import gtpyhop
except ImportError:
    raise unittest.SkipTest("gtpyhop is not installed here") from None

import compare
import domain
import measure
import museum
from rows import ROWS

SITE = museum.read(compare.MAP)


class Plans(unittest.TestCase):
    def setUp(self) -> None:
        silence = contextlib.redirect_stdout(io.StringIO())
        silence.__enter__()
        self.addCleanup(silence.__exit__, None, None, None)
        gtpyhop.set_verbose_level(0)
        gtpyhop.set_recursive_planning(True)
        domain.lay_out(SITE)

    def route_m(self, start: str, goal: str, is_open: dict[str, bool]) -> float:
        found = gtpyhop.find_plan(domain.state_at(start, is_open), [domain.go(goal)])
        self.assertIsInstance(found, list, f"{start} to {goal}")
        return SITE.route_m(start, goal, [step[1:4] for step in found], is_open)

    def test_every_plan_leads_from_anywhere_to_anywhere(self) -> None:
        for style in domain.STYLES:
            domain.declare("both", style)
            for start in SITE.place_m:
                for goal in SITE.place_m:
                    length = self.route_m(start, goal, SITE.open_at_first)
                    shortest = SITE.shortest_m(start, goal, SITE.open_at_first) or 0.0
                    self.assertGreaterEqual(length, shortest - 1e-9)
                    if style == "routing" and SITE.area_of[start] != SITE.area_of[goal]:
                        self.assertAlmostEqual(length, shortest, msg=f"{start} to {goal}")

    def test_a_closed_door_is_gone_round(self) -> None:
        for style in domain.STYLES:
            domain.declare("both", style)
            for row in ROWS:
                self.route_m(row.emergency, row.goal, SITE.doors(row.closes))

    def test_where_there_is_no_way_there_is_no_plan(self) -> None:
        closed = dict.fromkeys(SITE.open_at_first, False)
        for style in domain.STYLES:
            domain.declare("both", style)
            found = gtpyhop.find_plan(domain.state_at("n40", closed), [domain.go("n1")])
            self.assertFalse(found)

    def test_planning_level_by_level_leads_the_same_way(self) -> None:
        for style in domain.STYLES:
            domains = {(level, style): domain.declare(level, style) for level in domain.LEVELS}
            for row in ROWS:
                area, node, both = measure._questions(SITE, row, style, domains)
                whole = measure.plan(both)
                self.assertEqual(measure.plan(node), whole[: len(measure.plan(node))])
                doors = [step[-1] for step in whole if step[0] == "cross"]
                self.assertEqual([step[-1] for step in measure.plan(area)][:-1], doors)

    def test_everything_is_measured_in_every_row(self) -> None:
        found = measure.compare(SITE, 1)
        keys = {(one["row"], one["level"], one["planner"]) for one in found["measured"]}
        self.assertEqual(len(keys), len(ROWS) * 4 * len(domain.STYLES))
        self.assertEqual(len(found["routes"]), len(ROWS) * len(domain.STYLES))
        for one in found["measured"]:
            self.assertGreater(one["expanded"], 0)
            self.assertGreaterEqual(one["evaluated"], one["expanded"])


if __name__ == "__main__":
    unittest.main()
