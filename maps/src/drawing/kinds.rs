//! What is at a node, told by colour.

use std::collections::BTreeMap;

use crate::Site;

/// What it looks like where there is something of a kind.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) colour: &'static str,
    /// Times the usual radius.
    pub(super) size: f64,
    /// Its label goes first where there is no room for all: the less, the sooner.
    pub(super) rank: u8,
}

const PLAIN: Look = Look {
    colour: "#6c7a89",
    size: 0.8,
    rank: 4,
};

/// Kinds that are known from museums, offices and fleets.
const KNOWN: [(&str, Look); 14] = [
    ("charger", look("#1f9d55", 1.2, 1)),
    ("dock", look("#12888a", 1.1, 2)),
    ("door_side", look("#95a1ad", 0.7, 5)),
    ("dropoff", look("#c2410c", 1.1, 2)),
    ("entrance", look("#15803d", 1.3, 0)),
    ("exhibit", look("#3b6fb6", 1.0, 3)),
    ("holding", look("#7c8794", 0.9, 3)),
    ("info_desk", look("#0e7490", 1.2, 1)),
    ("lift", look("#4c1d95", 1.2, 1)),
    ("parking", look("#2563eb", 1.1, 2)),
    ("pickup", look("#b45309", 1.1, 2)),
    ("rest_area", look("#a16207", 1.1, 1)),
    ("shop", look("#be185d", 1.2, 1)),
    ("toilet", look("#7c3aed", 1.3, 0)),
];

/// For kinds that nobody has thought of, in turn.
const FURTHER: [&str; 6] = [
    "#9f1239", "#4d7c0f", "#1d4ed8", "#86198f", "#0f766e", "#9a3412",
];

const fn look(colour: &'static str, size: f64, rank: u8) -> Look {
    Look { colour, size, rank }
}

/// The kinds of a place: how each looks, and how many there are.
pub(super) struct Kinds<'a>(BTreeMap<&'a str, (Look, usize)>);

impl<'a> Kinds<'a> {
    pub(super) fn of(site: &'a Site) -> Self {
        let mut kinds: BTreeMap<&str, (Look, usize)> = BTreeMap::new();
        for kind in site.nodes().filter_map(crate::Node::kind) {
            kinds.entry(kind).or_insert((PLAIN, 0)).1 += 1;
        }
        let mut further = FURTHER.iter().cycle();
        for (kind, (look, _)) in &mut kinds {
            *look = match KNOWN.iter().find(|(known, _)| known == kind) {
                Some((_, known)) => *known,
                None => Look {
                    colour: further.next().unwrap_or(&"#000"),
                    size: 1.0,
                    rank: 2,
                },
            };
        }
        Self(kinds)
    }

    /// How a node of that kind looks.
    pub(super) fn look(&self, kind: Option<&str>) -> Look {
        kind.and_then(|kind| self.0.get(kind))
            .map_or(PLAIN, |(look, _)| *look)
    }

    /// Each kind, how it looks and how often it occurs.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&'a str, Look, usize)> {
        self.0
            .iter()
            .map(|(kind, (look, count))| (*kind, *look, *count))
    }
}
