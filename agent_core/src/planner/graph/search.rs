//! Where the costs that are known end in estimates: best first from the roots, as the baseline
//! does it, but over nodes that keep what is found out.
//!
//! While a search runs no costs are carried backwards: one expansion would change those of many
//! nodes, and the next one most of them again. They are all carried on once, when it has ended.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::intern::{Map, NONE};
use super::lists::NIL;
use super::nodes::{Graph, INFINITE};

/// How a node was reached.
#[derive(Clone, Copy, Debug)]
struct Reached {
    spent: u64,
    from: u32,
    actions: usize,
}

/// What a step came to.
#[derive(Debug)]
pub(super) enum Step {
    /// A node was visited, or expanded (`true`).
    Visited(bool),
    /// The nodes of the cheapest plan, and what it costs.
    Found(Vec<u32>, u64),
    /// There is no plan.
    Exhausted,
}

/// A search for the cheapest plan from some roots.
#[derive(Clone, Debug)]
pub(super) struct Search {
    /// By what is spent and estimated; among equals the one that has come furthest.
    frontier: BinaryHeap<Reverse<(u64, Reverse<u64>, u32)>>,
    reached: Map<u32, Reached>,
    pub expansions: u64,
    pub has_dived: bool,
    /// What is not cheaper is not of interest: so much costs a plan that is known.
    pub bound: u64,
}

impl Search {
    pub fn new(graph: &Graph, roots: &[u32]) -> Self {
        let mut search = Self {
            frontier: BinaryHeap::new(),
            reached: Map::default(),
            expansions: 0,
            has_dived: false,
            bound: INFINITE,
        };
        for root in roots {
            let reached = Reached {
                spent: 0,
                from: NONE,
                actions: 0,
            };
            search.reach(graph, *root, reached);
        }
        search
    }

    fn reach(&mut self, graph: &Graph, node: u32, how: Reached) {
        let known = &graph.nodes[node as usize];
        let total = how.spent.saturating_add(known.v);
        if total >= self.bound {
            return;
        }
        let before = self.reached.get(&node);
        if before.is_none_or(|before| how.spent < before.spent) {
            self.reached.insert(node, how);
            self.frontier
                .push(Reverse((total, Reverse(how.spent), node)));
        }
    }

    /// Visits one node. A plan ends with its last action, or with as many as are `wanted`.
    pub fn step(&mut self, graph: &mut Graph, wanted: Option<usize>) -> Step {
        let Some(Reverse((total, Reverse(spent), node))) = self.frontier.pop() else {
            return Step::Exhausted;
        };
        if total >= self.bound {
            return Step::Exhausted;
        }
        let here = self.reached[&node];
        if here.spent != spent {
            return Step::Visited(false);
        }
        let list = graph.nodes[node as usize].list;
        if list == NIL || wanted.is_some_and(|wanted| here.actions >= wanted) {
            return Step::Found(self.way_to(node), total);
        }
        let fresh = !graph.nodes[node as usize].expanded;
        if fresh {
            self.expansions += 1;
            graph.expand(node);
        }
        let acts = usize::from(graph.is_action(node));
        for edge in 0..graph.nodes[node as usize].out.len() {
            let edge = graph.nodes[node as usize].out[edge];
            let reached = Reached {
                spent: spent.saturating_add(edge.weight()),
                from: node,
                actions: here.actions + acts,
            };
            self.reach(graph, edge.to, reached);
        }
        Step::Visited(fresh)
    }

    fn way_to(&self, node: u32) -> Vec<u32> {
        let mut way = vec![node];
        let mut at = self.reached[&node].from;
        while at != NONE {
            way.push(at);
            at = self.reached[&at].from;
        }
        way.reverse();
        way
    }
}

/// The cheapest way from a root, if all of it is known; costs must be settled.
pub(super) fn walk(graph: &Graph, root: u32, wanted: Option<usize>) -> Option<Vec<u32>> {
    let mut way = vec![root];
    let mut actions = 0;
    let mut at = root;
    loop {
        let known = &graph.nodes[at as usize];
        if known.list == NIL || wanted.is_some_and(|wanted| actions >= wanted) {
            return Some(way);
        }
        if !known.expanded {
            return None;
        }
        actions += usize::from(graph.is_action(at));
        at = graph.best_edge(at)?.to;
        way.push(at);
    }
}
