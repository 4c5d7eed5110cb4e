//! What can be reached: facts, tasks, methods and actions, if nothing that was once true ever
//! became false.
//!
//! Tasks are reached from above: the first subtask of a link once the link is possible, each next
//! one only once those before it can be done. Facts are reached from below, by the actions among
//! the reached tasks. Both feed the same queue until nothing new comes, and every tuple is joined
//! once (semi-naive evaluation). The order of subtasks makes this tighter than looking at actions
//! alone and then at the hierarchy.

use std::collections::VecDeque;

use super::formula::{Arg, Lit};
use super::join::{Ground, Truth, bindings, each, simplify};
use super::lifted::{Lifted, What};
use super::space::UNKNOWN;
use super::tables::Relation;
use super::{Limits, Stopped};
use crate::compile::{KindId, PredicateId};

/// No node or instance.
pub(super) const NONE: u32 = u32::MAX;

/// A task that can come up.
pub(super) struct Node {
    pub done: bool,
    first_waiting: u32,
}

/// An instance of a rule.
pub(super) struct Made {
    pub rule: u32,
    /// The node that it does.
    pub head: u32,
    /// Where its values begin in [`Reached::values`].
    pub values: usize,
    /// How many of its subtasks can be done, in order.
    pub progress: u32,
    next_waiting: u32,
}

/// The fixpoint.
pub(super) struct Reached {
    pub tables: Vec<Relation>,
    pub nodes: Vec<Node>,
    /// By task relation (from the first on) and row.
    pub node_of: Vec<Vec<u32>>,
    pub made: Vec<Made>,
    pub values: Vec<u32>,
    /// How many rows each predicate has at first; those are the facts that hold then.
    pub initial: Vec<usize>,
}

/// Runs to the fixpoint.
pub(super) fn reach(lifted: &Lifted<'_>, limits: &Limits<'_>) -> Result<Reached, Stopped> {
    let mut run = Run::new(lifted);
    run.task(lifted.space.task(lifted.compiled.top), &[]);
    run.run(limits)?;
    Ok(run.reached)
}

struct Run<'l> {
    lifted: &'l Lifted<'l>,
    first_task: usize,
    reached: Reached,
    listeners: Vec<Vec<(u32, u32)>>,
    queue: VecDeque<u32>,
    done: Vec<u32>,
}

impl<'l> Run<'l> {
    fn new(lifted: &'l Lifted<'l>) -> Self {
        let compiled = lifted.compiled;
        let first_task = lifted.space.first_task();
        let mut arity = vec![0; lifted.relations];
        for (place, predicate) in compiled.predicates.iter().enumerate() {
            arity[place] = predicate.kinds.len();
        }
        for kind in 0..compiled.kinds.len() {
            arity[lifted.space.kind(KindId::new(kind)) as usize] = 1;
        }
        let mut learn = |lit: &Lit| {
            if let Some(arity) = arity.get_mut(lit.relation as usize) {
                *arity = lit.args.len();
            }
        };
        for rule in &lifted.rules {
            learn(&rule.head);
            rule.body.iter().chain(&rule.negative).for_each(&mut learn);
            if let What::Link { subs, .. } = &rule.what {
                subs.iter().for_each(&mut learn);
            }
        }
        let mut tables: Vec<Relation> = arity.into_iter().map(Relation::new).collect();
        let mut queue = VecDeque::new();
        for (place, table) in tables
            .iter_mut()
            .enumerate()
            .take(compiled.predicates.len())
        {
            for tuple in compiled.init_of(PredicateId::new(place)) {
                let key: Vec<u32> = tuple.iter().map(|object| object.0).collect();
                if table.insert(&key).1 {
                    if lifted.fluent[place] {
                        queue.push_back(place as u32);
                    } else {
                        table.join_next();
                    }
                }
            }
        }
        for kind in (0..compiled.kinds.len()).map(KindId::new) {
            let table = &mut tables[lifted.space.kind(kind) as usize];
            for object in &compiled.kind(kind).members {
                table.insert(&[object.0]);
                table.join_next();
            }
        }
        let mut listeners = vec![Vec::new(); tables.len()];
        for (index, rule) in lifted.rules.iter().enumerate() {
            let possible = rule
                .body
                .iter()
                .all(|lit| (lit.relation as usize) < tables.len());
            if !possible || rule.head.relation as usize >= tables.len() {
                continue;
            }
            listeners[rule.head.relation as usize].push((index as u32, 0));
            for (atom, lit) in rule.body.iter().enumerate() {
                let relation = lit.relation as usize;
                if lifted.fluent.get(relation).copied().unwrap_or(false) {
                    listeners[relation].push((index as u32, atom as u32 + 1));
                }
            }
        }
        let initial = tables[..lifted.space.predicates()]
            .iter()
            .map(Relation::len)
            .collect();
        Self {
            lifted,
            first_task,
            reached: Reached {
                node_of: vec![Vec::new(); lifted.relations - first_task],
                tables,
                nodes: Vec::new(),
                made: Vec::new(),
                values: Vec::new(),
                initial,
            },
            listeners,
            queue,
            done: Vec::new(),
        }
    }

