//! Reality goes on where it was when its process is started again.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Durable, Ledger, Row, Rows, Unreadable, read_row, read_rows};
use serde::{Deserialize, Serialize};

use super::World;
use super::body::Body;
use super::done::{Done, Head};
use crate::{MotorCommand, Place};

const BODY: &str = "m/body";
const DOORS: &str = "m/doors";
const HEAD: &str = "m/head";
const DONE: &str = "m/done/";

/// The body as somebody saw it who looked at that moment.
#[derive(Debug, Serialize, Deserialize)]
struct Snapshot {
    at: Time,
    place: Place,
    heading_rad: f64,
    odometer_m: f64,
}

/// What stands, and what was done. What was under way when a world's process ends has come to
/// nothing when it starts again: the robot stands where it was seen last, and is silent.
impl Durable for World {
    fn write_down(&mut self) -> Vec<Row> {
        let seen = self.body.seen(&self.floor, self.now);
        let snapshot = Snapshot {
            at: self.now,
            heading_rad: seen.isometry.rotation.angle(),
            odometer_m: seen.odometer_m,
            place: seen.place,
        };
        let ledger = &mut self.ledger;
        ledger.put(BODY.to_owned(), &snapshot);
        if !std::mem::replace(&mut self.doors_are_written, true) {
            ledger.put(DOORS.to_owned(), &self.doors);
        }
        ledger.put(HEAD.to_owned(), &self.chronicle.head);
        let mut keys = BTreeSet::new();
        for done in &self.chronicle.kept {
            let key = format!("{DONE}{:020}", done.number);
            if !ledger.has(&key) {
                ledger.put(key.clone(), done);
            }
            keys.insert(key);
        }
        ledger.keep_only(DONE, &keys);
        ledger.take()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        let Some(snapshot) = read_row::<Snapshot>(rows, BODY)? else {
            return Ok(());
        };
        if !self.floor.has(&snapshot.place) {
            let reason = format!("the floor plan has no such place: {}", snapshot.place);
            return Err(Unreadable::new(BODY, reason));
        }
        if !(snapshot.heading_rad.is_finite() && snapshot.odometer_m.is_finite()) {
            return Err(Unreadable::new(BODY, "it has numbers that are none"));
        }
        let doors: BTreeMap<Symbol, bool> = read_row(rows, DOORS)?.unwrap_or_default();
        if !doors.keys().eq(self.doors.keys()) {
            return Err(Unreadable::new(
                DOORS,
                "these are not the doors of the floor plan",
            ));
        }
        let head: Head = read_row(rows, HEAD)?.unwrap_or_default();
        self.chronicle.head = head;
        self.chronicle.kept = read_rows::<Done>(rows, DONE)
            .map(|row| row.map(|(_, done)| done))
            .collect::<Result<_, _>>()?;
        self.now = snapshot.at;
        self.body = Body::new(snapshot.place, snapshot.heading_rad, snapshot.odometer_m);
        self.doors = doors;
        self.doors_are_written = false;
        self.ledger = Ledger::of(rows, "m/");
        self.outputs.clear();
        self.tell_pose(self.now);
        Ok(())
    }

    fn is_stop(_: &crate::Sensor) -> bool {
        // The world tells what is so, and waits for nobody's disk.
        true
    }
}

impl World {
    /// Whether that is a repetition: a number is used once, and they come in order.
    pub(super) fn has_heard(&mut self, command: &MotorCommand) -> bool {
        let (MotorCommand::Drive { ticket, .. }
        | MotorCommand::Speak { ticket, .. }
        | MotorCommand::SetDoor { ticket, .. }
        | MotorCommand::Deed { ticket, .. }) = command
        else {
            return false;
        };
        if *ticket <= self.chronicle.head.heard {
            return true;
        }
        self.chronicle.head.heard = *ticket;
        false
    }
}
