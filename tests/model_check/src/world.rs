//! What really happens. It outlives every process, and counts what is done to it.

use std::collections::{BTreeMap, VecDeque};

use agent_core::model::Action;
use agent_core::protocol::ActionId;

/// What an executor tells its motors.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Motor {
    /// Do it.
    Go {
        /// Which command.
        ticket: u64,
        /// For which execution.
        id: ActionId,
        /// What.
        action: Action,
    },
    /// Stop that.
    Stop {
        /// Which command.
        ticket: u64,
    },
    /// Stop whatever it is, and say what was done.
    Halt,
}

/// What the motors say.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub enum Sensor {
    /// It is done.
    Done {
        /// Which command.
        ticket: u64,
    },
    /// It stands still before it was done.
    Stopped {
        /// Which command.
        ticket: u64,
    },
    /// Everything stands still.
    Halted {
        /// The last command that was done.
        done: Option<u64>,
    },
}

/// The motors and what they have brought about.
#[derive(Clone, Debug, Default, Eq, Hash, PartialEq)]
pub struct World {
    /// What is being done.
    pub doing: Option<(u64, ActionId, Action)>,
    /// The last command that was done.
    pub done: Option<u64>,
    /// How often each action was done to its end.
    pub effects: BTreeMap<Action, u8>,
    /// What it has said and nobody has heard, oldest first.
    pub says: VecDeque<Sensor>,
}

impl World {
    /// Obeys. Whether it could not, for doing something else.
    pub fn obey(&mut self, motor: Motor) -> bool {
        match motor {
            Motor::Go { ticket, id, action } => {
                let busy = self.doing.is_some();
                self.doing = Some((ticket, id, action));
                return busy;
            }
            Motor::Stop { ticket } => {
                if self.doing.take_if(|(doing, ..)| *doing == ticket).is_some() {
                    self.says.push_back(Sensor::Stopped { ticket });
                }
            }
            Motor::Halt => {
                self.doing = None;
                let done = self.done;
                self.says.push_back(Sensor::Halted { done });
            }
        }
        false
    }

    /// What is being done is done. How often it has been, now.
    pub fn finish(&mut self) -> u8 {
        let Some((ticket, _, action)) = self.doing.take() else {
            return 0;
        };
        self.done = Some(ticket);
        self.says.push_back(Sensor::Done { ticket });
        let times = self.effects.entry(action).or_default();
        *times += 1;
        *times
    }
}
