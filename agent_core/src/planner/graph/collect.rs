//! Memory that is bounded: nodes that no goal leads to are given up after a while.

use std::collections::BTreeSet;

use super::Kept;
use super::intern::{Map, Slices};
use super::nodes::Graph;
use crate::planner::Agenda;

/// Below so many nodes nothing is collected.
const LEAST: usize = 20_000;
/// After so many collections that have not found it, a node is given up. A way that is closed for
/// now, a door or an action that is under way, may be open again by then.
const AGE: u8 = 2;

impl Graph {
    /// Whether the graph has doubled since it was last collected.
    pub fn is_full(&self) -> bool {
        self.live() > LEAST.max(2 * self.live_after_collection)
    }

    /// Gives up what these agendas and those of goals that are kept do not lead to.
    pub fn forget_all_but(&mut self, agendas: &[Agenda], kept: &Kept) {
        let tasks = agendas.iter().map(|agenda| &agenda.tasks);
        let tasks = tasks.chain(kept.values().flatten());
        let lists: Vec<u32> = tasks.map(|tasks| self.world.list(tasks)).collect();
        self.collect(&lists);
    }

    /// Gives up nodes to which none of these lists leads, nor what follows on them.
    pub fn collect(&mut self, lists: &[u32]) {
        let mut kept = BTreeSet::new();
        for list in lists {
            let mut list = *list;
            while kept.insert(list)
                && let Some((_, rest)) = self.world.lists.first(list)
            {
                list = rest;
            }
        }
        let mut reached = vec![false; self.nodes.len()];
        self.mark(&mut reached, |graph, node| {
            kept.contains(&graph.nodes[node].list)
        });
        for (node, reached) in reached.iter().enumerate() {
            let known = &mut self.nodes[node];
            if !known.is_free() {
                known.age = if *reached { 0 } else { known.age + 1 };
            }
        }
        // What a node leads to stays as long as the node.
        self.mark(&mut reached, |graph, node| graph.nodes[node].age < AGE);
        for (node, reached) in reached.into_iter().enumerate() {
            if !reached && !self.nodes[node].is_free() {
                self.give_up(node as u32);
            }
        }
        self.compact();
        self.live_after_collection = self.live();
        self.upset += 1;
    }

    fn mark(&self, reached: &mut [bool], is_root: impl Fn(&Self, usize) -> bool) {
        let roots =
            (0..self.nodes.len()).filter(|n| !self.nodes[*n].is_free() && is_root(self, *n));
        let mut open: Vec<usize> = roots.filter(|node| !reached[*node]).collect();
        for node in &open {
            reached[*node] = true;
        }
        while let Some(node) = open.pop() {
            for edge in &self.nodes[node].out {
                let to = edge.to as usize;
                if !std::mem::replace(&mut reached[to], true) {
                    open.push(to);
                }
            }
        }
    }

    fn give_up(&mut self, node: u32) {
        self.count_out(node);
        self.connect(node, Vec::new());
        self.depend(node, Vec::new());
        self.wanted.remove(&node);
        let known = &mut self.nodes[node as usize];
        known.age = u8::MAX;
        known.dirty = false;
        self.table.remove(&(known.list, known.delta));
        self.free.push(node);
    }

    /// Gives up the lists and deltas that occur no more.
    fn compact(&mut self) {
        let live = self.nodes.iter().filter(|node| !node.is_free());
        let lists = self.world.lists.compact(live.map(|node| node.list));
        let mut deltas = Slices::default();
        deltas.intern(&[]);
        let mut table = Map::default();
        for (number, node) in self.nodes.iter_mut().enumerate() {
            if !node.is_free() {
                node.list = lists.get(&node.list).copied().unwrap_or_default();
                node.delta = deltas.intern(self.world.deltas.get(node.delta));
                table.insert((node.list, node.delta), number as u32);
            }
        }
        self.world.deltas = deltas;
        self.table = table;
        self.shapes = Slices::default();
        self.shapes_of.clear();
        for node in 0..self.nodes.len() {
            if !self.nodes[node].is_free() {
                self.note_shape(self.nodes[node].list, self.nodes[node].delta);
            }
        }
    }
}
