//! The belief and the map in numbers, as variables of which each has one value.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::code::Code;
use super::facts::{Facts, Source};
use super::groups::Members;
use super::intern::{Map, NONE, Names, Slices, Words};
use super::key::{Key, Touched};
use super::lists::{Lists, NIL};
use super::reading::Reading;
use crate::model::{Action, Atom, Belief, Domain, ExecutionModel, FactChange, Symbol};
use crate::planner::{Item, Problem, TaskList};
use smallvec::SmallVec;

/// What there is to be known, and names for all that is made of it.
#[derive(Clone, Debug)]
pub(super) struct World {
    pub domain: Arc<Domain>,
    pub model: Arc<ExecutionModel>,
    pub map: Arc<crate::model::Map>,
    pub names: Names,
    pub code: Arc<Code>,
    pub facts: Facts,
    pub lists: Lists,
    /// Sequences of variables and values.
    pub deltas: Slices,
    groups: Vec<Members>,
    kind_of: Map<u32, u32>,
    fits: Map<(u32, u32), bool>,
    objects: Map<u32, Arc<[u32]>>,
    /// By predicate that changes: the number of its group, or one of its own.
    class_of: Map<u32, u32>,
    /// By class: its predicates, and which of their arguments are parameters.
    classes: Vec<Map<u32, Vec<usize>>>,
    /// Class and parameters.
    variables: Slices,
    /// By atom; [`NONE`] if it was not asked for yet.
    variable_of: Vec<u32>,
    /// By variable: the fact that holds.
    values: Vec<u32>,
    /// Further facts of a variable that hold; none, or its group is none.
    more: Map<u32, Vec<u32>>,
    /// By task and action: the set of classes that doing it may ask for.
    reads: Map<u32, u32>,
    /// The set of classes on which it hangs what can be done.
    decisive: u32,
    /// Functions of which the belief has values.
    moving: BTreeSet<u32>,
    forbidden: BTreeSet<u32>,
    /// Of the belief as it is known here.
    fingerprint: u64,
}

impl World {
    /// With the problem's map and belief; `reading` is of its domain.
    pub fn new(problem: &Problem, reading: &Reading) -> Self {
        let mut world = Self {
            domain: problem.domain.clone(),
            model: problem.model.clone(),
            map: problem.map.clone(),
            names: reading.names.clone(),
            code: reading.code.clone(),
            facts: Facts::default(),
            lists: Lists::new(),
            deltas: Slices::default(),
            groups: reading.groups.clone(),
            kind_of: Map::default(),
            fits: Map::default(),
            objects: Map::default(),
            class_of: Map::default(),
            classes: Vec::new(),
            variables: Slices::default(),
            variable_of: Vec::new(),
            values: Vec::new(),
            more: Map::default(),
            reads: Map::default(),
            decisive: 0,
            moving: BTreeSet::new(),
            forbidden: BTreeSet::new(),
            fingerprint: problem.belief.fingerprint(),
        };
        world.load(&problem.belief);
        world.forbid(&problem.forbidden);
        world
    }

    fn load(&mut self, belief: &Belief) {
        let map = self.map.clone();
        let kinds = self.domain.clone();
        for (object, kind) in kinds.constants.iter().chain(&map.objects) {
            let (object, kind) = (self.names.number(object), self.names.number(kind));
            self.kind_of.insert(object, kind);
        }
        for fact in map.facts.facts() {
            let atom = self.atom(fact);
            self.facts.set(Source::Map, atom, true);
        }
        for (function, value) in map.facts.values() {
            let atom = self.atom(function);
            self.facts.set_value(Source::Map, atom, Some(value));
        }
        for fact in belief.facts() {
            let atom = self.atom(fact);
            self.facts.set(Source::Belief, atom, true);
        }
        for (function, value) in belief.values() {
            let atom = self.atom(function);
            self.facts.set_value(Source::Belief, atom, Some(value));
        }
        self.classify();
    }

