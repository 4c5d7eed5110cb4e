//! The actions of a layer that are done together: the clique of greatest saving.
//!
//! Maximal cliques are `pathfinding`'s (Bron and Kerbosch); the score is ours. Which maximal cliques
//! there are does not depend on the order in which that library comes upon them, and they are sorted.

use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BTreeSet};

use pathfinding::undirected::cliques::maximal_cliques;

use super::footprint::{Candidate, Footprint};
use super::relation::{Relation, relation};
use super::schedule::{Jobs, Schedule};
use crate::model::{Fact, Symbol, Time};

/// What has to be known of the world to judge a clique.
pub trait World {
    /// Whether a fact holds now.
    fn holds(&self, fact: &Fact) -> bool;

    /// How long the quickest action takes that makes the fact hold, or not hold, as `wanted` again once
    /// `changes` have come about; `None` if no single action does.
    fn mending(&self, changes: &BTreeMap<Fact, bool>, fact: &Fact, wanted: bool) -> Option<Time>;
}

/// Actions that are done together.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Clique {
    /// Which of the candidates, by their places, in order.
    pub members: Vec<usize>,
    /// For each member, which other members and which running actions have to end before it begins.
    /// Without an entry it begins at once.
    pub after: BTreeMap<usize, Prefix>,
    /// What is saved against one after the other, in microseconds.
    pub saving: Time,
    /// What it takes to make good what is spoilt for the candidates that are left out, as far as that is
    /// more than it would be the other way round.
    pub loss: Time,
}

/// What an action waits for.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Prefix {
    /// Other members, by their places among the candidates.
    pub members: BTreeSet<usize>,
    /// Running actions, by their places.
    pub running: BTreeSet<usize>,
}

impl Clique {
    /// The members that wait for nothing.
    pub fn first(&self) -> impl Iterator<Item = usize> + use<'_> {
        let waits = |member: &usize| self.after.contains_key(member);
        let members = self.members.iter().copied();
        members.filter(move |member| !waits(member))
    }

    fn score(&self) -> i128 {
        i128::from(self.saving.0) - i128::from(self.loss.0)
    }
}

/// Chooses from `candidates`, the oldest goal's first, those that are done together, and with what is
/// `running` for so long still. `admitted`: those that may be chosen; the others only count as left
/// out. `needed`: one that must be among them. `None` if there is nothing to choose; an empty clique
/// if it is better to wait for what runs.
///
/// The score: what is saved against one after the other (the sum of the durations less the makespan in
/// allowance order) less the loss, which is, for each candidate that is left out, what it takes to
/// bring those of its needs about again that the clique spoils, unless what it is done for has come
/// about; and of that only what is more than the members would lose if the candidate went first, as of
/// two that spoil each other's ground one has to. Ties: the greater sum, more members, the earlier
/// deadline, the older goals.
pub fn best(
    world: &dyn World,
    candidates: &[Candidate],
    running: &[(Footprint, Time)],
    admitted: &BTreeSet<usize>,
    needed: Option<usize>,
) -> Option<Clique> {
    let graph = Graph::new(candidates, running, admitted);
    let mut best: Option<(Rank, Clique)> = None;
    for members in graph.cliques() {
        let none = members.is_empty() && running.is_empty();
        if none || needed.is_some_and(|needed| !members.contains(&needed)) {
            continue;
        }
        let Some(clique) = graph.judged(world, &members) else {
            continue;
        };
        let rank = graph.rank(&clique);
        if (best.as_ref()).is_none_or(|(known, _)| rank.cmp(known) == Ordering::Greater) {
            best = Some((rank, clique));
        }
    }
    best.map(|(_, clique)| clique)
}

/// Greater is better.
type Rank = (i128, Time, usize, Reverse<Time>, Reverse<Vec<usize>>);

struct Graph<'a> {
    candidates: &'a [Candidate],
    running: &'a [(Footprint, Time)],
    /// Of candidates that may be chosen.
    admitted: BTreeSet<usize>,
    relations: BTreeMap<(usize, usize), Relation>,
    /// For each candidate the running actions that it has to wait for.
    waits_for: BTreeMap<usize, BTreeSet<usize>>,
}

