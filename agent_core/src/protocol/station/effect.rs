//! What comes into a station, and what goes out of it.

use crate::model::{FactChange, Symbol};
use crate::protocol::delivery::Envelope;
use crate::protocol::{Answer, Event, GoalId, Input, Instruction, Rejection, ReportBody};

/// What comes in. `L` is what the machine hears from elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub enum Arrival<L> {
    /// From a superior.
    Instruction(Envelope<Instruction>),
    /// From a superior, and it makes no sense: the reason in place of the instruction. It is applied
    /// by being rejected, so that what follows is not held up.
    Unreadable(Envelope<String>),
    /// From a superior: an [`Instruction::Suspend`] ahead of its turn. Not answered.
    StopAhead(Envelope<Instruction>),
    /// From an executor.
    Report(Envelope<ReportBody>),
    /// From elsewhere.
    Local(Envelope<L>),
    /// An executor has applied our instruction of that number.
    Answered {
        /// Which executor.
        by: Symbol,
        /// Its line.
        line: u64,
        /// Which instruction.
        seq: u64,
        /// Its answer.
        answer: Answer,
    },
    /// A superior has applied our report of that number.
    Delivered {
        /// Which superior.
        by: Symbol,
        /// Its line.
        line: u64,
        /// Which report.
        seq: u64,
    },
    /// A superior or an executor has appeared, with a memory that begins in that epoch. Without
    /// this, one that has lost its memory and has nothing to say would not be noticed.
    Appeared {
        /// Who.
        name: Symbol,
        /// Its line.
        line: u64,
    },
    /// What carries no number: goals, commands, observations, neighbours, time.
    Input(Input<L>),
}

/// What goes out. All but [`StopAhead`](Self::StopAhead) and what stops something elsewhere has been
/// written down before.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect<O, T> {
    /// To an executor, in order, again and again until it is answered.
    Instruct {
        /// Which executor.
        to: Symbol,
        /// What.
        message: Envelope<Instruction>,
    },
    /// To an executor, once and at once: the copy of a suspension whose original follows.
    StopAhead {
        /// Which executor.
        to: Symbol,
        /// Numbered as the original.
        message: Envelope<Instruction>,
    },
    /// To a superior, in order, again and again until it is acknowledged.
    Report {
        /// Which superior.
        to: Symbol,
        /// What.
        message: Envelope<ReportBody>,
    },
    /// To elsewhere, in order, again and again until it is acknowledged; not after a restart.
    Local(Envelope<O>),
    /// To all superiors.
    Observed {
        /// What is true now, at the receivers' level.
        facts: Vec<FactChange>,
        /// Who needs no telling.
        reported_to: Option<Symbol>,
    },
    /// To one superior alone.
    Seen {
        /// Which superior.
        to: Symbol,
        /// All that can be told it now, at its level.
        facts: Vec<FactChange>,
        /// Whether it needs no telling.
        reported: bool,
    },
    /// To people, logs and experiments.
    Event {
        /// Counts the events of this machine, also over restarts: one that is told twice has the
        /// same number.
        number: u64,
        /// What.
        event: Event,
    },
    /// To whoever waits.
    Respond {
        /// The way back.
        to: T,
        /// The response.
        response: Response,
        /// The line of this station.
        line: u64,
    },
}

/// What the sender of an arrival is told.
#[derive(Clone, Debug, PartialEq)]
pub enum Response {
    /// The message was applied, now or before; an instruction, with this answer. No answer to an
    /// instruction: the sender has had it long since.
    Applied {
        /// Which message.
        seq: u64,
        /// To an instruction.
        answer: Option<Answer>,
    },
    /// From a process that has been replaced; it has to end.
    Superseded {
        /// Which message.
        seq: u64,
    },
    /// Not applied, since another is due.
    Gap {
        /// Which message.
        seq: u64,
        /// Which is due.
        due: u64,
    },
    /// To a goal.
    Goal(Result<GoalId, Rejection>),
    /// To a command.
    Command(Result<(), Rejection>),
    /// It was taken in.
    Noted,
}
