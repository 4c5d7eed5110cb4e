//! What is looked at of a process, and of a letter, in every moment.

use crate::letter::{Letter, Side};
use crate::mutant::heard;
use crate::node::Node;
use crate::role::Role;

/// What is looked at of one of the two. It is found out once.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Seen {
    /// Whether it is writing.
    pub is_writing: bool,
    /// Whether something that it is to say waits for its disk.
    pub is_busy: bool,
    /// The letter that is to be answered next: its name and its number.
    pub first: Option<(u32, u64)>,
    /// Of its start.
    pub epoch: u64,
    /// The epoch and the number of the last message that it has applied and will not forget: if it can
    /// die, as it has written it down.
    pub heard: (u64, u64),
    /// The goals it knows of, a bit each.
    pub known: u8,
    /// The goals that the next process would know of.
    pub kept: u8,
    /// The goals that have ended.
    pub ended: u8,
    /// Whether it has nothing to do and keeps nothing.
    pub is_idle: bool,
    /// What is wrong with it.
    pub fault: Option<String>,
}

impl Seen {
    /// What there is to be seen, but for what needs more than a look: the name of the first letter, and
    /// what is kept.
    pub fn of<M: Role>(node: &Node<M>, goals: usize, first: Option<u32>, kept: u8) -> Self {
        let machine = node.station.machine();
        let heard = match node.is_spared {
            true => heard(&node.disk_to_be(), M::SIDE),
            false => heard(&node.disk, M::SIDE),
        };
        Self {
            is_writing: node.flight.is_some(),
            is_busy: node.station.has_to_say(),
            first: first.zip(node.queue.front().map(Letter::seq)),
            epoch: node.epoch,
            heard,
            known: machine.known(goals),
            kept,
            ended: machine.ended(goals),
            is_idle: machine.is_idle(),
            fault: machine.fault(),
        }
    }
}

/// What is looked at of a letter.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Stamp {
    /// What kind it is.
    pub kind: Kind,
    /// Of whoever sent the message that this is or answers.
    pub epoch: u64,
    /// The number of that message.
    pub seq: u64,
}

/// The kinds of letters.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    /// Down; whether it takes up something suspended.
    Instruction {
        /// Whether it does.
        resumes: bool,
    },
    /// Down, and not answered.
    StopAhead,
    /// Up.
    Report,
    /// Back to that one.
    Response(Side),
}

impl Kind {
    /// Whom it goes to.
    pub fn to(self) -> Side {
        match self {
            Self::Instruction { .. } | Self::StopAhead => Side::Arm,
            Self::Report => Side::Boss,
            Self::Response(side) => side,
        }
    }
}

impl Stamp {
    /// Of that letter.
    pub fn of(letter: &Letter) -> Self {
        use agent_core::protocol::Instruction;
        let (kind, epoch) = match letter {
            Letter::Instruction(message) => {
                let resumes = matches!(message.body, Instruction::Resume { .. });
                (Kind::Instruction { resumes }, message.epoch)
            }
            Letter::StopAhead(message) => (Kind::StopAhead, message.epoch),
            Letter::Report(message) => (Kind::Report, message.epoch),
            Letter::Response { to, epoch, .. } => (Kind::Response(*to), *epoch),
        };
        let seq = letter.seq();
        Self { kind, epoch, seq }
    }
}
