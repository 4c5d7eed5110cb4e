//! The search itself.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use rustc_hash::FxHashMap;

use super::facts::Facts;
use super::hash::{Numbers, join, spread};
use super::program::{HeadStep, Program};
use super::query::AtHand;
use super::table::FactPlace;
use crate::compile::{ActionId, Compiled, MethodId, ObjectId, PredicateId, Step, TaskId};
use crate::control::{Control, Halt, Outcome};
use crate::plan::Choices;

/// No node: the end of a task list.
const END: u32 = u32::MAX;
/// Every so many tasks without a choice are looked up among those met before, all the same: a loop
/// may have no choice in it.
const LOOK_UP_EVERY: u64 = 16;
/// Every so many nodes the search looks whether it is to stop.
const CONTROL_EVERY: u64 = 256;

/// What is to be done, first of a list of tasks.
#[derive(Clone, Copy, Debug)]
struct Node {
    kind: NodeKind,
    /// Where its arguments begin.
    args: u32,
    /// What is to be done next.
    next: u32,
    /// Of the whole list from here on.
    hash: u64,
}

#[derive(Clone, Copy, Debug)]
enum NodeKind {
    Action(ActionId),
    Task(TaskId),
    /// A task that was decomposed under this number is done.
    Close(u64),
}

/// Where another way may be taken, and how to get back there.
#[derive(Clone, Copy, Debug)]
struct Fork {
    node: u32,
    /// Place of the method among those of the task.
    method: u32,
    facts: usize,
    nodes: u32,
    args: u32,
    cursors: u32,
    chosen: u32,
    bindings: u32,
    opened: u32,
    needs: u32,
}

/// A depth-first search that can be interrupted and taken up again.
#[derive(Debug)]
pub struct DepthFirst {
    compiled: Arc<Compiled>,
    program: Program,
    facts: Facts,
    nodes: Vec<Node>,
    args: Vec<ObjectId>,
    current: u32,
    forks: Vec<Fork>,
    cursors: Vec<u32>,
    chosen: Vec<MethodId>,
    bindings: Vec<ObjectId>,
    /// States with task lists that have been met.
    met: Numbers,
    /// Tasks that are being decomposed, with the state in which that began; how many of each.
    open: FxHashMap<u64, u32>,
    /// Tasks, with states, that were ever begun, and those that were ever done.
    begun: Numbers,
    done: Numbers,
    /// What was opened (`true`) and closed, to be taken back.
    opened: Vec<(u64, bool)>,
    /// How many of what is still to be done need a fact (the last bit: to hold) that can be lost
    /// and never be had again.
    needed: FxHashMap<(PredicateId, FactPlace, bool), u32>,
    /// Where such a count went up (`true`) and down, to be taken back.
    needs: Vec<((PredicateId, FactPlace, bool), bool)>,
    /// Whether something was left out that may be part of a plan.
    left_out: bool,
    /// If there is chance in the order of choices, it comes from here.
    chance: Option<u64>,
    /// How often everything was tried and led nowhere, and it had to go back.
    dead_ends: u64,
    /// After so many dead ends it gives up.
    patience: u64,
    /// For each task of the problem in order, the facts that must hold (or not) once it is done,
    /// as no later task can help them.
    settled: Vec<Vec<Settled>>,
    /// How often a task may be begun within itself in one and the same state.
    nesting: u32,
    expanded: u64,
    scratch: Scratch,
}

#[derive(Debug, Default)]
struct Scratch {
    bindings: Vec<ObjectId>,
    cursors: Vec<u32>,
    changes: Vec<(PredicateId, FactPlace)>,
    tuple: Vec<ObjectId>,
}

/// A fact that must hold, or must not.
#[derive(Debug)]
struct Settled {
    holds: bool,
    predicate: PredicateId,
    args: Vec<ObjectId>,
}

/// How one step of the search ended.
enum Advance {
    On,
    Dead,
    Solved,
}

