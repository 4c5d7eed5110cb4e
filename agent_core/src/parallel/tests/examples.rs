//! Layers of a carrier's day: bottles, tables, one arm, one base.

use std::collections::{BTreeMap, BTreeSet};

use crate::language::parse_atom;
use crate::model::{Fact, Time};
use crate::parallel::clique::World;
use crate::parallel::footprint::{Candidate, Footprint, Literals};
use crate::parallel::layer::{Layer, PATIENCE, Underway, choose};

fn atom(text: &str) -> Fact {
    parse_atom(text).expect("an atom")
}

fn literals(texts: &[&str]) -> Literals {
    texts.iter().map(|text| (atom(text), true)).collect()
}

fn facts(texts: &[&str]) -> BTreeSet<Fact> {
    texts.iter().map(|text| atom(text)).collect()
}

fn action(
    action: &str,
    needs: &[&str],
    adds: &[&str],
    removes: &[&str],
    resource: &str,
    seconds: u64,
) -> Candidate {
    Candidate {
        footprint: Footprint {
            action: atom(action),
            needs: literals(needs),
            protects: Literals::new(),
            adds: facts(adds),
            removes: facts(removes),
            resources: BTreeSet::from([resource.into()]),
            duration: Time(seconds),
        },
        missing: Literals::new(),
        later: Literals::new(),
        deadline: None,
    }
}

/// From one place to another, between which it takes so long.
fn drive(from: &str, to: &str, seconds: u64) -> Candidate {
    let (here, there) = (format!("(at {from})"), format!("(at {to})"));
    let text = format!("(move {from} {to})");
    action(
        &text,
        &[&here, "(hand-free)"],
        &[&there],
        &[&here],
        "base",
        seconds,
    )
}

fn grasp(bottle: &str) -> Candidate {
    let held = format!("(holding {bottle})");
    let text = format!("(grasp {bottle})");
    let needs = ["(at kitchen)", "(hand-free)"];
    action(&text, &needs, &[&held], &["(hand-free)"], "arm", 30)
}

/// Everything can be mended in its own time: the place by driving back, the hand by putting away.
struct Room;

impl World for Room {
    fn holds(&self, fact: &Fact) -> bool {
        [atom("(at kitchen)"), atom("(hand-free)")].contains(fact)
    }

    fn mending(&self, _: &BTreeMap<Fact, bool>, fact: &Fact, _: bool) -> Option<Time> {
        match fact.name.as_str() {
            "at" => Some(Time(40)),
            "hand-free" => Some(Time(15)),
            _ => None,
        }
    }
}

fn layer(candidates: &[Candidate], executed: &[Footprint], left_out: &[u32]) -> Layer {
    let underway = Underway {
        running: &[],
        executed,
        left_out,
    };
    choose(&Room, candidates, underway).expect("there is something to do")
}

fn chosen(candidates: &[Candidate], layer: &Layer) -> Vec<String> {
    let members = layer.clique.members.iter();
    let actions = members.map(|it| candidates[*it].footprint.action.to_string());
    actions.collect()
}

#[test]
fn the_second_drink_is_grasped_before_the_carrier_drives_off_with_the_first() {
    let candidates = [drive("kitchen", "table1", 40), grasp("juice")];
    let layer = layer(&candidates, &[], &[]);
    assert_eq!(chosen(&candidates, &layer), ["(grasp juice)"]);
    // To free the hand again takes less than to come back.
    assert_eq!(layer.clique.loss, Time::ZERO);
}

#[test]
fn what_has_nothing_to_do_with_each_other_is_done_at_once_and_what_spoils_it_afterwards() {
    let speak = action("(speak)", &["(at kitchen)"], &["(told)"], &[], "voice", 10);
    let candidates = [drive("kitchen", "table1", 40), speak, grasp("juice")];
    let layer = layer(&candidates, &[], &[]);
    assert_eq!(chosen(&candidates, &layer), ["(speak)", "(grasp juice)"]);
    assert_eq!(layer.clique.first().collect::<Vec<_>>(), [1, 2]);
    assert_eq!(layer.clique.saving, Time(10));
}

#[test]
fn what_the_other_needs_until_then_is_left_to_it_within_one_clique() {
    let speak = action("(speak)", &["(at kitchen)"], &["(told)"], &[], "voice", 10);
    let candidates = [drive("kitchen", "table1", 40), speak];
    let layer = layer(&candidates, &[], &[]);
    assert_eq!(layer.clique.members, [0, 1]);
    assert_eq!(layer.clique.first().collect::<Vec<_>>(), [1]);
    let waits = &layer.clique.after[&0];
    assert_eq!(waits.members, BTreeSet::from([1]));
}

#[test]
fn nobody_drives_straight_back_while_somebody_needs_to_be_there() {
    let there = drive("table1", "kitchen", 40).footprint;
    let candidates = [drive("kitchen", "table1", 40), grasp("juice")];
    let layer = layer(&candidates, std::slice::from_ref(&there), &[PATIENCE, 0]);
    assert_eq!(chosen(&candidates, &layer), ["(grasp juice)"]);
    assert!(!layer.ban_lifted);
}

#[test]
fn if_everything_would_take_something_back_the_ban_is_lifted() {
    let there = drive("table1", "kitchen", 40).footprint;
    let candidates = [
        drive("kitchen", "table1", 40),
        drive("kitchen", "table1", 40),
    ];
    let layer = layer(&candidates, &[there], &[]);
    assert_eq!(layer.clique.members, [0]);
    assert!(layer.ban_lifted);
}

#[test]
fn who_was_left_out_too_often_goes_first() {
    let candidates = [drive("kitchen", "table1", 40), grasp("juice")];
    let layer = layer(&candidates, &[], &[PATIENCE, 0]);
    assert_eq!(chosen(&candidates, &layer), ["(move kitchen table1)"]);
}

#[test]
fn what_is_reached_by_the_others_anyway_is_no_loss() {
    // One wants to hand over what it holds, the other to put it away, only to have the hand free.
    let mut away = action(
        "(put-on-tray cola)",
        &["(holding cola)"],
        &["(hand-free)", "(loaded cola)"],
        &["(holding cola)"],
        "arm",
        15,
    );
    away.later = literals(&["(hand-free)"]);
    let hand_over = action(
        "(put-drink cola)",
        &["(holding cola)"],
        &["(hand-free)", "(served)"],
        &["(holding cola)"],
        "arm",
        20,
    );
    let candidates = [away, hand_over];
    let layer = layer(&candidates, &[], &[]);
    assert_eq!(chosen(&candidates, &layer), ["(put-drink cola)"]);
    assert_eq!(layer.clique.loss, Time::ZERO);
}
