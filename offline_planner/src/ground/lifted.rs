//! The problem as rules with variables: what is to be instantiated.
//!
//! A method becomes a chain of *links*. A link replaces its task by some subtasks and, where
//! later subtasks bring variables that nothing before them needs, by an auxiliary task that
//! stands for the rest. So each variable is chosen no sooner than it matters, and where a method
//! as a whole would have as many instances as the product of its choices, the links have the sum.

use super::chain::{Body, chain};
use super::formula::{Arg, Conjunction, Formula, Lit, Scope, disjuncts};
use super::space::Space;
use crate::compile::{ActionId, Change, Compiled, KindId, MethodId, Subtask};

/// What a link was made of.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Source {
    /// A method.
    Method(MethodId),
    /// One of several readings of an action's precondition.
    Variant,
}

/// What is to be instantiated for every reachable instance of its head.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    /// The task.
    pub head: Lit,
    /// How many variables there are, quantified ones aside.
    pub vars: usize,
    /// What must hold, types included.
    pub body: Vec<Lit>,
    /// What must not hold.
    pub negative: Vec<Lit>,
    /// What must differ.
    pub unequal: Vec<(Arg, Arg)>,
    /// What can only be evaluated.
    pub checks: Vec<Formula>,
    /// What follows.
    pub what: What,
}

/// What a rule's instance is.
#[derive(Clone, Debug)]
pub(crate) enum What {
    /// A piece of a method.
    Link {
        /// What is to be done instead of the head.
        subs: Vec<Lit>,
        /// What it was made of.
        source: Source,
        /// Whether the method begins here.
        first: bool,
        /// The method's own number of each of the link's variables.
        canonical: Vec<u16>,
    },
    /// An action.
    Action {
        /// Which.
        action: ActionId,
        /// What it changes.
        effects: Vec<LiftedEffect>,
    },
}

/// A fact that is added or removed.
#[derive(Clone, Debug)]
pub(crate) struct LiftedEffect {
    /// Whether it is added.
    pub add: bool,
    /// Variables over which it ranges, with their types.
    pub over: Vec<(u16, u32)>,
    /// Under which condition.
    pub when: Conjunction,
    /// The fact.
    pub fact: Lit,
}

/// How a method's variables are found again from those of its links.
#[derive(Clone, Debug)]
pub(crate) struct Reading {
    /// For every parameter, the variable or object that it equals.
    pub resolve: Vec<Arg>,
}

/// Everything to be instantiated.
pub(crate) struct Lifted<'c> {
    /// What it was made of.
    pub compiled: &'c Compiled,
    /// How relations are numbered.
    pub space: Space,
    /// Rules, those of one head together only by chance.
    pub rules: Vec<Rule>,
    /// For the first link of each chain, how its method is read.
    pub readings: Vec<Option<Reading>>,
    /// How many relations there are.
    pub relations: usize,
    /// By predicate, whether an action changes facts of it.
    pub fluent: Vec<bool>,
}

impl Lifted<'_> {
    /// A task that the author did not write.
    pub fn auxiliary(&mut self) -> u32 {
        self.relations += 1;
        (self.relations - 1) as u32
    }

    /// Whether facts of the relation change.
    pub fn is_fluent(&self, relation: u32) -> bool {
        self.fluent.get(relation as usize).copied().unwrap_or(false)
    }

    /// The objects of a kind, given its relation.
    pub fn members(&self, relation: u32) -> &[crate::compile::ObjectId] {
        self.space
            .as_kind(relation)
            .map_or(&[], |kind| &self.compiled.kind(kind).members)
    }
}

/// Takes the problem apart.
pub(crate) fn lift(compiled: &Compiled) -> Lifted<'_> {
    let space = Space::new(compiled);
    let mut into = Lifted {
        compiled,
        space,
        rules: Vec::new(),
        readings: Vec::new(),
        relations: space.first_auxiliary(),
        fluent: compiled
            .predicates
            .iter()
            .map(|predicate| !predicate.is_static())
            .collect(),
    };
    for (index, method) in compiled.methods.iter().enumerate() {
        let mut scope = Scope::new(space, method.kinds.len());
        let head = Lit {
            relation: space.task(method.task),
            args: method.head.iter().map(|term| scope.arg(*term)).collect(),
        };
        let subs: Vec<Lit> = method
            .subtasks
            .iter()
            .map(|subtask| task(&scope, space, subtask))
            .collect();
        let condition = scope.condition(&method.precondition);
        let kinds = kinds(space, &method.kinds);
        let count = scope.count;
        let source = Source::Method(MethodId::new(index));
        method_rules(&mut into, source, &head, &subs, &condition, &kinds, count);
    }
    for (index, action) in compiled.actions.iter().enumerate() {
        let id = ActionId::new(index);
        let mut scope = Scope::new(space, action.kinds.len());
        let head = Lit {
            relation: space.action(id),
            args: (0..action.kinds.len() as u16).map(Arg::Var).collect(),
        };
        let condition = scope.condition(&action.precondition);
        let mut effects = Vec::new();
        for change in &action.effect {
            lift_change(&mut scope, change, &mut effects);
        }
        let kinds = kinds(space, &action.kinds);
        action_rules(&mut into, id, &head, &condition, &kinds, &effects);
    }
    into
}

