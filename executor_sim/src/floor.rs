//! The floor plan, as far as a robot and its world need one.

use std::collections::BTreeMap;

use agent_core::model::Symbol;
use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::Place;

/// Nodes, the passages between them, and doors.
///
/// Every name in here leads somewhere: [`Floor::new`] has checked it, and nothing changes later.
/// Whether a door is open *now* is the [`World`](crate::World)'s; here it is how the day begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    nodes: BTreeMap<Symbol, Point2<f64>>,
    arcs: BTreeMap<Symbol, Passage>,
    doors: BTreeMap<Symbol, bool>,
}

/// A way between two nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Passage {
    /// Both ends. Offsets along the passage count from the first.
    pub ends: [Symbol; 2],
    /// How long it is to drive, in metres: more than the straight line if it is curved.
    pub length_m: f64,
    /// A door in the middle of it.
    pub door: Option<Symbol>,
}

impl Passage {
    /// How far from the first end `node` lies; `None` if it is no end of this passage.
    pub fn offset_of(&self, node: &Symbol) -> Option<f64> {
        if *node == self.ends[0] {
            Some(0.0)
        } else if *node == self.ends[1] {
            Some(self.length_m)
        } else {
            None
        }
    }

    /// Whether the door, where there is one, lies between the two offsets.
    ///
    /// Whoever stands exactly under it has it on neither side and may leave both ways.
    pub fn door_lies_between(&self, here_m: f64, there_m: f64) -> bool {
        let door_m = self.length_m / 2.0;
        self.door.is_some() && (door_m - here_m) * (there_m - door_m) > 0.0
    }
}

/// Why a floor plan was refused.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum FloorError {
    /// An arc that leads nowhere.
    #[error("arc `{arc}` ends at `{node}`, which is not a node")]
    UnknownNode {
        /// The arc.
        arc: Symbol,
        /// Its end.
        node: Symbol,
    },
    /// An arc with a door that nobody has put there.
    #[error("arc `{arc}` leads through `{door}`, which is not a door")]
    UnknownDoor {
        /// The arc.
        arc: Symbol,
        /// Its door.
        door: Symbol,
    },
    /// On such an arc nobody could say which way is forward.
    #[error("arc `{0}` begins and ends at the same node")]
    Loop(Symbol),
    /// Not a number, or nothing to drive.
    #[error("arc `{0}` has no length")]
    NoLength(Symbol),
}

impl Floor {
    /// Checks that every name leads somewhere.
    pub fn new(
        nodes: BTreeMap<Symbol, [f64; 2]>,
        arcs: BTreeMap<Symbol, Passage>,
        doors: BTreeMap<Symbol, bool>,
    ) -> Result<Self, FloorError> {
        for (arc, passage) in &arcs {
            if let Some(node) = passage.ends.iter().find(|node| !nodes.contains_key(*node)) {
                return Err(FloorError::UnknownNode {
                    arc: arc.clone(),
                    node: node.clone(),
                });
            }
            if let Some(door) = passage.door.iter().find(|door| !doors.contains_key(*door)) {
                return Err(FloorError::UnknownDoor {
                    arc: arc.clone(),
                    door: door.clone(),
                });
            }
            if passage.ends[0] == passage.ends[1] {
                return Err(FloorError::Loop(arc.clone()));
            }
            if !passage.length_m.is_finite() || passage.length_m <= 0.0 {
                return Err(FloorError::NoLength(arc.clone()));
            }
        }
        let nodes = nodes
            .into_iter()
            .map(|(node, [x_m, y_m])| (node, Point2::new(x_m, y_m)))
            .collect();
        Ok(Self { nodes, arcs, doors })
    }

    /// The passage of that name.
    pub fn passage(&self, arc: &Symbol) -> Option<&Passage> {
        self.arcs.get(arc)
    }

    /// All passages, by name.
    pub fn passages(&self) -> impl Iterator<Item = (&Symbol, &Passage)> {
        self.arcs.iter()
    }

    /// All nodes, by name.
    pub fn nodes(&self) -> impl Iterator<Item = (&Symbol, Point2<f64>)> {
        self.nodes.iter().map(|(node, point)| (node, *point))
    }

    /// All doors and whether they are open at the beginning.
    pub fn doors(&self) -> &BTreeMap<Symbol, bool> {
        &self.doors
    }

    /// Whether there is such a place.
    pub fn has(&self, place: &Place) -> bool {
        match place {
            Place::Node { node } => self.nodes.contains_key(node),
            Place::Arc {
                arc,
                offset_m,
                left,
            } => self.passage(arc).is_some_and(|passage| {
                passage.ends.contains(left) && *offset_m > 0.0 && *offset_m < passage.length_m
            }),
        }
    }

