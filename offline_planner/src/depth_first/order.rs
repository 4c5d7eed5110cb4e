//! In which order a condition's parts are looked at.

use rustc_hash::{FxHashMap, FxHashSet};

use super::facts::Facts;
use super::hash::join;
use super::query::{Query, Step};
use crate::compile::{Clause, Compiled, FactPattern, KindId, PredicateId, Quantified, Term};

/// Makes queries of conditions, and the indexes that they need.
#[derive(Debug)]
pub struct Planner<'a> {
    pub compiled: &'a Compiled,
    pub facts: &'a mut Facts,
    /// How many facts fit on average, for argument places that are bound.
    pub fits: FxHashMap<(PredicateId, Vec<usize>), f64>,
}

/// Which variables have a value, and what kinds they are of.
#[derive(Clone, Debug)]
pub struct Scope {
    pub kinds: Vec<KindId>,
    pub bound: Vec<bool>,
}

impl Planner<'_> {
    /// A query that binds all variables in scope so that all clauses hold.
    ///
    /// Tests come as soon as they can be made, then the facts that leave the fewest choices, by
    /// what holds at first; objects of a kind are tried one by one only where nothing else binds a
    /// variable.
    pub fn query(&mut self, clauses: &[Clause], scope: &Scope) -> Query {
        let mut scope = scope.clone();
        let mut left: Vec<&Clause> = clauses.iter().collect();
        let mut steps = Vec::new();
        loop {
            self.tests(&mut left, &scope, &mut steps);
            if let Some((at, variable, term)) = assignment(&left, &scope) {
                left.remove(at);
                steps.push(Step::Assign { variable, term });
                steps.push(Step::Of(variable, scope.kinds[variable]));
                scope.bound[variable] = true;
                continue;
            }
            let mut best: Option<(f64, usize)> = None;
            for (at, clause) in left.iter().enumerate() {
                if let Clause::Fact(true, fact) = clause {
                    let choices = self.choices(fact, &scope);
                    if best.is_none_or(|(least, _)| choices < least) {
                        best = Some((choices, at));
                    }
                }
            }
            if let Some((_, at)) = best {
                if let Clause::Fact(_, fact) = left.remove(at) {
                    steps.push(self.matching(fact, &mut scope));
                }
                continue;
            }
            let Some(variable) = next_to_range(&left, &scope) else {
                break;
            };
            steps.push(Step::Range {
                variable,
                kind: scope.kinds[variable],
            });
            scope.bound[variable] = true;
        }
        let nested = steps.iter().flat_map(|step| match step {
            Step::Some(_, queries) => &queries[..],
            _ => &[],
        });
        let width = nested
            .map(|query| query.width)
            .fold(scope.kinds.len(), usize::max);
        Query::new(steps, width)
    }

    /// Takes out of `left` everything whose variables are all bound.
    fn tests(&mut self, left: &mut Vec<&Clause>, scope: &Scope, steps: &mut Vec<Step>) {
        let mut late = Vec::new();
        left.retain(|clause| {
            if !variables_of(clause)
                .iter()
                .all(|variable| *variable >= scope.bound.len() || scope.bound[*variable])
            {
                return true;
            }
            match clause {
                Clause::Fact(positive, fact) => {
                    steps.push(Step::Holds(*positive, fact.predicate, fact.args.clone()));
                }
                Clause::Equal(positive, one, other) => {
                    steps.push(Step::Equal(*positive, *one, *other));
                }
                Clause::Any(choices) => {
                    let queries = choices.iter().map(|choice| self.query(choice, scope));
                    late.push(Step::Some(true, queries.collect()));
                }
                Clause::Exists(quantified) => {
                    let query = self.inner(quantified, &quantified.inner, scope);
                    late.push(Step::Some(true, vec![query]));
                }
                // For all: there is none of which one of the clauses does not hold.
                Clause::Every(quantified) => {
                    let queries = quantified
                        .inner
                        .iter()
                        .map(|clause| self.inner(quantified, &negated(clause), scope));
                    late.push(Step::Some(false, queries.collect()));
                }
            }
            false
        });
        steps.extend(late);
    }

    fn inner(&mut self, quantified: &Quantified, clauses: &[Clause], scope: &Scope) -> Query {
        let mut inner = scope.clone();
        inner.kinds.truncate(quantified.first);
        inner.bound.truncate(quantified.first);
        inner.kinds.extend(&quantified.kinds);
        inner.bound.resize(inner.kinds.len(), false);
        self.query(clauses, &inner)
    }

    /// How many facts will fit on average, once what is bound has a value.
    fn choices(&mut self, fact: &FactPattern, scope: &Scope) -> f64 {
        let bound = bound_places(fact, scope);
        let init = self.compiled.init_of(fact.predicate);
        let count = || {
            let mut keys: FxHashSet<u64> = FxHashSet::default();
            let mut total = 0.0;
            for tuple in init {
                let key = bound.iter().map(|place| u64::from(tuple[*place].0));
                keys.insert(key.fold(0, join));
                total += 1.0;
            }
            // Where nothing holds at first it will be little.
            if keys.is_empty() {
                1.0
            } else {
                total / keys.len() as f64
            }
        };
        *self
            .fits
            .entry((fact.predicate, bound.clone()))
            .or_insert_with(count)
    }

    fn matching(&mut self, fact: &FactPattern, scope: &mut Scope) -> Step {
        let places = bound_places(fact, scope);
        let key = places.iter().map(|place| fact.args[*place]).collect();
        let mut binds: Vec<(usize, usize)> = Vec::new();
        let mut again = Vec::new();
        let mut kinds = Vec::new();
        for (place, term) in fact.args.iter().enumerate() {
            let Term::Variable(variable) = *term else {
                continue;
            };
            if scope.bound[variable] {
                continue;
            }
            if binds.iter().any(|(_, known)| *known == variable) {
                again.push((place, variable));
                continue;
            }
            binds.push((place, variable));
            let stands = self.compiled.predicate(fact.predicate).kinds[place];
            let wanted = self.compiled.kind(scope.kinds[variable]);
            let mut members = self.compiled.kind(stands).members.iter();
            if !members.all(|member| wanted.contains(*member)) {
                kinds.push((variable, scope.kinds[variable]));
            }
        }
        for (_, variable) in &binds {
            scope.bound[*variable] = true;
        }
        Step::Match {
            predicate: fact.predicate,
            index: self.facts.table_mut(fact.predicate).index_by(&places),
            key,
            binds,
            again,
            kinds,
        }
    }
}