impl<'a> Graph<'a> {
    fn new(
        candidates: &'a [Candidate],
        running: &'a [(Footprint, Time)],
        admitted: &BTreeSet<usize>,
    ) -> Self {
        let mut graph = Self {
            candidates,
            running,
            admitted: BTreeSet::new(),
            relations: BTreeMap::new(),
            waits_for: BTreeMap::new(),
        };
        for place in admitted.iter().copied() {
            let Some(candidate) = candidates.get(place) else {
                continue;
            };
            if let Some(waits_for) = beside(candidate, running) {
                graph.waits_for.insert(place, waits_for);
                graph.admitted.insert(place);
            }
        }
        for a in &graph.admitted {
            for b in graph.admitted.range(a + 1..) {
                let relation = relation(&candidates[*a], &candidates[*b]);
                graph.relations.insert((*a, *b), relation);
            }
        }
        graph
    }

    /// How `a` stands to `b`, which comes after it.
    fn relation(&self, a: usize, b: usize) -> Relation {
        let known = self.relations.get(&(a, b)).copied();
        known.unwrap_or(Relation::Exclusive)
    }

    /// All sets of actions that go together in pairs, the empty one included.
    fn cliques(&self) -> BTreeSet<Vec<usize>> {
        let mut maximal: Vec<BTreeSet<usize>> = Vec::new();
        maximal_cliques(
            self.admitted.iter().copied(),
            &mut |a: &usize, b: &usize| self.relation(*a.min(b), *a.max(b)) != Relation::Exclusive,
            &mut |clique| maximal.push(clique.iter().copied().collect()),
        );
        // What is best is not always maximal: an action that spoils something is better done later.
        let mut all = BTreeSet::from([Vec::new()]);
        for clique in maximal {
            let mut parts: Vec<Vec<usize>> = vec![Vec::new()];
            for member in clique {
                let with: Vec<Vec<usize>> = (parts.iter())
                    .map(|part| part.iter().copied().chain([member]).collect())
                    .collect();
                parts.extend(with);
            }
            all.extend(parts);
        }
        all
    }

    /// A set of actions in its best order; `None` if there is none, or something is missing to begin one
    /// of them that no other one brings about.
    fn judged(&self, world: &dyn World, members: &[usize]) -> Option<Clique> {
        let (mut before, mut apart) = (Vec::new(), Vec::new());
        let first_running = members.len();
        for (place, a) in members.iter().enumerate() {
            for (other, b) in members.iter().enumerate().skip(place + 1) {
                match self.relation(*a, *b) {
                    Relation::Independent => {}
                    Relation::Before => before.push((place, other)),
                    Relation::After => before.push((other, place)),
                    Relation::Either => apart.push((place, other)),
                    Relation::Exclusive => return None,
                }
            }
            let waits_for = self.waits_for.get(a).into_iter().flatten();
            before.extend(waits_for.map(|running| (first_running + running, place)));
        }
        if !self.is_provided(members, &before) {
            return None;
        }
        let own = members
            .iter()
            .map(|it| self.candidates[*it].footprint.duration);
        let left = self.running.iter().map(|(_, left)| *left);
        let durations: Vec<Time> = own.chain(left).collect();
        let jobs = Jobs {
            durations: &durations,
            before,
            apart,
            at_least: self.load(members),
        };
        let schedule = jobs.shortest()?;
        let sum = durations.iter().fold(Time::ZERO, |sum, next| sum + *next);
        Some(Clique {
            after: prefixes(members, &schedule),
            saving: sum.since(schedule.makespan),
            loss: self.loss(world, members, &schedule),
            members: members.to_vec(),
        })
    }

    /// Whether whatever is missing for a member is brought about by one before it.
    fn is_provided(&self, members: &[usize], before: &[(usize, usize)]) -> bool {
        let footprint = |place: usize| match members.get(place) {
            Some(member) => &self.candidates[*member].footprint,
            None => &self.running[place - members.len()].0,
        };
        members.iter().enumerate().all(|(place, member)| {
            let mut missing = self.candidates[*member].missing.iter();
            missing.all(|(fact, wanted)| {
                let mut earlier = before.iter().filter(|(_, second)| *second == place);
                earlier.any(|(first, _)| footprint(*first).brings_about(fact, *wanted))
            })
        })
    }

