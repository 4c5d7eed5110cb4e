//! Asking the world after some actions, and remembering what was asked.

use super::code::{Arg, Operator, Shape, Test, Value, Write};
use super::intern::{NONE, Words};
use super::key::Key;
use super::world::World;
use crate::model::Cost;
use smallvec::SmallVec;

/// Of most states no more is asked.
const READS: usize = 16;

/// A state, and what was asked of it.
///
/// Every question is noted in `reads`, whatever the answer, unless the delta answers it: what an
/// earlier step of the same path brings about does not depend on the belief.
pub(super) struct Eval<'a> {
    pub world: &'a mut World,
    /// Variables and values that differ from the belief, or may, by variable.
    pub delta: SmallVec<[(u32, u32); 8]>,
    pub reads: Vec<Key>,
    /// Facts of observable predicates that were asked for and did not hold.
    pub wanted: Vec<u32>,
}

impl<'a> Eval<'a> {
    pub fn new(world: &'a mut World, delta: u32) -> Self {
        let pairs = world.deltas.get(delta).chunks_exact(2);
        let delta = pairs.map(|pair| (pair[0], pair[1])).collect();
        Self {
            world,
            delta,
            reads: Vec::with_capacity(READS),
            wanted: Vec::new(),
        }
    }

    fn shadow(&self, variable: u32) -> Option<u32> {
        let at = self.delta.binary_search_by_key(&variable, |(v, _)| *v);
        at.ok().map(|at| self.delta[at].1)
    }

    /// The fact that holds of a variable, or [`NONE`].
    fn value_of(&mut self, variable: u32) -> u32 {
        self.shadow(variable).unwrap_or_else(|| {
            self.reads.push(Key::Variable(variable));
            self.world.value(variable)
        })
    }

    /// Whether the fact holds, of which name and arguments are given.
    fn holds(&mut self, words: &[u32]) -> bool {
        if self.world.class_of(words[0]) == NONE {
            let atom = self.world.facts.find(words);
            return atom.is_some_and(|atom| self.world.facts.holds(atom));
        }
        let atom = self.world.facts.atom(words);
        let variable = self.world.variable_of(atom);
        self.value_of(variable) == atom
    }

    /// All facts that match `shape` as far as its variables are bound.
    fn matching(&mut self, shape: &Shape, bindings: &[u32]) -> Words {
        let args: Words = shape.args.iter().map(|arg| arg.bound(bindings)).collect();
        let name = shape.name;
        let class = self.world.class_of(name);
        if class == NONE {
            let facts = &self.world.facts;
            let candidates = facts.candidates(name, &args).iter().copied();
            return candidates
                .filter(|atom| agrees(facts.args(*atom), &args))
                .collect();
        }
        if let Some(variable) = self.variable_of_shape(class, name, &args) {
            let atom = self.value_of(variable);
            let facts = &self.world.facts;
            let fits = atom != NONE && facts.name(atom) == name && agrees(facts.args(atom), &args);
            return Words::from_iter(fits.then_some(atom));
        }
        let bound = args.iter().position(|arg| *arg != NONE);
        self.reads.push(match bound {
            Some(place) => Key::Pattern(name, place as u32 + 1, args[place]),
            None => Key::Pattern(name, 0, 0),
        });
        let facts = &self.world.facts;
        let candidates = facts.candidates(name, &args).iter().copied();
        let mut found: Words = candidates
            .filter(|atom| agrees(facts.args(*atom), &args))
            .collect();
        if !self.delta.is_empty() {
            found.retain(|atom| {
                let variable = self.world.variable_of(*atom);
                let shadowed = self.delta.binary_search_by_key(&variable, |(v, _)| *v);
                shadowed.is_err()
            });
            let facts = &self.world.facts;
            let added = self.delta.iter().map(|(_, atom)| *atom).filter(|atom| {
                *atom != NONE && facts.name(*atom) == name && agrees(facts.args(*atom), &args)
            });
            found.extend(added);
        }
        found.sort_unstable();
        found
    }

    /// The one variable that a shape is about, if its group's parameters are bound.
    fn variable_of_shape(&mut self, class: u32, name: u32, args: &[u32]) -> Option<u32> {
        let mut key = Words::from_elem(class, 1);
        match self.world.parameters(name) {
            Some(parameters) => key.extend(parameters.iter().map(|place| args[*place])),
            None => key.extend_from_slice(args),
        }
        let bound = key[1..].iter().all(|arg| *arg != NONE);
        bound.then(|| self.world.variable(&key))
    }

    /// All ways to bind variables so that `tests` hold. `kinds`: the types of the variables.
    pub fn solve(&mut self, kinds: &[u32], tests: &[Test], bindings: Words) -> Vec<Words> {
        let mut found = Vec::new();
        let open: SmallVec<[&Test; 8]> = tests.iter().collect();
        self.go_on(kinds, &open, bindings, &mut found);
        found
    }

