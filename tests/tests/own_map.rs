//! A robot in a building of the user's: the office of `maps/examples`, made of a navigation graph of
//! Open-RMF, with the museum's domains.

use std::path::Path;
use std::sync::Arc;

use intermezzo_tests::{Museum, Stack, museum};
use maps::{RmfOptions, from_rmf};

fn office() -> Museum {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../maps/examples/office.rmf.yaml");
    let graph = std::fs::read_to_string(file).expect("the graph is there");
    let made = from_rmf("office.rmf.yaml", &graph, &RmfOptions::default());
    Museum {
        site: Arc::new(made.expect("the graph is in order").site),
        ..museum()
    }
}

fn passed(stack: &Stack, door: &str) -> bool {
    let done = stack.done("executor");
    done.iter().any(|action| action.contains(door))
}

#[test]
fn a_robot_drives_through_the_office_and_is_interrupted_there() {
    let mut stack = office().stack("charger1");
    stack.goal("deliver", "(go shelf_b)");
    stack.run_into("child", "(pass n4 n5 arc4 fire_door)", 1.0);
    stack.emergency("visitor", "(go reception)");
    stack.run();
    assert!(stack.succeeded("visitor"), "{}", stack.story());
    assert!(stack.succeeded("deliver"), "{}", stack.story());
    assert_eq!(stack.place(), "at shelf_b");
}

#[test]
fn with_the_fire_door_closed_it_goes_round_through_the_meeting_room() {
    let mut stack = office().stack("charger1");
    stack.world("(not (open fire_door))");
    stack.goal("deliver", "(go shelf_b)");
    stack.run();
    assert!(stack.succeeded("deliver"), "{}", stack.story());
    assert!(
        passed(&stack, "meeting_side_door") && !passed(&stack, "fire_door"),
        "{}",
        stack.story()
    );
}
