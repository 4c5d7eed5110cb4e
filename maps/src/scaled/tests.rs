use proptest::prelude::*;

use super::*;
use crate::{Site, Summary};

fn site(nodes: u32, seed: u64) -> Site {
    match Site::from_text("scaled", &scaled_map(nodes, seed)) {
        Ok(site) => site,
        Err(findings) => unreachable!("{nodes} nodes, seed {seed}: {findings:?}"),
    }
}

#[test]
fn forty_nodes_make_a_museum_like_that_of_the_paper() {
    let found = site(40, 1).summary();
    let expected = Summary {
        nodes: 40,
        passages: 63,
        one_way: 0,
        doors: 10,
        closed: 1,
        areas: 8,
    };
    assert_eq!(found, expected);
}

#[test]
fn what_is_counted_grows_with_the_nodes() {
    let found = site(4000, 7).summary();
    let expected = Summary {
        nodes: 4000,
        passages: 6300,
        one_way: 0,
        doors: 1000,
        closed: 100,
        areas: 800,
    };
    assert_eq!(found, expected);
}

#[test]
fn the_robot_can_start_at_the_entrance() {
    for nodes in [1, 7, 40, 400] {
        let site = site(nodes, 3);
        assert_eq!(
            site.node("n1").and_then(|node| node.kind()),
            Some("entrance")
        );
    }
}

#[test]
fn the_open_doors_are_enough_to_get_everywhere() {
    let site = site(400, 5);
    let usable = |passage: &crate::Passage| {
        let door = passage.door().and_then(|door| site.door(door.as_str()));
        door.is_none_or(|door| door.is_open_at_first())
    };
    for node in site.nodes() {
        assert!(
            site.route("n1", node.name().as_str(), usable).is_some(),
            "{}",
            node.name()
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn every_museum_is_in_order_and_has_as_many_nodes_as_asked(nodes in 1u32..600, seed: u64) {
        prop_assert_eq!(site(nodes, seed).nodes().count(), nodes as usize);
        prop_assert_eq!(scaled_map(nodes, seed), scaled_map(nodes, seed));
    }
}
