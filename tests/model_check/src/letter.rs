//! What goes over the network.

use std::fmt;

use agent_core::protocol::{Envelope, Instruction, ReportBody, Response};

/// One of the two.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Side {
    /// The superior.
    Boss,
    /// The executor.
    Arm,
}

impl Side {
    /// Its neighbour.
    pub fn other(self) -> Self {
        match self {
            Self::Boss => Self::Arm,
            Self::Arm => Self::Boss,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Boss => "boss",
            Self::Arm => "arm",
        }
    }
}

/// The way back to whoever waits.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Way {
    /// To the user of that goal.
    User(usize),
    /// To the neighbour as it was when it asked.
    Neighbour {
        /// In which epoch.
        epoch: u64,
    },
}

/// Something on its way.
#[derive(Clone, Debug, PartialEq)]
pub enum Letter {
    /// Down.
    Instruction(Envelope<Instruction>),
    /// Down, and not answered.
    StopAhead(Envelope<Instruction>),
    /// Up.
    Report(Envelope<ReportBody>),
    /// Back to whoever sent.
    Response {
        /// Who that is.
        to: Side,
        /// As it was then.
        epoch: u64,
        /// What.
        response: Response,
        /// The line of whoever answers.
        line: u64,
    },
}

impl Letter {
    /// The number of the message.
    pub fn seq(&self) -> u64 {
        match self {
            Self::Instruction(message) | Self::StopAhead(message) => message.seq,
            Self::Report(message) => message.seq,
            Self::Response { response, .. } => match response {
                Response::Applied { seq, .. }
                | Response::Superseded { seq }
                | Response::Gap { seq, .. } => *seq,
                Response::Goal(_) | Response::Command(_) | Response::Noted => 0,
            },
        }
    }
}

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Instruction(message) => {
                write!(f, "instruction {} ({})", message.seq, verb(&message.body))
            }
            Self::StopAhead(message) => {
                write!(f, "stop ahead of {} ({})", message.seq, verb(&message.body))
            }
            Self::Report(message) => write!(
                f,
                "report {} ({}: {:?})",
                message.seq, message.body.id, message.body.report
            ),
            Self::Response { to, response, .. } => {
                write!(f, "answer to the {}: {response:?}", to.name())
            }
        }
    }
}

fn verb(instruction: &Instruction) -> String {
    let verb = match instruction {
        Instruction::Execute { action, .. } => {
            return format!("execute {} {action}", instruction.id());
        }
        Instruction::Suspend { .. } => "suspend",
        Instruction::Resume { .. } => "resume",
        Instruction::Clear { .. } => "clear",
    };
    format!("{verb} {}", instruction.id())
}
