//! The six interruptions of the paper's Table 1, on the reconstructed museum: whether the parent
//! keeps the suspended plan or revises it, the whole drive, and that the interrupted goal is
//! reached.

use agent_core::protocol::Resumption;
use intermezzo_tests::{Museum, Stack, museum};

/// Drives from `start` to `goal`; the emergency comes while the robot is on the first arc.
fn interrupted(museum: &Museum, start: &str, goal: &str, first: &str, emergency: &str) -> Stack {
    let mut stack = museum.stack_as_in_the_paper(start);
    stack.goal("tour", &format!("(go {goal})"));
    stack.run_into("child", first, 4.0);
    stack.emergency("emergency", &format!("(go {emergency})"));
    stack.run();
    assert!(stack.succeeded("emergency"), "{}", stack.story());
    assert!(stack.succeeded("tour"), "{}", stack.story());
    assert_eq!(stack.place(), format!("at {goal}"));
    stack
}

fn from_the_far_wing(emergency: &str) -> Stack {
    interrupted(&museum(), "n40", "n1", "(move n40 n35 arc59)", emergency)
}

fn from_the_entrance(emergency: &str) -> Stack {
    interrupted(&museum(), "n1", "n40", "(move n1 n6 arc5)", emergency)
}

fn keeps_its_plan(stack: &Stack) {
    let how = stack.resumption("parent", "tour");
    assert_eq!(how, Some(Resumption::Continued), "{}", stack.story());
}

/// Whether to one that it had kept beside it, or to a new one.
fn revises_its_plan(stack: &Stack) {
    let how = stack.resumption("parent", "tour");
    let revised = how.is_some_and(|how| how != Resumption::Continued);
    assert!(revised, "{how:?}\n{}", stack.story());
}

#[test]
fn n38_in_the_same_area_leaves_the_parents_plan_as_it_is() {
    let stack = from_the_far_wing("n38");
    keeps_its_plan(&stack);
    assert_eq!(
        stack.done("child"),
        [
            "(leave arc59 n40)",
            "(move n40 n38 arc62)",
            "(move n38 n40 arc62)",
            "(move n40 n35 arc59)",
            "(pass n35 n34 arc57 door7_8)",
            "(move n34 n30 arc52)",
            "(pass n30 n21 arc36 door5_7)",
            "(move n21 n17 arc30)",
            "(pass n17 n9 arc17 door3_5)",
            "(move n9 n8 arc14)",
            "(move n8 n10 arc15)",
            "(pass n10 n6 arc12 door1_3)",
            "(move n6 n1 arc5)",
        ]
    );
}

#[test]
fn n28_in_another_wing_makes_the_parent_revise_its_plan() {
    let stack = from_the_far_wing("n28");
    revises_its_plan(&stack);
    assert_eq!(
        stack.done("child"),
        [
            "(resume-move n40 n35 arc59)",
            "(pass n35 n34 arc57 door7_8)",
            "(move n34 n30 arc52)",
            "(pass n30 n21 arc36 door5_7)",
            "(move n21 n20 arc34)",
            "(pass n20 n22 arc35 door5_6)",
            "(move n22 n23 arc37)",
            "(pass n23 n27 arc40 door4_6)",
            "(move n27 n28 arc46)",
        ]
    );
}

#[test]
fn n29_on_the_way_leaves_the_rest_of_the_parents_plan_as_it_is() {
    let stack = from_the_far_wing("n29");
    keeps_its_plan(&stack);
    // The area move that the emergency has made is not made again.
    assert_eq!(
        stack.done("parent"),
        [
            "(enter area8 area7 door7_8)",
            "(approach n29 area7)",
            "(enter area7 area5 door5_7)",
            "(enter area5 area3 door3_5)",
            "(enter area3 area1 door1_3)",
            "(approach n1 area1)",
        ]
    );
}

#[test]
fn n13_in_the_next_room_makes_the_parent_revise_its_plan() {
    let stack = from_the_entrance("n13");
    revises_its_plan(&stack);
}

#[test]
fn n4_in_the_same_area_leaves_the_parents_plan_as_it_is() {
    let stack = from_the_entrance("n4");
    keeps_its_plan(&stack);
    assert_eq!(
        stack.done("parent"),
        [
            "(approach n4 area1)",
            "(resume-enter area1 area3 door1_3)",
            "(enter area3 area5 door3_5)",
            "(enter area5 area7 door5_7)",
            "(enter area7 area8 door7_8)",
            "(approach n40 area8)",
        ]
    );
}

#[test]
fn n12_on_the_way_leaves_the_rest_of_the_parents_plan_as_it_is() {
    let stack = from_the_entrance("n12");
    keeps_its_plan(&stack);
    assert_eq!(
        stack.done("parent"),
        [
            "(enter area1 area3 door1_3)",
            "(approach n12 area3)",
            "(enter area3 area5 door3_5)",
            "(enter area5 area7 door5_7)",
            "(enter area7 area8 door7_8)",
            "(approach n40 area8)",
        ]
    );
}