fn bound_places(fact: &FactPattern, scope: &Scope) -> Vec<usize> {
    let places = fact.args.iter().enumerate();
    places
        .filter(|(_, term)| term.variable().is_none_or(|variable| scope.bound[variable]))
        .map(|(place, _)| place)
        .collect()
}

/// An equation of which one side is bound.
fn assignment(left: &[&Clause], scope: &Scope) -> Option<(usize, usize, Term)> {
    let bound = |term: &Term| term.variable().is_none_or(|variable| scope.bound[variable]);
    left.iter()
        .enumerate()
        .find_map(|(at, clause)| match clause {
            Clause::Equal(true, Term::Variable(variable), term) if bound(term) => {
                Some((at, *variable, *term))
            }
            Clause::Equal(true, term, Term::Variable(variable)) if bound(term) => {
                Some((at, *variable, *term))
            }
            _ => None,
        })
}

/// The variable whose objects are tried one by one: such that something can be tested soon.
fn next_to_range(left: &[&Clause], scope: &Scope) -> Option<usize> {
    let free = |variable: &usize| scope.bound.get(*variable) == Some(&false);
    let missing = left.iter().map(|clause| {
        let mut variables = variables_of(clause);
        variables.retain(free);
        variables
    });
    missing
        .min_by_key(Vec::len)
        .and_then(|variables| variables.first().copied())
        .or_else(|| (0..scope.bound.len()).find(free))
}

/// All variables in a clause, those of its quantifiers included, each once.
fn variables_of(clause: &Clause) -> Vec<usize> {
    let mut found = Vec::new();
    let mut terms = |term: &Term| {
        if let Term::Variable(variable) = term
            && !found.contains(variable)
        {
            found.push(*variable);
        }
    };
    let mut open = vec![clause];
    while let Some(clause) = open.pop() {
        match clause {
            Clause::Fact(_, fact) => fact.args.iter().for_each(&mut terms),
            Clause::Equal(_, one, other) => [one, other].into_iter().for_each(&mut terms),
            Clause::Any(choices) => open.extend(choices.iter().flatten()),
            Clause::Every(quantified) | Clause::Exists(quantified) => {
                open.extend(&quantified.inner);
            }
        }
    }
    found
}

/// The opposite of a clause, as clauses that must all hold.
// Recursive, as what it negates is: whoever made the condition bounded how deep it is.
fn negated(clause: &Clause) -> Vec<Clause> {
    let opposite = |quantified: &Quantified| Quantified {
        first: quantified.first,
        kinds: quantified.kinds.clone(),
        inner: negated_all(&quantified.inner),
    };
    match clause {
        Clause::Fact(positive, fact) => vec![Clause::Fact(!positive, fact.clone())],
        Clause::Equal(positive, one, other) => vec![Clause::Equal(!positive, *one, *other)],
        Clause::Any(choices) => choices.iter().flat_map(|c| negated_all(c)).collect(),
        Clause::Every(quantified) => vec![Clause::Exists(opposite(quantified))],
        Clause::Exists(quantified) => vec![Clause::Every(opposite(quantified))],
    }
}

/// The opposite of several clauses together.
fn negated_all(clauses: &[Clause]) -> Vec<Clause> {
    match clauses {
        [clause] => negated(clause),
        _ => vec![Clause::Any(clauses.iter().map(negated).collect())],
    }
}
