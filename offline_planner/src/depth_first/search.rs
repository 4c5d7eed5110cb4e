//! The search itself.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::facts::Facts;
use super::hash::{Numbers, join, spread};
use super::needs::Needs;
use super::nesting::Nesting;
use super::program::Program;
use super::query::AtHand;
use super::settled::Settled;
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
    /// Tasks that are being decomposed, with the states in which that began.
    nesting: Nesting,
    /// What must not be lost.
    needs: Needs,
    /// Whether something was left out that may be part of a plan.
    left_out: bool,
    /// If there is chance in the order of choices, it comes from here.
    chance: Option<u64>,
    /// How often everything was tried and led nowhere, and it had to go back.
    dead_ends: u64,
    /// After so many dead ends it gives up.
    patience: u64,
    /// What must be so where one task of the problem ends and the next begins.
    settled: Settled,
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
            nesting: Nesting::default(),
            needs: Needs::default(),
            left_out: false,
            chance: None,
            dead_ends: 0,
            patience: u64::MAX,
            settled: Settled::new(compiled),
            expanded: 0,
        };
        search.begin(0);
        search
    }

    /// The whole problem is to be done, and nothing has been tried. Tasks may be begun within
    /// themselves so often.
    fn begin(&mut self, nesting: u32) {
        self.facts.undo_to(0);
        self.nodes.clear();
        self.args.clear();
        self.forks.clear();
        self.cursors.clear();
        self.chosen.clear();
        self.bindings.clear();
        self.nesting = Nesting::allowing(nesting);
        self.needs.clear();
        self.met = Numbers::default();
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
                    self.begin(self.nesting.most() + 1);
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
        self.dead_ends = 0;
        self.patience = patience;
        self.chance = Some(spread(seed));
        self.begin(0);
    }

    /// Whether what the tasks that are done should have brought about is so, as far as nothing that
    /// is left can help it. Looked at where one task of the problem ends and the next begins.
    fn is_settled(&self) -> bool {
        // The subtasks of the top were made first, the last of them first.
        let place = self.settled.tasks().checked_sub(self.current as usize);
        place.is_none_or(|place| self.settled.allows(place, &self.facts))
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
                self.nesting.close(number);
                self.current = node.next;
            }
            NodeKind::Task(task) => {
                if self.program.growing[task.index()]
                    && !self.nesting.may_open(self.number_of(self.current))
                {
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
            self.nesting.undo_to(fork.opened);
            self.needs.undo_to(fork.needs);
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
            if !program.bind_head(&compiled, args, &mut self.scratch.bindings) {
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
            opened: self.nesting.mark(),
            needs: self.needs.mark(),
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
            self.nesting.open(number);
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

    /// Counts what the action or task at the node needs, from when it is on the list until it is
    /// its turn.
    fn count_needs(&mut self, id: u32, up: bool) {
        let node = self.nodes[id as usize];
        let needs = match node.kind {
            NodeKind::Action(action) => &self.program.action_needs[action.index()],
            NodeKind::Task(task) => &self.program.task_needs[task.index()],
            NodeKind::Close(_) => return,
        };
        for need in needs {
            let tuple = &mut self.scratch.tuple;
            tuple.clear();
            let args = &self.args[node.args as usize..];
            tuple.extend(need.args.iter().map(|term| term.value(args)));
            if let Some(place) = self.facts.table_mut(need.predicate).place_of(tuple) {
                self.needs.change((need.predicate, place, need.holds), up);
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
            if self.needs.contains((*predicate, *place, at < removals)) {
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
            + self.nesting.bytes()
            + self.needs.bytes()
            + self.met.bytes()
            + self.facts.bytes()
    }
}