    /// The node of a task, made if need be.
    fn task(&mut self, relation: u32, args: &[u32]) -> u32 {
        let Some(table) = self.reached.tables.get_mut(relation as usize) else {
            return NONE;
        };
        let (row, new) = table.insert(args);
        let of_relation = &mut self.reached.node_of[relation as usize - self.first_task];
        if new {
            of_relation.push(self.reached.nodes.len() as u32);
            self.reached.nodes.push(Node {
                done: false,
                first_waiting: NONE,
            });
            self.queue.push_back(relation);
        }
        of_relation[row]
    }

    fn run(&mut self, limits: &Limits<'_>) -> Result<(), Stopped> {
        let mut found = Vec::new();
        let mut steps = 0_u64;
        while let Some(relation) = self.queue.pop_front() {
            self.reached.tables[relation as usize].join_next();
            for place in 0..self.listeners[relation as usize].len() {
                let (rule, atom) = self.listeners[relation as usize][place];
                found.clear();
                let count = bindings(
                    &self.lifted.rules[rule as usize],
                    atom as usize,
                    &mut self.reached.tables,
                    &mut found,
                );
                let vars = self.lifted.rules[rule as usize].vars;
                for place in 0..count {
                    let values = &found[place * vars..(place + 1) * vars];
                    if self.possible(rule, values) {
                        self.make(rule, values);
                    }
                }
                steps += 1 + count as u64;
                if steps > 4096 {
                    steps = 0;
                    self.check(limits)?;
                }
            }
        }
        Ok(())
    }

    fn check(&self, limits: &Limits<'_>) -> Result<(), Stopped> {
        if (limits.stop)() {
            return Err(Stopped::Cancelled);
        }
        let reached = &self.reached;
        let bytes = reached.made.len() * size_of::<Made>()
            + reached.values.len() * 4
            + reached.nodes.len() * (size_of::<Node>() + 4)
            + reached.tables.iter().map(Relation::bytes).sum::<usize>();
        // The model that is made of all this takes about as much again, and so does the search.
        if bytes > limits.memory_bytes / 4 {
            return Err(Stopped::TooLarge);
        }
        Ok(())
    }

    /// What joins do not see: facts that must not hold and conditions to be evaluated, as far as
    /// they do not depend on the state.
    fn possible(&self, rule: u32, values: &[u32]) -> bool {
        let rule = &self.lifted.rules[rule as usize];
        let negative = rule.negative.iter().all(|lit| {
            let key: Vec<u32> = lit.args.iter().map(|arg| bound(*arg, values)).collect();
            self.known(lit.relation, &key) != Truth::True
        });
        negative
            && rule.checks.iter().all(|check| {
                let mut env = values.to_vec();
                let mut known = |relation: u32, key: &[u32]| (self.known(relation, key), 0);
                simplify(check, self.lifted, &mut env, &mut known) != Ground::Known(false)
            })
    }

