//! What a map is made of.

use agent_core::model::Symbol;

/// A point where the robot knows where it is: an intersection, an exhibit, one side of a door.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub(super) id: u32,
    pub(super) name: Symbol,
    pub(super) area: Symbol,
    pub(super) kind: Option<String>,
    pub(super) label: Option<String>,
    pub(super) position_m: [f64; 2],
}

impl Node {
    /// The number that Nav2 knows it by.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// Its name, as the domains have it.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// The area it lies in.
    pub fn area(&self) -> &Symbol {
        &self.area
    }

    /// What is there, in one word of the drawer's choice: `exhibit`, `toilet`.
    pub fn kind(&self) -> Option<&str> {
        self.kind.as_deref()
    }

    /// What people call it; the name if nobody gave it a better one.
    pub fn label(&self) -> &str {
        self.label.as_deref().unwrap_or(self.name.as_str())
    }

    /// East and north of the map's origin.
    pub fn position_m(&self) -> [f64; 2] {
        self.position_m
    }
}

/// A way between two nodes, to be taken in both directions unless it is one-way. The paper calls
/// it an arc.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    pub(super) name: Symbol,
    pub(super) ends: [Symbol; 2],
    pub(super) length_mm: u64,
    pub(super) door: Option<Symbol>,
    pub(super) one_way: bool,
}

impl Passage {
    /// Its name, as the domains have it: `arc5`.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// The nodes at its ends. A one-way passage leads from the first to the second.
    pub fn ends(&self) -> [&Symbol; 2] {
        [&self.ends[0], &self.ends[1]]
    }

    /// From end to end, to the millimetre. At least the straight line between the ends, give or
    /// take a centimetre.
    pub fn length_m(&self) -> f64 {
        metres(self.length_mm)
    }

    pub(crate) fn length_mm(&self) -> u64 {
        self.length_mm
    }

    /// The door in it, if it joins two areas.
    pub fn door(&self) -> Option<&Symbol> {
        self.door.as_ref()
    }

    /// Whether it can be taken from its first end only.
    pub fn is_one_way(&self) -> bool {
        self.one_way
    }

    /// The directions in which it can be taken: one, or both.
    pub fn directions(&self) -> impl Iterator<Item = (&Symbol, &Symbol)> {
        let [from, to] = self.ends();
        std::iter::once((from, to)).chain((!self.one_way).then_some((to, from)))
    }

    /// The end that is not `node`. `None` if `node` is neither.
    pub fn other_end(&self, node: &str) -> Option<&Symbol> {
        let [one, other] = self.ends();
        if one.as_str() == node {
            Some(other)
        } else if other.as_str() == node {
            Some(one)
        } else {
            None
        }
    }
}

/// A door between two areas.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Door {
    pub(super) name: Symbol,
    pub(super) joins: [Symbol; 2],
    pub(super) open: bool,
}

impl Door {
    /// Its name.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// The two areas that it joins.
    pub fn joins(&self) -> [&Symbol; 2] {
        [&self.joins[0], &self.joins[1]]
    }

    /// Whether it stands open when the world begins.
    pub fn is_open_at_first(&self) -> bool {
        self.open
    }
}

/// A part of the place that the rough level does not look into.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    pub(super) name: Symbol,
    pub(super) nodes: Vec<Symbol>,
    pub(super) rectangle_m: Option<[f64; 4]>,
}

impl Area {
    /// Its name.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// Its nodes, in the order of their ids; at least one.
    pub fn nodes(&self) -> impl Iterator<Item = &Symbol> {
        self.nodes.iter()
    }

    /// West, south, east and north, for drawings. `None` if the map does not say.
    pub fn rectangle_m(&self) -> Option<[f64; 4]> {
        self.rectangle_m
    }
}

/// Lengths are added up as whole millimetres, so that a sum does not depend on the order of its
/// terms and an estimate is never above the cost that it estimates.
pub(crate) fn metres(length_mm: u64) -> f64 {
    // Exact below 2^53 mm, which is further than the moon.
    length_mm as f64 / 1000.0
}
