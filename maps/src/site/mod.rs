//! The map as it was drawn: nodes, the passages between them, doors and areas.

mod build;
mod check;
mod faults;
mod fields;
mod lines;
mod parts;
mod read;
mod route;
mod summary;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use agent_core::model::Symbol;
use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef;

pub(crate) use faults::Faults;
pub(crate) use parts::metres;
pub use parts::{Area, Door, Node, Passage};
pub use route::Route;
pub use summary::Summary;

use crate::Finding;

/// A place as it was drawn, in metres.
///
/// Invariant, kept by [`from_text`](Self::from_text), the only way to make one: names are unique
/// among all nodes, passages, doors and areas; a passage has a door exactly if it joins two areas;
/// inside an area every node is reached from every other, and every area from every other once
/// all doors are open.
#[derive(Clone, Debug)]
pub struct Site {
    name: String,
    /// One edge for each direction in which a passage can be taken, with its place in `passages`.
    graph: DiGraph<Node, usize>,
    nodes: BTreeMap<Symbol, NodeIndex>,
    passages: Vec<Passage>,
    passage_indices: BTreeMap<Symbol, usize>,
    doors: BTreeMap<Symbol, Door>,
    areas: BTreeMap<Symbol, Area>,
}

impl Site {
    /// Reads a map in the shape of Nav2's Route Server (`maps/README.md` has the format).
    ///
    /// # Errors
    /// Everything that is wrong with the file, not only the first thing.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Vec<Finding>> {
        let path = path.as_ref();
        let file = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::from_text(&file, &text),
            Err(error) => {
                let mut faults = Faults::of(&file);
                faults.add(0, format!("cannot be read: {error}"));
                Err(faults.into_findings())
            }
        }
    }

    /// The same from text; `file_name` is only for the findings.
    ///
    /// # Errors
    /// Everything that is wrong with the text, not only the first thing.
    pub fn from_text(file_name: &str, text: &str) -> Result<Self, Vec<Finding>> {
        let mut faults = Faults::of(file_name);
        let Some(drawing) = read::read(text, &mut faults) else {
            return Err(faults.into_findings());
        };
        check::check(&drawing, &mut faults);
        if faults.is_empty() {
            Ok(build::build(drawing))
        } else {
            Err(faults.into_findings())
        }
    }

    /// What the file calls the place; empty if it does not say.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All nodes, in the order of their ids.
    pub fn nodes(&self) -> impl Iterator<Item = &Node> {
        self.graph.node_weights()
    }

    /// The node of that name.
    pub fn node(&self, name: &str) -> Option<&Node> {
        self.nodes.get(name).map(|index| &self.graph[*index])
    }

    /// All passages, in the order of the ids of their (first) edges.
    pub fn passages(&self) -> impl Iterator<Item = &Passage> {
        self.passages.iter()
    }

    /// The passage of that name.
    pub fn passage(&self, name: &str) -> Option<&Passage> {
        self.passage_indices
            .get(name)
            .map(|index| &self.passages[*index])
    }

    /// All doors, by name.
    pub fn doors(&self) -> impl Iterator<Item = &Door> {
        self.doors.values()
    }

    /// The door of that name.
    pub fn door(&self, name: &str) -> Option<&Door> {
        self.doors.get(name)
    }

    /// All areas, by name.
    pub fn areas(&self) -> impl Iterator<Item = &Area> {
        self.areas.values()
    }

    /// The area of that name.
    pub fn area(&self, name: &str) -> Option<&Area> {
        self.areas.get(name)
    }

    /// Where one can go from a node, and through which passage, doors open or not. Nothing if
    /// there is no such node.
    pub fn neighbours(&self, node: &str) -> impl Iterator<Item = (&Passage, &Node)> {
        self.nodes.get(node).into_iter().flat_map(|index| {
            self.graph
                .edges_directed(*index, Direction::Outgoing)
                .map(|edge| (&self.passages[*edge.weight()], &self.graph[edge.target()]))
        })
    }

    /// The passages that end at one of these nodes, each once, in the order of
    /// [`passages`](Self::passages).
    pub(crate) fn passages_at<'a>(&self, nodes: impl Iterator<Item = &'a Symbol>) -> Vec<&Passage> {
        let indices = nodes.filter_map(|node| self.nodes.get(node));
        let found: BTreeSet<usize> = indices
            .flat_map(|index| {
                let edges = [Direction::Outgoing, Direction::Incoming]
                    .map(|direction| self.graph.edges_directed(*index, direction));
                edges.into_iter().flatten().map(|edge| *edge.weight())
            })
            .collect();
        found
            .into_iter()
            .map(|index| &self.passages[index])
            .collect()
    }

    /// The areas at the two ends of a passage; the same one twice unless it has a door.
    pub fn areas_of(&self, passage: &Passage) -> [&Symbol; 2] {
        // The ends of a passage are nodes of the map: `check` has seen to it.
        passage
            .ends()
            .map(|end| self.graph[self.nodes[end.as_str()]].area())
    }

    /// How many of each there are.
    pub fn summary(&self) -> Summary {
        Summary::of(self)
    }
}

/// What is wrong with a map, for people who draw one; empty if nothing is.
pub fn check_map(path: impl AsRef<Path>) -> Vec<Finding> {
    Site::read(path).err().unwrap_or_default()
}
