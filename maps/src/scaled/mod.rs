//! Museums of any size, made up from a seed: for benchmarks, and to try what a map of one's own
//! size would be like.
//!
//! What is counted in the paper's museum (`maps/museum`) stays in proportion: five nodes, one and a
//! quarter doors and eight arcs an area, areas of 16 m by 12 m in a grid, one door in ten closed.

mod floor;
mod room;
#[cfg(test)]
mod tests;
mod write;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use floor::Floor;
use room::Rooms;

/// The most nodes that a museum can be made of.
pub const MOST_NODES: u32 = 1_000_000;

/// The map of a museum with that many nodes (at least one, at most [`MOST_NODES`]), in the format of
/// `maps/README.md`. The same number and seed make the same text.
///
/// All areas can be reached from each other through the doors that are open at first; the closed ones
/// are further ways. The robot starts best at `n1`, the entrance.
pub fn scaled_map(nodes: u32, seed: u64) -> String {
    let nodes = nodes.clamp(1, MOST_NODES) as usize;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let floor = Floor::draw(nodes, &mut rng);
    let rooms = Rooms::furnish(&floor, nodes, &mut rng);
    let name = format!("museum of {nodes} nodes, seed {seed}");
    write::write(&name, &floor, &rooms)
}
