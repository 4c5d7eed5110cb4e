//! Random actions, judged by the code and by trying everything.

use std::collections::{BTreeMap, BTreeSet};

use super::oracle::{Act, Best, Case, Together, together};
use crate::model::{Action, Fact, Time};
use crate::parallel::clique::{World, best};
use crate::parallel::footprint::{Candidate, Footprint, Literals};
use crate::parallel::relation::{Relation, relation};

/// Numbers from a seed (Steele, Lea and Flood's SplitMix64).
pub struct Chance(pub u64);

impl Chance {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    pub fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }

    /// Each of the facts with one chance in `one_in`.
    fn some(&mut self, facts: u64, one_in: u64) -> u32 {
        (0..facts).fold(0, |set, fact| match self.below(one_in) {
            0 => set | 1 << fact,
            _ => set,
        })
    }
}

/// So many facts can be missing for one action and brought about by another.
const MISSING: u32 = 0b11;

fn act(chance: &mut Chance, facts: u64, now: u32) -> Act {
    let sparse = facts + chance.below(6);
    // What is missing is wanted by some and never in the way of others.
    let needs = chance.some(facts, sparse / 2) & (now | MISSING);
    let needs_not = chance.some(facts, sparse) & !now & !MISSING & !needs;
    let adds = chance.some(facts, sparse / 2) & !needs;
    let removes = (chance.some(facts, sparse) | needs & chance.some(facts, 3)) & !adds & !MISSING;
    Act {
        keeps: needs & !removes & chance.some(facts, 2) & now,
        keeps_not: needs_not & !adds & chance.some(facts, 2),
        needs,
        needs_not,
        adds,
        removes,
        resources: chance.some(4, 4) as u8,
        takes: 1 + chance.below(9),
        later: chance.some(facts, 3),
        later_not: 0,
        deadline: (chance.below(3) == 0).then(|| 100 + chance.below(3)),
    }
}

fn fact(number: usize) -> Fact {
    Fact::new("f", [number.to_string().as_str()])
}

fn facts(set: u32) -> BTreeSet<Fact> {
    let numbers = (0..32).filter(|number| set >> number & 1 == 1);
    numbers.map(fact).collect()
}

fn literals(so: u32, not_so: u32) -> Literals {
    let so = facts(so).into_iter().map(|fact| (fact, true));
    let not_so = facts(not_so).into_iter().map(|fact| (fact, false));
    so.chain(not_so).collect()
}

fn candidate(number: usize, act: &Act, now: u32) -> Candidate {
    let resources = (0..8).filter(|it| act.resources >> it & 1 == 1);
    Candidate {
        footprint: Footprint {
            action: Action::new("act", [number.to_string().as_str()]),
            needs: literals(act.needs, act.needs_not),
            protects: literals(act.keeps, act.keeps_not),
            adds: facts(act.adds),
            removes: facts(act.removes),
            resources: resources.map(|it| format!("r{it}").into()).collect(),
            duration: Time(act.takes),
        },
        missing: literals(act.missing(now), 0),
        later: literals(act.later, act.later_not),
        deadline: act.deadline.map(Time),
    }
}

fn mending(fact: usize, wanted: bool, changed: usize) -> Option<u64> {
    match fact % 4 {
        0 => None,
        other => Some(other as u64 + u64::from(wanted) + changed as u64 % 2),
    }
}

struct Given {
    now: u32,
}

impl World for Given {
    fn holds(&self, fact: &Fact) -> bool {
        let number: u32 = fact.args[0].as_str().parse().expect("a number");
        self.now >> number & 1 == 1
    }

    fn mending(&self, changes: &BTreeMap<Fact, bool>, fact: &Fact, wanted: bool) -> Option<Time> {
        let number = fact.args[0].as_str().parse().expect("a number");
        mending(number, wanted, changes.len()).map(Time)
    }
}

#[test]
fn actions_go_together_exactly_if_trying_them_out_in_all_orders_says_so() {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for seed in 0..20_000 {
        let mut chance = Chance(seed);
        let facts = 4 + chance.below(6);
        let now = chance.some(facts, 2) & !MISSING | chance.some(2, 3);
        let (a, b) = (act(&mut chance, facts, now), act(&mut chance, facts, now));
        let found = relation(&candidate(0, &a, now), &candidate(1, &b, now));
        let tried = together(&a, &b, now);
        let same = matches!(
            (found, tried),
            (Relation::Independent, Together::Independent)
                | (Relation::Before, Together::Before)
                | (Relation::After, Together::After)
                | (Relation::Either, Together::Either)
                | (Relation::Exclusive, Together::Exclusive)
        );
        assert!(
            same,
            "seed {seed}: {found:?}, tried: {tried:?}\n{a:?}\n{b:?}\n{now:b}"
        );
        *seen.entry(format!("{found:?}")).or_default() += 1;
    }
    assert_eq!(seen.len(), 5, "every relation has been met: {seen:?}");
    assert!(seen.values().all(|times| *times > 200), "{seen:?}");
}

/// One random layer, and what was found.
fn compare(seed: u64, most: u64) -> Option<Best> {
    let mut chance = Chance(seed);
    let facts = 6 + chance.below(10);
    let now = chance.some(facts, 2) & !MISSING | chance.some(2, 3);
    let count = 1 + chance.below(most);
    let acts: Vec<Act> = (0..count).map(|_| act(&mut chance, facts, now)).collect();
    let mut running: Vec<(Act, u64)> = Vec::new();
    for _ in 0..chance.below(3) {
        let another = act(&mut chance, facts, now);
        let goes =
            |(other, _): &(Act, u64)| together(other, &another, now) == Together::Independent;
        if another.missing(now) == 0 && running.iter().all(goes) {
            let left = 1 + chance.below(another.takes);
            running.push((another, left));
        }
    }
    let case = Case {
        acts: &acts,
        running: &running,
        now,
        mending: &mending,
    };
    let expected = case.best();
    let candidates: Vec<Candidate> = (acts.iter().enumerate())
        .map(|(number, act)| candidate(number, act, now))
        .collect();
    let running: Vec<(Footprint, Time)> = (running.iter())
        .map(|(act, left)| (candidate(99, act, now).footprint, Time(*left)))
        .collect();
    let admitted = (0..candidates.len()).collect();
    let found = best(&Given { now }, &candidates, &running, &admitted, None);
    let found = found.map(|clique| Best {
        members: clique.members,
        saving: clique.saving.0,
        loss: clique.loss.0,
    });
    assert_eq!(found, expected, "seed {seed}\n{acts:#?}\n{running:#?}");
    found
}

#[test]
fn the_best_clique_is_the_one_that_trying_all_sets_in_all_orders_finds() {
    let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
    for seed in 0..3000 {
        let found = compare(seed, 7);
        *sizes
            .entry(found.map_or(0, |it| it.members.len()))
            .or_default() += 1;
    }
    assert!(sizes.len() > 4, "cliques of all sizes: {sizes:?}");
}

#[test]
fn it_is_with_twelve_candidates_too() {
    for seed in 10_000..10_150 {
        compare(seed, 12);
    }
}
