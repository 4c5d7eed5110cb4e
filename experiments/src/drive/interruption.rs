//! One interruption, from the beginning of a tour until it goes on.

use std::time::Duration;

use agent_core::model::{Action, FactChange};
use agent_core::protocol::{
    ActionId, Event, Happening, Input, Instruction, Output, Report, Resumption, Urgency,
};

use super::{Call, Drive, Ground, Meter, Observer, Who};
use crate::ExperimentError;

const TOUR: &str = "tour";
const EMERGENCY: &str = "emergency";

/// A tour that is interrupted.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Situation {
    /// Where the robot stands at first.
    pub start: String,
    /// Where it is to go.
    pub goal: String,
    /// The passage that it goes along first, and is interrupted on; empty if it may be any.
    pub interruption: String,
    /// Where it has to go meanwhile.
    pub emergency: String,
    /// What changes meanwhile.
    pub change: Option<FactChange>,
}

/// What an agent has spent on one interruption.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spent {
    /// From the input after which the tour may go on to the instruction by which it does.
    pub resume: Duration,
    /// On everything else from the emergency's arrival on that is not planning for the emergency, and
    /// on what was put off until after the instruction.
    pub upkeep: Duration,
    /// On planning for the emergency.
    pub emergency: Duration,
    /// What the planner did for `resume`.
    pub work: Meter,
}

/// What one interruption has shown.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sample {
    pub parent: Spent,
    pub child: Spent,
    /// How the parent has taken up the tour.
    pub how: Resumption,
    /// Metres from where the emergency ended to the goal, if that was driven.
    pub route_m: Option<f64>,
    /// The passage that it was interrupted on.
    pub interruption: String,
    /// Whether something else was given the processor during the time to resume.
    pub is_disturbed: bool,
}

/// Drives into the situation and on until the tour goes on; `to_the_end`, until it is done.
///
/// # Errors
/// If it does not come to that.
pub(crate) fn interrupt(
    ground: &Ground,
    mut drive: Drive,
    situation: &Situation,
    to_the_end: bool,
) -> Result<Sample, ExperimentError> {
    let Situation { goal, .. } = situation;
    let mut watch = Watch::default();
    drive.ask(TOUR, &format!("(go {goal})"), Urgency::Normal, &mut watch)?;
    let first = loop {
        if let Some(first) = watch.first.take() {
            break first;
        }
        situation.go_on(&mut drive, &mut watch, "the tour does not begin")?;
    };
    let mut args = first.args.iter();
    let passage = args.find(|arg| ground.half_way(arg.as_str()).is_some());
    let passage = passage
        .filter(|passage| {
            let wanted = situation.interruption.as_str();
            wanted.is_empty() || **passage == wanted
        })
        .ok_or_else(|| {
            ExperimentError::course(situation, format_args!("the tour begins with {first}"))
        })?;
    let well_on = drive.now + ground.half_way(passage.as_str()).unwrap_or_default();
    drive.run_until(well_on, &mut watch);
    watch.phase = Phase::Emergency;
    let task = format!("(go {})", situation.emergency);
    drive.ask(EMERGENCY, &task, Urgency::Emergency, &mut watch)?;
    if let Some(change) = &situation.change {
        drive.change(change, &mut watch);
    }
    while watch.phase != Phase::Over {
        situation.go_on(&mut drive, &mut watch, "the tour does not go on")?;
    }
    let now = drive.now;
    drive.run_until(now, &mut watch);
    watch.phase = Phase::Before;
    while to_the_end && !watch.reached {
        situation.go_on(&mut drive, &mut watch, "the tour does not end")?;
    }
    let how = watch
        .how
        .ok_or_else(|| ExperimentError::course(situation, "the tour was not interrupted"))?;
    Ok(Sample {
        parent: watch.parent,
        child: watch.child,
        how,
        route_m: to_the_end.then(|| ground.length_m(&watch.driven)),
        interruption: passage.to_string(),
        is_disturbed: watch.is_disturbed,
    })
}

impl Situation {
    fn go_on(
        &self,
        drive: &mut Drive,
        watch: &mut Watch,
        otherwise: &str,
    ) -> Result<(), ExperimentError> {
        if watch.failed || !drive.step(watch) {
            return Err(ExperimentError::course(self, otherwise));
        }
        Ok(())
    }
}

impl std::fmt::Display for Situation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            start,
            goal,
            interruption,
            emergency,
            ..
        } = self;
        write!(
            f,
            "from {start} to {goal}, on {interruption} to {emergency}"
        )
    }
}

#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
enum Phase {
    /// Nothing is measured.
    #[default]
    Before,
    /// From the emergency's arrival on.
    Emergency,
    /// From the parent's input that ends the emergency on.
    ParentResumes,
    /// From the parent's next instruction for the tour on.
    OnTheWay,
    /// From its arrival at the child on.
    ChildResumes,
    /// The child's next instruction has left.
    Over,
}

