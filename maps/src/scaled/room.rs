//! What stands in the areas: door sides, exhibits, a toilet now and then, and the arcs between them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::floor::{DEPTH_M, Doorway, Floor, WIDTH_M};

/// From a door to the node on either side of it.
const DOOR_SIDE_M: f64 = 1.5;
/// Places tried for a thing; it is put where it is furthest from the others.
const TRIES: usize = 8;
/// In forty nodes the paper's museum has fifty-three arcs that lead through no door.
const ARCS_IN_AREAS: (usize, usize) = (53, 40);

/// The nodes and arcs of all areas.
pub(super) struct Rooms {
    /// The first of all is the entrance; those of one area stand together.
    pub(super) nodes: Vec<Spot>,
    /// In the order of their ends, the smaller first; counted from 0.
    pub(super) arcs: Vec<Arc>,
}

/// A node.
pub(super) struct Spot {
    pub(super) area: usize,
    pub(super) position_m: [f64; 2],
    pub(super) what: What,
}

/// What is at a node.
pub(super) enum What {
    /// One of the things that visitors come for, or need.
    Thing(&'static str),
    /// This side of a door to that area.
    DoorTo(usize, Doorway),
}

/// A way between two nodes.
#[derive(Clone, Copy)]
pub(super) struct Arc {
    pub(super) ends: [usize; 2],
    pub(super) door: Option<Doorway>,
}

impl Rooms {
    pub(super) fn furnish(floor: &Floor, nodes: usize, rng: &mut ChaCha8Rng) -> Self {
        let mut doors_of: Vec<Vec<(usize, [f64; 2])>> = vec![Vec::new(); floor.areas];
        for (index, door) in floor.doors.iter().enumerate() {
            let [one, other] = sides_m(floor, *door, rng);
            doors_of[door.one].push((index, one));
            doors_of[door.other].push((index, other));
        }
        let mut rooms = Self {
            nodes: Vec::with_capacity(nodes),
            arcs: Vec::new(),
        };
        let mut sides: Vec<Vec<usize>> = vec![Vec::new(); floor.doors.len()];
        let mut placed = 0;
        let mut arcs_due = 0;
        for (area, things) in things_per_area(&doors_of, nodes).into_iter().enumerate() {
            let first = rooms.nodes.len();
            let mut taken: Vec<[f64; 2]> = doors_of[area].iter().map(|(_, at)| *at).collect();
            for _ in 0..things {
                let position_m = free_spot(floor.corner_m(area), &taken, rng);
                taken.push(position_m);
                rooms.nodes.push(Spot {
                    area,
                    position_m,
                    what: What::Thing(kind_of_thing(placed)),
                });
                placed += 1;
            }
            for (index, position_m) in &doors_of[area] {
                sides[*index].push(rooms.nodes.len());
                let door = floor.doors[*index];
                let behind = if door.one == area {
                    door.other
                } else {
                    door.one
                };
                rooms.nodes.push(Spot {
                    area,
                    position_m: *position_m,
                    what: What::DoorTo(behind, door),
                });
            }
            arcs_due += (rooms.nodes.len() - first) * ARCS_IN_AREAS.0;
            let many = arcs_due / ARCS_IN_AREAS.1;
            let drawn = rooms.connect(first, many);
            arcs_due = arcs_due.saturating_sub(drawn * ARCS_IN_AREAS.1);
        }
        for (door, ends) in floor.doors.iter().zip(sides) {
            if let [one, other] = ends[..] {
                rooms.arcs.push(Arc {
                    ends: [one, other],
                    door: Some(*door),
                });
            }
        }
        rooms.arcs.sort_by_key(|arc| arc.ends);
        rooms
    }

    pub(super) fn length_m(&self, arc: Arc) -> f64 {
        let [one, other] = arc.ends.map(|end| self.nodes[end].position_m);
        distance_m(one, other)
    }

