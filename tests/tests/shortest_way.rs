//! The planner against an oracle that shares no code with it: the shortest way from node to node.

use std::collections::BTreeSet;
use std::sync::Arc;

use agent_core::language::parse_tasks;
use agent_core::model::{Belief, FactChange, Symbol};
use agent_core::planner::{
    Agenda, NaivePlanner, Origin, Outcome, Planner, Problem, Settings, TaskList, simulate,
};
use intermezzo_tests::{Museum, museum};
use proptest::prelude::*;

/// A visit is reckoned to be at least this long.
const LEAST_VISIT_M: f64 = 1.0;

fn plan(museum: &Museum, from: &str, to: &str, closed: &[Symbol]) -> (Problem, Outcome) {
    let mut map = maps::area_level(&museum.site);
    let mut belief = Belief::default();
    belief.apply_all(&map.take_changing(&museum.area.model.observable));
    for fact in maps::area_start(&museum.site, from).expect("it is a node") {
        belief.apply(&FactChange::Add(fact));
    }
    for door in museum.site.doors() {
        let fact = agent_core::model::Fact::new("open", [door.name().as_str()]);
        belief.apply(&match closed.contains(door.name()) {
            true => FactChange::Remove(fact),
            false => FactChange::Add(fact),
        });
    }
    let problem = Problem {
        domain: Arc::new(museum.area.domain.clone()),
        model: Arc::new(museum.area.model.clone()),
        map: Arc::new(map),
        belief: Arc::new(belief),
        forbidden: BTreeSet::new(),
    };
    let tasks = parse_tasks(&format!("(go {to})")).expect("HDDL");
    let agenda = Agenda {
        tasks: TaskList::of_tasks(tasks.into_iter()),
        origin: Origin::Goal,
    };
    let mut planner = NaivePlanner::new(Settings::default());
    planner.begin(problem.clone(), &[agenda]);
    let outcome = loop {
        if let Some(outcome) = planner.think(50) {
            break outcome;
        }
    };
    (problem, outcome)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_cheapest_plan_is_as_long_as_the_shortest_way(
        from in 1_u8..=40,
        to in 1_u8..=40,
        closed in proptest::collection::btree_set(0_usize..10, 0..4),
    ) {
        let museum = museum();
        let doors: Vec<Symbol> = museum.site.doors().map(|door| door.name().clone()).collect();
        let closed: Vec<Symbol> = closed.into_iter().map(|door| doors[door].clone()).collect();
        let (from, to) = (format!("n{from}"), format!("n{to}"));
        let (problem, outcome) = plan(&museum, &from, &to, &closed);
        let open = |passage: &maps::Passage| passage.door().is_none_or(|door| !closed.contains(door));
        let way = museum.site.route(&from, &to, open);
        prop_assert_eq!(outcome.plans.is_empty(), way.is_none());
        if outcome.plans.is_empty() {
            prop_assert!(!outcome.wanted.is_empty(), "a closed door is in the way, and it is named");
        }
        // Inside one area the rough level reckons from the middle; the way is not its business.
        let area = |node: &str| museum.site.node(node).map(|node| node.area().clone());
        if let (Some(best), Some(way)) = (outcome.plans.first(), way)
            && area(&from) != area(&to)
        {
            let cost = best.cost.units();
            prop_assert!(cost > way.length_m - 1e-3, "{} is less than {}", cost, way.length_m);
            prop_assert!(cost < way.length_m + LEAST_VISIT_M + 1e-3, "{} is more than {}", cost, way.length_m);
        }
        let mut costs = Vec::new();
        for plan in &outcome.plans {
            prop_assert_eq!(simulate(&problem, &plan.steps, false), Ok(plan.cost));
            costs.push(plan.cost);
        }
        prop_assert!(costs.is_sorted(), "the cheapest first: {:?}", costs);
    }
}
