//! Areas for a graph that has none.
//!
//! What an area must be (`maps/README.md`): whoever is in it can get from each of its nodes to each
//! other without leaving it, and what leads out of it is a door. So:
//!
//! 1. Only what can be reached from everywhere, and can be left again, is on the map: the largest
//!    strongly connected part of the graph.
//! 2. Lanes with doors, and with [`AreasBy::Names`] lanes between groups, are taken away. What is
//!    strongly connected then is an area.
//! 3. An area with a door inside (there is another way round) is cut between the two sides of the door,
//!    each node going to the nearer side. If its one-way lanes do not permit that, the door is left out.
//! 4. An area of too many nodes is cut in the same way between two of its nodes that are far apart.
//!
//! A half that is not strongly connected gives what is cut off from its main part to the other one.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use pathfinding::prelude::dijkstra_all;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;

use super::names::{folded, prefix};
use super::read::Graph;
use super::{AreasBy, Notes, RmfOptions};

/// A larger area is cut by size first: for each of its doors all of it would have to be looked at.
const LARGE: usize = 2000;

/// Which areas there are.
pub(super) struct Plan {
    /// Of each vertex; `None` if it is left out.
    pub(super) area_of: Vec<Option<usize>>,
    /// What the areas are called, if that is not for us to say.
    pub(super) names: Vec<Option<String>>,
    /// Passages, by their place, whose doors are left out: they are always open.
    pub(super) doorless: BTreeSet<usize>,
}

pub(super) fn partition(graph: &Graph, options: &RmfOptions, notes: &mut Notes) -> Plan {
    let ways = Ways::of(graph);
    let all: Vec<usize> = (0..graph.vertices.len()).collect();
    let kept: BTreeSet<usize> = ways
        .parts(&all, |_| true)
        .into_iter()
        .next()
        .unwrap_or_default()
        .into_iter()
        .collect();
    left_out(graph, &kept, notes);

    let groups = match options.areas_by {
        AreasBy::Doors => vec![None; all.len()],
        AreasBy::Names => groups(graph, &kept, &ways),
    };
    let within = |passage: usize| {
        let [one, other] = graph.passages[passage].ends;
        graph.passages[passage].door.is_none() && groups[one] == groups[other]
    };
    let kept: Vec<usize> = kept.into_iter().collect();
    let mut waiting: VecDeque<Vec<usize>> = ways.parts(&kept, within).into();
    let mut cutter = Cutter {
        graph,
        ways: &ways,
        within: &within,
        doorless: BTreeSet::new(),
        whole: 0,
    };
    let mut areas = Vec::new();
    while let Some(set) = waiting.pop_front() {
        match cutter.cut(&set, options.most_nodes.max(2)) {
            Some(halves) => waiting.extend(halves),
            None => areas.push(set),
        }
    }
    let Cutter {
        doorless, whole, ..
    } = cutter;
    if whole > 0 {
        let sentence =
            "areas have more nodes than wanted, as their one-way lanes let them not be cut";
        notes.say(format!("{whole} {sentence}"));
    }
    for passage in &doorless {
        let [one, other] = graph.passages[*passage].ends;
        let door = graph.passages[*passage].door.as_deref().unwrap_or_default();
        notes.say(format!(
            "door {door} between vertices {one} and {other} is left out, and the way taken to be free: \
             its two sides cannot lie in different areas"
        ));
    }

    // Numbered in the order of their first vertices.
    for area in &mut areas {
        area.sort_unstable();
    }
    areas.sort();
    let mut area_of = vec![None; graph.vertices.len()];
    let mut names = Vec::new();
    for (number, area) in areas.iter().enumerate() {
        names.push(area.first().and_then(|vertex| groups[*vertex].clone()));
        for vertex in area {
            area_of[*vertex] = Some(number);
        }
    }
    Plan {
        area_of,
        names,
        doorless,
    }
}

fn left_out(graph: &Graph, kept: &BTreeSet<usize>, notes: &mut Notes) {
    let out: Vec<String> = graph
        .vertices
        .iter()
        .filter(|vertex| !kept.contains(&vertex.index))
        .map(|vertex| {
            vertex
                .name
                .clone()
                .unwrap_or_else(|| vertex.index.to_string())
        })
        .collect();
    if out.is_empty() {
        return;
    }
    let shown = out.iter().take(8).cloned().collect::<Vec<_>>().join(", ");
    let more = if out.len() > 8 { ", …" } else { "" };
    notes.say(format!(
        "{} vertices cannot be reached from the others and left again: left out: {shown}{more}",
        out.len()
    ));
}

