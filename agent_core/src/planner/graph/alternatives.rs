//! Further plans, beside the best one.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::intern::{Map, NONE, Slices};
use super::lists::NIL;
use super::nodes::{Graph, INFINITE};

/// At most so many nodes are expanded to find alternatives, and at most so many visited beside
/// those of the best plan, each as often as there may be plans.
const EXPANSIONS: u64 = 200;

/// A node as one way leads to it.
#[derive(Clone, Copy, Debug)]
struct Twig {
    node: u32,
    spent: u64,
    from: u32,
    actions: usize,
    /// List, and what matters of the state.
    place: u32,
}

/// Best first, each node as often as there may be plans.
///
/// A way is no alternative if it only comes back to where something else could be done, by another
/// door: it is the best plan with a detour and of no use to anybody.
#[derive(Clone, Debug)]
pub(super) struct Alternatives {
    twigs: Vec<Twig>,
    frontier: BinaryHeap<Reverse<(u64, Reverse<u64>, u32)>>,
    visits: Map<u32, usize>,
    places: Slices,
    /// By place: the twigs that were visited there.
    visited: Map<u32, Vec<u32>>,
    /// The best plan first, as nodes.
    pub plans: Vec<Vec<u32>>,
    purposes: Vec<Vec<u32>>,
    expansions_left: u64,
    visits_left: usize,
    wanted: usize,
}

impl Alternatives {
    /// Looks for so many plans in all, of which the best is known.
    pub fn new(graph: &mut Graph, roots: &[u32], best: Vec<u32>, wanted: usize) -> Self {
        let mut search = Self {
            twigs: Vec::new(),
            frontier: BinaryHeap::new(),
            visits: Map::default(),
            places: Slices::default(),
            visited: Map::default(),
            purposes: vec![graph.purposes(&best)],
            expansions_left: EXPANSIONS,
            visits_left: EXPANSIONS as usize + 2 * wanted * best.len(),
            plans: vec![best],
            wanted,
        };
        for root in roots {
            search.add(graph, *root, 0, NONE, 0);
        }
        search
    }

    fn add(&mut self, graph: &Graph, node: u32, spent: u64, from: u32, actions: usize) {
        let total = spent.saturating_add(graph.nodes[node as usize].v);
        if total == INFINITE {
            return;
        }
        let twig = self.twigs.len() as u32;
        let place = self.places.intern(&graph.place(node));
        self.twigs.push(Twig {
            node,
            spent,
            from,
            actions,
            place,
        });
        self.frontier.push(Reverse((total, Reverse(spent), twig)));
    }

    /// Visits one node; `None` if there are no more plans, or it is not worth looking for them.
    /// Else whether the node was expanded.
    pub fn step(&mut self, graph: &mut Graph, depth: Option<usize>) -> Option<bool> {
        if self.plans.len() >= self.wanted || self.expansions_left == 0 || self.visits_left == 0 {
            return None;
        }
        let Reverse((_, _, number)) = self.frontier.pop()?;
        let twig = self.twigs[number as usize];
        let list = graph.nodes[twig.node as usize].list;
        if list == NIL || depth.is_some_and(|depth| twig.actions >= depth) {
            self.keep(graph, number);
            return Some(false);
        }
        let visits = self.visits.entry(twig.node).or_default();
        if *visits >= self.wanted {
            return Some(false);
        }
        *visits += 1;
        if self.goes_in_circles(number) {
            return Some(false);
        }
        self.visits_left -= 1;
        self.visited.entry(twig.place).or_default().push(number);
        let fresh = !graph.nodes[twig.node as usize].expanded;
        if fresh {
            self.expansions_left -= 1;
            graph.expand(twig.node);
        }
        let actions = twig.actions + usize::from(graph.is_action(twig.node));
        for edge in 0..graph.nodes[twig.node as usize].out.len() {
            let edge = graph.nodes[twig.node as usize].out[edge];
            let spent = twig.spent.saturating_add(edge.weight());
            self.add(graph, edge.to, spent, number, actions);
        }
        Some(fresh)
    }

    /// Whether the same work in the same state, as far as that matters, lies on the way here.
    fn goes_in_circles(&self, number: u32) -> bool {
        let Some(visited) = self.visited.get(&self.twigs[number as usize].place) else {
            return false;
        };
        let mut at = self.twigs[number as usize].from;
        while at != NONE {
            if visited.contains(&at) {
                return true;
            }
            at = self.twigs[at as usize].from;
        }
        false
    }

    fn keep(&mut self, graph: &mut Graph, number: u32) {
        let mut way = Vec::new();
        let mut at = number;
        while at != NONE {
            way.push(self.twigs[at as usize].node);
            at = self.twigs[at as usize].from;
        }
        way.reverse();
        let purposes = graph.purposes(&way);
        if !self.purposes.contains(&purposes) {
            self.purposes.push(purposes);
            self.plans.push(way);
        }
    }
}

impl Graph {
    /// What is left to do at a node, and of its state what decides on what can be done.
    fn place(&self, node: u32) -> Vec<u32> {
        let known = &self.nodes[node as usize];
        let mut place = vec![known.list];
        for pair in self.world.deltas.get(known.delta).chunks_exact(2) {
            if self.world.value(pair[0]) != pair[1] && self.world.is_decisive(pair[0]) {
                place.extend_from_slice(pair);
            }
        }
        place
    }

    /// What the actions on a way bring the robot forward by.
    fn purposes(&self, way: &[u32]) -> Vec<u32> {
        let acting = way.iter().take(way.len().saturating_sub(1));
        acting
            .filter(|node| self.is_action(**node))
            .filter_map(|node| {
                let (entry, _) = self.world.lists.first(self.nodes[*node as usize].list)?;
                Some(self.world.lists.entry(entry).purpose)
            })
            .collect()
    }
}