    /// In the order of the baseline planner, so that the same facts are found wanting.
    fn go_on(
        &mut self,
        kinds: &[u32],
        open: &[&Test],
        mut bindings: Words,
        found: &mut Vec<Words>,
    ) {
        let mut undecided: SmallVec<[&Test; 8]> = SmallVec::new();
        for test in open {
            match self.decide(test, &bindings) {
                Some(true) => {}
                Some(false) => return,
                None => undecided.push(*test),
            }
        }
        let binder = undecided
            .iter()
            .position(|test| matches!(test, Test::Fact(true, _)));
        if let Some(binder) = binder
            && let Test::Fact(_, shape) = undecided.remove(binder)
        {
            for atom in self.matching(shape, &bindings) {
                if let Some(bindings) = self.unify(kinds, shape, atom, &bindings) {
                    self.go_on(kinds, &undecided, bindings, found);
                }
            }
            return;
        }
        let Some(free) = bindings.iter().position(|object| *object == NONE) else {
            found.push(bindings);
            return;
        };
        let objects = self.world.objects_of(kinds[free]);
        for object in objects.iter() {
            bindings[free] = *object;
            self.go_on(kinds, &undecided, bindings.clone(), found);
        }
    }

    /// Whether a test is passed, if its variables are bound.
    fn decide(&mut self, test: &Test, bindings: &[u32]) -> Option<bool> {
        match test {
            Test::Equal(wanted, a, b) => {
                let (a, b) = (a.bound(bindings), b.bound(bindings));
                (a != NONE && b != NONE).then_some((a == b) == *wanted)
            }
            Test::Fact(wanted, shape) => {
                let words = ground(shape, bindings)?;
                let holds = self.holds(&words) == *wanted;
                if !holds && self.world.code.observable.contains(&shape.name) {
                    let atom = self.world.facts.atom(&words);
                    self.wanted.push(atom);
                }
                Some(holds)
            }
            _ if !test.is_bound(bindings) => None,
            Test::Any(choices) => Some(choices.iter().any(|c| self.some(&[], c, bindings))),
            Test::Exists(over, inner) => Some(self.some(over, inner, bindings)),
            Test::Every(over, inner) => {
                let (all, outer) = within(over, bindings);
                let ranged = self.solve(&all, &[], outer);
                Some(ranged.iter().all(|b| self.some(&[], inner, b)))
            }
        }
    }

    fn some(&mut self, over: &[u32], tests: &[Test], outer: &[u32]) -> bool {
        let (all, bindings) = within(over, outer);
        !self.solve(&all, tests, bindings).is_empty()
    }

    fn unify(
        &mut self,
        kinds: &[u32],
        shape: &Shape,
        atom: u32,
        bindings: &[u32],
    ) -> Option<Words> {
        let mut bindings = Words::from_slice(bindings);
        for (place, arg) in shape.args.iter().enumerate() {
            let object = self.world.facts.args(atom)[place];
            if let Arg::Variable(index) = arg {
                if bindings[*index] == NONE {
                    if !self.world.fits(object, kinds[*index]) {
                        return None;
                    }
                    bindings[*index] = object;
                } else if bindings[*index] != object {
                    return None;
                }
            }
        }
        Some(bindings)
    }

    /// The value of an expression; `None` if a function in it has none.
    pub fn number(&mut self, value: &Value, bindings: &[u32]) -> Option<f64> {
        Some(match value {
            Value::Constant(constant) => *constant,
            Value::Function(shape) => {
                let words = ground(shape, bindings)?;
                if self.world.moves(shape.name) {
                    let function = self.world.facts.atom(&words);
                    self.reads.push(Key::Value(function));
                }
                self.world.function(&words)?
            }
            Value::Sum(terms) => {
                let terms = terms.iter().map(|term| self.number(term, bindings));
                terms.sum::<Option<f64>>()?
            }
            Value::Product(factors) => {
                let factors = factors.iter().map(|factor| self.number(factor, bindings));
                factors.product::<Option<f64>>()?
            }
            Value::Difference(both) => {
                self.number(&both.0, bindings)? - self.number(&both.1, bindings)?
            }
            Value::Quotient(both) => {
                self.number(&both.0, bindings)? / self.number(&both.1, bindings)?
            }
        })
    }

    /// By the first rule of the execution model that matches, else by the operator.
    pub fn cost_of(&mut self, operator: &Operator, args: &[u32]) -> Cost {
        for rule in &operator.rules {
            let found = self.solve(&rule.kinds, &rule.given, bind(args, &rule.kinds));
            let costs = found.iter().filter_map(|b| self.number(&rule.value, b));
            if let Some(least) = costs.map(Cost::from_units).min() {
                return least;
            }
        }
        let bindings = bind(args, &operator.kinds);
        let units = self.number(&operator.cost, &bindings);
        units.map_or(Cost::ZERO, Cost::from_units)
    }

    /// The state after an action, as far as a kind of variable is in the set `matters`.
    pub fn act(&mut self, operator: &Operator, args: &[u32], matters: u32) {
        let bindings = bind(args, &operator.kinds);
        let mut removed = Words::new();
        for write in &operator.remove {
            self.written(write, false, &bindings, matters, &mut removed);
        }
        let mut added = Words::new();
        for write in &operator.add {
            self.written(write, true, &bindings, matters, &mut added);
        }
        self.write(&removed, &added);
    }