impl DepthFirst {
    /// A search that has not begun.
    pub fn new(compiled: &Arc<Compiled>) -> Self {
        let mut facts = Facts::new(compiled);
        let program = Program::new(compiled, &mut facts);
        facts.fill(compiled);
        let mut search = Self {
            scratch: Scratch {
                bindings: vec![ObjectId(0); program.width],
                cursors: vec![0; program.cursors],
                ..Scratch::default()
            },
            compiled: Arc::clone(compiled),
            program,
            facts,
            nodes: Vec::new(),
            args: Vec::new(),
            current: END,
            forks: Vec::new(),
            cursors: Vec::new(),
            chosen: Vec::new(),
            bindings: Vec::new(),
            met: Numbers::default(),
            open: FxHashMap::default(),
            begun: Numbers::default(),
            done: Numbers::default(),
            opened: Vec::new(),
            needed: FxHashMap::default(),
            needs: Vec::new(),
            left_out: false,
            chance: None,
            dead_ends: 0,
            patience: u64::MAX,
            settled: settled(compiled),
            nesting: 0,
            expanded: 0,
        };
        search.begin();
        search
    }

    /// The whole problem is to be done, and nothing has been tried.
    fn begin(&mut self) {
        self.facts.undo_to(0);
        self.nodes.clear();
        self.args.clear();
        self.forks.clear();
        self.cursors.clear();
        self.chosen.clear();
        self.bindings.clear();
        self.open.clear();
        self.opened.clear();
        self.needed.clear();
        self.needs.clear();
        self.met = Numbers::default();
        self.begun = Numbers::default();
        self.done = Numbers::default();
        self.left_out = false;
        let top = NodeKind::Task(self.compiled.top);
        self.current = self.push_node(top, 0, END);
    }

    /// Goes on until there is an answer, or [`Control::is_over`]; then it can be called again.
    pub fn run(&mut self, control: &Control<'_>) -> Outcome {
        loop {
            if self.expanded.is_multiple_of(CONTROL_EVERY) {
                control.expanded.fetch_add(CONTROL_EVERY, Ordering::Relaxed);
                if control.is_over() {
                    self.expanded += 1;
                    return Outcome::Stopped(Halt::Told);
                }
                if self.bytes() as u64 > control.memory_limit_bytes {
                    return Outcome::Stopped(Halt::Memory);
                }
            }
            self.expanded += 1;
            match self.advance() {
                Advance::On => {}
                Advance::Solved => return Outcome::Found(self.choices()),
                Advance::Dead => {
                    self.dead_ends += 1;
                    if self.dead_ends > self.patience {
                        return Outcome::Stopped(Halt::Incomplete);
                    }
                    if self.back() {
                        continue;
                    }
                    if !self.left_out {
                        return Outcome::Unsolvable;
                    }
                    // Once more, with more of what was left out.
                    self.nesting += 1;
                    self.begin();
                }
            }
        }
    }

    /// Gives up after so many dead ends.
    #[cfg(test)]
    pub fn be_patient(&mut self, dead_ends: u64) {
        self.patience = dead_ends;
    }

    /// Begins anew, with chance in the order of choices, and for so many dead ends; then
    /// [`DepthFirst::run`] ends with [`Halt::Incomplete`].
    pub fn restart(&mut self, seed: u64, patience: u64) {
        self.nesting = 0;
        self.dead_ends = 0;
        self.patience = patience;
        self.chance = Some(spread(seed));
        self.begin();
    }

    /// Whether what the tasks that are done should have brought about is so, as far as nothing that
    /// is left can help it. Looked at where one task of the problem ends and the next begins.
    fn is_settled(&self) -> bool {
        // The subtasks of the top were made first, the last of them first.
        let place = self.settled.len().checked_sub(self.current as usize);
        let Some(settled) = place.and_then(|place| self.settled.get(place)) else {
            return true;
        };
        settled.iter().all(|settled| {
            let args = settled.args.iter().copied();
            self.facts.holds(settled.predicate, args) == settled.holds
        })
    }

    fn choices(&self) -> Choices {
        let mut choices = Choices::default();
        let mut rest = &self.bindings[..];
        for method in &self.chosen {
            let (bindings, after) = rest.split_at(self.compiled.method(*method).kinds.len());
            choices.push(*method, bindings);
            rest = after;
        }
        choices
    }

