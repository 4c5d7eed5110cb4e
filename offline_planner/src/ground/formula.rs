//! Conditions in numbers: names resolved, every quantified variable with a number of its own.

use super::space::Space;
use crate::compile::{Clause, FactPattern, KindId, Quantified, Term};

/// A place in an atom: a variable of the rule it stands in, or an object.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Hash, Ord, PartialOrd)]
pub(crate) enum Arg {
    /// A variable, by its number.
    Var(u16),
    /// An object, by its number.
    Object(u32),
}

/// An atom with variables: a predicate, a type or a task, and its arguments.
#[derive(Clone, Debug, Eq, PartialEq, Hash, Ord, PartialOrd)]
pub(crate) struct Lit {
    /// The relation's number.
    pub relation: u32,
    /// Its arguments.
    pub args: Vec<Arg>,
}

impl Lit {
    /// The variables in it, repeated ones repeatedly.
    pub fn vars(&self) -> impl Iterator<Item = u16> {
        self.args.iter().filter_map(|arg| match arg {
            Arg::Var(var) => Some(*var),
            Arg::Object(_) => None,
        })
    }

    /// The same atom with every argument exchanged.
    pub fn map(&self, change: &mut impl FnMut(Arg) -> Arg) -> Self {
        Self {
            relation: self.relation,
            args: self.args.iter().map(|arg| change(*arg)).collect(),
        }
    }
}

/// A condition as a tree, in negation normal form.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Formula {
    /// The fact holds (`true`) or does not.
    Fact(bool, Lit),
    /// Both are the same object (`true`) or are not.
    Equal(bool, Arg, Arg),
    /// All of these.
    All(Vec<Formula>),
    /// One of these.
    Any(Vec<Formula>),
    /// For all objects of these types (relation numbers) in the place of the variables.
    Every(Vec<(u16, u32)>, Box<Formula>),
    /// For some objects.
    Exists(Vec<(u16, u32)>, Box<Formula>),
}

impl Formula {
    /// The same with every argument exchanged; the variables of quantifiers must become variables.
    pub fn map(&self, change: &mut impl FnMut(Arg) -> Arg) -> Self {
        match self {
            Self::Fact(sign, lit) => Self::Fact(*sign, lit.map(change)),
            Self::Equal(sign, a, b) => Self::Equal(*sign, change(*a), change(*b)),
            Self::All(parts) => Self::All(parts.iter().map(|part| part.map(change)).collect()),
            Self::Any(parts) => Self::Any(parts.iter().map(|part| part.map(change)).collect()),
            Self::Every(over, inner) => {
                Self::Every(renumbered(over, change), Box::new(inner.map(change)))
            }
            Self::Exists(over, inner) => {
                Self::Exists(renumbered(over, change), Box::new(inner.map(change)))
            }
        }
    }

    /// Calls `found` with every variable in it that no quantifier of its own binds.
    pub fn free_vars(&self, found: &mut impl FnMut(u16)) {
        let mut bound = Vec::new();
        self.walk(&mut bound, found);
    }

    fn walk(&self, bound: &mut Vec<u16>, found: &mut impl FnMut(u16)) {
        let mut meet = |arg: &Arg, bound: &[u16]| {
            if let Arg::Var(var) = arg
                && !bound.contains(var)
            {
                found(*var);
            }
        };
        match self {
            Self::Fact(_, lit) => lit.args.iter().for_each(|arg| meet(arg, bound)),
            Self::Equal(_, a, b) => {
                meet(a, bound);
                meet(b, bound);
            }
            Self::All(parts) | Self::Any(parts) => {
                for part in parts {
                    part.walk(bound, found);
                }
            }
            Self::Every(over, inner) | Self::Exists(over, inner) => {
                let before = bound.len();
                bound.extend(over.iter().map(|(var, _)| *var));
                inner.walk(bound, found);
                bound.truncate(before);
            }
        }
    }
}

fn renumbered(over: &[(u16, u32)], change: &mut impl FnMut(Arg) -> Arg) -> Vec<(u16, u32)> {
    over.iter()
        .map(|(var, kind)| match change(Arg::Var(*var)) {
            Arg::Var(var) => (var, *kind),
            Arg::Object(_) => (*var, *kind),
        })
        .collect()
}

/// Numbers the variables of one action or method.
///
/// The compiled problem numbers the variables of sibling quantifiers alike; here each has its own.
pub(crate) struct Scope {
    space: Space,
    /// By the compiled number, the variable's own.
    env: Vec<u16>,
    /// How many variables there are.
    pub count: u16,
}

