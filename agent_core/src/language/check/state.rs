//! What is known of facts before and after actions whose arguments are not.

use std::collections::{BTreeMap, BTreeSet};

use crate::model::{Change, Effect, Symbol, Term};

/// A fact over objects that are known only by number.
pub(super) type Ground = (Symbol, Vec<usize>);

/// An argument of a fact that is removed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Argument {
    /// This object.
    Object(usize),
    /// Every object; one number, one object at a time.
    Any(usize),
}

/// An effect whose variables have been replaced.
#[derive(Debug)]
pub(super) struct GroundEffect {
    remove: Vec<(Symbol, Vec<Argument>)>,
    add: BTreeSet<Ground>,
}

/// Facts that are known to hold or not to hold. Of all others nothing is known.
pub(super) type Known = BTreeMap<Ground, bool>;

impl GroundEffect {
    /// Replaces the variables of an effect. `None` if something added is not bound, which is a
    /// fault that is reported elsewhere.
    pub(super) fn new(
        effect: &Effect,
        argument: impl Fn(&Term) -> Option<Argument>,
    ) -> Option<Self> {
        let ground = |change: &Change| {
            let pattern = &change.fact;
            let args = pattern.args.iter().map(&argument).collect::<Option<_>>()?;
            Some((pattern.name.clone(), args))
        };
        let remove = effect.remove.iter().map(&ground).collect::<Option<_>>()?;
        let added: Vec<(Symbol, Vec<Argument>)> =
            effect.add.iter().map(&ground).collect::<Option<_>>()?;
        let add = added
            .into_iter()
            .map(|(name, args)| {
                let args = args.into_iter().map(|argument| match argument {
                    Argument::Object(object) => Some(object),
                    Argument::Any(_) => None,
                });
                Some((name, args.collect::<Option<_>>()?))
            })
            .collect::<Option<_>>()?;
        Some(Self { remove, add })
    }

    /// Whether this makes the fact true.
    pub(super) fn adds(&self, fact: &Ground) -> bool {
        self.add.contains(fact)
    }

    fn removes(&self, (name, objects): &Ground) -> bool {
        self.remove.iter().any(|(removed, args)| {
            let mut bound = BTreeMap::new();
            removed == name
                && args.len() == objects.len()
                && args
                    .iter()
                    .zip(objects)
                    .all(|(argument, object)| match argument {
                        Argument::Object(wanted) => wanted == object,
                        Argument::Any(variable) => bound
                            .insert(*variable, *object) // the first time
                            .is_none_or(|before| before == *object),
                    })
        })
    }

    /// What a fact is after this, if `before` is what it was. `None`: what it was at first, and
    /// that is not known. Removing comes before adding, as PDDL has it.
    pub(super) fn after(&self, fact: &Ground, before: Option<bool>) -> Option<bool> {
        if self.adds(fact) {
            Some(true)
        } else if self.removes(fact) {
            Some(false)
        } else {
            before
        }
    }

    /// Facts that stand for all that this may change: those that are named, and of a quantified
    /// one that with objects beyond `objects`, of which nothing else is said.
    pub(super) fn touched(&self, objects: usize) -> BTreeSet<Ground> {
        let removed = self.remove.iter().map(|(name, args)| {
            let object = |argument: &Argument| match argument {
                Argument::Object(object) => *object,
                Argument::Any(variable) => objects + variable,
            };
            (name.clone(), args.iter().map(object).collect())
        });
        self.add.iter().cloned().chain(removed).collect()
    }
}