    /// Finds out what changes, and makes variables of it.
    fn classify(&mut self) {
        self.class_of.clear();
        self.classes.clear();
        self.variables = Slices::default();
        self.variable_of.clear();
        self.values.clear();
        self.more.clear();
        self.lists = Lists::new();
        self.deltas = Slices::default();
        self.deltas.intern(&[]);
        for group in &self.groups {
            let mut class = Map::default();
            for (predicate, parameters) in group {
                let predicate = self.names.number(predicate);
                class.insert(predicate, parameters.clone());
                self.class_of.insert(predicate, self.classes.len() as u32);
            }
            self.classes.push(class);
        }
        let mut changing = self.code.changing.clone();
        let believed = self.facts.each_believed();
        changing.extend(believed.map(|atom| self.facts.name(atom)));
        changing.sort_unstable();
        changing.dedup();
        for predicate in changing {
            self.add_class(predicate);
        }
        let functions = self.facts.believed_values().keys();
        self.moving = functions.map(|f| self.facts.name(*f)).collect();
        self.reads = Map::default();
        let code = self.code.clone();
        for (name, predicates) in &code.reads {
            let classes = predicates.iter().filter_map(|p| self.class_of.get(p));
            let classes: Vec<u32> = classes.copied().collect();
            let set = self.lists.set(classes);
            self.reads.insert(*name, set);
        }
        let decisive = code.decisive.iter().filter_map(|p| self.class_of.get(p));
        self.decisive = self.lists.set(decisive.copied().collect::<Vec<u32>>());
        for atom in 0..self.facts.len() as u32 {
            if self.facts.holds(atom) && self.class_of.contains_key(&self.facts.name(atom)) {
                self.turn(atom, true);
            }
        }
        self.mend_groups();
    }

    fn add_class(&mut self, predicate: u32) {
        if !self.class_of.contains_key(&predicate) {
            self.class_of.insert(predicate, self.classes.len() as u32);
            self.classes.push(Map::default());
        }
    }

    /// Gives up the groups of which more than one fact holds. Returns whether there were any.
    fn mend_groups(&mut self) -> bool {
        if self.more.is_empty() {
            return false;
        }
        let variables = self.more.keys();
        let broken: BTreeSet<usize> = variables.map(|v| self.class(*v) as usize).collect();
        let mut number = 0;
        self.groups.retain(|_| {
            number += 1;
            !broken.contains(&(number - 1))
        });
        self.classify();
        true
    }

    /// The number of an atom.
    pub fn atom(&mut self, atom: &Atom) -> u32 {
        let mut words = Words::from_elem(self.names.number(&atom.name), 1);
        words.extend(atom.args.iter().map(|arg| self.names.number(arg)));
        self.facts.atom(&words)
    }

    /// The atom with a number.
    pub fn name_atom(&self, atom: u32) -> Atom {
        self.spell(self.facts.words(atom))
    }

    fn spell(&self, words: &[u32]) -> Atom {
        let args = words[1..].iter().map(|arg| self.names.name(*arg).clone());
        Atom {
            name: self.names.name(words[0]).clone(),
            args: args.collect(),
        }
    }

    /// The class of variables that a predicate's facts are values of; [`NONE`] if they do not
    /// change.
    pub fn class_of(&self, predicate: u32) -> u32 {
        self.class_of.get(&predicate).copied().unwrap_or(NONE)
    }

    /// The class of a variable.
    pub fn class(&self, variable: u32) -> u32 {
        self.variables.get(variable)[0]
    }

    /// Whether it hangs on a variable what can be done.
    pub fn is_decisive(&self, variable: u32) -> bool {
        self.lists.contains(self.decisive, self.class(variable))
    }

    /// Which arguments of a predicate are the parameters of its group; `None` if all are.
    pub fn parameters(&self, predicate: u32) -> Option<&[usize]> {
        let class = self.class_of.get(&predicate)?;
        let parameters = self.classes[*class as usize].get(&predicate)?;
        Some(parameters)
    }

    /// The variable that a fact is a value of, if its predicate is one that changes.
    pub fn variable_of(&mut self, atom: u32) -> u32 {
        if self.variable_of.len() <= atom as usize {
            self.variable_of.resize(self.facts.len(), NONE);
        }
        let known = self.variable_of[atom as usize];
        if known != NONE {
            return known;
        }
        let words = self.facts.words(atom);
        let class = self.class_of(words[0]);
        let mut key = Words::from_elem(class, 1);
        match self.parameters(words[0]) {
            Some(parameters) => key.extend(parameters.iter().map(|place| words[place + 1])),
            None => key.extend_from_slice(&words[1..]),
        }
        let variable = self.variable(&key);
        self.variable_of[atom as usize] = variable;
        variable
    }

    /// The variable of a class with parameters.
    pub fn variable(&mut self, key: &[u32]) -> u32 {
        let variable = self.variables.intern(key);
        if variable as usize == self.values.len() {
            self.values.push(NONE);
        }
        variable
    }