    /// Draws arcs among the nodes from `first` on: as many as it takes to get from each to each,
    /// then the shortest of the others until there are `many`. Says how many it drew.
    fn connect(&mut self, first: usize, many: usize) -> usize {
        let nodes = first..self.nodes.len();
        let mut pairs: Vec<[usize; 2]> = nodes
            .clone()
            .flat_map(|one| (one + 1..nodes.end).map(move |other| [one, other]))
            .collect();
        let length = |ends: &[usize; 2]| {
            self.length_m(Arc {
                ends: *ends,
                door: None,
            })
        };
        pairs.sort_by(|one, other| length(one).total_cmp(&length(other)).then(one.cmp(other)));
        let mut joined = petgraph::unionfind::UnionFind::new(nodes.len());
        let (needed, further): (Vec<_>, Vec<_>) = pairs
            .into_iter()
            .partition(|[one, other]| joined.union(one - first, other - first));
        let more = many.saturating_sub(needed.len());
        let drawn: Vec<_> = needed
            .into_iter()
            .chain(further.into_iter().take(more))
            .collect();
        let count = drawn.len();
        self.arcs
            .extend(drawn.into_iter().map(|ends| Arc { ends, door: None }));
        count
    }
}

/// Where the two sides of a door are, that of its first area first.
fn sides_m(floor: &Floor, door: Doorway, rng: &mut ChaCha8Rng) -> [[f64; 2]; 2] {
    let [west, south] = floor.corner_m(door.other);
    if floor.side_by_side(door) {
        let y = south + half_metres(rng, 3.0, DEPTH_M - 3.0);
        [[west - DOOR_SIDE_M, y], [west + DOOR_SIDE_M, y]]
    } else {
        let x = west + half_metres(rng, 3.0, WIDTH_M - 3.0);
        [[x, south - DOOR_SIDE_M], [x, south + DOOR_SIDE_M]]
    }
}

/// How many things stand in each area, beside the sides of its doors: such that all have about as
/// many nodes.
fn things_per_area(doors_of: &[Vec<(usize, [f64; 2])>], nodes: usize) -> Vec<usize> {
    let doors: usize = doors_of.iter().map(Vec::len).sum();
    let mut things = vec![0; doors_of.len()];
    let sizes = doors_of.iter().enumerate();
    let mut emptiest: BinaryHeap<Reverse<(usize, usize)>> = sizes
        .map(|(area, doors)| Reverse((doors.len(), area)))
        .collect();
    for _ in doors..nodes {
        if let Some(Reverse((size, area))) = emptiest.pop() {
            things[area] += 1;
            emptiest.push(Reverse((size + 1, area)));
        }
    }
    things
}

/// As often as in the paper's museum.
fn kind_of_thing(number: usize) -> &'static str {
    match number % 20 {
        0 if number == 0 => "entrance",
        2 => "info_desk",
        7 => "rest_area",
        12 => "toilet",
        17 => "shop",
        _ => "exhibit",
    }
}

fn free_spot(corner_m: [f64; 2], taken: &[[f64; 2]], rng: &mut ChaCha8Rng) -> [f64; 2] {
    let mut best = (f64::NEG_INFINITY, corner_m);
    for _ in 0..TRIES {
        let spot = [
            corner_m[0] + half_metres(rng, 2.0, WIDTH_M - 2.0),
            corner_m[1] + half_metres(rng, 2.0, DEPTH_M - 2.0),
        ];
        let nearest = taken.iter().map(|other| distance_m(spot, *other));
        let room = nearest.fold(f64::INFINITY, f64::min);
        if room > best.0 {
            best = (room, spot);
        }
    }
    best.1
}

/// Between `from` and `to`, on a grid of half metres.
fn half_metres(rng: &mut ChaCha8Rng, from: f64, to: f64) -> f64 {
    let steps = ((to - from) * 2.0) as u32;
    from + f64::from(rng.random_range(0..=steps)) / 2.0
}

fn distance_m(one: [f64; 2], other: [f64; 2]) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}
