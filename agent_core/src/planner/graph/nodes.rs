//! The graph: what is left to do in which state, what it costs from there, and what that hangs on.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use super::behind::Behind;
use super::decompose::{self, Way};
use super::intern::{Map, Slices, Words};
use super::key::{Key, Touched};
use super::lists::NIL;
use super::world::World;

/// No way.
pub(super) const INFINITE: u64 = u64::MAX;

/// If so many expanded nodes are to be looked at again …
pub(super) const LEAST_TO_BEGIN_ANEW: usize = 24;
/// … and they are more than one in so many of those that there are, it is begun anew.
const BEGIN_ANEW_PART: usize = 2;
/// So many forgotten nodes, and places where nodes were noted, are given back at a time.
const SWEPT: usize = 16;

/// One way on from a node: a decomposition of its first task, or its first action.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Edge {
    pub to: u32,
    /// Of the action; zero for a decomposition.
    pub cost: u64,
    /// Where `to` notes that it is led to.
    back: u32,
}

impl Edge {
    /// What it counts in the search. Never nothing, so that no cycle supports itself and every
    /// search in a finite space ends: of equal plans, the one with the fewest decompositions.
    pub fn weight(&self) -> u64 {
        self.cost.max(1)
    }
}

/// A node that leads here, and by which of its edges.
#[derive(Clone, Copy, Debug)]
struct Back {
    from: u32,
    edge: u32,
}

/// A key that was asked for, and where this is noted with the key.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dependency {
    pub key: u32,
    pub at: u32,
}

/// A node that has asked for a key, and which of its dependencies this is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Subscription {
    pub node: u32,
    pub dependency: u32,
}

/// A list of tasks in a state: the belief overlaid with a delta. It means the same however it was
/// reached, so ways that come to the same work in the same state share everything that follows.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub list: u32,
    pub delta: u32,
    /// The cost to the end, as it is known to the nodes that lead here …
    pub v: u64,
    /// … and as it follows from the nodes that this one leads to, or from an estimate. Both are
    /// the same unless the node is in the queue.
    pub rhs: u64,
    /// The key under which it is in the queue; [`INFINITE`] if it is not.
    pub queued: u64,
    pub out: Vec<Edge>,
    back: Vec<Back>,
    pub dependencies: Vec<Dependency>,
    pub expanded: bool,
    /// Something it has asked for has changed since.
    pub dirty: bool,
    /// How many collections have not found it; [`u8::MAX`]: it is a free place.
    pub age: u8,
}

impl Node {
    pub fn is_free(&self) -> bool {
        self.age == u8::MAX
    }
}

/// What was done, in numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Work {
    pub expanded: u64,
    pub reevaluated: u64,
    pub repaired: u64,
    /// Nodes that were met for the first time.
    pub met: u64,
}

impl Work {
    /// How often the cost of a node was estimated or worked out anew.
    pub fn evaluated(&self) -> u64 {
        self.met + self.reevaluated + self.repaired
    }
}

#[derive(Clone, Debug)]
pub(super) struct Graph {
    pub world: World,
    pub nodes: Vec<Node>,
    pub free: Vec<u32>,
    pub table: Map<(u32, u32), u32>,
    pub keys: Map<Key, u32>,
    pub subscriptions: Vec<Vec<Subscription>>,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
    dirty: VecDeque<u32>,
    /// By node: observable facts that it asked for and that did not hold.
    pub wanted: Map<u32, Vec<u32>>,
    /// Sets of variables that occur as those of deltas.
    pub shapes: Slices,
    /// By list: the shapes of the deltas that it occurs with.
    pub shapes_of: Map<u32, Vec<u32>>,
    pub work: Work,
    /// Counts what makes a search that is under way worthless.
    pub upset: u64,
    pub live_after_collection: usize,
    /// How many nodes are expanded, and how many of those are dirty.
    expanded: usize,
    dirty_expanded: usize,
    /// With fewer to be looked at again, it is never begun anew.
    least_to_begin_anew: usize,
    /// What was forgotten at once, and is given back bit by bit.
    old_nodes: Vec<Node>,
    old_subscriptions: Vec<Vec<Subscription>>,
    /// What it was not told yet.
    pub behind: Behind,
}

