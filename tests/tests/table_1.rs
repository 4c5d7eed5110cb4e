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
            "(leave arc59 n35)",
            "(pass n35 n34 arc57 door7_8)",
            "(move n34 n30 arc52)",
            "(pass n30 n21 arc36 door5_7)",
            "(move n21 n20 arc34)",
            "(pass n20 n22 arc35 door5_6)",
            "(move n22 n23 arc37)",
            "(pass n23 n27 arc40 door4_6)",
            "(move n27 n28 arc46)",
            "(move n28 n26 arc45)",
            "(pass n26 n16 arc27 door2_4)",
            "(move n16 n14 arc25)",
            "(pass n14 n7 arc13 door1_2)",
            "(move n7 n5 arc10)",
            "(move n5 n1 arc4)",
        ]
    );
}

#[test]
fn n29_on_the_way_leaves_the_rest_of_the_parents_plan_as_it_is() {
    let stack = from_the_far_wing("n29");
    keeps_its_plan(&stack);
    assert_eq!(
        stack.done("child"),
        [
            "(leave arc59 n35)",
            "(pass n35 n34 arc57 door7_8)",
            "(move n34 n32 arc55)",
            "(move n32 n29 arc48)",
            "(move n29 n32 arc48)",
            "(move n32 n30 arc51)",
            "(pass n30 n21 arc36 door5_7)",
            "(move n21 n17 arc30)",
            "(pass n17 n9 arc17 door3_5)",
            "(move n9 n8 arc14)",
            "(move n8 n10 arc15)",
            "(pass n10 n6 arc12 door1_3)",
            "(move n6 n1 arc5)",
        ]
    );
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
    assert_eq!(
        stack.done("child"),
        [
            "(leave arc5 n1)",
            "(move n1 n5 arc4)",
            "(move n5 n7 arc10)",
            "(pass n7 n14 arc13 door1_2)",
            "(move n14 n15 arc24)",
            "(move n15 n13 arc22)",
            "(move n13 n16 arc23)",
            "(pass n16 n26 arc27 door2_4)",
            "(move n26 n27 arc44)",
            "(pass n27 n23 arc40 door4_6)",
            "(move n23 n22 arc37)",
            "(pass n22 n20 arc35 door5_6)",
            "(move n20 n21 arc34)",
            "(pass n21 n30 arc36 door5_7)",
            "(move n30 n34 arc52)",
            "(pass n34 n35 arc57 door7_8)",
            "(move n35 n40 arc59)",
        ]
    );
}

#[test]
fn n4_in_the_same_area_leaves_the_parents_plan_as_it_is() {
    let stack = from_the_entrance("n4");
    keeps_its_plan(&stack);
    assert_eq!(
        stack.done("child"),
        [
            "(leave arc5 n1)",
            "(move n1 n4 arc3)",
            "(move n4 n1 arc3)",
            "(move n1 n6 arc5)",
            "(pass n6 n10 arc12 door1_3)",
            "(move n10 n8 arc15)",
            "(move n8 n9 arc14)",
            "(pass n9 n17 arc17 door3_5)",
            "(move n17 n21 arc30)",
            "(pass n21 n30 arc36 door5_7)",
            "(move n30 n34 arc52)",
            "(pass n34 n35 arc57 door7_8)",
            "(move n35 n40 arc59)",
        ]
    );
}

#[test]
fn n12_on_the_way_leaves_the_rest_of_the_parents_plan_as_it_is() {
    let stack = from_the_entrance("n12");
    keeps_its_plan(&stack);
    assert_eq!(
        stack.done("child"),
        [
            "(leave arc5 n6)",
            "(pass n6 n10 arc12 door1_3)",
            "(move n10 n12 arc19)",
            "(move n12 n9 arc16)",
            "(pass n9 n17 arc17 door3_5)",
            "(move n17 n21 arc30)",
            "(pass n21 n30 arc36 door5_7)",
            "(move n30 n34 arc52)",
            "(pass n34 n35 arc57 door7_8)",
            "(move n35 n40 arc59)",
        ]
    );
}
