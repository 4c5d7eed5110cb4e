//! A method as a chain of links, each binding the variables that are needed by then.

use super::formula::{Arg, Conjunction, Formula, Lit};
use super::lifted::{Lifted, Reading, Rule, Source, What};
use crate::compile::ObjectId;

/// One reading of a method.
pub(super) struct Body {
    /// Its task.
    pub head: Lit,
    /// What is to be done instead.
    pub subs: Vec<Lit>,
    /// When; `hidden` has the types of all variables.
    pub condition: Conjunction,
    /// How many variables there are, quantified ones included.
    pub count: u16,
}

/// Makes the links of a method. None, if its conditions contradict each other.
pub(super) fn chain(into: &mut Lifted<'_>, source: Source, body: Body) {
    let Some(resolve) = resolve(&body.condition.equal, body.count) else {
        return;
    };
    let mut change = |arg: Arg| match arg {
        Arg::Var(var) => resolve.get(var as usize).copied().unwrap_or(arg),
        object => object,
    };
    let mut unequal = Vec::new();
    for (sign, a, b) in &body.condition.equal {
        if !sign {
            match (change(*a), change(*b)) {
                (a, b) if a == b => return,
                (Arg::Object(_), Arg::Object(_)) => {}
                pair => unequal.push(pair),
            }
        }
    }
    let condition = &body.condition;
    let kinds: Vec<Lit> = condition
        .hidden
        .iter()
        .map(|(var, kind)| Lit {
            relation: *kind,
            args: vec![change(Arg::Var(*var))],
        })
        .collect();
    let mut rest = Rest {
        source,
        positive: condition
            .positive
            .iter()
            .map(|lit| lit.map(&mut change))
            .collect(),
        negative: condition
            .negative
            .iter()
            .map(|lit| lit.map(&mut change))
            .collect(),
        unequal,
        checks: condition
            .checks
            .iter()
            .map(|check| check.map(&mut change))
            .collect(),
        subs: body.subs.iter().map(|sub| sub.map(&mut change)).collect(),
        kinds,
    };
    rest.kinds.sort_unstable();
    rest.kinds.dedup();
    // A variable that nothing needs stands for any object, if there is one of its type.
    let needed = rest.needed(&body.head);
    let idle = (0..body.count).filter(|var| !needed.contains(var));
    for var in idle {
        let mut kinds = rest
            .kinds
            .iter()
            .filter(|kind| kind.args == [Arg::Var(var)]);
        if let Some(first) = kinds.next() {
            let others: Vec<u32> = kinds.map(|kind| kind.relation).collect();
            let fits = |object: &ObjectId| {
                others
                    .iter()
                    .all(|kind| into.members(*kind).contains(object))
            };
            if !into.members(first.relation).iter().any(fits) {
                return;
            }
        }
    }
    rest.kinds.retain(|kind| {
        kind.vars().next().is_none() || kind.vars().any(|var| needed.contains(&var))
    });
    let reading = Reading {
        resolve: (0..body.count).map(|var| change(Arg::Var(var))).collect(),
    };
    let head = body.head.map(&mut change);
    rest.emit(into, head, Some(reading));
}

/// By variable, the variable or object that it equals. `None` if that cannot be.
fn resolve(equal: &[(bool, Arg, Arg)], count: u16) -> Option<Vec<Arg>> {
    let mut stands_for: Vec<Arg> = (0..count).map(Arg::Var).collect();
    for (sign, a, b) in equal {
        if !sign {
            continue;
        }
        let find = |arg: &Arg| match arg {
            Arg::Var(var) => stands_for.get(*var as usize).copied().unwrap_or(*arg),
            Arg::Object(_) => *arg,
        };
        let (a, b) = (find(a), find(b));
        let (from, to) = match (a, b) {
            (Arg::Object(a), Arg::Object(b)) if a != b => return None,
            (Arg::Object(_), _) => (b, a),
            _ => (a, b),
        };
        for arg in &mut stands_for {
            if *arg == from {
                *arg = to;
            }
        }
    }
    Some(stands_for)
}

/// What of a method is still to be put into links.
struct Rest {
    source: Source,
    positive: Vec<Lit>,
    negative: Vec<Lit>,
    unequal: Vec<(Arg, Arg)>,
    checks: Vec<Formula>,
    subs: Vec<Lit>,
    kinds: Vec<Lit>,
}

impl Rest {
    /// Variables that something depends on.
    fn needed(&self, head: &Lit) -> Vec<u16> {
        let mut needed: Vec<u16> = head.vars().collect();
        for lit in self.positive.iter().chain(&self.negative).chain(&self.subs) {
            needed.extend(lit.vars());
        }
        for (a, b) in &self.unequal {
            needed.extend(vars_of(&[*a, *b]));
        }
        for check in &self.checks {
            check.free_vars(&mut |var| needed.push(var));
        }
        needed.sort_unstable();
        needed.dedup();
        needed
    }