impl Graph {
    pub fn new(world: World, least_to_begin_anew: usize) -> Self {
        Self {
            world,
            nodes: Vec::new(),
            free: Vec::new(),
            table: Map::default(),
            keys: Map::default(),
            subscriptions: Vec::new(),
            queue: BinaryHeap::new(),
            dirty: VecDeque::new(),
            wanted: Map::default(),
            shapes: Slices::default(),
            shapes_of: Map::default(),
            work: Work::default(),
            upset: 0,
            live_after_collection: 0,
            expanded: 0,
            dirty_expanded: 0,
            least_to_begin_anew,
            old_nodes: Vec::new(),
            old_subscriptions: Vec::new(),
            behind: Behind::default(),
        }
    }

    /// Forgets all nodes. What they took is given back later, by [`sweep`](Self::sweep).
    pub fn clear(&mut self) {
        append(&mut self.old_nodes, &mut self.nodes);
        append(&mut self.old_subscriptions, &mut self.subscriptions);
        self.free = Vec::new();
        self.table = Map::default();
        self.keys = Map::default();
        self.queue = BinaryHeap::new();
        self.dirty = VecDeque::new();
        self.wanted = Map::default();
        self.shapes = Slices::default();
        self.shapes_of = Map::default();
        self.expanded = 0;
        self.dirty_expanded = 0;
        self.upset += 1;
    }

    /// Gives back some of what was forgotten: more than one step of planning can add.
    pub fn sweep(&mut self) {
        truncate_by(&mut self.old_nodes, SWEPT);
        truncate_by(&mut self.old_subscriptions, SWEPT);
    }

    /// How many nodes there are.
    pub fn live(&self) -> usize {
        self.nodes.len() - self.free.len()
    }

    /// Notes which nodes have asked for something that has changed.
    pub fn touched(&mut self, touched: &Touched) {
        if touched.all {
            self.clear();
            return;
        }
        if !touched.keys.is_empty() {
            self.upset += 1;
        }
        for (key, variable) in &touched.keys {
            let Some(number) = self.keys.get(key) else {
                continue;
            };
            for subscription in &self.subscriptions[*number as usize] {
                let node = &mut self.nodes[subscription.node as usize];
                if !node.dirty && !self.world.shadows(node.delta, *variable) {
                    node.dirty = true;
                    self.dirty_expanded += usize::from(node.expanded);
                    self.dirty.push_back(subscription.node);
                }
            }
        }
    }

    /// If much of what was found out has to be looked at again, it is cheaper to begin anew: then
    /// only that is looked at which the search comes to.
    pub fn begin_anew_if_much_is_dirty(&mut self) {
        if self.dirty_expanded >= self.least_to_begin_anew
            && BEGIN_ANEW_PART * self.dirty_expanded > self.expanded
        {
            self.clear();
            self.world.forget_lists();
        }
    }

    /// Looks again at one of the nodes for which something has changed. Returns whether there was
    /// one.
    pub fn reevaluate_one(&mut self) -> bool {
        while let Some(node) = self.dirty.pop_front() {
            let known = &mut self.nodes[node as usize];
            if known.is_free() || !std::mem::take(&mut known.dirty) {
                continue;
            }
            self.work.reevaluated += 1;
            match known.expanded {
                true => {
                    self.dirty_expanded -= 1;
                    self.evaluate(node);
                }
                false => self.evaluate_leaf(node),
            }
            self.touch(node);
            return true;
        }
        false
    }

    /// The node of a list in a state.
    pub fn node(&mut self, list: u32, delta: u32) -> u32 {
        if let Some(node) = self.table.get(&(list, delta)) {
            return *node;
        }
        let fresh = Node {
            list,
            delta,
            v: 0,
            rhs: 0,
            queued: INFINITE,
            out: Vec::new(),
            back: Vec::new(),
            dependencies: Vec::new(),
            expanded: false,
            dirty: false,
            age: 0,
        };
        let node = match self.free.pop() {
            Some(place) => {
                self.nodes[place as usize] = fresh;
                place
            }
            None => {
                self.nodes.push(fresh);
                self.nodes.len() as u32 - 1
            }
        };
        self.table.insert((list, delta), node);
        self.note_shape(list, delta);
        self.work.met += 1;
        self.evaluate_leaf(node);
        let node_now = &mut self.nodes[node as usize];
        node_now.v = node_now.rhs;
        node
    }