/// The group of each vertex that is kept; that of its nearest neighbour if it has none of its own.
fn groups(graph: &Graph, kept: &BTreeSet<usize>, ways: &Ways<'_>) -> Vec<Option<String>> {
    let mut groups: Vec<Option<String>> = graph
        .vertices
        .iter()
        .map(|vertex| match (&vertex.area, &vertex.name) {
            (Some(area), _) => Some(folded(area, 'a')),
            (None, Some(name)) => Some(folded(prefix(name), 'a')),
            (None, None) => None,
        })
        .collect();
    // One search from all that have a group; from a place beyond the last vertex to them it is no way.
    let outside = graph.vertices.len();
    let given: Vec<usize> = kept
        .iter()
        .copied()
        .filter(|vertex| groups[*vertex].is_some())
        .collect();
    let reached = dijkstra_all(&outside, |vertex| -> Vec<(usize, u64)> {
        if *vertex == outside {
            return given.iter().map(|vertex| (*vertex, 0)).collect();
        }
        let steps = ways.around[*vertex].iter();
        let free = steps.filter(|(_, passage)| graph.passages[*passage].door.is_none());
        free.map(|(next, passage)| (*next, graph.passages[*passage].length_mm))
            .collect()
    });
    for vertex in kept {
        if groups[*vertex].is_some() {
            continue;
        }
        // Back along the way to where it began. No way is longer than there are vertices.
        let mut at = *vertex;
        for _ in 0..=graph.vertices.len() {
            match reached.get(&at) {
                Some((before, _)) if *before != outside => at = *before,
                _ => break,
            }
        }
        groups[*vertex] = groups[at].clone();
    }
    groups
}

/// Who is next to whom.
struct Ways<'a> {
    graph: &'a Graph,
    /// Of each vertex: its neighbours in whatever direction, and by which passage.
    around: Vec<Vec<(usize, usize)>>,
}

impl<'a> Ways<'a> {
    fn of(graph: &'a Graph) -> Self {
        let mut around = vec![Vec::new(); graph.vertices.len()];
        for (index, passage) in graph.passages.iter().enumerate() {
            let [one, other] = passage.ends;
            around[one].push((other, index));
            around[other].push((one, index));
        }
        Self { graph, around }
    }

    /// The strongly connected parts of some vertices by the passages that are usable, the largest
    /// first, of equal ones that with the first vertex; each sorted.
    fn parts(&self, set: &[usize], usable: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
        let mut graph: DiGraph<usize, ()> = DiGraph::new();
        let nodes: BTreeMap<usize, _> = set
            .iter()
            .map(|vertex| (*vertex, graph.add_node(*vertex)))
            .collect();
        for (vertex, node) in &nodes {
            for (next, index) in &self.around[*vertex] {
                let passage = &self.graph.passages[*index];
                let way = usize::from(passage.ends[0] != *vertex);
                if let Some(next) = nodes.get(next)
                    && passage.open_to[way]
                    && usable(*index)
                {
                    graph.add_edge(*node, *next, ());
                }
            }
        }
        let parts = kosaraju_scc(&graph).into_iter();
        let mut parts: Vec<Vec<usize>> = parts
            .map(|part| {
                let mut part: Vec<usize> = part.into_iter().map(|node| graph[node]).collect();
                part.sort_unstable();
                part
            })
            .collect();
        parts.sort_by_key(|part| (std::cmp::Reverse(part.len()), part.first().copied()));
        parts
    }
}

/// Cuts areas in two.
struct Cutter<'a, F: Fn(usize) -> bool> {
    graph: &'a Graph,
    ways: &'a Ways<'a>,
    /// Which passages join what may lie in one area.
    within: F,
    doorless: BTreeSet<usize>,
    /// How many areas are too large and cannot be cut.
    whole: usize,
}