    /// The fact that holds of a variable, or [`NONE`].
    pub fn value(&self, variable: u32) -> u32 {
        self.values[variable as usize]
    }

    /// Keeps the value of a fact's variable.
    fn turn(&mut self, atom: u32, holds: bool) -> u32 {
        let variable = self.variable_of(atom);
        let value = &mut self.values[variable as usize];
        if holds {
            match *value {
                NONE => *value = atom,
                _ => self.more.entry(variable).or_default().push(atom),
            }
            return variable;
        }
        let more = self.more.get_mut(&variable);
        if *value == atom {
            *value = more.and_then(Vec::pop).unwrap_or(NONE);
        } else if let Some(more) = more {
            more.retain(|other| *other != atom);
        }
        if self.more.get(&variable).is_some_and(Vec::is_empty) {
            self.more.remove(&variable);
        }
        variable
    }

    /// The belief changes.
    pub fn apply(&mut self, changes: &[FactChange], touched: &mut Touched) {
        for change in changes {
            let (fact, holds) = match change {
                FactChange::Add(fact) => (fact, true),
                FactChange::Remove(fact) => (fact, false),
                FactChange::Set(function, value) => {
                    let atom = self.atom(function);
                    self.fingerprint = self.fingerprint.wrapping_sub(
                        self.facts
                            .believed_values()
                            .get(&atom)
                            .map_or(0, |before| Belief::fingerprint_of_value(function, *before)),
                    );
                    self.fingerprint = self
                        .fingerprint
                        .wrapping_add(Belief::fingerprint_of_value(function, *value));
                    self.set_value(atom, Some(*value), touched);
                    continue;
                }
            };
            let atom = self.atom(fact);
            if self.facts.says(Source::Belief, atom) != holds {
                let print = Belief::fingerprint_of(fact);
                self.fingerprint = match holds {
                    true => self.fingerprint.wrapping_add(print),
                    false => self.fingerprint.wrapping_sub(print),
                };
                self.set_fact(atom, holds, touched);
            }
        }
        self.settle(touched);
    }

    /// Whether this belief is the one that is known here already.
    pub fn knows(&self, belief: &Belief) -> bool {
        self.fingerprint == belief.fingerprint()
    }

    /// The belief is this one.
    pub fn become_like(&mut self, belief: &Belief, touched: &mut Touched) {
        let mut stays = BTreeSet::new();
        for fact in belief.facts() {
            let atom = self.atom(fact);
            stays.insert(atom);
            if !self.facts.says(Source::Belief, atom) {
                self.set_fact(atom, true, touched);
            }
        }
        if self.facts.believed() != stays.len() {
            let gone = self.facts.each_believed().filter(|a| !stays.contains(a));
            for atom in gone.collect::<Vec<u32>>() {
                self.set_fact(atom, false, touched);
            }
        }
        let mut stays = BTreeSet::new();
        for (function, value) in belief.values() {
            let atom = self.atom(function);
            stays.insert(atom);
            self.set_value(atom, Some(value), touched);
        }
        let values = self.facts.believed_values().keys();
        let gone = values.copied().filter(|function| !stays.contains(function));
        for atom in gone.collect::<BTreeSet<u32>>() {
            self.set_value(atom, None, touched);
        }
        self.fingerprint = belief.fingerprint();
        self.settle(touched);
    }

    fn set_fact(&mut self, atom: u32, holds: bool, touched: &mut Touched) {
        if !self.facts.set(Source::Belief, atom, holds) {
            return;
        }
        let predicate = self.facts.name(atom);
        if self.class_of(predicate) == NONE {
            touched.all = true;
            return;
        }
        let variable = self.turn(atom, holds);
        touched.keys.push((Key::Variable(variable), NONE));
        touched.keys.push((Key::Pattern(predicate, 0, 0), variable));
        let args = self.facts.args(atom).iter().zip(1..);
        let patterns = args.map(|(arg, place)| Key::Pattern(predicate, place, *arg));
        touched.keys.extend(patterns.map(|key| (key, variable)));
    }

    fn set_value(&mut self, function: u32, value: Option<f64>, touched: &mut Touched) {
        if self.facts.set_value(Source::Belief, function, value) {
            touched.keys.push((Key::Value(function), NONE));
            touched.all |= !self.moves(self.facts.name(function));
        }
    }

    fn settle(&mut self, touched: &mut Touched) {
        if touched.all {
            self.classify();
        }
        touched.all |= self.mend_groups();
    }

