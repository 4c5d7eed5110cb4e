//! The search for mutex groups.

use std::collections::{BTreeSet, VecDeque};

use super::balance::{Addition, additions, too_heavy};
use super::group::{Group, Part, Role};
use super::schema::{Schema, schemata};
use crate::model::{Domain, ExecutionModel, Pattern, Symbol};

/// So many candidates are looked at. Real domains have some dozens.
const CANDIDATES: usize = 2_000;
/// So many groups are tried to be joined, two by two.
const TO_JOIN: usize = 60;

/// All groups that are found, in a fixed order.
///
/// They may share predicates: of the blocks, `(holding ?x)` is in what is on a block, in where a
/// block is and in what the hand holds. [`Variables`](super::Variables) chooses among them.
pub fn mutex_groups(domain: &Domain, model: &ExecutionModel) -> Vec<Group> {
    let synthesis = Synthesis {
        domain,
        schemata: schemata(domain, model),
        changing: changing(domain, model),
    };
    let mut found = synthesis.search();
    synthesis.join(&mut found);
    found.into_iter().collect()
}

struct Synthesis<'a> {
    domain: &'a Domain,
    schemata: Vec<Schema>,
    /// Predicates that may be in a group.
    changing: BTreeSet<Symbol>,
}

/// Predicates that actions or suspensions add to and nobody else, so that a group can be kept.
fn changing(domain: &Domain, model: &ExecutionModel) -> BTreeSet<Symbol> {
    let suspensions = (model.actions.values())
        .filter_map(|action| action.suspension.as_ref())
        .map(|suspension| &suspension.effect);
    let effects = domain.operators.values().map(|operator| &operator.effect);
    effects
        .chain(suspensions)
        .flat_map(|effect| &effect.add)
        .map(|add| add.fact.name.clone())
        .filter(|name| domain.predicates.contains_key(name) && !model.observable.contains(name))
        .collect()
}

impl Synthesis<'_> {
    /// Refines candidates until nothing happens that unbalances them.
    fn search(&self) -> BTreeSet<Group> {
        let mut open: VecDeque<Group> = VecDeque::new();
        for predicate in &self.changing {
            let arity = self.domain.predicates.get(predicate).map_or(0, Vec::len);
            let places = std::iter::once(None).chain((0..arity).map(Some));
            open.extend(places.map(|counted| {
                let args = (0..arity).map(|place| match Some(place) == counted {
                    true => Role::Counted,
                    false => Role::Parameter(place),
                });
                Group::new(vec![Part {
                    predicate: predicate.clone(),
                    args: args.collect(),
                }])
            }));
        }
        let mut seen: BTreeSet<Group> = open.iter().cloned().collect();
        let mut found = BTreeSet::new();
        while let Some(candidate) = open.pop_front() {
            let refine_by = match self.fault(&candidate) {
                Fault::None if !candidate.is_trivial() => {
                    found.insert(candidate);
                    continue;
                }
                // One fact alone is never more than one. With others it may say something.
                Fault::None => self.schemata.iter().collect(),
                Fault::TooHeavy => continue,
                Fault::Unbalanced(schema) => vec![schema],
            };
            for refined in self.refinements(&candidate, &refine_by) {
                if seen.len() < CANDIDATES && seen.insert(refined.clone()) {
                    open.push_back(refined);
                }
            }
        }
        found
    }

    /// What is wrong with a candidate.
    fn fault(&self, group: &Group) -> Fault<'_> {
        let mut unbalanced = None;
        for schema in &self.schemata {
            let all = additions(self.domain, schema, group);
            for (index, a) in all.iter().enumerate() {
                for b in all[index..].iter().filter(|b| too_heavy(group, a, b)) {
                    if a.terms() == b.terms() {
                        return Fault::TooHeavy;
                    }
                    // Only if two variables are the same object, which a condition may rule out
                    // that speaks of a part that is still to come.
                    unbalanced = Some(schema);
                }
                if unbalanced.is_none() && !a.is_balanced(group) {
                    unbalanced = Some(schema);
                }
            }
        }
        unbalanced.map_or(Fault::None, Fault::Unbalanced)
    }

    /// The candidate with one more part, which one of `schemata` takes away where it adds something.
    fn refinements(&self, group: &Group, schemata: &[&Schema]) -> Vec<Group> {
        let mut found = Vec::new();
        for schema in schemata {
            for addition in additions(self.domain, schema, group) {
                for fact in addition.taken_away() {
                    if self.changing.contains(&fact.name) && group.part(&fact.name).is_none() {
                        let parts = parts_with(fact, &addition);
                        found.extend(parts.into_iter().map(|part| {
                            let mut parts = group.parts().to_vec();
                            parts.push(part);
                            Group::new(parts)
                        }));
                    }
                }
            }
        }
        found
    }

    /// Adds what two groups are together, where that is a group that no action or suspension ever
    /// empties, though each of the two is emptied at times: a robot that is on no arc is at a node.
    ///
    /// Two that are never empty are two things, and together never one. Groups that only happen to go together are not joined. The more a group claims, the
    /// sooner an observation breaks it.
    fn join(&self, found: &mut BTreeSet<Group>) {
        let mut open: Vec<Group> = found.iter().cloned().collect();
        open.retain(|group| !self.is_never_emptied(group));
        let mut others = open.clone();
        let mut tried = BTreeSet::new();
        while let Some(group) = open.pop() {
            if others.len() > TO_JOIN {
                return;
            }
            for other in others.clone() {
                for joined in unions(&group, &other) {
                    if !tried.insert(joined.clone())
                        || found.contains(&joined)
                        || !matches!(self.fault(&joined), Fault::None)
                    {
                        continue;
                    }
                    if self.is_never_emptied(&joined) {
                        found.insert(joined);
                    } else {
                        // A third may be missing.
                        others.push(joined.clone());
                        open.push(joined);
                    }
                }
            }
        }
    }

    /// Whether everything that takes away from the group also adds to it.
    fn is_never_emptied(&self, group: &Group) -> bool {
        self.schemata.iter().all(|schema| {
            let additions = additions(self.domain, schema, group);
            schema.effect.remove.iter().all(|remove| {
                let part = group.part(&remove.fact.name);
                let Some(terms) = part.and_then(|part| part.parameters_in(&remove.fact.args))
                else {
                    return true;
                };
                let replaces = |add: &Addition<'_>| add.always_comes() && add.terms() == terms;
                additions.iter().any(replaces)
            })
        })
    }
}

