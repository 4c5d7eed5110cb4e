//! A first plan soon, where nothing says which way is short: depth first, each node once.

use super::intern::{Map, NONE};
use super::lists::NIL;
use super::nodes::{Graph, INFINITE};
use super::search::Step;

/// Depth first from some roots, by what seems cheapest at each node.
#[derive(Clone, Debug)]
pub(super) struct Dive {
    /// A node, what is spent on the way there, the actions on it, and the node before.
    open: Vec<(u32, u64, usize, u32)>,
    before: Map<u32, u32>,
    pub expansions_left: u64,
}

impl Dive {
    pub fn new(graph: &Graph, roots: &[u32], expansions: u64) -> Self {
        let mut open: Vec<_> = roots.iter().map(|root| (*root, 0, 0, NONE)).collect();
        open.sort_by_key(|(root, ..)| std::cmp::Reverse(graph.nodes[*root as usize].v));
        Self {
            open,
            before: Map::default(),
            expansions_left: expansions,
        }
    }

    /// Visits one node.
    pub fn step(&mut self, graph: &mut Graph, wanted: Option<usize>) -> Step {
        let next = self.open.pop().filter(|_| self.expansions_left > 0);
        let Some((node, spent, actions, from)) = next else {
            return Step::Exhausted;
        };
        if self.before.contains_key(&node) {
            return Step::Visited(false);
        }
        self.before.insert(node, from);
        let list = graph.nodes[node as usize].list;
        if list == NIL || wanted.is_some_and(|wanted| actions >= wanted) {
            let total = spent.saturating_add(graph.nodes[node as usize].v);
            return Step::Found(self.way_to(node), total);
        }
        let fresh = !graph.nodes[node as usize].expanded;
        if fresh {
            self.expansions_left -= 1;
            graph.expand(node);
        }
        let actions = actions + usize::from(graph.is_action(node));
        let through = |to: u32, weight: u64| weight.saturating_add(graph.nodes[to as usize].v);
        let out = graph.nodes[node as usize].out.iter();
        let mut ways: Vec<(u64, u32, u64)> = out
            .map(|edge| (through(edge.to, edge.weight()), edge.to, edge.weight()))
            .filter(|(total, to, _)| *total != INFINITE && !self.before.contains_key(to))
            .collect();
        // The first of the cheapest is to be visited first, and so stands last.
        ways.reverse();
        ways.sort_by_key(|(total, ..)| std::cmp::Reverse(*total));
        let ways = ways.into_iter();
        self.open
            .extend(ways.map(|(_, to, weight)| (to, spent.saturating_add(weight), actions, node)));
        Step::Visited(fresh)
    }

    fn way_to(&self, node: u32) -> Vec<u32> {
        let mut way = vec![node];
        let mut at = self.before[&node];
        while at != NONE {
            way.push(at);
            at = self.before[&at];
        }
        way.reverse();
        way
    }
}
