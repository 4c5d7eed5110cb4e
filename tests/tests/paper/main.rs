//! The paper's algorithms, step by step, and the decisions where it is silent: one agent on the
//! bench, the test its executor, its superior and its user.

mod algorithm_1;
mod algorithm_2;
mod algorithm_3;
mod algorithm_4;
mod algorithm_5;
mod decisions;

use agent_core::model::Map;
use intermezzo_tests::{Bench, museum};

/// The parent of a robot at n1.
fn parent() -> Bench {
    Bench::new(museum().parent("n1"))
}

/// The same, as in the paper: nothing that runs is kept for an emergency (decision 8 off).
fn parent_as_in_the_paper() -> Bench {
    let mut configuration = museum().parent("n1");
    configuration.policy.keep_what_helps = false;
    Bench::new(configuration)
}

/// A parent on the way to n40: `#1` enters area3.
fn on_the_way() -> Bench {
    let mut parent = parent_as_in_the_paper();
    parent.goal("tour", "(go n40)");
    assert_eq!(parent.told(), ["execute #1 (enter area1 area3 door1_3)"]);
    parent
}

/// The child of a robot at n1.
fn child() -> Bench {
    Bench::new(museum().child("n1", "child", "executor"))
}

/// The map of an area, as the parent hands it down.
fn map_of(area: &str) -> Map {
    maps::node_level(&museum().site, area).expect("the area is there")
}

/// A child that its superior has told to enter area3: `#1` moves from n1 to n6.
fn entering() -> Bench {
    let mut child = child();
    child.execute(1, "(enter area1 area3 door1_3)", Some(&map_of("area1")));
    assert_eq!(child.told(), ["execute #1 (move n1 n6 arc5)"]);
    child
}

/// What a robot reports that stands on arc5.
const ON_ARC5: [&str; 5] = [
    "(not (at n1))",
    "(on arc5)",
    "(left n1)",
    "(= (gap arc5 n1) 3.0)",
    "(= (gap arc5 n6) 4.762)",
];