    pub fn note_shape(&mut self, list: u32, delta: u32) {
        let pairs = self.world.deltas.get(delta).chunks_exact(2);
        let variables: Words = pairs.map(|pair| pair[0]).collect();
        let shape = self.shapes.intern(&variables);
        let shapes = self.shapes_of.entry(list).or_default();
        if !shapes.contains(&shape) {
            shapes.push(shape);
        }
    }

    /// The estimate of a node that was not expanded.
    fn evaluate_leaf(&mut self, node: u32) {
        let Node { list, delta, .. } = self.nodes[node as usize];
        let (estimate, reads) = decompose::estimate(&mut self.world, list, delta);
        self.depend(node, reads);
        self.nodes[node as usize].rhs = estimate;
    }

    /// All ways on from a node, as they are now.
    pub fn expand(&mut self, node: u32) {
        let known = &mut self.nodes[node as usize];
        known.expanded = true;
        self.expanded += 1;
        self.dirty_expanded += usize::from(known.dirty);
        self.work.expanded += 1;
        self.evaluate(node);
        self.touch(node);
    }

    fn evaluate(&mut self, node: u32) {
        let Node { list, delta, .. } = self.nodes[node as usize];
        let found = decompose::ways(&mut self.world, list, delta);
        self.depend(node, found.reads);
        if found.wanted.is_empty() {
            self.wanted.remove(&node);
        } else {
            self.wanted.insert(node, found.wanted);
        }
        let mut edges: Vec<Edge> = Vec::with_capacity(found.ways.len());
        for Way { list, delta, cost } in found.ways {
            let to = self.node(list, delta);
            match edges.iter_mut().find(|edge| edge.to == to) {
                Some(known) => known.cost = known.cost.min(cost),
                None => edges.push(Edge { to, cost, back: 0 }),
            }
        }
        self.connect(node, edges);
    }

    /// A node is given up.
    pub fn count_out(&mut self, node: u32) {
        let known = &self.nodes[node as usize];
        self.expanded -= usize::from(known.expanded);
        self.dirty_expanded -= usize::from(known.expanded && known.dirty);
    }

    /// These are the edges of a node from now on.
    pub fn connect(&mut self, node: u32, edges: Vec<Edge>) {
        let old = &self.nodes[node as usize].out;
        let same = |(a, b): (&Edge, &Edge)| a.to == b.to && a.cost == b.cost;
        if old.len() == edges.len() && old.iter().zip(&edges).all(same) {
            return;
        }
        for edge in 0..old.len() {
            let Edge { to, back, .. } = self.nodes[node as usize].out[edge];
            let backs = &mut self.nodes[to as usize].back;
            backs.swap_remove(back as usize);
            if let Some(moved) = backs.get(back as usize).copied() {
                self.nodes[moved.from as usize].out[moved.edge as usize].back = back;
            }
        }
        self.nodes[node as usize].out = edges;
        for edge in 0..self.nodes[node as usize].out.len() {
            let to = self.nodes[node as usize].out[edge].to;
            let backs = &mut self.nodes[to as usize].back;
            let back = backs.len() as u32;
            backs.push(Back {
                from: node,
                edge: edge as u32,
            });
            self.nodes[node as usize].out[edge].back = back;
        }
    }

