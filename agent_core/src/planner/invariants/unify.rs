//! Terms that are taken to be the same.

use std::collections::BTreeMap;

use crate::model::{Pattern, Term};

/// Which variables are equal to which terms.
#[derive(Clone, Debug, Default)]
pub(super) struct Unifier {
    same: BTreeMap<usize, Term>,
}

impl Unifier {
    /// The term that stands for all that equal this one.
    pub fn find(&self, term: &Term) -> Term {
        let mut at = term;
        while let Term::Variable(index) = at
            && let Some(next) = self.same.get(index)
        {
            at = next;
        }
        at.clone()
    }

    /// Takes both for the same; whether they can be.
    pub fn unify(&mut self, a: &Term, b: &Term) -> bool {
        match (self.find(a), self.find(b)) {
            (a, b) if a == b => true,
            // Never a circle: both stand for themselves.
            (Term::Variable(index), other) | (other, Term::Variable(index)) => {
                self.same.insert(index, other);
                true
            }
            (Term::Constant(_), Term::Constant(_)) => false,
        }
    }

    /// Takes the terms of both lists for the same, one by one; whether they can be.
    pub fn unify_all(&mut self, a: &[Term], b: &[Term]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| self.unify(a, b))
    }

    /// Whether both are the same already.
    pub fn equal(&self, a: &Pattern, b: &Pattern) -> bool {
        a.name == b.name && self.all_equal(&a.args, &b.args)
    }

    /// Whether the terms of both lists are the same already, one by one.
    pub fn all_equal(&self, a: &[Term], b: &[Term]) -> bool {
        a.len() == b.len() && (a.iter().zip(b)).all(|(a, b)| self.find(a) == self.find(b))
    }
}