impl Scope {
    /// The parameters keep their numbers.
    pub fn new(space: Space, parameters: usize) -> Self {
        let count = u16::try_from(parameters).unwrap_or(u16::MAX);
        Self {
            space,
            env: (0..count).collect(),
            count,
        }
    }

    /// An argument.
    pub fn arg(&self, term: Term) -> Arg {
        match term {
            Term::Variable(index) => Arg::Var(self.env.get(index).copied().unwrap_or(u16::MAX)),
            Term::Object(object) => Arg::Object(object.0),
        }
    }

    /// A fact's atom.
    pub fn fact(&self, pattern: &FactPattern) -> Lit {
        Lit {
            relation: self.space.predicate(pattern.predicate),
            args: pattern.args.iter().map(|term| self.arg(*term)).collect(),
        }
    }

    /// A whole condition.
    pub fn condition(&mut self, condition: &[Clause]) -> Formula {
        Formula::All(condition.iter().map(|clause| self.clause(clause)).collect())
    }

    /// Opens a quantifier; `close` with what it returns as second ends it.
    pub fn open(&mut self, over: &[KindId]) -> (Vec<(u16, u32)>, usize) {
        let before = self.env.len();
        let mut vars = Vec::with_capacity(over.len());
        for kind in over {
            let var = self.count;
            self.count = self.count.saturating_add(1);
            self.env.push(var);
            vars.push((var, self.space.kind(*kind)));
        }
        (vars, before)
    }

    /// Ends a quantifier.
    pub fn close(&mut self, before: usize) {
        self.env.truncate(before);
    }

    fn quantified(&mut self, quantified: &Quantified) -> (Vec<(u16, u32)>, Box<Formula>) {
        let (vars, before) = self.open(&quantified.kinds);
        let inner = self.condition(&quantified.inner);
        self.close(before);
        (vars, Box::new(inner))
    }

    fn clause(&mut self, clause: &Clause) -> Formula {
        match clause {
            Clause::Fact(sign, pattern) => Formula::Fact(*sign, self.fact(pattern)),
            Clause::Equal(sign, a, b) => Formula::Equal(*sign, self.arg(*a), self.arg(*b)),
            Clause::Any(choices) => Formula::Any(
                choices
                    .iter()
                    .map(|choice| self.condition(choice))
                    .collect(),
            ),
            Clause::Every(quantified) => {
                let (vars, inner) = self.quantified(quantified);
                Formula::Every(vars, inner)
            }
            Clause::Exists(quantified) => {
                let (vars, inner) = self.quantified(quantified);
                Formula::Exists(vars, inner)
            }
        }
    }
}

/// A conjunction of what can be joined, and of what can only be evaluated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Conjunction {
    /// Facts that must hold.
    pub positive: Vec<Lit>,
    /// Facts that must not hold.
    pub negative: Vec<Lit>,
    /// Equalities and inequalities.
    pub equal: Vec<(bool, Arg, Arg)>,
    /// Types of variables that `exists` has brought in.
    pub hidden: Vec<(u16, u32)>,
    /// The rest: `forall`, and `or` where it would have to be multiplied out too often.
    pub checks: Vec<Formula>,
}

/// At most this many conjunctions are made of one condition; beyond, `or` stays as it is.
const MOST_CHOICES: usize = 64;

/// Multiplies `or` out and takes `exists` as further variables.
pub(crate) fn disjuncts(formula: &Formula) -> Vec<Conjunction> {
    let mut result = vec![Conjunction::default()];
    expand(formula, &mut result);
    result
}

fn expand(formula: &Formula, into: &mut Vec<Conjunction>) {
    match formula {
        Formula::Fact(true, lit) => into.iter_mut().for_each(|c| c.positive.push(lit.clone())),
        Formula::Fact(false, lit) => into.iter_mut().for_each(|c| c.negative.push(lit.clone())),
        Formula::Equal(sign, a, b) => into.iter_mut().for_each(|c| c.equal.push((*sign, *a, *b))),
        Formula::All(parts) => parts.iter().for_each(|part| expand(part, into)),
        Formula::Exists(over, inner) => {
            into.iter_mut().for_each(|c| c.hidden.extend(over));
            expand(inner, into);
        }
        Formula::Any(parts) => {
            let mut all = Vec::new();
            for part in parts {
                let mut copy = into.clone();
                expand(part, &mut copy);
                all.extend(copy);
                if all.len() > MOST_CHOICES {
                    into.iter_mut().for_each(|c| c.checks.push(formula.clone()));
                    return;
                }
            }
            *into = all;
        }
        Formula::Every(..) => into.iter_mut().for_each(|c| c.checks.push(formula.clone())),
    }
}