    /// The longest that one resource has to work.
    fn load(&self, members: &[usize]) -> Time {
        let mut loads: BTreeMap<&Symbol, Time> = BTreeMap::new();
        for member in members {
            let footprint = &self.candidates[*member].footprint;
            for resource in &footprint.resources {
                let load = loads.entry(resource).or_default();
                *load = *load + footprint.duration;
            }
        }
        loads.into_values().max().unwrap_or(Time::ZERO)
    }

    fn loss(&self, world: &dyn World, members: &[usize], schedule: &Schedule) -> Time {
        let mut order: Vec<(Time, usize)> = (members.iter().enumerate())
            .map(|(place, member)| {
                let takes = self.candidates[*member].footprint.duration;
                (schedule.begins[place] + takes, *member)
            })
            .collect();
        order.sort();
        let mut changes: BTreeMap<Fact, bool> = BTreeMap::new();
        for (_, member) in order {
            let effects = self.candidates[member].footprint.effects();
            changes.extend(effects.map(|(fact, holds)| (fact.clone(), holds)));
        }
        let left_out = (0..self.candidates.len()).filter(|place| !members.contains(place));
        left_out.fold(Time::ZERO, |sum, place| {
            let candidate = &self.candidates[place];
            let lost = loss_of(world, candidate, &changes);
            if lost == Time::ZERO {
                return sum;
            }
            let effects = candidate.footprint.effects();
            let changes = effects.map(|(fact, holds)| (fact.clone(), holds)).collect();
            let otherwise = members.iter().fold(Time::ZERO, |sum, member| {
                sum + loss_of(world, &self.candidates[*member], &changes)
            });
            sum + lost.since(otherwise)
        })
    }

    fn rank(&self, clique: &Clique) -> Rank {
        let members = || clique.members.iter().map(|it| &self.candidates[*it]);
        let deadlines = members().filter_map(|it| it.deadline);
        (
            clique.score(),
            members().fold(Time::ZERO, |sum, it| sum + it.footprint.duration),
            clique.members.len(),
            Reverse(deadlines.min().unwrap_or(Time(u64::MAX))),
            Reverse(clique.members.clone()),
        )
    }
}

/// The running actions that a candidate has to wait for; `None` if it does not go with one of them.
fn beside(candidate: &Candidate, running: &[(Footprint, Time)]) -> Option<BTreeSet<usize>> {
    let mut waits_for = BTreeSet::new();
    for (place, (footprint, _)) in running.iter().enumerate() {
        let running = Candidate {
            footprint: footprint.clone(),
            missing: BTreeMap::new(),
            later: BTreeMap::new(),
            deadline: None,
        };
        match relation(&running, candidate) {
            Relation::Independent => {}
            Relation::Before | Relation::Either => {
                waits_for.insert(place);
            }
            Relation::After | Relation::Exclusive => return None,
        }
    }
    Some(waits_for)
}

/// Who waits for whom. Of running actions only those are named that a member waits for itself.
fn prefixes(members: &[usize], schedule: &Schedule) -> BTreeMap<usize, Prefix> {
    let mut prefixes: BTreeMap<usize, Prefix> = BTreeMap::new();
    for (first, second) in &schedule.before {
        let Some(second) = members.get(*second) else {
            continue;
        };
        let prefix = prefixes.entry(*second).or_default();
        match members.get(*first) {
            Some(first) => prefix.members.insert(*first),
            None => prefix.running.insert(first - members.len()),
        };
    }
    prefixes
}

/// What it takes to make good what `changes` spoil for a candidate: for each of its needs that they undo
/// the quickest single action that brings it about again, or, if there is none, as long as the
/// candidate itself takes. Nothing, if what it is done for is so by then.
fn loss_of(world: &dyn World, candidate: &Candidate, changes: &BTreeMap<Fact, bool>) -> Time {
    let footprint = &candidate.footprint;
    let so = |(fact, holds): (&Fact, bool)| match changes.get(fact) {
        Some(after) => *after == holds,
        None => world.holds(fact) == holds,
    };
    if candidate.point().all(so) {
        return Time::ZERO;
    }
    let spoilt = (footprint.needs.iter())
        .filter(|(fact, wanted)| changes.get(*fact).is_some_and(|after| after != *wanted))
        .filter(|(fact, _)| !candidate.missing.contains_key(*fact));
    spoilt.fold(Time::ZERO, |sum, (fact, wanted)| {
        let mending = world.mending(changes, fact, *wanted);
        sum + mending.unwrap_or(footprint.duration)
    })
}