    fn known(&self, relation: u32, key: &[u32]) -> Truth {
        let Some(table) = self.reached.tables.get(relation as usize) else {
            return Truth::False;
        };
        match self.lifted.fluent.get(relation as usize) {
            Some(true) => Truth::Open,
            _ if table.find(key).is_some() => Truth::True,
            _ => Truth::False,
        }
    }

    fn make(&mut self, rule: u32, values: &[u32]) {
        let lifted = self.lifted;
        let declared = &lifted.rules[rule as usize];
        let head: Vec<u32> = declared
            .head
            .args
            .iter()
            .map(|arg| bound(*arg, values))
            .collect();
        let head = self.task(declared.head.relation, &head);
        let made = self.reached.made.len() as u32;
        self.reached.made.push(Made {
            rule,
            head,
            values: self.reached.values.len(),
            progress: 0,
            next_waiting: NONE,
        });
        self.reached.values.extend_from_slice(values);
        match &declared.what {
            What::Action { effects, .. } => {
                for effect in effects.iter().filter(|effect| effect.add) {
                    let mut env = values.to_vec();
                    let mut facts = Vec::new();
                    each(&effect.over, lifted, &mut env, &mut |env| {
                        if self.may_happen(&effect.when.positive, env) {
                            let key: Vec<u32> = effect
                                .fact
                                .args
                                .iter()
                                .map(|arg| bound(*arg, env))
                                .collect();
                            facts.push(key);
                        }
                    });
                    for key in facts {
                        self.fact(effect.fact.relation, &key);
                    }
                }
                self.finish(head);
            }
            What::Link { .. } => self.advance(made),
        }
        while let Some(node) = self.done.pop() {
            let mut waiting = self.reached.nodes[node as usize].first_waiting;
            self.reached.nodes[node as usize].first_waiting = NONE;
            while waiting != NONE {
                let next = self.reached.made[waiting as usize].next_waiting;
                self.reached.made[waiting as usize].progress += 1;
                self.advance(waiting);
                waiting = next;
            }
        }
    }

    fn may_happen(&self, positive: &[Lit], env: &[u32]) -> bool {
        positive.iter().all(|lit| {
            let key: Vec<u32> = lit.args.iter().map(|arg| bound(*arg, env)).collect();
            self.known(lit.relation, &key) != Truth::False
        })
    }

    fn fact(&mut self, relation: u32, key: &[u32]) {
        if let Some(table) = self.reached.tables.get_mut(relation as usize)
            && table.insert(key).1
        {
            self.queue.push_back(relation);
        }
    }

    fn finish(&mut self, node: u32) {
        if let Some(node_ref) = self.reached.nodes.get_mut(node as usize)
            && !node_ref.done
        {
            node_ref.done = true;
            self.done.push(node);
        }
    }

    /// Goes on to the next subtask that cannot be done yet, and waits there.
    fn advance(&mut self, made: u32) {
        let lifted = self.lifted;
        loop {
            let one = &self.reached.made[made as usize];
            let What::Link { subs, .. } = &lifted.rules[one.rule as usize].what else {
                return;
            };
            let Some(sub) = subs.get(one.progress as usize) else {
                let head = one.head;
                self.finish(head);
                return;
            };
            let values = one.values;
            let key: Vec<u32> = sub
                .args
                .iter()
                .map(|arg| bound(*arg, &self.reached.values[values..]))
                .collect();
            let node = self.task(sub.relation, &key);
            let Some(state) = self.reached.nodes.get_mut(node as usize) else {
                return;
            };
            if state.done {
                self.reached.made[made as usize].progress += 1;
            } else {
                let next = std::mem::replace(&mut state.first_waiting, made);
                self.reached.made[made as usize].next_waiting = next;
                return;
            }
        }
    }
}

/// The value of an argument.
pub(super) fn bound(arg: Arg, values: &[u32]) -> u32 {
    match arg {
        Arg::Var(var) => values.get(usize::from(var)).copied().unwrap_or(UNKNOWN),
        Arg::Object(object) => object,
    }
}