    fn emit(mut self, into: &mut Lifted<'_>, mut head: Lit, mut reading: Option<Reading>) {
        loop {
            let bound = self.bound_at_first(into, &head);
            let now = self
                .subs
                .iter()
                .position(|sub| sub.vars().any(|var| !bound.contains(&var)))
                .unwrap_or(self.subs.len());
            let later = self.subs.split_off(now);
            let within = |vars: Vec<u16>| vars.iter().all(|var| bound.contains(var));
            let (kinds, kinds_later) = split(self.kinds, |kind| within(kind.vars().collect()));
            let (positive, positive_later) =
                split(self.positive, |lit| within(lit.vars().collect()));
            let (negative, negative_later) =
                split(self.negative, |lit| within(lit.vars().collect()));
            let (unequal, unequal_later) = split(self.unequal, |(a, b)| within(vars_of(&[*a, *b])));
            let rest = Self {
                source: self.source,
                positive: positive_later,
                negative: negative_later,
                unequal: unequal_later,
                checks: Vec::new(),
                subs: later,
                kinds: kinds_later,
            };
            let mut subs = self.subs;
            let next = if rest.subs.is_empty() {
                None
            } else {
                let needed = rest.needed(&Lit {
                    relation: 0,
                    args: Vec::new(),
                });
                let tail = Lit {
                    relation: into.auxiliary(),
                    args: bound
                        .iter()
                        .filter(|var| needed.contains(var))
                        .map(|var| Arg::Var(*var))
                        .collect(),
                };
                subs.push(tail.clone());
                Some(tail)
            };
            let mut body = positive;
            body.extend(kinds);
            let link = Link {
                head,
                bound,
                body,
                negative,
                unequal,
                checks: self.checks,
                subs,
            };
            into.rules.push(link.rule(self.source, reading.is_some()));
            into.readings.push(reading);
            match next {
                None => return,
                Some(tail) => {
                    self = rest;
                    head = tail;
                    reading = None;
                }
            }
        }
    }

    /// The variables that the first link binds: those of the head, of everything that must be
    /// evaluated at once, of the first subtask, and of what static conditions connect with them.
    fn bound_at_first(&self, into: &Lifted<'_>, head: &Lit) -> Vec<u16> {
        let mut bound: Vec<u16> = head.vars().collect();
        for lit in self.positive.iter().chain(&self.negative) {
            if into.is_fluent(lit.relation) {
                bound.extend(lit.vars());
            }
        }
        for check in &self.checks {
            check.free_vars(&mut |var| bound.push(var));
        }
        if let Some(first) = self.subs.first() {
            bound.extend(first.vars());
        }
        // What no subtask mentions is not worth being carried on.
        let in_subs: Vec<u16> = self.subs.iter().flat_map(Lit::vars).collect();
        let needed = self.needed(head);
        bound.extend(needed.iter().filter(|var| !in_subs.contains(var)));
        loop {
            let before = bound.len();
            for lit in &self.positive {
                let mut vars = lit.vars().peekable();
                let apart = vars.peek().is_some() && lit.vars().all(|var| !bound.contains(&var));
                if !apart {
                    for var in lit.vars() {
                        if !bound.contains(&var) {
                            bound.push(var);
                        }
                    }
                }
            }
            if bound.len() == before {
                break;
            }
        }
        bound.sort_unstable();
        bound.dedup();
        bound
    }
}

/// One link, its variables still numbered as the method's.
struct Link {
    head: Lit,
    bound: Vec<u16>,
    body: Vec<Lit>,
    negative: Vec<Lit>,
    unequal: Vec<(Arg, Arg)>,
    checks: Vec<Formula>,
    subs: Vec<Lit>,
}

impl Link {
    fn rule(self, source: Source, first: bool) -> Rule {
        let shift = self.bound.len() as u16;
        let bound = &self.bound;
        let mut change = |arg: Arg| match arg {
            Arg::Var(var) => Arg::Var(match bound.binary_search(&var) {
                Ok(place) => place as u16,
                Err(_) => shift.saturating_add(var),
            }),
            object => object,
        };
        Rule {
            head: self.head.map(&mut change),
            vars: bound.len(),
            body: self.body.iter().map(|lit| lit.map(&mut change)).collect(),
            negative: self
                .negative
                .iter()
                .map(|lit| lit.map(&mut change))
                .collect(),
            unequal: self
                .unequal
                .iter()
                .map(|(a, b)| (change(*a), change(*b)))
                .collect(),
            checks: self
                .checks
                .iter()
                .map(|check| check.map(&mut change))
                .collect(),
            what: What::Link {
                subs: self.subs.iter().map(|sub| sub.map(&mut change)).collect(),
                source,
                first,
                canonical: bound.clone(),
            },
        }
    }
}

fn split<T>(all: Vec<T>, mut now: impl FnMut(&T) -> bool) -> (Vec<T>, Vec<T>) {
    all.into_iter().partition(|one| now(one))
}

fn vars_of(args: &[Arg]) -> Vec<u16> {
    args.iter()
        .filter_map(|arg| match arg {
            Arg::Var(var) => Some(*var),
            Arg::Object(_) => None,
        })
        .collect()
}
