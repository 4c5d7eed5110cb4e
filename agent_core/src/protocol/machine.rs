//! The shape of everything that a driver loop drives: agents at every level, and the executor.

use super::{
    ActionId, Answer, Command, Event, GoalId, GoalRequest, Instruction, Rejection, Report,
};
use crate::model::{FactChange, Symbol, Time};

/// What comes in. `L` is what a machine hears from elsewhere: an executor from its robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Input<L> {
    /// A user's goal. Normal goals wait for their turn (Algorithm 4), emergencies do not
    /// (Algorithm 3). Answered by [`Reply::Goal`].
    Goal(GoalRequest),
    /// A user's wish about a goal. Answered by [`Reply::Command`].
    Command(Command),
    /// From a superior, to whom this machine is one executor among others (Algorithm 5). Answered
    /// by [`Reply::Instruction`].
    Instruction {
        /// Who instructs, and gets the reports.
        from: Symbol,
        /// What.
        instruction: Instruction,
    },
    /// What our executor answered to an instruction of ours.
    Answer {
        /// The instruction, as it was sent.
        to: Instruction,
        /// Its answer.
        answer: Answer,
    },
    /// From our executor (Algorithm 2, step 7a).
    Report {
        /// Which execution.
        id: ActionId,
        /// How it goes.
        report: Report,
    },
    /// Facts that turned out otherwise, though nobody was told to change them.
    Observation(Vec<FactChange>),
    /// A superior or an executor has appeared or vanished. A machine whose superior is gone holds:
    /// it stops what runs and starts nothing until the superior is back, as a robot that cannot be
    /// interrupted must not move.
    Neighbour {
        /// Who.
        name: Symbol,
        /// Whether it is there now.
        there: bool,
    },
    /// A superior or an executor has lost its memory. What it has instructed it will neither resume
    /// nor clear; how that ended what it was told to do, nobody knows.
    Reborn {
        /// Who.
        name: Symbol,
    },
    /// The time of [`Machine::wake_at`] has come.
    Wake,
    /// From elsewhere.
    Local(L),
}

/// What goes out.
#[derive(Clone, Debug, PartialEq)]
pub enum Output<L> {
    /// To an executor; must arrive once and in order.
    Instruct {
        /// Which executor.
        to: Symbol,
        /// What.
        instruction: Instruction,
    },
    /// To a superior; must arrive once and in order.
    Report {
        /// Which superior.
        to: Symbol,
        /// Which execution.
        id: ActionId,
        /// How it goes.
        report: Report,
    },
    /// To all superiors: facts at their level that hold now. One of them has them in a report
    /// already, if they came about by its instruction.
    Observed {
        /// What is true now, at the receivers' level.
        facts: Vec<FactChange>,
        /// Who needs no telling.
        reported_to: Option<Symbol>,
    },
    /// To one superior alone: all that can be told it now, so that what was seen before counts no
    /// more. An executor that is the body of several tells each of them of its own.
    Seen {
        /// Which superior.
        to: Symbol,
        /// What is true now, at its level.
        facts: Vec<FactChange>,
        /// Whether it has them in a report already and needs no telling.
        reported: bool,
    },
    /// To people, logs and experiments.
    Event(Event),
    /// To elsewhere.
    Local(L),
}

/// What the sender of an input is told at once.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// To [`Input::Instruction`].
    Instruction(Answer),
    /// To [`Input::Goal`].
    Goal(Result<GoalId, Rejection>),
    /// To [`Input::Command`].
    Command(Result<(), Rejection>),
}

/// Something that takes inputs and gives outputs and never waits.
///
/// After every [`handle`](Self::handle), call [`poll_output`](Self::poll_output) until it returns
/// `None`: a machine that is not drained has decided things that the world has not been told.
pub trait Machine {
    /// What comes from elsewhere.
    type In;
    /// What goes elsewhere.
    type Out;

    /// Takes one input at time `now`, which never goes back. The reply is for the input's sender;
    /// inputs that nobody waits for have none.
    fn handle(&mut self, now: Time, input: Input<Self::In>) -> Option<Reply>;

    /// The next thing to tell, in the order in which it was decided.
    fn poll_output(&mut self) -> Option<Output<Self::Out>>;

    /// When [`Input::Wake`] is due. A time that has passed already means: there is more to think
    /// about, wake me as soon as nothing else has come in.
    fn wake_at(&self) -> Option<Time>;

    /// Its process is about to end: what moves by its doing is to stop. What comes of that is handled
    /// as ever, until it [`rests`](Self::rests).
    fn wind_down(&mut self, _now: Time) {}

    /// Whether nothing moves by its doing.
    fn rests(&self) -> bool {
        true
    }
}