fn method_rules(
    into: &mut Lifted<'_>,
    source: Source,
    head: &Lit,
    subs: &[Lit],
    condition: &Formula,
    kinds: &[(u16, u32)],
    count: u16,
) {
    for mut conjunction in disjuncts(condition) {
        conjunction.hidden.extend(kinds);
        let body = Body {
            head: head.clone(),
            subs: subs.to_vec(),
            condition: conjunction,
            count,
        };
        chain(into, source, body);
    }
}

fn action_rules(
    into: &mut Lifted<'_>,
    action: ActionId,
    head: &Lit,
    condition: &Formula,
    kinds: &[(u16, u32)],
    effects: &[LiftedEffect],
) {
    let readings = disjuncts(condition);
    let plain = readings.len() == 1 && readings.iter().all(|one| one.hidden.is_empty());
    for mut conjunction in readings {
        let mut variant = head.clone();
        if !plain {
            variant.relation = into.auxiliary();
            variant
                .args
                .extend(conjunction.hidden.iter().map(|(var, _)| Arg::Var(*var)));
        }
        conjunction.hidden.extend(kinds);
        if !plain {
            let count = count_of(&variant, &conjunction);
            let body = Body {
                head: head.clone(),
                subs: vec![variant.clone()],
                condition: conjunction.clone(),
                count,
            };
            chain(into, Source::Variant, body);
        }
        let Conjunction {
            mut positive,
            negative,
            equal,
            hidden,
            checks,
        } = conjunction;
        // An action's own equalities are rare; they are evaluated like the rest.
        let mut checks = checks;
        let mut unequal = Vec::new();
        for (sign, a, b) in equal {
            if sign {
                checks.push(Formula::Equal(true, a, b));
            } else {
                unequal.push((a, b));
            }
        }
        positive.extend(hidden.iter().map(|(var, kind)| Lit {
            relation: *kind,
            args: vec![Arg::Var(*var)],
        }));
        // The arguments of the head are the first variables, in order, but for hidden ones that
        // `forall` has numbered in between; those are given their place here.
        let order: Vec<u16> = variant.vars().collect();
        let shift = order.len() as u16;
        let mut change = |arg: Arg| match arg {
            Arg::Var(var) => Arg::Var(
                order
                    .iter()
                    .position(|other| *other == var)
                    .map_or(shift.saturating_add(var), |place| place as u16),
            ),
            object => object,
        };
        let rule = Rule {
            head: variant.map(&mut change),
            vars: order.len(),
            body: positive.iter().map(|lit| lit.map(&mut change)).collect(),
            negative: negative.iter().map(|lit| lit.map(&mut change)).collect(),
            unequal: unequal
                .iter()
                .map(|(a, b)| (change(*a), change(*b)))
                .collect(),
            checks: checks.iter().map(|check| check.map(&mut change)).collect(),
            what: What::Action {
                action,
                effects: effects
                    .iter()
                    .map(|effect| effect.map(&mut change))
                    .collect(),
            },
        };
        into.rules.push(rule);
        into.readings.push(None);
    }
}

fn count_of(head: &Lit, conjunction: &Conjunction) -> u16 {
    head.vars()
        .chain(conjunction.hidden.iter().map(|(var, _)| *var))
        .max()
        .map_or(0, |most| most.saturating_add(1))
}

fn lift_change(scope: &mut Scope, change: &Change, into: &mut Vec<LiftedEffect>) {
    let (over, before) = scope.open(&change.over);
    let when = scope.condition(&change.when);
    let fact = scope.fact(&change.fact);
    scope.close(before);
    for mut when in disjuncts(&when) {
        let mut over = over.clone();
        over.append(&mut when.hidden);
        into.push(LiftedEffect {
            add: change.adds,
            over,
            when,
            fact: fact.clone(),
        });
    }
}

impl LiftedEffect {
    fn map(&self, change: &mut impl FnMut(Arg) -> Arg) -> Self {
        let when = &self.when;
        Self {
            add: self.add,
            over: self
                .over
                .iter()
                .map(|(var, kind)| match change(Arg::Var(*var)) {
                    Arg::Var(var) => (var, *kind),
                    Arg::Object(_) => (*var, *kind),
                })
                .collect(),
            when: Conjunction {
                positive: when.positive.iter().map(|lit| lit.map(change)).collect(),
                negative: when.negative.iter().map(|lit| lit.map(change)).collect(),
                equal: when
                    .equal
                    .iter()
                    .map(|(sign, a, b)| (*sign, change(*a), change(*b)))
                    .collect(),
                hidden: Vec::new(),
                checks: when.checks.iter().map(|check| check.map(change)).collect(),
            },
            fact: self.fact.map(change),
        }
    }
}

fn kinds(space: Space, kinds: &[KindId]) -> Vec<(u16, u32)> {
    kinds
        .iter()
        .enumerate()
        .map(|(index, kind)| (index as u16, space.kind(*kind)))
        .collect()
}

fn task(scope: &Scope, space: Space, subtask: &Subtask) -> Lit {
    Lit {
        relation: space.step(subtask.step),
        args: subtask.args.iter().map(|term| scope.arg(*term)).collect(),
    }
}