impl<F: Fn(usize) -> bool> Cutter<'_, F> {
    /// The halves of an area. `None` if it is well as it is, or cannot be cut.
    fn cut(&mut self, set: &[usize], most_nodes: usize) -> Option<[Vec<usize>; 2]> {
        let too_large = set.len() > most_nodes;
        if set.len() > LARGE
            && let Some(halves) = self.cut_in_the_middle(set)
        {
            return Some(halves);
        }
        let inside: BTreeSet<usize> = set.iter().copied().collect();
        let passages = set.iter().flat_map(|vertex| &self.ways.around[*vertex]);
        let doors: BTreeSet<usize> = passages
            .filter(|(next, passage)| {
                inside.contains(next) && self.graph.passages[*passage].door.is_some()
            })
            .map(|(_, passage)| *passage)
            .collect();
        for door in doors {
            if self.doorless.contains(&door) {
                continue;
            }
            match self.between(set, self.graph.passages[door].ends) {
                Some(halves) => return Some(halves),
                None => self.doorless.insert(door),
            };
        }
        if !too_large {
            return None;
        }
        let halves = self.cut_in_the_middle(set);
        self.whole += usize::from(halves.is_none());
        halves
    }

    fn cut_in_the_middle(&self, set: &[usize]) -> Option<[Vec<usize>; 2]> {
        let inside: BTreeSet<usize> = set.iter().copied().collect();
        let first = set.iter().copied().min()?;
        let one = self.furthest(first, &inside);
        let other = self.furthest(one, &inside);
        self.between(set, [one, other])
            .or_else(|| self.between(set, [first, one]))
    }

    /// Each node to the nearer of two; to the first if it is as near.
    fn between(&self, set: &[usize], [one, other]: [usize; 2]) -> Option<[Vec<usize>; 2]> {
        if one == other {
            return None;
        }
        let inside: BTreeSet<usize> = set.iter().copied().collect();
        let [near, far] = [one, other].map(|from| self.distances_mm(from, &inside));
        let distance =
            |known: &BTreeMap<usize, u64>, to: usize| known.get(&to).copied().unwrap_or(u64::MAX);
        // On the shortest way to the nearer one everything is nearer to that, too: both halves hang
        // together as long as lanes lead both ways.
        let (here, there): (Vec<usize>, Vec<usize>) = set
            .iter()
            .partition(|vertex| distance(&near, **vertex) <= distance(&far, **vertex));
        self.mended(set, here, one, other).or_else(|| {
            let [other, one] = self.mended(set, there, other, one)?;
            Some([one, other])
        })
    }

    /// The part of `half` that `seed` is in, and all the rest; if both are strongly connected.
    fn mended(
        &self,
        set: &[usize],
        half: Vec<usize>,
        seed: usize,
        other: usize,
    ) -> Option<[Vec<usize>; 2]> {
        let parts = self.ways.parts(&half, &self.within).into_iter();
        let main = parts
            .into_iter()
            .find(|part| part.binary_search(&seed).is_ok())?;
        let rest: Vec<usize> = set
            .iter()
            .copied()
            .filter(|vertex| main.binary_search(vertex).is_err())
            .collect();
        let whole = rest.contains(&other) && self.ways.parts(&rest, &self.within).len() == 1;
        whole.then_some([main, rest])
    }

    /// The vertex that is furthest from another, of equal ones the first.
    fn furthest(&self, from: usize, inside: &BTreeSet<usize>) -> usize {
        let distances = self.distances_mm(from, inside).into_iter();
        distances
            .max_by_key(|(vertex, length)| (*length, std::cmp::Reverse(*vertex)))
            .map_or(from, |(vertex, _)| vertex)
    }

    /// How far it is, whichever way lanes lead.
    fn distances_mm(&self, from: usize, inside: &BTreeSet<usize>) -> BTreeMap<usize, u64> {
        let reached = dijkstra_all(&from, |vertex| -> Vec<(usize, u64)> {
            let steps = self.ways.around[*vertex].iter();
            let usable =
                steps.filter(|(next, passage)| inside.contains(next) && (self.within)(*passage));
            usable
                .map(|(next, passage)| (*next, self.graph.passages[*passage].length_mm))
                .collect()
        });
        reached
            .into_iter()
            .map(|(vertex, (_, length))| (vertex, length))
            .chain([(from, 0)])
            .collect()
    }
}
