//! What users and scenarios do to a room, as facts.

use agent_core::model::{Fact, FactChange, Symbol};

use super::things::{Spot, Things, Whereabouts};

/// Follows what somebody says is so now. What makes no sense changes nothing.
///
/// | fact | what happens |
/// | --- | --- |
/// | `(not (stands B P))`, `(not (edge B P))` | somebody takes the bottle away from there |
/// | `(not (holding B))`, `(not (loaded B S))`, `(not (with B V))` | … out of a hand, off a tray |
/// | `(stands B P)`, `(edge B P)` | … puts it there, if no vehicle has it |
/// | `(used B)`, `(not (used B))` | … empties it, fills it |
/// | `(spill P)`, `(blocked P)`, or `not` | … spills something, puts something in the way; takes it away |
/// | `(arrived G)`, `(seated G T)`, `(gone G)` | a guest comes, sits down, goes |
/// | `(not (seated G T))` | the guest who sits there goes |
/// | `(wants G K)` | the guest will say so when asked |
pub(super) fn follow(things: &mut Things, change: &FactChange) {
    let (fact, so) = match change {
        FactChange::Add(fact) => (fact, true),
        FactChange::Remove(fact) => (fact, false),
        FactChange::Set(..) => return,
    };
    if let ("arrived" | "seated" | "gone", [guest, ..]) = (fact.name.as_str(), fact.args.as_slice())
        && let Some(guest) = things.guests.get_mut(guest)
    {
        // Whoever says so decides from now on.
        guest.plans.clear();
    }
    match (fact.name.as_str(), fact.args.as_slice()) {
        ("stands" | "edge", [bottle, place]) => stand(things, fact, bottle, place, so),
        ("holding", [bottle]) if !so => {
            take(things, bottle, |spot| matches!(spot, Spot::Hand { .. }))
        }
        ("loaded", [bottle, place]) if !so => take(
            things,
            bottle,
            |spot| matches!(spot, Spot::Slot { slot, .. } if slot == place),
        ),
        ("with", [bottle, whose]) if !so => take(
            things,
            bottle,
            |spot| matches!(spot, Spot::Hand { vehicle } | Spot::Slot { vehicle, .. } if vehicle == whose),
        ),
        ("used", [bottle]) => {
            if let Some(bottle) = things.bottles.get_mut(bottle) {
                bottle.used = so;
                things.version += 1;
            }
        }
        ("spill", [place]) => {
            if so && things.is_place(place) {
                things.spills.insert(place.clone());
            } else if !so {
                things.spills.remove(place);
            }
            things.version += 1;
        }
        ("blocked", [place]) => {
            if so && things.is_place(place) {
                things.blocked.insert(place.clone());
            } else if !so {
                things.blocked.remove(place);
            }
            things.version += 1;
        }
        ("arrived", [guest]) if so => things.move_guest(guest, Whereabouts::Entrance),
        ("seated", [guest, table]) if so && things.is_place(table) => {
            let table = table.clone();
            things.move_guest(guest, Whereabouts::Seated { table });
        }
        ("seated", [guest, table]) if !so => {
            let known = things.guests.get(guest).map(|guest| &guest.whereabouts);
            let table = table.clone();
            if known == Some(&Whereabouts::Seated { table }) {
                things.move_guest(guest, Whereabouts::Gone);
            }
        }
        ("gone", [guest]) if so => things.move_guest(guest, Whereabouts::Gone),
        ("wants", [guest, kind]) if so => {
            if let Some(guest) = things.guests.get_mut(guest) {
                guest.wants = kind.clone();
            }
        }
        _ => {}
    }
}

/// What the things in a fact are that the room takes notice of when users say it. `None` if it takes none,
/// whatever they are: what vehicles do nobody else can do for them.
pub fn about(change: &FactChange) -> Option<&'static [&'static str]> {
    let (fact, so) = match change {
        FactChange::Add(fact) => (fact, true),
        FactChange::Remove(fact) => (fact, false),
        FactChange::Set(..) => return None,
    };
    Some(match (fact.name.as_str(), so) {
        ("stands" | "edge", _) => &["bottle", "node"],
        ("holding", false) | ("used", _) => &["bottle"],
        ("loaded", false) => &["bottle", "slot"],
        ("with", false) => &["bottle", "vehicle"],
        ("spill" | "blocked", _) => &["node"],
        ("arrived" | "gone", true) => &["guest"],
        ("seated", _) => &["guest", "node"],
        ("wants", true) => &["guest", "kind"],
        _ => return None,
    })
}

fn stand(things: &mut Things, fact: &Fact, bottle: &Symbol, place: &Symbol, so: bool) {
    let node = place.clone();
    let there = if fact.name == "stands" {
        Spot::Proper { node }
    } else {
        Spot::Edge { node }
    };
    if !so {
        take(things, bottle, |spot| *spot == there);
    } else if things.is_place(place) {
        let known = things.bottles.get(bottle).map(|bottle| &bottle.spot);
        if let Some(Spot::Proper { .. } | Spot::Edge { .. } | Spot::Away) = known {
            things.put(bottle, there);
        }
    }
}

fn take(things: &mut Things, bottle: &Symbol, there: impl Fn(&Spot) -> bool) {
    let known = things.bottles.get(bottle);
    if known.is_some_and(|bottle| there(&bottle.spot)) {
        things.put(bottle, Spot::Away);
    }
}
