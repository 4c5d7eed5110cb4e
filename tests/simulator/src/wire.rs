//! What goes over the network, and how that is sent until it is answered.

use std::collections::VecDeque;

use agent_core::model::FactChange;
use agent_core::protocol::{Envelope, Instruction, ReportBody, Response};
use executor_sim::{MotorCommand, Sensor};

use crate::process::Kind;
use crate::scenario::Who;

/// Something on its way.
#[derive(Clone, Debug)]
pub enum Message {
    /// Down.
    Instruction(Envelope<Instruction>),
    /// Down, and not answered.
    StopAhead(Envelope<Instruction>),
    /// Up.
    Report(Envelope<ReportBody>),
    /// To the world.
    Command(Envelope<MotorCommand>),
    /// From the world.
    Sensor(Envelope<Sensor>),
    /// To whoever asked through that channel in that epoch.
    Response {
        /// Its epoch.
        epoch: u64,
        /// Its channel.
        kind: Kind,
        /// What.
        response: Response,
        /// The line of whoever answers.
        line: u64,
    },
    /// Told to all superiors.
    Facts {
        /// Of whoever tells.
        epoch: u64,
        /// Counts what was told in this epoch.
        seq: u64,
        /// What is true now.
        facts: Vec<FactChange>,
        /// The receiver has it in a report.
        reported: bool,
        /// All that was ever told, in answer to a question.
        all: bool,
    },
    /// Asks for all facts.
    WhatHolds,
    /// From a user, about that request.
    Request(u32),
    /// To a user, about that request.
    Verdict(u32),
    /// Everyone is told of a door.
    Door(FactChange),
}

impl Message {
    /// In a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Instruction(_) => "instruction",
            Self::StopAhead(_) => "stop ahead",
            Self::Report(_) => "report",
            Self::Command(_) => "command",
            Self::Sensor(_) => "sensor",
            Self::Response { .. } => "answer",
            Self::Facts { .. } => "facts",
            Self::WhatHolds => "question",
            Self::Request(_) => "request",
            Self::Verdict(_) => "verdict",
            Self::Door(_) => "door",
        }
    }
}

/// What is to be sent to one receiver, one after the other.
#[derive(Clone, Debug)]
pub struct Channel {
    /// What it carries.
    pub kind: Kind,
    /// To whom.
    pub to: Who,
    /// The first is under way.
    pub queue: VecDeque<(u64, Message)>,
    /// How often the first was sent.
    pub attempts: u32,
}

impl Channel {
    /// With nothing in it.
    pub fn new(kind: Kind, to: Who) -> Self {
        Self {
            kind,
            to,
            queue: VecDeque::new(),
            attempts: 0,
        }
    }

    /// Whether the message of that number is the one under way.
    pub fn is_first(&self, seq: u64) -> bool {
        self.queue.front().is_some_and(|(first, _)| *first == seq)
    }
}
