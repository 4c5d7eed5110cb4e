//! How far it is at least from an area to a node: exactly, as long as that can be listed.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use agent_core::model::{Landmarks, Reach, Symbol};

use crate::site::{Area, Site};

/// Up to here every pair of an area and a node is listed; on larger maps landmarks say nearly the
/// same in a thousandth of the room.
const LISTED_PAIRS: usize = 100_000;
/// More of them are nearer to the truth, and take more time to ask.
const LANDMARKS: usize = 16;

pub(super) fn can_be_listed(site: &Site) -> bool {
    site.areas().count() * site.nodes().count() <= LISTED_PAIRS
}

/// The least that it takes from anywhere in an area to each node, all doors open: no plan from
/// there costs less.
pub(super) fn least_lengths<'a>(site: &'a Site, area: &'a Area) -> BTreeMap<&'a Symbol, u64> {
    let mut least = BTreeMap::new();
    for start in area.nodes().filter_map(|node| site.node(node.as_str())) {
        for (node, length) in site.distances_mm(start, |_| true) {
            let known = least.entry(node).or_insert(length);
            *known = length.min(*known);
        }
    }
    least
}

/// The same for sites where that is too much: at most what [`least_lengths`] would say.
pub(super) fn landmarks(site: &Site, function: Symbol) -> Landmarks {
    let roads = Roads::of(site);
    let reaches: Vec<Vec<Reach>> = roads
        .landmarks()
        .into_iter()
        .map(|landmark| {
            let from = roads.lengths(landmark, &roads.out);
            let to = roads.lengths(landmark, &roads.back);
            let reaches = from.into_iter().zip(to);
            let reaches = reaches.map(|(from_landmark, to_landmark)| Reach {
                from_landmark,
                to_landmark,
            });
            reaches.collect()
        })
        .collect();
    let of_node =
        |index: usize| -> Vec<Reach> { reaches.iter().map(|reaches| reaches[index]).collect() };
    let mut nodes = BTreeMap::new();
    let mut areas: BTreeMap<Symbol, Vec<Reach>> = BTreeMap::new();
    for (index, node) in site.nodes().enumerate() {
        let of_node = of_node(index);
        // From anywhere in the area: from the place in it where the bound is the least.
        let of_area = areas
            .entry(node.area().clone())
            .or_insert_with(|| of_node.clone());
        for (area, node) in of_area.iter_mut().zip(&of_node) {
            area.from_landmark = area.from_landmark.max(node.from_landmark);
            area.to_landmark = area.to_landmark.min(node.to_landmark);
        }
        nodes.insert(node.name().clone(), of_node);
    }
    Landmarks::new(function, areas, nodes)
}

/// The ways out of each node, by the node's place in the site, with their lengths in millimetres.
type Ways = Vec<Vec<(usize, u64)>>;

/// A site as numbers, for when much of it is gone through.
struct Roads {
    out: Ways,
    /// The same, backwards.
    back: Ways,
}

impl Roads {
    fn of(site: &Site) -> Self {
        let places: BTreeMap<&Symbol, usize> = site
            .nodes()
            .enumerate()
            .map(|(index, node)| (node.name(), index))
            .collect();
        let nothing = vec![Vec::new(); places.len()];
        let (mut out, mut back) = (nothing.clone(), nothing);
        for passage in site.passages() {
            for (from, to) in passage.directions() {
                let (from, to) = (places[from], places[to]);
                out[from].push((to, passage.length_mm()));
                back[to].push((from, passage.length_mm()));
            }
        }
        Self { out, back }
    }

    /// Nodes at the ends of the site: each the one that is furthest from those before it.
    fn landmarks(&self) -> Vec<usize> {
        let furthest = |lengths: &[u64]| (0..lengths.len()).max_by_key(|node| lengths[*node]);
        let mut found = Vec::new();
        // A corner, from wherever one starts.
        let mut nearest = self.lengths(0, &self.out);
        while let Some(next) = furthest(&nearest)
            && found.len() < LANDMARKS.min(self.out.len())
        {
            let lengths = self.lengths(next, &self.out);
            if found.is_empty() {
                nearest = lengths;
            } else {
                for (nearest, length) in nearest.iter_mut().zip(lengths) {
                    *nearest = length.min(*nearest);
                }
            }
            found.push(next);
        }
        found
    }

    /// How far it is along `ways` from `start` to every node (Dijkstra's algorithm); every node can
    /// be reached (`Site`).
    fn lengths(&self, start: usize, ways: &Ways) -> Vec<u64> {
        let mut lengths = vec![u64::MAX; ways.len()];
        let mut open = BinaryHeap::from([Reverse((0, start))]);
        while let Some(Reverse((length, node))) = open.pop() {
            if lengths[node] != u64::MAX {
                continue;
            }
            lengths[node] = length;
            for (next, more) in &ways[node] {
                if lengths[*next] == u64::MAX {
                    open.push(Reverse((length + more, *next)));
                }
            }
        }
        lengths
    }
}

#[cfg(test)]
mod tests {
    use agent_core::model::Fact;

    use super::*;
    use crate::scaled_map;

    #[test]
    fn landmarks_never_say_more_than_the_way_is_and_seldom_much_less() {
        let site = Site::from_text("scaled", &scaled_map(300, 11)).expect("in order");
        let bounds = landmarks(&site, Symbol::from("distance"));
        let (mut bounded_mm, mut true_mm) = (0.0, 0.0);
        for area in site.areas() {
            for (node, length) in least_lengths(&site, area) {
                let function = Fact::new("distance", [area.name().as_str(), node.as_str()]);
                let bound = bounds.value(&function).expect("both are on the map") * 1000.0;
                assert!(
                    bound <= length as f64 + 1e-6,
                    "{function}: {bound} {length}"
                );
                bounded_mm += bound;
                true_mm += length as f64;
            }
        }
        assert!(bounded_mm > 0.8 * true_mm, "{}", bounded_mm / true_mm);
    }
}
