//! What could be wrong with the protocol, on purpose: each must be caught.

use std::collections::VecDeque;
use std::fmt;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{
    ActionId, Answer, Durable, Input, Instruction, Machine, Output, Reply, Report, Row, Rows,
    Unreadable,
};

/// One deliberate mistake.
#[derive(
    Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Mutant {
    /// Nothing is ever written, and every writing is said to have succeeded.
    SkipTheJournal,
    /// One writing in eight is forgotten.
    LyingDisk,
    /// Of a writing that a crash interrupts only the first half is there.
    TornWriting,
    /// What depends on a writing leaves before it.
    AckBeforePersist,
    /// Stopping waits for the disk.
    StopWaitsForTheDisk,
    /// After a restart nothing is sent that was not acknowledged.
    LoseTheOutbox,
    /// After a restart messages are numbered from one.
    ResetNumbers,
    /// After a restart nobody knows what was applied.
    ForgetTheInbox,
    /// After a restart the epoch is that of before.
    ForgetTheEpoch,
    /// After a restart a line is begun though the memory is there.
    NewLineAtEveryStart,
    /// A repeated message is applied again.
    ApplyTwice,
    /// A report of an end is acknowledged and not applied, now and then.
    DropTheLastReport,
    /// An answer that tells an outcome is taken for a plain yes.
    AnswerWithoutOutcome,
    /// A repeated instruction is answered with a plain yes, whatever was answered before.
    ForgetAnswers,
    /// An instruction to clear is sent as one to resume.
    ResumeAfterClear,
    /// Another record is resumed than was meant.
    PopTheWrongEntry,
    /// The robot says that it stands before it does.
    SuspendedTooSoon,
    /// The robot says that it stops, and does not.
    NeverStops,
    /// Nobody is told that a neighbour has lost its memory.
    IgnoreReborn,
    /// Nobody is told that a superior is gone.
    DoNotHold,
    /// A controller that starts does not halt the robot.
    NoHaltAtStart,
    /// What has ended nobody knows how is taken for suspended and done again.
    UnknownIsRepeatable,
    /// What has ended nobody knows how is taken for done.
    UnknownIsSuccess,
    /// A restarted agent has lost one goal.
    LoseAGoal,
    /// Now and then a message for one robot comes to another.
    MixUpRobots,
}

/// All of them.
pub const MUTANTS: [Mutant; 25] = [
    Mutant::SkipTheJournal,
    Mutant::LyingDisk,
    Mutant::TornWriting,
    Mutant::AckBeforePersist,
    Mutant::StopWaitsForTheDisk,
    Mutant::LoseTheOutbox,
    Mutant::ResetNumbers,
    Mutant::ForgetTheInbox,
    Mutant::ForgetTheEpoch,
    Mutant::NewLineAtEveryStart,
    Mutant::ApplyTwice,
    Mutant::DropTheLastReport,
    Mutant::AnswerWithoutOutcome,
    Mutant::ForgetAnswers,
    Mutant::ResumeAfterClear,
    Mutant::PopTheWrongEntry,
    Mutant::SuspendedTooSoon,
    Mutant::NeverStops,
    Mutant::IgnoreReborn,
    Mutant::DoNotHold,
    Mutant::NoHaltAtStart,
    Mutant::UnknownIsRepeatable,
    Mutant::UnknownIsSuccess,
    Mutant::LoseAGoal,
    Mutant::MixUpRobots,
];

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match serde_json::to_value(self) {
            Ok(serde_json::Value::String(name)) => f.pad(&name),
            _ => write!(f, "{self:?}"),
        }
    }
}

impl Mutant {
    /// What becomes of the rows that a process finds when it starts.
    pub fn found(self, rows: &mut Rows) {
        match self {
            Self::LoseTheOutbox => rows.retain(|key, _| !is_message(key)),
            Self::ResetNumbers => rows.retain(|key, _| !key.starts_with("s/out/")),
            Self::ForgetTheInbox => rows.retain(|key, _| !key.starts_with("s/in/")),
            Self::NewLineAtEveryStart => rows.retain(|key, _| !key.starts_with("s/")),
            Self::LoseAGoal => {
                let goal = rows.keys().find(|key| key.starts_with("m/goal/")).cloned();
                if let Some(goal) = goal {
                    rows.remove(&goal);
                }
            }
            _ => {}
        }
    }
}

/// Whether a row is a message that waits: `s/out/<kind>/<receiver>/<number>`.
fn is_message(key: &str) -> bool {
    key.starts_with("s/out/") && key.matches('/').count() == 4
}

