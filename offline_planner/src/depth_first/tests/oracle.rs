//! Whether there is a plan, found out as plainly as can be: what states each task can lead to from
//! each state, until nothing new comes. Shares no code with what it judges.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Atom, Change, Clause, Domain, Instance, Parameter, Pattern, Symbol, Term};

type State = BTreeSet<Atom>;

/// Answers for one problem.
pub struct Oracle<'a> {
    domain: &'a Domain,
    instance: &'a Instance,
    objects: BTreeMap<Symbol, Symbol>,
    ends: BTreeMap<(Atom, State), BTreeSet<State>>,
}

/// More tasks with states than this are too many for a test.
const LIMIT: usize = 1500;

impl<'a> Oracle<'a> {
    pub fn new(domain: &'a Domain, instance: &'a Instance) -> Self {
        let mut objects = domain.constants.clone();
        objects.extend(instance.objects.clone());
        Self {
            domain,
            instance,
            objects,
            ends: BTreeMap::new(),
        }
    }

    /// Whether there is a plan; `None` if that is too much to find out.
    pub fn solvable(mut self) -> Option<bool> {
        let init: State = self.instance.init.facts().cloned().collect();
        loop {
            let before = (
                self.ends.len(),
                self.ends.values().map(BTreeSet::len).sum::<usize>(),
            );
            let mut solved = false;
            for bindings in self.bindings(&self.instance.parameters, Vec::new()) {
                if self.holds_all(&init, &self.instance.constraints, &bindings) {
                    let ends = self.sequence(&self.instance.tasks, &bindings, init.clone());
                    let goal = &self.instance.goal;
                    solved |= ends.iter().any(|state| self.holds_all(state, goal, &[]));
                }
            }
            for (task, state) in self.ends.keys().cloned().collect::<Vec<_>>() {
                let found = self.once(&task, &state);
                self.ends.entry((task, state)).or_default().extend(found);
            }
            if solved {
                return Some(true);
            }
            if self.ends.len() > LIMIT {
                return None;
            }
            let now = (
                self.ends.len(),
                self.ends.values().map(BTreeSet::len).sum::<usize>(),
            );
            if now == before {
                return Some(false);
            }
        }
    }

    /// Where the task leads by what is known of its subtasks.
    fn once(&mut self, task: &Atom, state: &State) -> BTreeSet<State> {
        let mut found = BTreeSet::new();
        for method in &self.domain.methods {
            if method.task.name != task.name {
                continue;
            }
            for bindings in self.bindings(&method.parameters, Vec::new()) {
                if ground(&method.task, &bindings) == *task
                    && self.holds_all(state, &method.precondition, &bindings)
                {
                    found.extend(self.sequence(&method.subtasks, &bindings, state.clone()));
                }
            }
        }
        found
    }

    fn sequence(
        &mut self,
        subtasks: &[Pattern],
        bindings: &[Symbol],
        from: State,
    ) -> BTreeSet<State> {
        let mut states = BTreeSet::from([from]);
        for subtask in subtasks {
            let atom = ground(subtask, bindings);
            let mut next = BTreeSet::new();
            for state in states {
                next.extend(self.step(&atom, state));
            }
            states = next;
        }
        states
    }

    fn step(&mut self, atom: &Atom, state: State) -> BTreeSet<State> {
        let Some(operator) = self.domain.operators.get(&atom.name) else {
            let declared = &self.domain.tasks[&atom.name];
            if !self.fits(declared, atom) {
                return BTreeSet::new();
            }
            return self.ends.entry((atom.clone(), state)).or_default().clone();
        };
        if !self.fits(&operator.parameters, atom)
            || !self.holds_all(&state, &operator.precondition, &atom.args)
        {
            return BTreeSet::new();
        }
        let mut after = state.clone();
        for fact in self.changes(&operator.effect.remove, &state, &atom.args) {
            after.remove(&fact);
        }
        after.extend(self.changes(&operator.effect.add, &state, &atom.args));
        BTreeSet::from([after])
    }

    fn fits(&self, declared: &[Parameter], atom: &Atom) -> bool {
        declared
            .iter()
            .zip(&atom.args)
            .all(|(parameter, object)| self.domain.is_a(&self.objects[object], &parameter.kind))
    }

    fn changes(&self, changes: &[Change], state: &State, args: &[Symbol]) -> Vec<Atom> {
        let mut found = Vec::new();
        for change in changes {
            for bindings in self.bindings(&change.over, args.to_vec()) {
                if self.holds_all(state, &change.when, &bindings) {
                    found.push(ground(&change.fact, &bindings));
                }
            }
        }
        found
    }

    fn bindings(&self, parameters: &[Parameter], prefix: Vec<Symbol>) -> Vec<Vec<Symbol>> {
        let mut all = vec![prefix];
        for parameter in parameters {
            let objects: Vec<&Symbol> = self
                .objects
                .iter()
                .filter(|(_, kind)| self.domain.is_a(kind, &parameter.kind))
                .map(|(object, _)| object)
                .collect();
            let longer = |bindings: &Vec<Symbol>| {
                let with = |object: &&Symbol| [&bindings[..], &[(*object).clone()]].concat();
                objects.iter().map(with).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(longer).collect();
        }
        all
    }

    fn holds_all(&self, state: &State, clauses: &[Clause], bindings: &[Symbol]) -> bool {
        clauses.iter().all(|clause| match clause {
            Clause::Fact(positive, pattern) => {
                state.contains(&ground(pattern, bindings)) == *positive
            }
            Clause::Equal(positive, one, other) => {
                (value(one, bindings) == value(other, bindings)) == *positive
            }
            Clause::Any(choices) => choices
                .iter()
                .any(|choice| self.holds_all(state, choice, bindings)),
            Clause::Every(over, inner) => self
                .bindings(over, bindings.to_vec())
                .iter()
                .all(|bindings| self.holds_all(state, inner, bindings)),
            Clause::Exists(over, inner) => self
                .bindings(over, bindings.to_vec())
                .iter()
                .any(|bindings| self.holds_all(state, inner, bindings)),
        })
    }
}

fn value(term: &Term, bindings: &[Symbol]) -> Symbol {
    match term {
        Term::Variable(index) => bindings[*index].clone(),
        Term::Constant(name) => name.clone(),
    }
}

fn ground(pattern: &Pattern, bindings: &[Symbol]) -> Atom {
    Atom {
        name: pattern.name.clone(),
        args: pattern
            .args
            .iter()
            .map(|term| value(term, bindings))
            .collect(),
    }
}
