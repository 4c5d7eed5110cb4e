//! Open-RMF's navigation graphs (YAML, as `rmf_building_map_tools` writes and `rmf_fleet_adapter` reads
//! them) as maps of ours.
//!
//! A navigation graph has no areas, and an area of ours is what one door or more lead out of. So areas
//! are made ([`partition`]): doors are their borders, and what is too large between doors is cut where
//! it is long. A cut that is no door becomes a gate: a door that is open at first and that nobody need
//! ever close.

mod names;
mod partition;
mod read;
#[cfg(test)]
mod tests;
mod tree;
mod write;

use std::collections::BTreeMap;

use crate::site::Faults;
use crate::{Finding, Site};

/// How areas are made of a navigation graph.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum AreasBy {
    /// What can be reached without passing a door lies in one area.
    Doors,
    /// What has the same property `area`, or else a name that begins alike up to its last `_`, `-`,
    /// `.`, space or number, lies in one area; what has neither lies with its nearest neighbour. Doors
    /// are borders all the same.
    Names,
}

/// What is wanted of a navigation graph.
#[derive(Clone, Debug)]
pub struct RmfOptions {
    /// Which level; without it the only one.
    pub level: Option<String>,
    /// How areas are made.
    pub areas_by: AreasBy,
    /// An area of more nodes is cut, if its one-way lanes permit. At least 2.
    pub most_nodes: usize,
}

impl Default for RmfOptions {
    fn default() -> Self {
        Self {
            level: None,
            areas_by: AreasBy::Doors,
            most_nodes: 16,
        }
    }
}

/// A navigation graph as a map.
#[derive(Clone, Debug)]
pub struct FromRmf {
    /// The text of the map, in the format of `maps/README.md`.
    pub map: String,
    /// The same, read.
    pub site: Site,
    /// The level that was taken.
    pub level: String,
    /// A node where a robot could start: a charger, a parking spot, or the first.
    pub start: String,
    /// What was left out, taken for granted or made up, a sentence each.
    pub notes: Vec<String>,
}

/// Makes a map of a navigation graph; `file_name` is only for the findings.
///
/// # Errors
/// Everything that is wrong with the graph, not only the first thing.
pub fn from_rmf(
    file_name: &str,
    text: &str,
    options: &RmfOptions,
) -> Result<FromRmf, Vec<Finding>> {
    let mut faults = Faults::of(file_name);
    let mut notes = Notes::default();
    let tree = match tree::parse(text) {
        Ok(tree) => tree,
        Err((line, message)) => {
            faults.add(line, message);
            return Err(faults.into_findings());
        }
    };
    let graph = read::read(&tree, options.level.as_deref(), &mut faults, &mut notes);
    let Some(graph) = graph.filter(|_| faults.is_empty()) else {
        return Err(faults.into_findings());
    };
    if graph.passages.is_empty() {
        faults.add(
            0,
            format!(
                "level {} has no lane, so there is nowhere to go",
                graph.level
            ),
        );
        return Err(faults.into_findings());
    }
    let plan = partition::partition(&graph, options, &mut notes);
    let (map, start) = write::write(&graph, &plan, &mut notes);
    let site = Site::from_text(file_name, &map).map_err(|findings| {
        // A fault of this crate: better said than hidden.
        let said = |finding: Finding| Finding {
            message: format!("the map made of it is not in order: {finding}"),
            place: String::new(),
            ..finding
        };
        findings.into_iter().map(said).collect::<Vec<_>>()
    })?;
    Ok(FromRmf {
        map,
        site,
        level: graph.level,
        start,
        notes: notes.into_sentences(),
    })
}

/// What people should know of how a graph was taken.
#[derive(Default)]
struct Notes {
    said: Vec<String>,
    /// By what they belong to and what they are called.
    unused: BTreeMap<(&'static str, String), usize>,
}

/// More sentences than that nobody reads.
const MOST_NOTES: usize = 40;

impl Notes {
    fn say(&mut self, sentence: String) {
        self.said.push(sentence);
    }

    /// A property that has no meaning here.
    fn unused(&mut self, key: &str, many: &'static str) {
        *self.unused.entry((many, key.to_owned())).or_default() += 1;
    }

    fn into_sentences(self) -> Vec<String> {
        let unused: Vec<String> = self
            .unused
            .into_iter()
            .map(|((what, key), count)| format!("`{key}` of {count} {what}"))
            .collect();
        let mut said = self.said;
        if said.len() > MOST_NOTES {
            let more = said.len() - MOST_NOTES;
            said.truncate(MOST_NOTES);
            said.push(format!("and {more} more of the kind"));
        }
        if !unused.is_empty() {
            said.push(format!("not used: {}", unused.join(", ")));
        }
        said
    }
}
