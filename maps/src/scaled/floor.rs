//! Areas in a grid, and the doors between neighbours.

use petgraph::unionfind::UnionFind;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

/// Of an area, west to east.
pub(super) const WIDTH_M: f64 = 16.0;
/// Of an area, south to north.
pub(super) const DEPTH_M: f64 = 12.0;
/// Nodes in an area, on average.
const NODES_PER_AREA: usize = 5;

/// Which areas there are and how one gets from one to another.
pub(super) struct Floor {
    pub(super) areas: usize,
    columns: usize,
    /// In the order of the areas that they join.
    pub(super) doors: Vec<Doorway>,
}

/// A door between two neighbours.
#[derive(Clone, Copy, Eq, Ord, PartialEq, PartialOrd)]
pub(super) struct Doorway {
    /// The area to the west or south, counted from 0.
    pub(super) one: usize,
    /// The area to the east or north.
    pub(super) other: usize,
    pub(super) open: bool,
}

impl Floor {
    pub(super) fn draw(nodes: usize, rng: &mut ChaCha8Rng) -> Self {
        let areas = ((nodes + NODES_PER_AREA / 2) / NODES_PER_AREA).max(1);
        // About as wide as it is deep.
        let columns = ((areas as f64 * DEPTH_M / WIDTH_M).sqrt().round() as usize).max(1);
        let mut neighbours: Vec<(usize, usize)> = (0..areas)
            .flat_map(|area| {
                let east = (area % columns + 1 < columns).then_some(area + 1);
                let north = Some(area + columns);
                let neighbours = [east, north].into_iter().flatten();
                neighbours.map(move |other| (area, other))
            })
            .filter(|(_, other)| *other < areas)
            .collect();
        neighbours.shuffle(rng);
        // First as many doors as it takes to get everywhere, then some more, of which some are shut.
        let mut joined = UnionFind::new(areas);
        let (needed, further): (Vec<_>, Vec<_>) = neighbours
            .into_iter()
            .partition(|(one, other)| joined.union(*one, *other));
        let more = (areas * 5 / 4).saturating_sub(needed.len());
        let closed = areas / 8;
        let needed = needed.into_iter().map(|(one, other)| Doorway {
            one,
            other,
            open: true,
        });
        let further = further.into_iter().take(more).enumerate();
        let further = further.map(|(index, (one, other))| Doorway {
            one,
            other,
            open: index >= closed,
        });
        let mut doors: Vec<Doorway> = needed.chain(further).collect();
        doors.sort_unstable();
        Self {
            areas,
            columns,
            doors,
        }
    }

    /// Whether the areas of a door lie side by side, and not one north of the other.
    pub(super) fn side_by_side(&self, door: Doorway) -> bool {
        door.one / self.columns == door.other / self.columns
    }

    /// The south-western corner of an area.
    pub(super) fn corner_m(&self, area: usize) -> [f64; 2] {
        let (row, column) = (area / self.columns, area % self.columns);
        [column as f64 * WIDTH_M, row as f64 * DEPTH_M]
    }
}
