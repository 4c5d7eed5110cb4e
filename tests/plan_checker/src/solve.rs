//! Whether a condition holds, and for which values of its variables.

use std::borrow::Cow;

use crate::model::{Atom, Formula, Id, Model, Quantified, Term, Variable};

/// Where facts are true or not.
pub(crate) trait World {
    /// Whether this is true: a predicate and its arguments.
    fn holds(&self, fact: &[Id]) -> bool;
    /// All true facts of a predicate, perhaps with others among them.
    fn candidates(&self, predicate: Id) -> &[Box<[Id]>];
}

/// The values of a scope's variables.
pub(crate) type Values = Vec<Option<Id>>;

/// A scope in a world.
pub(crate) struct Solver<'a, W> {
    pub(crate) model: &'a Model,
    pub(crate) world: &'a W,
    pub(crate) variables: &'a [Variable],
}

/// What to do with a solution; `true` to be shown no more of them.
type Found<'f> = &'f mut dyn FnMut(&Values) -> bool;

impl<W: World> Solver<'_, W> {
    /// Whether a formula holds for some values of those variables in `wanted` that have none.
    pub(crate) fn solvable(
        &self,
        formula: &Formula,
        wanted: &[usize],
        values: &mut Values,
    ) -> bool {
        self.solve(vec![formula], wanted, values, &mut |_| true)
    }

    /// Shows all values of `wanted` for which a formula holds.
    pub(crate) fn solutions(
        &self,
        formula: &Formula,
        wanted: &[usize],
        values: &mut Values,
        found: Found<'_>,
    ) {
        self.solve(vec![formula], wanted, values, found);
    }

    /// Whether a formula without open variables holds.
    pub(crate) fn holds(&self, formula: &Formula, values: &mut Values) -> bool {
        match formula {
            Formula::Atom(atom, truth) => self.is_true(atom, values) == *truth,
            Formula::Equal(left, right, truth) => {
                (value(left, values) == value(right, values)) == *truth
            }
            Formula::OfSort(left, sort, truth) => {
                value(left, values).is_some_and(|object| self.model.sorts[*sort].has(object))
                    == *truth
            }
            Formula::And(parts) => parts.iter().all(|part| self.holds(part, values)),
            Formula::Or(parts) => parts.iter().any(|part| self.holds(part, values)),
            Formula::Some(Quantified { slots, body, .. }, truth) => {
                self.solvable(body, slots, values) == *truth
            }
        }
    }

    /// The first part of a condition that does not hold, if its variables all have values.
    pub(crate) fn first_false<'f>(
        &self,
        formula: &'f Formula,
        values: &mut Values,
    ) -> Option<&'f Formula> {
        match formula {
            Formula::And(parts) => parts.iter().find_map(|part| self.first_false(part, values)),
            other => (closed(other, values) && !self.holds(other, values)).then_some(other),
        }
    }

    fn is_true(&self, atom: &Atom, values: &Values) -> bool {
        // Few facts have more arguments than this.
        let mut short = [0; 8];
        let length = atom.terms.len() + 1;
        let mut long = Vec::new();
        let fact = if length <= short.len() {
            &mut short[..length]
        } else {
            long.resize(length, 0);
            &mut long[..]
        };
        fact[0] = atom.name;
        for (place, term) in fact[1..].iter_mut().zip(&atom.terms) {
            match value(term, values) {
                Some(object) => *place = object,
                None => return false,
            }
        }
        self.world.holds(fact)
    }

    /// Looks for values with which all of `open` holds. True if `found` wants no more.
    fn solve(
        &self,
        mut open: Vec<&Formula>,
        wanted: &[usize],
        values: &mut Values,
        found: Found<'_>,
    ) -> bool {
        let mut wanted = Cow::Borrowed(wanted);
        let mut index = 0;
        while let Some(formula) = open.get(index).copied() {
            if let Formula::And(parts) = formula {
                open.swap_remove(index);
                open.extend(parts);
            } else if closed(formula, values) {
                if !self.holds(formula, values) {
                    return false;
                }
                open.swap_remove(index);
            } else if let Formula::Some(quantified, true) = formula {
                open.swap_remove(index);
                open.push(&quantified.body);
                wanted.to_mut().extend(&quantified.slots);
            } else {
                index += 1;
            }
        }
        if let Some(place) = self.narrowest(&open, values) {
            let atom = match open.swap_remove(place) {
                Formula::Atom(atom, _) => atom,
                _ => return false,
            };
            return self.by_facts(atom, &open, &wanted, values, found);
        }
        let unknown = |slot: &&usize| values[**slot].is_none();
        let Some(slot) = wanted.iter().find(unknown).copied() else {
            return open.is_empty() && found(values);
        };
        for object in &self.model.sorts[self.variables[slot].sort].members {
            values[slot] = Some(*object);
            if self.solve(open.clone(), &wanted, values, found) {
                values[slot] = None;
                return true;
            }
        }
        values[slot] = None;
        false
    }

    /// The fact that leaves the fewest values to try.
    fn narrowest(&self, open: &[&Formula], values: &Values) -> Option<usize> {
        let facts = open.iter().enumerate().filter_map(|(index, formula)| {
            let Formula::Atom(atom, true) = formula else {
                return None;
            };
            let unknown = |term: &&Term| value(term, values).is_none();
            let unknown = atom.terms.iter().filter(unknown).count();
            let facts = self.world.candidates(atom.name).len();
            // What is known thins them out; how much, nobody has counted.
            let known = atom.terms.len() - unknown;
            Some((facts >> (3 * known).min(30), unknown, index))
        });
        facts.min().map(|(_, _, index)| index)
    }

    fn by_facts(
        &self,
        atom: &Atom,
        open: &[&Formula],
        wanted: &[usize],
        values: &mut Values,
        found: Found<'_>,
    ) -> bool {
        let mut set = Vec::new();
        let mut stop = false;
        for fact in self.world.candidates(atom.name) {
            let agrees = self.unify(&atom.terms, &fact[1..], values, &mut set);
            if agrees && self.world.holds(fact) {
                stop = self.solve(open.to_vec(), wanted, values, found);
            }
            for slot in set.drain(..) {
                values[slot] = None;
            }
            if stop {
                break;
            }
        }
        stop
    }

    /// Makes terms equal to objects, and remembers in `set` which variables that took.
    pub(crate) fn unify(
        &self,
        terms: &[Term],
        objects: &[Id],
        values: &mut Values,
        set: &mut Vec<usize>,
    ) -> bool {
        for (term, object) in terms.iter().zip(objects) {
            match term {
                Term::Object(other) if other == object => (),
                Term::Object(_) => return false,
                Term::Variable(slot) => match values[*slot] {
                    Some(other) if other == *object => (),
                    Some(_) => return false,
                    None => {
                        if !self.model.sorts[self.variables[*slot].sort].has(*object) {
                            return false;
                        }
                        values[*slot] = Some(*object);
                        set.push(*slot);
                    }
                },
            }
        }
        true
    }
}

pub(crate) fn value(term: &Term, values: &Values) -> Option<Id> {
    match term {
        Term::Object(object) => Some(*object),
        Term::Variable(slot) => values[*slot],
    }
}

/// Whether all variables of a formula have values, save those that it quantifies.
fn closed(formula: &Formula, values: &Values) -> bool {
    let known = |term: &Term| value(term, values).is_some();
    match formula {
        Formula::Atom(atom, _) => atom.terms.iter().all(known),
        Formula::Equal(left, right, _) => known(left) && known(right),
        Formula::OfSort(left, ..) => known(left),
        Formula::And(parts) | Formula::Or(parts) => parts.iter().all(|part| closed(part, values)),
        Formula::Some(quantified, _) => quantified.free.iter().all(|slot| values[*slot].is_some()),
    }
}