    /// The value of a function, if it has one.
    pub fn function(&self, words: &[u32]) -> Option<f64> {
        let listed = self.facts.find(words).and_then(|f| self.facts.value(f));
        if listed.is_some() || self.map.facts.landmarks().next().is_none() {
            return listed;
        }
        self.map.facts.value(&self.spell(words))
    }

    /// Whether a function may change.
    pub fn moves(&self, function: u32) -> bool {
        self.moving.contains(&function)
    }

    /// These actions, and no others, are not to be tried. Returns those that were, or were not,
    /// before.
    pub fn forbid(&mut self, actions: &BTreeSet<Action>) -> Vec<u32> {
        if actions.is_empty() && self.forbidden.is_empty() {
            return Vec::new();
        }
        let forbidden: BTreeSet<u32> = actions.iter().map(|action| self.atom(action)).collect();
        let changed = forbidden.symmetric_difference(&self.forbidden);
        let changed = changed.copied().collect();
        self.forbidden = forbidden;
        changed
    }

    pub fn is_forbidden(&self, action: u32) -> bool {
        self.forbidden.contains(&action)
    }

    /// [`Problem::fits`].
    pub fn fits(&mut self, object: u32, kind: u32) -> bool {
        let Some(given) = self.kind_of.get(&object) else {
            return true;
        };
        let (domain, names) = (&self.domain, &self.names);
        let is_a = || domain.is_a(names.name(*given), names.name(kind));
        *self.fits.entry((*given, kind)).or_insert_with(is_a)
    }

    /// Whether arguments are of the types declared.
    pub fn fit(&mut self, args: &[u32], kinds: &[u32]) -> bool {
        let mut pairs = args.iter().zip(kinds);
        args.len() == kinds.len() && pairs.all(|(arg, kind)| self.fits(*arg, *kind))
    }

    /// [`Problem::objects_of`].
    pub fn objects_of(&mut self, kind: u32) -> Arc<[u32]> {
        if let Some(known) = self.objects.get(&kind) {
            return known.clone();
        }
        let wanted = self.names.name(kind);
        let all = self.map.objects.iter().chain(&self.domain.constants);
        let fitting = all.filter(|(_, given)| self.domain.is_a(given, wanted));
        let objects: BTreeSet<Symbol> = fitting.map(|(object, _)| object.clone()).collect();
        let objects: Arc<[u32]> = objects.iter().map(|o| self.names.number(o)).collect();
        self.objects.insert(kind, objects.clone());
        objects
    }

    /// The number of a thing to be done.
    pub fn entry(&mut self, item: &Item) -> u32 {
        let atom = self.atom(item.atom());
        if let Item::Task(_) = item {
            return self.lists.task(atom);
        }
        let purpose = self.atom(item.purpose());
        self.lists.other(item, atom, purpose)
    }

    /// `entry` first, then `rest`.
    pub fn prepend(&mut self, entry: u32, rest: u32) -> u32 {
        let name = self.facts.name(self.lists.entry(entry).atom);
        let reads = self.reads.get(&name).copied().unwrap_or_default();
        self.lists.prepend(entry, reads, rest)
    }

    /// The number of a list of tasks.
    pub fn list(&mut self, tasks: &TaskList) -> u32 {
        let items: SmallVec<[&Item; 16]> = tasks.items().collect();
        items.into_iter().rev().fold(NIL, |rest, item| {
            let entry = self.entry(item);
            self.prepend(entry, rest)
        })
    }

    /// Forgets all lists and deltas: there are no nodes.
    pub fn forget_lists(&mut self) {
        self.lists.compact(std::iter::empty());
        self.deltas = Slices::default();
        self.deltas.intern(&[]);
    }

    /// The delta of these variables as they are now.
    pub fn realised(&self, variables: &[u32]) -> Option<u32> {
        let pairs = variables.iter().flat_map(|v| [*v, self.value(*v)]);
        self.deltas.find(&pairs.collect::<Words>())
    }

    /// Whether a delta says something of a variable.
    pub fn shadows(&self, delta: u32, variable: u32) -> bool {
        let mut pairs = self.deltas.get(delta).chunks_exact(2);
        variable != NONE && pairs.any(|pair| pair[0] == variable)
    }

    /// Whether everything that a delta says is so.
    #[cfg(test)]
    pub fn is_realised(&self, delta: u32) -> bool {
        let mut pairs = self.deltas.get(delta).chunks_exact(2);
        pairs.all(|pair| self.value(pair[0]) == pair[1])
    }
}
