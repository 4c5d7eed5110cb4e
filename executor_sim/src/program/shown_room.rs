//! A room that can be looked at.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{
    ActionId, Durable, Input, Machine, Output, Reply, Row, Rows, Unreadable,
};
use agent_link::{Clock, Inspect};
use serde_json::{Map, Value, json};

use crate::{Mover, Room};

/// How many of the latest things that were done are shown with every snapshot. All that are kept are
/// in the view `stack`.
const SHOWN: usize = 16;

/// What is seen is published, and may overtake a report that is sent again until it is acknowledged: then
/// what the report says is older, and is believed last. So long after the last report everything is said
/// once more, in seconds of everybody.
const OVERTAKEN_S: f64 = 2.0;

/// A [`Room`] and the clock that says where in its motions it is: the room itself has none, and
/// between two events everything in it is a formula of the time.
pub struct ShownRoom {
    room: Room,
    clock: Clock,
    /// Something has happened since that was asked last.
    changed: AtomicBool,
    /// When vehicles are told once more what they know.
    again: BTreeMap<Symbol, Time>,
}

impl ShownRoom {
    /// A room that is shown as it is by this clock.
    pub fn new(room: Room, clock: Clock) -> Self {
        Self {
            room,
            clock,
            changed: AtomicBool::new(true),
            again: BTreeMap::new(),
        }
    }

    fn tell_again(&mut self, now: Time) {
        let due = self.again.iter().filter(|(_, at)| **at <= now);
        let due: Vec<Symbol> = due.map(|(vehicle, _)| vehicle.clone()).collect();
        for vehicle in due {
            self.again.remove(&vehicle);
            self.room.tell_everything(&vehicle);
        }
    }

    fn things(&self) -> (Value, Value) {
        let things = self.room.things();
        let bottles: Map<String, Value> = things
            .bottles()
            .map(|(name, bottle)| {
                let shown = json!({
                    "kind": bottle.kind,
                    "where": bottle.spot.to_string(),
                    "spot": bottle.spot,
                    "gripped_by": bottle.gripped_by,
                    "given_to": bottle.given_to,
                    "used": bottle.used,
                });
                (name.to_string(), shown)
            })
            .collect();
        let guests: Map<String, Value> = things
            .guests()
            .map(|(name, guest)| {
                let shown = json!({
                    "table": guest.table,
                    "wants": guest.wants,
                    "where": guest.whereabouts.to_string(),
                    "served": guest.served,
                });
                (name.to_string(), shown)
            })
            .collect();
        (Value::Object(bottles), Value::Object(guests))
    }

    fn vehicle(&self, mover: &Mover, now: Time) -> Value {
        let things = self.room.things();
        let place = mover.place(now);
        let tray: Map<String, Value> = mover
            .slots()
            .iter()
            .map(|slot| (slot.to_string(), json!(things.in_slot(mover.name(), slot))))
            .collect();
        let doing: Map<String, Value> = mover
            .doing()
            .map(|(part, action, stopping)| {
                let shown = json!({ "action": action.to_string(), "stopping": stopping });
                (part.to_string(), shown)
            })
            .collect();
        let mut shown = json!({
            "where": place.to_string(),
            "place": place,
            "hand": things.in_hand(mover.name()),
            "has_arm": mover.has_arm(),
            "tray": tray,
            "parts": doing,
            "suspended": mover.suspended(),
            "driven_by_nobody": mover.is_gone(),
        });
        if let (Some(base), Some(shown)) = (mover.base(), shown.as_object_mut()) {
            let pose = base.world().pose(now);
            let (motion, since) = base.world().motion();
            shown.insert("position_m".to_owned(), json!(pose.position_m));
            shown.insert("heading_rad".to_owned(), json!(pose.heading_rad));
            shown.insert("speed_m_s".to_owned(), json!(pose.speed_m_s));
            shown.insert("motion".to_owned(), json!(motion));
            shown.insert("motion_since_t_s".to_owned(), json!(since.secs()));
            let odometer_m = base.world().odometer_m(now);
            shown.insert("odometer_m".to_owned(), json!(odometer_m));
        }
        shown
    }
}

impl Durable for ShownRoom {
    fn write_down(&mut self) -> Vec<Row> {
        self.room.write_down()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.room.recall(rows)
    }

    fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.room.is_suspended(superior, id)
    }
}

impl Machine for ShownRoom {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, now: Time, input: Input<Infallible>) -> Option<Reply> {
        let reply = self.room.handle(now, input);
        self.tell_again(now);
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        let output = self.room.poll_output();
        if output.is_some() {
            self.changed.store(true, Ordering::Relaxed);
        }
        if let Some(Output::Report { to, .. }) = &output {
            let later = Time::from_secs(OVERTAKEN_S * self.clock.speed());
            self.again.insert(to.clone(), self.clock.now() + later);
        }
        output
    }

    fn wake_at(&self) -> Option<Time> {
        let again = self.again.values().copied();
        again.chain(self.room.wake_at()).min()
    }

    fn wind_down(&mut self, now: Time) {
        self.room.wind_down(now);
    }

    fn rests(&self) -> bool {
        self.room.rests()
    }
}

impl Inspect for ShownRoom {
    fn is_worth_showing(&self) -> bool {
        self.changed.swap(false, Ordering::Relaxed)
    }

    fn status(&self) -> Value {
        let now = self.clock.now();
        let vehicles: Map<String, Value> = self
            .room
            .movers()
            .map(|mover| (mover.name().to_string(), self.vehicle(mover, now)))
            .collect();
        let (bottles, guests) = self.things();
        let things = self.room.things();
        json!({
            "t_s": now.secs(),
            "speed": self.clock.speed(),
            "vehicles": vehicles,
            "bottles": bottles,
            "guests": guests,
            "spills": things.spills().collect::<Vec<_>>(),
            "blocked": things.blocked().collect::<Vec<_>>(),
            "done_count": self.room.done_count(),
            "done": self.room.done().rev().take(SHOWN).rev().collect::<Vec<_>>(),
        })
    }

    fn belief(&self) -> Value {
        let (bottles, guests) = self.things();
        let names: BTreeMap<_, _> = self.room.names().into_iter().collect();
        json!({ "bottles": bottles, "guests": guests, "names": names })
    }

    fn stack(&self) -> Value {
        json!(self.room.done().collect::<Vec<_>>())
    }
}