    /// Executes the first action or decomposes the first task of the list.
    fn advance(&mut self) -> Advance {
        let Some(node) = self.nodes.get(self.current as usize).copied() else {
            return Advance::Solved;
        };
        if !self.is_settled() {
            return Advance::Dead;
        }
        match node.kind {
            NodeKind::Action(action) => {
                self.count_needs(self.current, false);
                if !self.execute(action, node) {
                    return Advance::Dead;
                }
                self.current = node.next;
            }
            NodeKind::Close(number) => {
                self.close(number);
                self.done.insert(number);
                self.opened.push((number, false));
                self.current = node.next;
            }
            NodeKind::Task(task) => {
                if self.program.growing[task.index()] && !self.may_open(self.current) {
                    self.left_out = true;
                    return Advance::Dead;
                }
                if !self.decompose(task, node, None) {
                    return Advance::Dead;
                }
            }
        }
        Advance::On
    }

    /// Takes the last fork's next way; `false` if there is none left anywhere.
    fn back(&mut self) -> bool {
        while let Some(fork) = self.forks.pop() {
            self.facts.undo_to(fork.facts);
            self.nodes.truncate(fork.nodes as usize);
            self.args.truncate(fork.args as usize);
            self.chosen.truncate(fork.chosen as usize);
            self.bindings.truncate(fork.bindings as usize);
            while self.opened.len() > fork.opened as usize {
                match self.opened.pop() {
                    Some((number, true)) => self.close(number),
                    Some((number, false)) => *self.open.entry(number).or_insert(0) += 1,
                    None => {}
                }
            }
            while self.needs.len() > fork.needs as usize {
                if let Some((need, up)) = self.needs.pop() {
                    self.count_need(need, !up);
                }
            }
            let saved = fork.cursors as usize..self.cursors.len();
            let count = saved.len();
            self.scratch.cursors[..count].copy_from_slice(&self.cursors[saved]);
            self.cursors.truncate(fork.cursors as usize);
            self.current = fork.node;
            let node = self.nodes[fork.node as usize];
            if let NodeKind::Task(task) = node.kind
                && self.decompose(task, node, Some(fork.method))
            {
                return true;
            }
        }
        false
    }

    /// Decomposes the current node by the first way, or by the next after that of a fork, whose
    /// cursors are in the scratch.
    fn decompose(&mut self, task: TaskId, node: Node, after: Option<u32>) -> bool {
        let compiled = Arc::clone(&self.compiled);
        let methods = &compiled.task(task).methods;
        let mut resume = after.is_some();
        for place in after.unwrap_or(0) as usize..methods.len() {
            let method = methods[place];
            let program = &self.program.methods[method.index()];
            let args = &self.args[node.args as usize..];
            if !bind_head(&program.head, &compiled, args, &mut self.scratch.bindings) {
                continue;
            }
            let at_hand = AtHand {
                facts: &self.facts,
                compiled: &compiled,
                chance: self.chance,
            };
            let scratch = &mut self.scratch;
            let (bindings, cursors) = (&mut scratch.bindings, &mut scratch.cursors);
            let found = if std::mem::take(&mut resume) {
                program.query.rebind(at_hand, bindings, cursors);
                program.query.next(at_hand, bindings, cursors)
            } else {
                program.query.first(at_hand, bindings, cursors)
            };
            if !found {
                continue;
            }
            let more = place + 1 < methods.len()
                || program.query.may_have_more(at_hand, bindings, cursors);
            let choices = program.query.choices();
            if after.is_none()
                && (more || self.expanded.is_multiple_of(LOOK_UP_EVERY))
                && !self.met.insert(join(self.facts.hash(), node.hash))
            {
                return false;
            }
            if more {
                self.fork(place as u32, choices);
            }
            self.apply(method, task, node);
            return true;
        }
        false
    }

    fn fork(&mut self, method: u32, choices: usize) {
        self.forks.push(Fork {
            node: self.current,
            method,
            facts: self.facts.mark(),
            nodes: self.nodes.len() as u32,
            args: self.args.len() as u32,
            cursors: self.cursors.len() as u32,
            chosen: self.chosen.len() as u32,
            bindings: self.bindings.len() as u32,
            opened: self.opened.len() as u32,
            needs: self.needs.len() as u32,
        });
        self.cursors
            .extend_from_slice(&self.scratch.cursors[..choices]);
    }

