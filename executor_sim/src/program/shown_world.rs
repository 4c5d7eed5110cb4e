//! A world that can be looked at.

use std::sync::atomic::{AtomicBool, Ordering};

use agent_core::model::Time;
use agent_core::protocol::{Durable, Input, Machine, Output, Reply, Row, Rows, Unreadable};
use agent_link::{Clock, Inspect};
use serde_json::{Value, json};

use crate::{MotorCommand, Sensor, World};

/// How many of the latest things that were done are shown with every snapshot. All that are kept are
/// in the view `stack`.
const SHOWN: usize = 16;

/// A [`World`] and the clock that says where in its motions it is: the world itself has none, and
/// between two events everything in it is a formula of the time.
pub struct ShownWorld {
    world: World,
    clock: Clock,
    /// Its motion has changed since that was asked last.
    changed: AtomicBool,
}

impl ShownWorld {
    /// A world that is shown as it is by this clock.
    pub fn new(world: World, clock: Clock) -> Self {
        Self {
            world,
            clock,
            changed: AtomicBool::new(true),
        }
    }
}

impl Durable for ShownWorld {
    fn write_down(&mut self) -> Vec<Row> {
        self.world.write_down()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.world.recall(rows)
    }

    fn is_stop(output: &Sensor) -> bool {
        World::is_stop(output)
    }
}

impl Machine for ShownWorld {
    type In = MotorCommand;
    type Out = Sensor;

    fn handle(&mut self, now: Time, input: Input<MotorCommand>) -> Option<Reply> {
        self.world.handle(now, input)
    }

    fn poll_output(&mut self) -> Option<Output<Sensor>> {
        let output = self.world.poll_output();
        if let Some(Output::Local(Sensor::Pose(_))) = output {
            self.changed.store(true, Ordering::Relaxed);
        }
        output
    }

    fn wake_at(&self) -> Option<Time> {
        self.world.wake_at()
    }

    fn wind_down(&mut self, now: Time) {
        self.world.wind_down(now);
    }

    fn rests(&self) -> bool {
        self.world.rests()
    }
}

impl Inspect for ShownWorld {
    fn is_worth_showing(&self) -> bool {
        self.changed.swap(false, Ordering::Relaxed)
    }

    fn status(&self) -> Value {
        let now = self.clock.now();
        let (motion, since) = self.world.motion();
        let pose = self.world.pose(now);
        json!({
            "t_s": now.secs(),
            "speed": self.clock.speed(),
            "place": self.world.place(now),
            "where": self.world.place(now).to_string(),
            "position_m": pose.position_m,
            "heading_rad": pose.heading_rad,
            "speed_m_s": pose.speed_m_s,
            "motion": motion,
            "motion_since_t_s": since.secs(),
            "speaking": pose.speaking,
            "odometer_m": self.world.odometer_m(now),
            "done_count": self.world.done_count(),
            "done": self.world.done().rev().take(SHOWN).rev().collect::<Vec<_>>(),
        })
    }

    fn belief(&self) -> Value {
        let doors = self.world.doors().iter();
        let doors: serde_json::Map<String, Value> = doors
            .map(|(door, open)| (door.to_string(), json!(open)))
            .collect();
        let done = self.world.done().map(|done| {
            json!({
                "number": done.number,
                "t_s": done.at.secs(),
                "what": done.what.to_string(),
                "to_the_end": done.to_the_end,
            })
        });
        json!({ "doors": doors, "done": done.collect::<Value>() })
    }

    fn stack(&self) -> Value {
        json!(self.world.done().collect::<Vec<_>>())
    }
}
