//! What is planned for, and in which order: all ways to what remains of a goal at once, of which the
//! cheapest is taken, or, after a failure, one task after the other from the nearest outward.
//!
//! The latter is the second paper's repair by partial backtracking (section 5.2, Algorithm 3). Its task
//! tree is what frames remember, and *decompose this ancestor again* is the agenda that every open
//! ancestor has anyway: it leaves out what was done before that task, which is what is achieved already,
//! and what follows it is as it was. So repair is not another planner but an order in which agendas are
//! tried, and what the plan graph has found out for one of them serves the next.
//!
//! *Another solution* is one without the action that has failed. Only when no ancestor has one is the
//! action tried again, as often as it may be; this too from the nearest outward.

use std::borrow::Cow;
use std::sync::Arc;

use super::{Agent, Intention};
use crate::model::{Action, Task};
use crate::planner::{Agenda, Frame, Origin, Planner, Problem};
use crate::protocol::Happening;

/// Which plan is followed after an action has failed.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Repair {
    /// The cheapest of all that are left.
    #[default]
    Cheapest,
    /// The cheapest of those that decompose the nearest task anew for which there is another.
    Nearest,
}

/// What is planned for at once.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    /// `None`: all that are left.
    agendas: Option<Vec<Agenda>>,
    /// Whether actions count as forbidden that have failed, however seldom.
    pub strict: bool,
    /// The task that these agendas decompose anew, and how far it is above the action that has failed;
    /// `None` if they are about that action itself, or about everything.
    pub anew: Option<(Task, usize)>,
    /// Whether all that is left is planned for.
    pub whole: bool,
}

impl Stage {
    /// Everything that is left is planned for at once.
    fn whole(strict: bool) -> Self {
        Self {
            agendas: None,
            strict,
            anew: None,
            whole: true,
        }
    }

    /// What is planned for.
    pub fn agendas<'a>(&'a self, intention: &'a Intention) -> &'a [Agenda] {
        self.agendas.as_deref().unwrap_or(&intention.agendas)
    }
}

/// How far planning is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reached {
    /// So many stages have come to nothing.
    pub place: usize,
    /// What was expanded in them.
    pub expanded: u64,
}

impl<P: Planner> Agent<P> {
    /// What is to be planned for, one after the other until there is a plan.
    pub(super) fn stages(&self, intention: &Intention) -> Vec<Stage> {
        let policy = self.configuration.policy.repair;
        if policy == Repair::Cheapest
            || intention.failures.is_empty()
            || intention.cancelled.is_some()
        {
            return vec![Stage::whole(false)];
        }
        if intention.failed.is_none() {
            return vec![Stage::whole(true), Stage::whole(false)];
        }
        let levels = levels(&intention.agendas);
        let stages = [true, false].into_iter().flat_map(|strict| {
            levels.iter().map(move |(anew, agendas)| Stage {
                agendas: Some(agendas.clone()),
                strict,
                anew: anew.clone(),
                whole: false,
            })
        });
        // The last finds nothing more, and tells what all of them were in want of.
        stages.chain([Stage::whole(false)]).collect()
    }

    /// The stage that the running goal is in.
    pub(super) fn stage(&self) -> Option<(Stage, bool)> {
        let running = self.running.as_ref()?;
        let mut stages = self.stages(&running.intention);
        let place = running.stage.place.min(stages.len().checked_sub(1)?);
        let is_last = place + 1 == stages.len();
        Some((stages.swap_remove(place), is_last))
    }

    /// Everything that a plan in this stage depends on.
    pub(super) fn problem_in(&self, stage: &Stage) -> Problem {
        let mut problem = self.problem();
        if let (true, Some(running)) = (stage.strict, &self.running) {
            let failed = running.intention.failures.keys().cloned();
            problem.forbidden.extend(failed);
        }
        problem
    }

    /// There is a plan: says which task it decomposes anew, if it is the answer to a failure. `same`: it
    /// is the one that was followed before. Returns why it was chosen, and whether that is new.
    pub(super) fn repaired(&mut self, stage: &Stage, same: bool) -> (Cow<'static, str>, bool) {
        let cheapest = (Cow::from("it is the cheapest"), !same);
        let running = self.running.as_mut();
        let Some((failed, told)) = running.and_then(|it| it.intention.failed.as_mut()) else {
            return cheapest;
        };
        let is_new = !std::mem::replace(told, true) || !same;
        let failed: Action = failed.clone();
        let Some((task, levels)) = stage.anew.clone() else {
            return match stage.whole {
                true => cheapest,
                false => {
                    let why = format!("nothing else is left, and {failed} may be tried again");
                    (why.into(), is_new)
                }
            };
        };
        let why = format!("{task} is the nearest task that can be done otherwise");
        if is_new {
            let goal = self.running_goal();
            let what = Happening::TaskRepaired {
                task,
                levels,
                failed,
            };
            self.emit(goal.as_ref(), what);
        }
        (why.into(), is_new)
    }
}

type Level = (Option<(Task, usize)>, Vec<Agenda>);

/// The agendas of an action that has failed, by the task that they decompose anew: first those about the
/// action itself, then those of its parent, and so on. Undoing what is half done may come before
/// any of them.
fn levels(agendas: &[Agenda]) -> Vec<Level> {
    let undoes = |agenda: &&Agenda| agenda.origin == Origin::RollBack;
    let itself = agendas.iter().find(|agenda| agenda.origin == Origin::Again);
    let mut frame = itself.and_then(|agenda| agenda.tasks.first()?.1.cloned());
    let mut above = 0;
    let mut levels: Vec<Level> = Vec::new();
    for agenda in agendas.iter().filter(|agenda| !undoes(agenda)) {
        let undoing = agendas.iter().filter(undoes);
        let undoing = undoing.filter(|undoing| {
            let rest = undoing.tasks.first().map(|(_, _, rest)| rest);
            rest == Some(&agenda.tasks)
        });
        let mut group = vec![agenda.clone()];
        group.extend(undoing.cloned());
        let anew = (agenda.origin == Origin::Ancestor)
            .then(|| {
                above += climb(&mut frame, agenda);
                let (item, ..) = agenda.tasks.first()?;
                Some((item.purpose().clone(), above))
            })
            .flatten();
        levels.push((anew, group));
    }
    // What must be done again only to be undone is about the action itself.
    if levels.is_empty() {
        levels.push((None, agendas.to_vec()));
    }
    levels
}

/// Goes up to the task that the agenda begins with, and beyond it; returns how far that was.
fn climb(frame: &mut Option<Arc<Frame>>, agenda: &Agenda) -> usize {
    let mut climbed = 0;
    while let Some(at) = frame.take() {
        climbed += 1;
        frame.clone_from(&at.parent);
        let begins = agenda.tasks.first();
        if begins.is_some_and(|(item, _, rest)| *item == at.task && *rest == at.rest) {
            return climbed;
        }
    }
    climbed.max(1)
}
