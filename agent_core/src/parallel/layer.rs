//! One layer of actions after another.

use std::collections::BTreeSet;

use super::clique::{Clique, World, best};
use super::footprint::{Candidate, Footprint};
use super::relation::retracts;
use crate::model::Time;

/// So many candidates are looked at in one layer, the oldest goals' first. All sets of them are judged.
pub const MOST: usize = 12;

/// A candidate that was left out so many times in a row goes before greater savings.
pub const PATIENCE: u32 = 12;

/// What is known when a layer is chosen.
#[derive(Clone, Copy, Debug)]
pub struct Underway<'a> {
    /// What runs, and how long it still takes.
    pub running: &'a [(Footprint, Time)],
    /// What was done in the layer before.
    pub executed: &'a [Footprint],
    /// How often in a row each candidate was left out.
    pub left_out: &'a [u32],
}

/// What is done next.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Layer {
    /// The actions, and who waits for whom.
    pub clique: Clique,
    /// All candidates would have taken something back, and nothing else was left to do.
    pub ban_lifted: bool,
}

/// The next layer from the candidates, the oldest goal's first; `None` if there is none to choose.
///
/// A candidate that would take back what the last layer has brought about for others is not chosen,
/// unless all of them would and nothing runs: then the ban is lifted, or nobody would ever move.
pub fn choose(
    world: &dyn World,
    candidates: &[Candidate],
    underway: Underway<'_>,
) -> Option<Layer> {
    let candidates = candidates.get(..MOST).unwrap_or(candidates);
    if candidates.is_empty() {
        return None;
    }
    let all: BTreeSet<usize> = (0..candidates.len()).collect();
    let steady: BTreeSet<usize> = (candidates.iter().enumerate())
        .filter(|(place, candidate)| {
            let others = candidates.iter().enumerate();
            let waiting = others
                .filter(|(other, _)| other != place)
                .map(|(_, other)| &other.footprint.needs);
            !retracts(&candidate.footprint, underway.executed, waiting)
        })
        .map(|(place, _)| place)
        .collect();
    let choose = |admitted: &BTreeSet<usize>| {
        let impatient = admitted.iter().copied().find(|place| {
            let times = underway.left_out.get(*place).copied();
            times.unwrap_or_default() >= PATIENCE
        });
        let needed =
            impatient.and_then(|_| best(world, candidates, underway.running, admitted, impatient));
        match (&needed, impatient, underway.running) {
            // What runs has to end first, and is not to be followed by more of its kind.
            (None, Some(_), [_, ..]) => Some(Clique::default()),
            (None, ..) => best(world, candidates, underway.running, admitted, None),
            (Some(_), ..) => needed,
        }
    };
    let something = |clique: &Clique| !clique.members.is_empty() || !underway.running.is_empty();
    let chosen = choose(&steady).filter(something).map(|clique| Layer {
        clique,
        ban_lifted: false,
    });
    chosen.or_else(|| {
        let clique = choose(&all).filter(something)?;
        Some(Layer {
            clique,
            ban_lifted: true,
        })
    })
}