/// A machine that may have a mistake in it.
#[derive(Clone, Debug)]
pub struct Wayward<M: Machine> {
    /// The machine.
    pub inner: M,
    mutant: Option<Mutant>,
    said: VecDeque<Output<M::Out>>,
    suspended: Vec<ActionId>,
}

impl<M: Machine> Wayward<M> {
    /// That machine, with that mistake.
    pub fn new(inner: M, mutant: Option<Mutant>) -> Self {
        Self {
            inner,
            mutant,
            said: VecDeque::new(),
            suspended: Vec::new(),
        }
    }

    fn heard(&mut self, input: Input<M::In>) -> Option<Input<M::In>> {
        let Some(mutant) = self.mutant else {
            return Some(input);
        };
        if let Input::Report {
            id,
            report: Report::Suspended { .. },
        } = &input
        {
            self.suspended.push(id.clone());
        }
        Some(match (mutant, input) {
            (Mutant::IgnoreReborn, Input::Reborn { .. }) => return None,
            (Mutant::DoNotHold, Input::Neighbour { name, there: false }) => {
                Input::Neighbour { name, there: true }
            }
            (
                Mutant::AnswerWithoutOutcome,
                Input::Answer {
                    to,
                    answer: Answer::Finished { .. },
                },
            ) => {
                let answer = Answer::Accepted;
                Input::Answer { to, answer }
            }
            (
                Mutant::UnknownIsRepeatable,
                Input::Report {
                    id,
                    report: Report::Unknown { reason, facts },
                },
            ) => {
                let blocked_by = Vec::new();
                let report = Report::Failure {
                    reason,
                    facts,
                    blocked_by,
                };
                Input::Report { id, report }
            }
            (
                Mutant::UnknownIsSuccess,
                Input::Report {
                    id,
                    report: Report::Unknown { facts, .. },
                },
            ) => {
                let report = Report::Success { facts };
                Input::Report { id, report }
            }
            (_, input) => input,
        })
    }

    fn says(&mut self, output: Output<M::Out>) -> Output<M::Out> {
        match (self.mutant, output) {
            (
                Some(Mutant::ResumeAfterClear),
                Output::Instruct {
                    to,
                    instruction: Instruction::Clear { id },
                },
            ) => {
                let instruction = Instruction::Resume { id, map: None };
                Output::Instruct { to, instruction }
            }
            (
                Some(Mutant::PopTheWrongEntry),
                Output::Instruct {
                    to,
                    instruction: Instruction::Resume { id, map },
                },
            ) => {
                let other = self.suspended.iter().find(|other| **other != id);
                let id = other.cloned().unwrap_or(id);
                let instruction = Instruction::Resume { id, map };
                Output::Instruct { to, instruction }
            }
            (_, output) => output,
        }
    }
}

impl<M: Machine> Machine for Wayward<M> {
    type In = M::In;
    type Out = M::Out;

    fn handle(&mut self, now: Time, input: Input<M::In>) -> Option<Reply> {
        let (from, id) = match &input {
            Input::Instruction {
                from,
                instruction: Instruction::Suspend { id },
            } => (Some(from.clone()), Some(id.clone())),
            _ => (None, None),
        };
        let input = self.heard(input)?;
        if let (Some(Mutant::NeverStops), Some(_)) = (self.mutant, &id) {
            return Some(Reply::Instruction(Answer::Suspending));
        }
        let reply = self.inner.handle(now, input);
        if let (Some(Mutant::SuspendedTooSoon), Some(to), Some(id)) = (self.mutant, from, id)
            && reply == Some(Reply::Instruction(Answer::Suspending))
        {
            let facts = Vec::new();
            let report = Report::Suspended { facts };
            self.said.push_back(Output::Report { to, id, report });
        }
        reply
    }

    fn poll_output(&mut self) -> Option<Output<M::Out>> {
        if let Some(output) = self.inner.poll_output() {
            return Some(self.says(output));
        }
        self.said.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        self.inner.wake_at()
    }
}

impl<M: Durable> Durable for Wayward<M> {
    fn write_down(&mut self) -> Vec<Row> {
        self.inner.write_down()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.inner.recall(rows)?;
        if self.mutant == Some(Mutant::NoHaltAtStart) {
            // The first thing that a controller says.
            while self.inner.poll_output().is_some() {}
        }
        Ok(())
    }

    fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.inner.is_suspended(superior, id)
    }

    fn is_stop(output: &Self::Out) -> bool {
        M::is_stop(output)
    }
}
