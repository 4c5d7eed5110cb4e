//! Shortest ways, doors and areas apart.

use std::collections::BTreeMap;

use agent_core::model::Symbol;
use pathfinding::prelude::{dijkstra, dijkstra_all};

use super::parts::metres;
use super::{Node, Passage, Site};

/// A shortest way from one node to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Where it starts, what it passes and where it ends.
    pub nodes: Vec<Symbol>,
    /// How long it is.
    pub length_m: f64,
}

impl Site {
    /// A shortest way through those passages that `usable` accepts. `None` if there is none, or
    /// no such node.
    pub fn route(&self, from: &str, to: &str, usable: impl Fn(&Passage) -> bool) -> Option<Route> {
        let [from, to] = [self.node(from)?.name(), self.node(to)?.name()];
        let steps = |node: &&Symbol| self.steps(node, &usable);
        let (nodes, length_mm) = dijkstra(&from, steps, |node| *node == to)?;
        Some(Route {
            nodes: nodes.into_iter().cloned().collect(),
            length_m: metres(length_mm),
        })
    }

    /// How far it is, in millimetres, from a node to each that can be reached through the
    /// passages that `usable` accepts; to itself 0.
    pub(crate) fn distances_mm<'a>(
        &'a self,
        from: &Node,
        usable: impl Fn(&Passage) -> bool,
    ) -> BTreeMap<&'a Symbol, u64> {
        let Some((from, _)) = self.nodes.get_key_value(from.name()) else {
            return BTreeMap::new();
        };
        dijkstra_all(&from, |node| self.steps(node, &usable))
            .into_iter()
            .map(|(node, (_, length_mm))| (node, length_mm))
            .chain([(from, 0)])
            .collect()
    }

    fn steps<'a>(
        &'a self,
        node: &Symbol,
        usable: impl Fn(&Passage) -> bool,
    ) -> Vec<(&'a Symbol, u64)> {
        self.neighbours(node.as_str())
            .filter(|(passage, _)| usable(passage))
            .map(|(passage, next)| (next.name(), passage.length_mm))
            .collect()
    }
}