#[derive(Debug, Default)]
struct Watch {
    phase: Phase,
    /// The child's first action of the tour.
    first: Option<Action>,
    /// By which the parent goes on with the tour.
    instruction: Option<ActionId>,
    parent: Spent,
    child: Spent,
    how: Option<Resumption>,
    /// What the child has begun since the emergency ended.
    driven: Vec<Action>,
    reached: bool,
    failed: bool,
    is_disturbed: bool,
}

impl Observer for Watch {
    fn call(&mut self, call: &Call<'_>) {
        match call.who {
            Who::Parent => self.parent_call(call),
            Who::Child => self.child_call(call),
            Who::Robot => {}
        }
    }
}

impl Watch {
    fn parent_call(&mut self, call: &Call<'_>) {
        let mut emergency_is_over = false;
        for event in events(call) {
            let goal = event.goal.as_ref().map_or("", |goal| goal.as_str());
            match (&event.what, goal) {
                (Happening::GoalSucceeded, EMERGENCY) => {
                    emergency_is_over = true;
                    self.driven.clear();
                }
                (Happening::GoalSucceeded, TOUR) => self.reached = true,
                (Happening::GoalResumed { how, .. }, TOUR) => self.how = Some(*how),
                (Happening::GoalFailed { .. } | Happening::GoalBlocked { .. }, _) => {
                    self.failed = true;
                }
                _ => {}
            }
        }
        if self.phase == Phase::Emergency && emergency_is_over {
            self.phase = Phase::ParentResumes;
        }
        match self.phase {
            Phase::Before => {}
            Phase::Emergency => self.parent.keep_up(call),
            Phase::ParentResumes => {
                self.is_disturbed |= call.is_disturbed;
                if let Some(at) = self.parent.resume(call, begins) {
                    self.instruction = begun(&call.outputs[at].1).cloned();
                    self.phase = Phase::OnTheWay;
                }
            }
            // What was put off.
            Phase::OnTheWay | Phase::ChildResumes | Phase::Over => {
                self.parent.upkeep += call.spent;
            }
        }
    }

    fn child_call(&mut self, call: &Call<'_>) {
        let begun = events(call).filter_map(|event| match &event.what {
            Happening::ActionStarted { action, .. } => Some(action.clone()),
            _ => None,
        });
        self.driven.extend(begun);
        if self.phase == Phase::Before && self.first.is_none() {
            self.first = self.driven.first().cloned();
        }
        if self.phase == Phase::OnTheWay
            && let Input::Instruction { instruction, .. } = call.input
            && self.instruction.as_ref() == Some(instruction.id())
        {
            self.phase = Phase::ChildResumes;
        }
        match self.phase {
            Phase::Before => {}
            Phase::Emergency | Phase::ParentResumes | Phase::OnTheWay => self.child.keep_up(call),
            Phase::ChildResumes => {
                self.is_disturbed |= call.is_disturbed;
                // There may be nothing to do for it.
                let ends = |output: &Output<_>| {
                    let done = matches!(
                        output,
                        Output::Report {
                            report: Report::Success { .. },
                            ..
                        }
                    );
                    done || begins(output)
                };
                if self.child.resume(call, ends).is_some() {
                    self.phase = Phase::Over;
                }
            }
            Phase::Over => self.child.upkeep += call.spent,
        }
    }
}

impl Spent {
    /// Both.
    pub fn and(self, other: Self) -> Self {
        Self {
            resume: self.resume + other.resume,
            upkeep: self.upkeep + other.upkeep,
            emergency: self.emergency + other.emergency,
            work: self.work.and(other.work),
        }
    }

    /// A call during the emergency.
    fn keep_up(&mut self, call: &Call<'_>) {
        self.emergency += call.planning.planning;
        self.upkeep += call.spent.saturating_sub(call.planning.planning);
    }

    /// A call that brings the tour nearer to going on. Returns the output by which it does.
    fn resume(
        &mut self,
        call: &Call<'_>,
        is_the_end: impl Fn(&Output<std::convert::Infallible>) -> bool,
    ) -> Option<usize> {
        let end = call
            .outputs
            .iter()
            .position(|(_, output)| is_the_end(output));
        let until = end.map_or(call.spent, |at| call.outputs[at].0);
        self.resume += until;
        self.upkeep += call.spent.saturating_sub(until);
        self.work = self.work.and(call.planning);
        end
    }
}

fn events<'a>(call: &Call<'a>) -> impl Iterator<Item = &'a Event> + use<'a> {
    call.outputs.iter().filter_map(|(_, output)| match output {
        Output::Event(event) => Some(event),
        _ => None,
    })
}

/// The execution that an output begins, or goes on with.
fn begun<L>(output: &Output<L>) -> Option<&ActionId> {
    match output {
        Output::Instruct {
            instruction: Instruction::Execute { id, .. } | Instruction::Resume { id, .. },
            ..
        } => Some(id),
        _ => None,
    }
}

fn begins<L>(output: &Output<L>) -> bool {
    begun(output).is_some()
}