enum Fault<'a> {
    None,
    TooHeavy,
    Unbalanced(&'a Schema),
}

/// How `fact` can be a part of the group that `addition` adds to, for the same values of the
/// parameters.
fn parts_with(fact: &Pattern, addition: &Addition<'_>) -> Vec<Part> {
    let mut ways: Vec<Vec<Role>> = vec![Vec::new()];
    for arg in &fact.args {
        let mut longer = Vec::new();
        for way in &ways {
            let roles = (addition.terms().iter().enumerate())
                .filter(|(_, term)| *term == arg)
                .map(|(index, _)| Role::Parameter(index))
                .chain([Role::Counted]);
            for role in roles.filter(|role| !way.contains(role)) {
                let mut way = way.clone();
                way.push(role);
                longer.push(way);
            }
        }
        ways = longer;
    }
    let all = |way: &Vec<Role>| {
        (0..addition.terms().len()).all(|index| way.contains(&Role::Parameter(index)))
    };
    ways.into_iter()
        .filter(all)
        .map(|args| Part {
            predicate: fact.name.clone(),
            args,
        })
        .collect()
}

/// The two as one group: for every way in which the parameters of the second can be those of the
/// first. None, if they share a predicate.
fn unions(a: &Group, b: &Group) -> Vec<Group> {
    let shared = |part: &Part| a.part(&part.predicate).is_some();
    let parameters = a.parameters();
    if parameters != b.parameters() || parameters > 3 || b.parts().iter().any(shared) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for order in orders(parameters) {
        let mut parts = a.parts().to_vec();
        parts.extend(b.parts().iter().map(|part| {
            let role = |role: &Role| match role {
                Role::Parameter(index) => Role::Parameter(order[*index]),
                Role::Counted => Role::Counted,
            };
            Part {
                predicate: part.predicate.clone(),
                args: part.args.iter().map(role).collect(),
            }
        }));
        found.push(Group::new(parts));
    }
    found
}

/// All orders of the numbers below `count`.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..count {
        found = (found.iter())
            .flat_map(|order| {
                (0..count)
                    .filter(|next| !order.contains(next))
                    .map(|next| [order.as_slice(), &[next]].concat())
            })
            .collect();
    }
    found
}