    /// Facts that no longer hold, then facts that do.
    pub fn write(&mut self, removed: &[u32], added: &[u32]) {
        let mut writes: SmallVec<[(u32, u32); 8]> = SmallVec::new();
        for atom in added {
            writes.push((self.world.variable_of(*atom), *atom));
        }
        for atom in removed {
            let variable = self.world.variable_of(*atom);
            if writes.iter().any(|(written, _)| *written == variable) {
                continue;
            }
            // With others in its group, one that does not hold is not removed.
            let alone = self
                .world
                .parameters(self.world.facts.name(*atom))
                .is_none();
            if alone || self.value_of(variable) == *atom {
                writes.push((variable, NONE));
            }
        }
        for (variable, value) in writes {
            match self.delta.binary_search_by_key(&variable, |(v, _)| *v) {
                Ok(at) => self.delta[at].1 = value,
                Err(at) => self.delta.insert(at, (variable, value)),
            }
        }
    }

    /// The facts that a part of an effect is about.
    fn written(
        &mut self,
        write: &Write,
        holds: bool,
        bindings: &[u32],
        matters: u32,
        found: &mut Words,
    ) {
        let class = self.world.class_of(write.fact.name);
        if !self.world.lists.contains(matters, class) {
            return;
        }
        if write.over.is_empty() && write.when.is_empty() {
            let words = ground(&write.fact, bindings);
            found.extend(words.map(|words| self.world.facts.atom(&words)));
            return;
        }
        let mut kinds = Words::from_elem(NONE, bindings.len());
        kinds.extend_from_slice(&write.over);
        let mut all = Words::from_slice(bindings);
        all.resize(kinds.len(), NONE);
        // Only what holds needs to be removed, which binds the variables faster than their types.
        let fact = Test::Fact(true, write.fact.clone());
        let first = std::iter::once(&fact).filter(|_| !holds);
        let open: SmallVec<[&Test; 8]> = first.chain(&write.when).collect();
        let mut solutions = Vec::new();
        let wanted = self.wanted.len();
        self.go_on(&kinds, &open, all, &mut solutions);
        self.wanted.truncate(wanted);
        let words = solutions.iter().filter_map(|b| ground(&write.fact, b));
        for words in words {
            found.push(self.world.facts.atom(&words));
        }
    }

    /// The state in which `facts` hold and no others of their predicates do, as far as a kind of
    /// variable is in the set `matters`.
    pub fn establish(&mut self, facts: &[Shape], bindings: &[u32], matters: u32) {
        let (mut removed, mut added) = (Words::new(), Words::new());
        for shape in facts {
            if !self
                .world
                .lists
                .contains(matters, self.world.class_of(shape.name))
            {
                continue;
            }
            let any = Shape {
                name: shape.name,
                args: vec![Arg::Variable(usize::MAX); shape.args.len()],
            };
            removed.extend(self.matching(&any, &[]));
            let words = ground(shape, bindings);
            added.extend(words.map(|words| self.world.facts.atom(&words)));
        }
        self.write(&removed, &added);
    }

    /// The number of the delta, of what is in the set `matters` alone.
    pub fn projected(&mut self, matters: u32) -> u32 {
        let world = &mut *self.world;
        let mut words = Words::new();
        for (variable, value) in &self.delta {
            if world.lists.contains(matters, world.class(*variable)) {
                words.extend([*variable, *value]);
            }
        }
        world.deltas.intern(&words)
    }
}

/// The types of the variables in scope and then of a quantifier's own, which nothing binds as yet.
///
/// A quantifier is only decided when all that it speaks of is bound, so that variables which are
/// still free are of no interest within it.
fn within(over: &[u32], outer: &[u32]) -> (Words, Words) {
    let mut kinds = Words::from_elem(NONE, outer.len());
    kinds.extend_from_slice(over);
    let some = |object: &u32| if *object == NONE { 0 } else { *object };
    let mut bindings: Words = outer.iter().map(some).collect();
    bindings.resize(kinds.len(), NONE);
    (kinds, bindings)
}

/// Name and arguments, if every variable is bound.
pub(super) fn ground(shape: &Shape, bindings: &[u32]) -> Option<Words> {
    let mut words = Words::new();
    words.push(shape.name);
    for arg in &shape.args {
        match arg.bound(bindings) {
            NONE => return None,
            object => words.push(object),
        }
    }
    Some(words)
}

/// The arguments of an atom as bindings of the variables of its declaration.
pub(super) fn bind(args: &[u32], kinds: &[u32]) -> Words {
    let mut bindings = Words::from_slice(args);
    bindings.resize(kinds.len().max(args.len()), NONE);
    bindings
}

fn agrees(args: &[u32], wanted: &[u32]) -> bool {
    let same = |(arg, wanted): (&u32, &u32)| *wanted == NONE || arg == wanted;
    args.len() == wanted.len() && args.iter().zip(wanted).all(same)
}