    /// Puts the method's subtasks, with the bindings in the scratch, in the place of the node.
    fn apply(&mut self, method: MethodId, task: TaskId, node: Node) {
        let compiled = Arc::clone(&self.compiled);
        let method_ = compiled.method(method);
        let bindings = &self.scratch.bindings[..method_.kinds.len()];
        self.chosen.push(method);
        self.bindings.extend_from_slice(bindings);
        self.count_needs(self.current, false);
        let mut next = node.next;
        if self.program.growing[task.index()] {
            let number = self.number_of(self.current);
            *self.open.entry(number).or_insert(0) += 1;
            self.begun.insert(number);
            self.opened.push((number, true));
            let hash = self.nodes.get(next as usize).map_or(0, |next| next.hash);
            self.nodes.push(Node {
                kind: NodeKind::Close(number),
                args: 0,
                next,
                hash,
            });
            next = self.nodes.len() as u32 - 1;
        }
        for subtask in method_.subtasks.iter().rev() {
            let args = self.args.len() as u32;
            for term in &subtask.args {
                self.args.push(term.value(&self.scratch.bindings));
            }
            let kind = match subtask.step {
                Step::Action(action) => NodeKind::Action(action),
                Step::Task(task) => NodeKind::Task(task),
            };
            next = self.push_node(kind, args, next);
            self.count_needs(next, true);
        }
        self.current = next;
    }

    fn push_node(&mut self, kind: NodeKind, args: u32, next: u32) -> u32 {
        let after = self.nodes.get(next as usize).map_or(0, |next| next.hash);
        self.nodes.push(Node {
            kind,
            args,
            next,
            hash: 0,
        });
        let id = self.nodes.len() as u32 - 1;
        let own = self.own_hash(id);
        self.nodes[id as usize].hash = join(own, after);
        id
    }

    /// Of the action or task with its arguments alone.
    fn own_hash(&self, id: u32) -> u64 {
        let node = self.nodes[id as usize];
        let (seed, count) = match node.kind {
            NodeKind::Action(action) => (
                u64::from(action.0) << 1,
                self.compiled.action(action).kinds.len(),
            ),
            NodeKind::Task(task) => (
                u64::from(task.0) << 1 | 1,
                self.compiled.task(task).kinds.len(),
            ),
            NodeKind::Close(number) => (number, 0),
        };
        let first = node.args as usize;
        let args = self.args[first..first + count].iter();
        args.fold(spread(seed), |hash, arg| join(hash, u64::from(arg.0) + 1))
    }

    /// Of the task at the node, in the present state.
    fn number_of(&self, id: u32) -> u64 {
        join(self.own_hash(id), self.facts.hash())
    }

    /// Whether the task may be begun in the present state: within itself only so often, or the
    /// list would grow for ever; and at first not again if it was never brought to an end. (That
    /// may have been because it was tried within what it is now tried beside.)
    fn may_open(&self, id: u32) -> bool {
        let number = self.number_of(id);
        match self.open.get(&number) {
            Some(open) => *open <= self.nesting,
            None => self.nesting > 0 || !self.begun.contains(number) || self.done.contains(number),
        }
    }

    /// Counts what the action or task at the node needs, from when it is on the list until it is
    /// its turn.
    fn count_needs(&mut self, id: u32, up: bool) {
        let node = self.nodes[id as usize];
        let needs = match node.kind {
            NodeKind::Action(action) => &self.program.action_needs[action.index()],
            NodeKind::Task(task) => &self.program.task_needs[task.index()],
            NodeKind::Close(_) => return,
        };
        let first = self.needs.len();
        for need in needs {
            let tuple = &mut self.scratch.tuple;
            tuple.clear();
            let args = &self.args[node.args as usize..];
            tuple.extend(need.args.iter().map(|term| term.value(args)));
            if let Some(place) = self.facts.table_mut(need.predicate).place_of(tuple) {
                self.needs.push(((need.predicate, place, need.holds), up));
            }
        }
        for at in first..self.needs.len() {
            let (need, up) = self.needs[at];
            self.count_need(need, up);
        }
    }

    fn count_need(&mut self, need: (PredicateId, FactPlace, bool), up: bool) {
        let count = self.needed.entry(need).or_insert(0);
        *count = if up {
            *count + 1
        } else {
            count.saturating_sub(1)
        };
    }

    /// Whether something that is still to be done needs the fact to be so.
    fn is_needed(&self, predicate: PredicateId, place: FactPlace, holds: bool) -> bool {
        !self.needed.is_empty()
            && (self.needed.get(&(predicate, place, holds))).is_some_and(|count| *count > 0)
    }

