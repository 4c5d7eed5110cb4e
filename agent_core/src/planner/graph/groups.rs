//! Which facts are values of one variable.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use crate::model::Symbol;
use crate::planner::invariants::{Group, Role};

/// Facts of which at most one holds at a time, for each choice of their parameters: predicates,
/// and which of their arguments are the parameters, in the order of the group's.
pub(super) type Members = Vec<(Symbol, Vec<usize>)>;

/// Of the groups that are known, some in which no predicate occurs twice: the largest first.
pub(super) fn disjoint(groups: &[Group]) -> Vec<Members> {
    let mut sorted: Vec<&Group> = groups.iter().collect();
    sorted.sort_by_key(|group| (Reverse(group.parts().len()), group.parameters()));
    let mut taken = BTreeSet::new();
    let mut chosen = Vec::new();
    for group in sorted {
        let mut members = Members::new();
        let mut counts = false;
        for part in group.parts() {
            if !taken.contains(&part.predicate) {
                let mut places: Vec<(usize, usize)> = Vec::new();
                for (place, role) in part.args.iter().enumerate() {
                    match role {
                        Role::Parameter(index) => places.push((*index, place)),
                        Role::Counted => counts = true,
                    }
                }
                places.sort_unstable();
                let places = places.into_iter().map(|(_, place)| place).collect();
                members.push((part.predicate.clone(), places));
            }
        }
        // One fact alone is a variable anyway.
        if counts || members.len() > 1 {
            taken.extend(members.iter().map(|(predicate, _)| predicate.clone()));
            chosen.push(members);
        }
    }
    chosen
}
