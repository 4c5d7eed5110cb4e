//! What is found in the domains that the agents have: the robot is at one place.

use std::path::Path;

use agent_core::planner::invariants::{Variables, mutex_groups};
use maps::{Level, read_level};

fn groups(level: &Level) -> Vec<String> {
    let found = mutex_groups(&level.domain, &level.model);
    found.iter().map(ToString::to_string).collect()
}

fn level(dir: &str, name: &str) -> Level {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join(dir);
    read_level(&dir, name).expect("our own domains can be read")
}

#[test]
fn in_the_museum_the_robot_is_in_one_area_and_has_come_in_by_one_door() {
    let area = level("museum", "area");
    assert_eq!(groups(&area), ["{(at *)}", "{(entered *)}", "{(in *)}"]);
}

#[test]
fn in_the_museum_the_robot_is_at_one_node_or_on_one_arc() {
    assert_eq!(groups(&level("museum", "node")), ["{(at *), (on *)}"]);
}

#[test]
fn so_it_is_on_the_third_storey() {
    let motion = level("../tests/domains", "motion");
    let all = mutex_groups(&motion.domain, &motion.model);
    let chosen = Variables::choose(&all, []);
    let chosen: Vec<String> = chosen.groups().iter().map(ToString::to_string).collect();
    assert_eq!(chosen, ["{(at *), (on *)}"]);
}