    fn close(&mut self, number: u64) {
        if let Some(count) = self.open.get_mut(&number) {
            *count -= 1;
            if *count == 0 {
                self.open.remove(&number);
            }
        }
    }

    fn execute(&mut self, action: ActionId, node: Node) -> bool {
        let compiled = &self.compiled;
        let program = &self.program.actions[action.index()];
        let count = compiled.action(action).kinds.len();
        let first = node.args as usize;
        let scratch = &mut self.scratch;
        let (bindings, cursors) = (&mut scratch.bindings, &mut scratch.cursors);
        bindings[..count].copy_from_slice(&self.args[first..first + count]);
        let mut kinds = compiled.action(action).kinds.iter().zip(&*bindings);
        if !kinds.all(|(kind, object)| compiled.kind(*kind).contains(*object)) {
            return false;
        }
        let at_hand = AtHand::plain(&self.facts, compiled);
        if !program.precondition.first(at_hand, bindings, cursors) {
            return false;
        }
        // Everything is decided in the state in which the action begins.
        scratch.changes.clear();
        let mut removals = 0;
        for change in &program.effect {
            let mut more = match &change.when {
                Some(when) => when.first(AtHand::plain(&self.facts, compiled), bindings, cursors),
                None => true,
            };
            while more {
                let tuple = &mut scratch.tuple;
                tuple.clear();
                tuple.extend(change.args.iter().map(|term| term.value(bindings)));
                let table = self.facts.table_mut(change.predicate);
                if let Some(place) = table.place_of(tuple) {
                    scratch.changes.push((change.predicate, place));
                    removals += usize::from(!change.adds);
                }
                more = match &change.when {
                    Some(when) => {
                        when.next(AtHand::plain(&self.facts, compiled), bindings, cursors)
                    }
                    None => false,
                };
            }
        }
        // Removals come first in the list.
        let changes = self.scratch.changes.iter().enumerate();
        for (at, (predicate, place)) in changes {
            if self.is_needed(*predicate, *place, at < removals) {
                return false;
            }
        }
        let scratch = &self.scratch;
        for (predicate, place) in &scratch.changes[..removals] {
            self.facts.remove(*predicate, *place);
        }
        for (predicate, place) in &scratch.changes[removals..] {
            self.facts.add(*predicate, *place);
        }
        true
    }

    /// Memory taken by what grows.
    fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
            + self.forks.capacity() * size_of::<Fork>()
            + (self.args.capacity() + self.bindings.capacity()) * size_of::<ObjectId>()
            + self.cursors.capacity() * size_of::<u32>()
            + self.chosen.capacity() * size_of::<MethodId>()
            + self.open.capacity() * size_of::<(u64, u32)>()
            + self.opened.capacity() * size_of::<(u64, bool)>()
            + self.needs.capacity() * size_of::<((PredicateId, FactPlace, bool), bool)>()
            + self.met.bytes()
            + self.begun.bytes()
            + self.done.bytes()
            + self.facts.bytes()
    }
}

/// Binds the method's variables to the task's arguments; `false` if they do not fit.
fn bind_head(
    head: &[HeadStep],
    compiled: &Compiled,
    args: &[ObjectId],
    bindings: &mut [ObjectId],
) -> bool {
    head.iter().zip(args).all(|(step, arg)| match step {
        HeadStep::Bind(variable, kind) => {
            bindings[*variable] = *arg;
            compiled.kind(*kind).contains(*arg)
        }
        HeadStep::Is(term) => term.value(bindings) == *arg,
    })
}

/// For each subtask of the top, what must be so when it begins.
fn settled(compiled: &Compiled) -> Vec<Vec<Settled>> {
    let methods = &compiled.task(compiled.top).methods;
    let count = methods
        .first()
        .map_or(0, |top| compiled.method(*top).subtasks.len());
    let mut settled: Vec<Vec<Settled>> = (0..count).map(|_| Vec::new()).collect();
    for goal in &compiled.goals {
        let from = goal.last_help.map_or(0, |last| last + 1);
        for settled in settled.iter_mut().skip(from) {
            settled.push(Settled {
                holds: goal.holds,
                predicate: goal.fact.predicate,
                args: goal.fact.args.iter().map(|term| term.value(&[])).collect(),
            });
        }
    }
    settled
}