    /// How far along `arc` that place is; `None` if it is neither on the arc nor at an end of it.
    pub fn offset_on(&self, arc: &Symbol, place: &Place) -> Option<f64> {
        match place {
            Place::Node { node } => self.passage(arc)?.offset_of(node),
            Place::Arc {
                arc: on, offset_m, ..
            } => (on == arc).then_some(*offset_m),
        }
    }

    /// Where that place is on the plan. On a curved arc this is a point of the straight line.
    pub fn point(&self, place: &Place) -> Option<Point2<f64>> {
        match place {
            Place::Node { node } => self.nodes.get(node).copied(),
            Place::Arc { arc, offset_m, .. } => {
                let passage = self.passage(arc)?;
                let [first, second] = &passage.ends;
                let (first, second) = (self.nodes.get(first)?, self.nodes.get(second)?);
                Some(first + (second - first) * (offset_m / passage.length_m))
            }
        }
    }

    /// The direction of `arc` towards its end `to`, in radians from the x axis.
    pub fn heading_rad(&self, arc: &Symbol, to: &Symbol) -> Option<f64> {
        let passage = self.passage(arc)?;
        let from = passage.ends.iter().find(|end| *end != to)?;
        let way = self.nodes.get(to)? - self.nodes.get(from)?;
        // Two nodes drawn on one spot give no direction; any will do.
        Some(way.y.atan2(way.x))
    }
}

impl TryFrom<&maps::Site> for Floor {
    type Error = FloorError;

    /// The map, as far as a robot needs it. A one-way passage can be driven both ways: to keep to
    /// the direction is planning's business, and backing out of a passage that of safety.
    fn try_from(site: &maps::Site) -> Result<Self, FloorError> {
        let nodes = site
            .nodes()
            .map(|node| (node.name().clone(), node.position_m()));
        let arcs = site.passages().map(|passage| {
            let arc = Passage {
                ends: passage.ends().map(Symbol::clone),
                length_m: passage.length_m(),
                door: passage.door().cloned(),
            };
            (passage.name().clone(), arc)
        });
        let doors = site
            .doors()
            .map(|door| (door.name().clone(), door.is_open_at_first()));
        Self::new(nodes.collect(), arcs.collect(), doors.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_museum_is_a_floor() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../maps/museum/map.geojson");
        let site = maps::Site::read(path).expect("the museum");
        let floor = Floor::try_from(&site).expect("every name leads somewhere");
        let arc5 = floor.passage(&"arc5".into()).expect("n1 to n6");
        assert!(arc5.ends.contains(&"n1".into()) && arc5.ends.contains(&"n6".into()));
        assert_eq!(floor.nodes().count(), site.nodes().count());
        // Nothing is drawn so crookedly that a body would jump.
        for (arc, passage) in floor.passages() {
            let ends = passage.ends.clone().map(|node| Place::Node { node });
            let [Some(first), Some(second)] = [floor.point(&ends[0]), floor.point(&ends[1])] else {
                unreachable!("both ends of {arc} are nodes");
            };
            assert!((second - first).norm() <= passage.length_m + 0.011, "{arc}");
        }
    }

    #[test]
    fn a_floor_with_a_name_that_leads_nowhere_is_refused() {
        let refused = |ends: [&str; 2], length_m, door: Option<&str>| {
            let passage = Passage {
                ends: ends.map(Symbol::from),
                length_m,
                door: door.map(Symbol::from),
            };
            Floor::new(
                BTreeMap::from([("a".into(), [0.0, 0.0]), ("b".into(), [1.0, 0.0])]),
                BTreeMap::from([("ab".into(), passage)]),
                BTreeMap::new(),
            )
            .err()
            .map(|error| error.to_string())
        };
        assert_eq!(refused(["a", "b"], 1.0, None), None);
        let words = |error: &str| Some(error.to_owned());
        assert_eq!(
            refused(["a", "c"], 1.0, None),
            words("arc `ab` ends at `c`, which is not a node")
        );
        assert_eq!(
            refused(["a", "b"], 1.0, Some("d")),
            words("arc `ab` leads through `d`, which is not a door")
        );
        assert_eq!(
            refused(["a", "a"], 1.0, None),
            words("arc `ab` begins and ends at the same node")
        );
        assert_eq!(
            refused(["a", "b"], 0.0, None),
            words("arc `ab` has no length")
        );
    }
}
