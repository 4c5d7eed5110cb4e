//! What it takes to take up what was interrupted, counted in the nodes that are expanded until the
//! plan is known: next to nothing where nothing has changed, whatever the size of the map.
//!
//! `NODES=100000 cargo test --release -p intermezzo_tests --test resuming` asks a larger map.

use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_core::protocol::{Happening, Resumption, Urgency};
use intermezzo_tests::{Ground, Museum, Planning, Rig, museum};

/// A row of the paper's Table 1: from where to where, the action that is interrupted, and where the
/// emergency takes the robot.
type Interruption = (&'static str, &'static str, &'static str, &'static str);

/// The suspended plan is taken up as it was.
const UNAFFECTED: [Interruption; 4] = [
    ("n40", "n1", "(move n40 n35 arc59)", "n38"),
    ("n40", "n1", "(move n40 n35 arc59)", "n29"),
    ("n1", "n40", "(move n1 n6 arc5)", "n4"),
    ("n1", "n40", "(move n1 n6 arc5)", "n12"),
];
/// It is revised.
const REVISED: [Interruption; 2] = [
    ("n40", "n1", "(move n40 n35 arc59)", "n28"),
    ("n1", "n40", "(move n1 n6 arc5)", "n13"),
];

/// How the parent has taken up the tour, and the nodes that were expanded for that.
fn resumed(planning: Planning, interruption: Interruption) -> (Resumption, u64) {
    let (start, goal, first, emergency) = interruption;
    let museum = Museum {
        planning,
        ..museum()
    };
    let mut stack = museum.stack_as_in_the_paper(start);
    stack.goal("tour", &format!("(go {goal})"));
    stack.run_into("child", first, 4.0);
    stack.emergency("emergency", &format!("(go {emergency})"));
    stack.run();
    assert!(stack.succeeded("tour"), "{}", stack.story());
    let found = stack
        .about("parent", "tour")
        .find_map(|event| match &event.what {
            Happening::GoalResumed { expanded, how, .. } => Some((*how, *expanded)),
            _ => None,
        });
    found.expect("the tour was interrupted")
}

#[test]
fn an_unaffected_plan_is_taken_up_with_two_expansions_at_most_where_planning_anew_takes_many() {
    for interruption in UNAFFECTED {
        let (how, expanded) = resumed(Planning::AsShipped, interruption);
        assert_eq!(how, Resumption::Continued, "{interruption:?}");
        assert!(expanded <= 2, "{interruption:?}: {expanded}");
        let (_, from_scratch) = resumed(Planning::FromScratch, interruption);
        assert!(from_scratch >= 9, "{interruption:?}: {from_scratch}");
    }
}

#[test]
fn a_plan_is_revised_with_less_than_half_of_what_planning_anew_takes() {
    for interruption in REVISED {
        let (how, expanded) = resumed(Planning::AsShipped, interruption);
        assert_ne!(how, Resumption::Continued, "{interruption:?}");
        let (_, from_scratch) = resumed(Planning::FromScratch, interruption);
        assert!(
            2 * expanded < from_scratch,
            "{interruption:?}: {expanded} of {from_scratch}"
        );
    }
}

/// The nodes expanded to take up a goal after an emergency in the same area.
fn resumed_on_a_map_of(nodes: u32) -> u64 {
    let ground = Ground::of(nodes);
    let planner = AnyPlanner::new(PlannerKind::Graph, Settings::default());
    let mut rig = Rig::new(&ground, planner);
    rig.go(&ground.target, Urgency::Normal);
    rig.emergency(&ground.nearby);
    rig.run_to_the_last_action();
    rig.happened.clear();
    rig.done();
    rig.think();
    let continued = |what: &Happening| {
        matches!(
            what,
            Happening::GoalResumed {
                how: Resumption::Continued,
                ..
            }
        )
    };
    assert!(rig.happened.iter().any(continued), "{:?}", rig.happened);
    rig.expanded()
}

#[test]
fn what_an_unaffected_plan_takes_does_not_grow_with_the_map() {
    let asked = std::env::var("NODES")
        .ok()
        .and_then(|text| text.parse().ok());
    for nodes in [40, 400, 2000].into_iter().chain(asked) {
        let expanded = resumed_on_a_map_of(nodes);
        assert!(expanded <= 2, "{nodes} nodes: {expanded}");
    }
}