    /// These are the keys that a node has asked for.
    pub fn depend(&mut self, node: u32, mut reads: Vec<Key>) {
        reads.sort_unstable();
        reads.dedup();
        for dependency in 0..self.nodes[node as usize].dependencies.len() {
            let Dependency { key, at } = self.nodes[node as usize].dependencies[dependency];
            let subscriptions = &mut self.subscriptions[key as usize];
            subscriptions.swap_remove(at as usize);
            if let Some(moved) = subscriptions.get(at as usize) {
                let moved_node = &mut self.nodes[moved.node as usize];
                moved_node.dependencies[moved.dependency as usize].at = at;
            }
        }
        let mut dependencies = Vec::with_capacity(reads.len());
        for (dependency, key) in reads.into_iter().enumerate() {
            let fresh = self.subscriptions.len() as u32;
            let key = *self.keys.entry(key).or_insert(fresh);
            if key == fresh {
                self.subscriptions.push(Vec::new());
            }
            let subscriptions = &mut self.subscriptions[key as usize];
            dependencies.push(Dependency {
                key,
                at: subscriptions.len() as u32,
            });
            subscriptions.push(Subscription {
                node,
                dependency: dependency as u32,
            });
        }
        self.nodes[node as usize].dependencies = dependencies;
    }

    /// Computes a node's cost to the end from those it leads to, and queues it if that is news.
    pub fn touch(&mut self, node: u32) {
        let known = &self.nodes[node as usize];
        if known.expanded && known.list != NIL {
            let through =
                |edge: &Edge| edge.weight().saturating_add(self.nodes[edge.to as usize].v);
            let least = known.out.iter().map(through).min();
            self.nodes[node as usize].rhs = least.unwrap_or(INFINITE);
        }
        let known = &mut self.nodes[node as usize];
        if known.v == known.rhs {
            known.queued = INFINITE;
            return;
        }
        let key = known.v.min(known.rhs);
        if known.queued != key {
            known.queued = key;
            self.queue.push(Reverse((key, node)));
        }
    }

    /// Carries one change of a cost on to the nodes that lead there (G. Ramalingam and T. Reps,
    /// *An Incremental Algorithm for a Generalization of the Shortest-Path Problem*, 1996).
    /// Returns whether there was one.
    pub fn repair_one(&mut self) -> bool {
        while let Some(Reverse((key, node))) = self.queue.pop() {
            let known = &mut self.nodes[node as usize];
            if known.queued != key || known.is_free() {
                continue;
            }
            self.work.repaired += 1;
            known.queued = INFINITE;
            if known.v > known.rhs {
                known.v = known.rhs;
            } else {
                known.v = INFINITE;
                self.touch(node);
            }
            for back in 0..self.nodes[node as usize].back.len() {
                let from = self.nodes[node as usize].back[back].from;
                self.touch(from);
            }
            return true;
        }
        false
    }

    /// All nodes for a list in the belief as it is now: those whose deltas say nothing but what is
    /// so. They all mean the same.
    pub fn realised(&self, list: u32) -> Vec<u32> {
        let shapes = self.shapes_of.get(&list);
        let realised = shapes.into_iter().flatten().filter_map(|shape| {
            let delta = self.world.realised(self.shapes.get(*shape))?;
            self.table.get(&(list, delta)).copied()
        });
        realised.collect()
    }

    /// The node for a list in the belief as it is now from which most is known.
    pub fn root(&mut self, list: u32) -> u32 {
        let best = self.realised(list).into_iter().max_by_key(|node| {
            let known = &self.nodes[*node as usize];
            (!known.dirty, known.expanded, known.v, Reverse(*node))
        });
        best.unwrap_or_else(|| self.node(list, 0))
    }

    /// The edge by which the cheapest way goes on, if there is one.
    pub fn best_edge(&self, node: u32) -> Option<&Edge> {
        let out = &self.nodes[node as usize].out;
        let through = |edge: &&Edge| edge.weight().saturating_add(self.nodes[edge.to as usize].v);
        out.iter().min_by_key(through)
    }
}

/// Moves what is in `new` behind `old`, which costs nothing if `old` is empty.
fn append<T>(old: &mut Vec<T>, new: &mut Vec<T>) {
    match old.is_empty() {
        true => *old = std::mem::take(new),
        false => old.append(new),
    }
}

fn truncate_by<T>(list: &mut Vec<T>, count: usize) {
    list.truncate(list.len().saturating_sub(count));
    if list.is_empty() {
        *list = Vec::new();
    }
}
