//! What is shared comes to be known by all, whatever is lost on the way.

use super::*;
use crate::model::Atom;
use crate::service::message::Tasks;

fn at(secs: f64) -> Time {
    Time::from_secs(secs)
}

fn service(name: &str) -> StateService {
    let names = |names: &[&str]| {
        names
            .iter()
            .map(|name| Symbol::from(*name))
            .collect::<Vec<_>>()
    };
    StateService::new(
        name.into(),
        at(1.0),
        names(&["spill", "with", "seated"]),
        names(&["seated"]),
    )
}

fn spill(place: &str) -> Fact {
    Atom::new("spill", [place])
}

fn seated(guest: &str, table: &str) -> Fact {
    Atom::new("seated", [guest, table])
}

fn said(service: &mut StateService) -> Vec<Message> {
    outputs(service)
        .into_iter()
        .filter_map(|output| match output {
            StateOutput::Say(message) => Some(message),
            _ => None,
        })
        .collect()
}

fn outputs(service: &mut StateService) -> Vec<StateOutput> {
    std::iter::from_fn(|| service.poll_output()).collect()
}

fn tasks(service: &StateService, now: Time) -> Message {
    let digest = service.digest();
    Message {
        by: service.name.clone(),
        at: now,
        body: Body::Tasks(Tasks {
            digest,
            ..Tasks::default()
        }),
    }
}

#[test]
fn what_one_sees_the_others_learn_with_its_source_and_its_age() {
    let (mut a, mut b) = (service("a"), service("b"));
    a.sensed(at(3.0), &[FactChange::Add(spill("t3"))]);
    b.settle(at(3.1));
    for message in said(&mut a) {
        b.heard(&message);
    }
    let learnt = StateOutput::Learn {
        by: "a".into(),
        changes: vec![FactChange::Add(spill("t3"))],
    };
    assert_eq!(outputs(&mut b), [learnt]);
    let known = Known {
        holds: true,
        source: "a".into(),
        at: at(3.0),
    };
    assert_eq!(b.table()[&spill("t3")], known);
}

#[test]
fn an_older_word_does_not_count_against_what_was_seen_since() {
    let (mut a, mut b) = (service("a"), service("b"));
    a.sensed(at(1.0), &[FactChange::Add(spill("t3"))]);
    let old = said(&mut a);
    b.sensed(at(2.0), &[FactChange::Remove(spill("t3"))]);
    outputs(&mut b);
    for message in old.iter().chain(&old) {
        b.heard(message);
    }
    assert_eq!(outputs(&mut b), []);
    assert!(!b.table()[&spill("t3")].holds);
}

#[test]
fn of_two_words_at_one_moment_the_one_that_was_said_later_counts() {
    let (mut a, mut b) = (service("a"), service("b"));
    for holds in [true, false, true, false] {
        let change = match holds {
            true => FactChange::Add(spill("t3")),
            false => FactChange::Remove(spill("t3")),
        };
        a.sensed(at(1.0), &[change]);
        b.settle(at(1.0));
        for message in said(&mut a) {
            b.heard(&message);
        }
        assert_eq!(b.table()[&spill("t3")].holds, holds);
        assert_eq!(a.digest(), b.digest());
    }
}

#[test]
fn what_is_seen_here_counts_more_than_what_was_said_by_a_clock_that_is_fast() {
    let (mut a, mut b) = (service("a"), service("b"));
    a.sensed(at(1.4), &[FactChange::Add(spill("t3"))]);
    b.settle(at(1.0));
    for message in said(&mut a) {
        b.heard(&message);
    }
    b.sensed(at(1.2), &[FactChange::Remove(spill("t3"))]);
    for message in said(&mut b) {
        a.heard(&message);
    }
    assert!(!a.table()[&spill("t3")].holds && !b.table()[&spill("t3")].holds);
    assert_eq!(a.digest(), b.digest());
}

#[test]
fn what_is_ones_own_business_is_told_to_nobody_and_believed_of_nobody() {
    let (mut a, mut b) = (service("a"), service("b"));
    let own = Atom::new("hand-free", []);
    a.sensed(at(1.0), &[FactChange::Add(own.clone())]);
    assert_eq!(outputs(&mut a), []);
    let told = Told {
        fact: own,
        holds: true,
        source: "a".into(),
        at: at(1.0),
    };
    b.heard(&Message {
        by: "a".into(),
        at: at(1.0),
        body: Body::Told(vec![told]),
    });
    assert_eq!(outputs(&mut b), []);
    assert!(b.table().is_empty());
}

