//! Whether two actions go together (the multitasking paper's relations 1 to 3).
//!
//! The formulas of the paper are lost in its text; these are ours, after Graphplan's and LCGP's, in the
//! direction that the paper describes: independence is stricter than allowance, which comes in two
//! cases.

use super::footprint::{Candidate, Footprint, Literals};

/// How two actions of one layer stand to each other.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Relation {
    /// At the same time (relation 1).
    Independent,
    /// Together, the first before the second (relation 2).
    Before,
    /// Together, the second before the first (relation 2).
    After,
    /// Together, one after the other, in whichever order: they share a resource and nothing else.
    Either,
    /// Not together.
    Exclusive,
}

/// How `a` stands to `b`.
pub fn relation(a: &Candidate, b: &Candidate) -> Relation {
    let shared = share_a_resource(&a.footprint, &b.footprint);
    let (forward, backward) = (supplies(a, b), supplies(b, a));
    if leaves_alone(&a.footprint, &b.footprint) && leaves_alone(&b.footprint, &a.footprint) {
        // Neither undoes anything of the other's. Is one of them to wait for the other all the same?
        return match (forward, backward) {
            (true, true) => Relation::Exclusive,
            (true, false) => Relation::Before,
            (false, true) => Relation::After,
            (false, false) if shared => Relation::Either,
            (false, false) => Relation::Independent,
        };
    }
    match (allows(a, b) && !backward, allows(b, a) && !forward) {
        (true, false) => Relation::Before,
        (false, true) => Relation::After,
        _ => Relation::Exclusive,
    }
}

/// Half of relation 1: `a` undoes nothing that `b` needs, protects or brings about.
fn leaves_alone(a: &Footprint, b: &Footprint) -> bool {
    !a.undoes(&b.needs) && !a.undoes(&b.protects) && a.removes.is_disjoint(&b.adds)
}

/// Relation 2: `a` may be done before `b` in one clique. Nothing of `b` is undone by `a`, and nothing
/// that `a` has brought about and its own goal still needs is undone by `b`. In the first case (*yield*)
/// `b` undoes what `a` needs while it is done; in the second (*enable*) `a` brings about what `b`
/// needs, or both want the same resource.
fn allows(a: &Candidate, b: &Candidate) -> bool {
    let (first, second) = (&a.footprint, &b.footprint);
    let still_needed: Literals = (a.later.iter())
        .filter(|(fact, wanted)| first.brings_about(fact, **wanted))
        .map(|(fact, wanted)| (fact.clone(), *wanted))
        .collect();
    let common = leaves_alone(first, second) && !second.undoes(&still_needed);
    let yields = second.undoes(&first.needs) || second.undoes(&first.protects);
    let enables = (second.needs.iter()).any(|(fact, wanted)| first.brings_about(fact, *wanted))
        || share_a_resource(first, second);
    common && (yields || enables)
}

/// Whether `a` brings about something that `b` cannot begin without and that is not so now.
fn supplies(a: &Candidate, b: &Candidate) -> bool {
    (b.missing.iter()).any(|(fact, wanted)| a.footprint.brings_about(fact, *wanted))
}

fn share_a_resource(a: &Footprint, b: &Footprint) -> bool {
    !a.resources.is_disjoint(&b.resources)
}

/// Relation 3: whether `action` would take back what one of the actions that were executed last has
/// brought about before anybody made use of it: to the other table and straight back again, with the
/// guest there still waiting. `waiting`: what the other actions of the layer need.
pub fn retracts<'a>(
    action: &Footprint,
    executed: &[Footprint],
    waiting: impl Iterator<Item = &'a Literals> + Clone,
) -> bool {
    executed.iter().any(|before| {
        let unused = |fact| {
            let mut waiting = waiting.clone();
            waiting.any(|needs: &Literals| needs.get(fact) == Some(&true))
        };
        !action.adds.is_disjoint(&before.removes)
            && action.removes.intersection(&before.adds).any(unused)
    })
}
