//! What a room writes down, and how it comes back from that.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{ActionId, Durable, Ledger, Row, Rows, Unreadable, read_row, read_rows};
use serde::{Deserialize, Serialize};

use super::Room;
use super::chronicle::Deed;
use super::things::{Bottle, Guest, Spot};

const NOW: &str = "m/room/now";
const BOTTLE: &str = "m/room/bottle/";
const GUEST: &str = "m/room/guest/";
const PLACES: &str = "m/room/places";
const COUNT: &str = "m/room/count";
const DEED: &str = "m/room/deed/";
const WAYS: &str = "m/room/ways/";

/// Where something was spilt, and where nobody can drive.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Places {
    spills: BTreeSet<Symbol>,
    blocked: BTreeSet<Symbol>,
}

/// Everything is written down: bodies, parts, things, and what was done. What was under way when a
/// room's process ends has come to nothing when it starts again: a base stands where it was seen last,
/// and a bottle that was half lifted stands at the edge.
impl Durable for Room {
    fn write_down(&mut self) -> Vec<Row> {
        let mut rows = Vec::new();
        for (name, mover) in &mut self.movers {
            if let Some(base) = &mut mover.base {
                move_to(&mut rows, base.write_down(), &format!("{name}/base"));
                let world = base.write_down_world();
                move_to(&mut rows, world, &format!("{name}/body"));
            }
            for (part, doing) in &mut mover.parts {
                move_to(&mut rows, doing.write_down(), &format!("{name}/{part}"));
            }
        }
        let ledger = &mut self.ledger;
        ledger.put(NOW.to_owned(), &self.now);
        for (name, bottle) in &self.things.bottles {
            ledger.put(format!("{BOTTLE}{name}"), bottle);
        }
        for (name, guest) in &self.things.guests {
            ledger.put(format!("{GUEST}{name}"), guest);
        }
        let places = Places {
            spills: self.things.spills.clone(),
            blocked: self.things.blocked.clone(),
        };
        ledger.put(PLACES.to_owned(), &places);
        ledger.put(COUNT.to_owned(), &self.chronicle.count);
        let mut keys = BTreeSet::new();
        for deed in &self.chronicle.kept {
            let key = format!("{DEED}{:020}", deed.number);
            if !ledger.has(&key) {
                ledger.put(key.clone(), deed);
            }
            keys.insert(key);
        }
        ledger.keep_only(DEED, &keys);
        for (name, mover) in &self.movers {
            ledger.put(format!("{WAYS}{name}"), &mover.ways);
        }
        rows.append(&mut ledger.take());
        rows
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        let Some(now) = read_row::<Time>(rows, NOW)? else {
            return Ok(());
        };
        let mut known = BTreeSet::new();
        for row in read_rows::<Bottle>(rows, BOTTLE) {
            let (name, bottle) = row?;
            let key = format!("{BOTTLE}{name}");
            self.fits(&key, &bottle)?;
            known.insert(Symbol::from(name));
            match self.things.bottles.get_mut(&Symbol::from(name)) {
                Some(place) => *place = bottle,
                None => return Err(Unreadable::new(key, "there is no such bottle here")),
            }
        }
        if known.len() != self.things.bottles.len() {
            return Err(Unreadable::new(
                BOTTLE,
                "these are not the bottles that are here",
            ));
        }
        for row in read_rows::<Guest>(rows, GUEST) {
            let (name, guest) = row?;
            match self.things.guests.get_mut(&Symbol::from(name)) {
                Some(place) => *place = guest,
                None => {
                    let key = format!("{GUEST}{name}");
                    return Err(Unreadable::new(key, "there is no such guest here"));
                }
            }
        }
        let places: Places = read_row(rows, PLACES)?.unwrap_or_default();
        (self.things.spills, self.things.blocked) = (places.spills, places.blocked);
        self.chronicle.count = read_row(rows, COUNT)?.unwrap_or_default();
        self.chronicle.kept = read_rows::<Deed>(rows, DEED)
            .map(|row| row.map(|(_, deed)| deed))
            .collect::<Result<_, _>>()?;
        self.now = now;
        for (name, mover) in &mut self.movers {
            let ways: Option<BTreeMap<ActionId, Symbol>> =
                read_row(rows, &format!("{WAYS}{name}"))?;
            mover.ways = ways.unwrap_or_default();
            if let Some(base) = &mut mover.base {
                base.recall_world(&own(rows, &format!("{name}/body")))?;
                base.recall(&own(rows, &format!("{name}/base")))?;
            }
            for (part, doing) in &mut mover.parts {
                doing.recall(&own(rows, &format!("{name}/{part}")))?;
            }
        }
        self.ledger = Ledger::of(rows, "m/room/");
        self.outputs.clear();
        self.things.version += 1;
        self.settle();
        self.after();
        Ok(())
    }

    fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.movers.get(superior).is_some_and(|mover| {
            let mut parts = mover.parts.values();
            let base = mover.base.as_ref();
            parts.any(|part| part.is_suspended(id))
                || base.is_some_and(|base| base.is_suspended(superior, id))
        })
    }
}

impl Room {
    fn fits(&self, key: &str, bottle: &Bottle) -> Result<(), Unreadable> {
        let there = match &bottle.spot {
            Spot::Proper { node } | Spot::Edge { node } => self.things.is_place(node),
            Spot::Hand { vehicle } => self.movers.contains_key(vehicle),
            Spot::Slot { vehicle, slot } => {
                let mover = self.movers.get(vehicle);
                mover.is_some_and(|mover| mover.slots.contains(slot))
            }
            Spot::Away => true,
        };
        if there {
            return Ok(());
        }
        let reason = format!("it is {}, and there is no such thing here", bottle.spot);
        Err(Unreadable::new(key, reason))
    }
}

/// Rows of a part of the room, under a name of their own.
fn move_to(rows: &mut Vec<Row>, own: Vec<Row>, name: &str) {
    rows.extend(own.into_iter().map(|row| Row {
        key: format!("m/of/{name}/{}", row.key),
        value: row.value,
    }));
}

/// The rows under that name, as they were.
fn own(rows: &Rows, name: &str) -> Rows {
    let prefix = format!("m/of/{name}/");
    let under = rows.range(prefix.clone()..);
    let under = under.map_while(|(key, value)| Some((key.strip_prefix(&prefix)?, value)));
    under
        .map(|(key, value)| (key.to_owned(), value.clone()))
        .collect()
}