#[test]
fn what_is_not_known_is_asked_for_until_somebody_says_it() {
    let (mut a, mut b) = (service("a"), service("b"));
    let wanted = seated("ann", "t1");
    assert!(a.is_unknown(&wanted));
    // What nobody has said of what need not be asked for does not hold.
    assert!(!a.is_unknown(&spill("t1")));
    a.need(BTreeSet::from([wanted.clone(), spill("t1")]));
    a.settle(at(1.0));
    let asked = said(&mut a);
    assert!(matches!(&asked[0].body, Body::Need(facts) if *facts == [wanted.clone()]));
    // Lost. It is said again.
    assert_eq!(a.wake_at(), Some(at(2.0)));
    a.settle(at(2.0));
    let asked = said(&mut a);
    b.heard(&asked[0]);
    let to_find_out = StateOutput::Asked {
        by: "a".into(),
        facts: vec![wanted.clone()],
    };
    assert_eq!(outputs(&mut b), [to_find_out]);
    b.sensed(at(2.5), &[FactChange::Add(wanted.clone())]);
    a.settle(at(2.6));
    for message in said(&mut b) {
        a.heard(&message);
    }
    assert!(!a.is_unknown(&wanted));
    assert!(a.needs().is_empty());
    assert_eq!(a.wake_at(), None);
}

#[test]
fn one_that_comes_late_hears_all_that_is_known() {
    let (mut a, mut b) = (service("a"), service("b"));
    for place in 0..200 {
        let fact = spill(&format!("t{place}"));
        a.sensed(at(1.0), &[FactChange::Add(fact)]);
    }
    said(&mut a);
    b.settle(at(10.0));
    a.settle(at(10.0));
    let hello = tasks(&b, at(10.0));
    a.heard(&hello);
    let told = said(&mut a);
    assert!(
        told.len() > 1
            && told
                .iter()
                .all(|it| matches!(&it.body, Body::Told(told) if told.len() <= FACTS_IN_A_MESSAGE))
    );
    for message in told {
        b.heard(&message);
    }
    assert_eq!(a.table(), b.table());
    assert_eq!(a.digest(), b.digest());
    // Then nobody has anything to say.
    outputs(&mut b);
    b.settle(at(20.0));
    let hello = tasks(&a, at(20.0));
    b.heard(&hello);
    assert_eq!(outputs(&mut b), []);
}

#[test]
fn a_vehicle_that_is_started_again_knows_what_it_knew() {
    let mut a = service("a");
    a.sensed(at(1.0), &[FactChange::Add(spill("t1"))]);
    a.sensed(at(2.0), &[FactChange::Add(seated("ann", "t1"))]);
    let rows = a.write_down().into_iter();
    let rows: crate::protocol::Rows = rows.filter_map(|row| Some((row.key, row.value?))).collect();
    let mut again = service("a");
    again.recall(&rows).unwrap();
    assert_eq!(again.table(), a.table());
    assert_eq!(again.digest(), a.digest());
    assert_eq!(again.write_down(), []);
}

#[test]
fn what_a_vehicle_has_with_it_is_known_to_the_others() {
    let mut a = service("a");
    let with = |bottle| Atom::new("with", [bottle, "k3"]);
    a.sensed(
        at(1.0),
        &[
            FactChange::Add(with("cola1")),
            FactChange::Add(with("juice1")),
        ],
    );
    a.sensed(at(2.0), &[FactChange::Remove(with("juice1"))]);
    assert_eq!(a.about(&"k3".into()), [with("cola1")]);
}

#[test]
fn whatever_is_lost_or_late_all_come_to_know_the_same() {
    let number = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
    let seeds = match number("SEED") {
        Some(seed) => seed..seed + 1,
        None => 0..number("RUNS").unwrap_or(200),
    };
    for seed in seeds {
        let mut state = seed;
        // Enough of chance for this (Knuth's linear congruence).
        let mut below = |most: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % most
        };
        let names = ["a", "b", "c", "d"];
        let mut all: Vec<StateService> = names.iter().map(|name| service(name)).collect();
        let mut late: Vec<(usize, Message)> = Vec::new();
        for step in 0..120_u64 {
            let now = Time(step * 300_000);
            let calm = step >= 60;
            for (who, one) in all.iter_mut().enumerate() {
                one.settle(now);
                if !calm && below(5) == 0 {
                    let fact = spill(&format!("t{}", below(6)));
                    let change = match below(2) {
                        0 => FactChange::Add(fact),
                        _ => FactChange::Remove(fact),
                    };
                    one.sensed(now, &[change]);
                }
                for message in said(one).into_iter().chain([tasks(one, now)]) {
                    for to in (0..names.len()).filter(|to| *to != who) {
                        if below(3) > 0 {
                            late.push((to, message.clone()));
                        }
                    }
                }
            }
            // Any of what is on its way, in any order, some of it twice.
            for _ in 0..late.len() / 2 + 1 {
                if late.is_empty() {
                    break;
                }
                let which = below(late.len() as u64) as usize;
                let (to, message) = match below(6) {
                    0 => late[which].clone(),
                    _ => late.swap_remove(which),
                };
                all[to].heard(&message);
            }
        }
        for other in &all[1..] {
            assert_eq!(all[0].table(), other.table(), "seed {seed}");
            assert_eq!(all[0].digest(), other.digest(), "seed {seed}");
        }
    }
}
