//! What users ask about goals that were accepted.

use super::{Agent, Intention, WaitsFor};
use crate::planner::{Agenda, Origin, Planner, TaskList};
use crate::protocol::{Command, GoalId, Happening, Rejection, Report};

use super::suspension::continuations;

impl<P: Planner> Agent<P> {
    /// Carries out a command, or says why not.
    pub(super) fn command(&mut self, command: &Command) -> Result<(), Rejection> {
        let (Command::Suspend(goal) | Command::Resume(goal) | Command::Cancel(goal)) = command;
        let known = self.all_intentions().find(|i| i.goal.id == *goal);
        let Some(intention) = known else {
            let over = self.ended.iter().any(|ended| ended.id == *goal);
            return Err(if over {
                not_now(goal, "is over")
            } else {
                Rejection::UnknownGoal(goal.clone())
            });
        };
        if intention.goal.superior.is_some() {
            return Err(not_now(goal, "belongs to a superior; ask there"));
        }
        if intention.cancelled.is_some() {
            return Err(not_now(goal, "is being cancelled"));
        }
        match command {
            Command::Suspend(goal) => self.set_aside(goal),
            Command::Resume(goal) => self.let_go_on(goal),
            Command::Cancel(goal) => {
                self.cancel(goal, "the user has cancelled it");
                Ok(())
            }
        }
    }

    fn set_aside(&mut self, goal: &GoalId) -> Result<(), Rejection> {
        if let Some(running) = &mut self.running
            && running.intention.goal.id == *goal
        {
            running.set_aside = true;
            return Ok(());
        }
        let found = self
            .stack
            .remove(goal)
            .or_else(|| self.waiting.remove(goal));
        let Some(intention) = found.or_else(|| self.aside.remove(goal)) else {
            return Err(Rejection::UnknownGoal(goal.clone()));
        };
        self.tell_suspended(&intention, "the user wants it set aside");
        self.aside.add(intention, WaitsFor::User);
        Ok(())
    }

    fn let_go_on(&mut self, goal: &GoalId) -> Result<(), Rejection> {
        if let Some(intention) = self.aside.remove(goal) {
            self.waiting.add(intention);
            return Ok(());
        }
        match &mut self.running {
            Some(running) if running.intention.goal.id == *goal && running.set_aside => {
                running.set_aside = false;
                Ok(())
            }
            _ => Err(not_now(goal, "is not set aside")),
        }
    }

    /// Ends a goal that is not over. What is half done is rolled back where the domain says how:
    /// at once if the goal is running, else when its turn comes.
    pub(super) fn cancel(&mut self, goal: &GoalId, reason: &str) {
        if let Some(running) = &mut self.running
            && running.intention.goal.id == *goal
        {
            // `settle` stops its action first.
            running.intention.cancelled = Some(reason.to_owned());
            return;
        }
        let undo = self
            .all_intentions()
            .find(|intention| intention.goal.id == *goal)
            .is_some_and(|intention| self.undoing(intention).is_some());
        if undo {
            // It keeps its place, and does nothing but undo when its turn comes.
            let mut aside = self.aside.remove(goal);
            let others = self
                .stack
                .intentions_mut()
                .chain(self.waiting.intentions_mut());
            for intention in others.chain(&mut aside).filter(|i| i.goal.id == *goal) {
                intention.cancelled = Some(reason.to_owned());
            }
            if let Some(intention) = aside {
                self.waiting.add(intention);
            }
            return;
        }
        let found = self
            .stack
            .remove(goal)
            .or_else(|| self.waiting.remove(goal));
        if let Some(intention) = found.or_else(|| self.aside.remove(goal)) {
            self.drop_goal(&intention, reason);
        }
    }

    /// Gives up a goal that is not running and has been taken out of wherever it stood.
    pub(super) fn drop_goal(&mut self, intention: &Intention, reason: &str) {
        self.clear_all(intention);
        let reason = reason.to_owned();
        let what = Happening::GoalFailed {
            reason: reason.clone(),
        };
        self.emit(Some(&intention.goal.id), what);
        let outcome = Report::Failure {
            reason,
            facts: Vec::new(),
            blocked_by: Vec::new(),
        };
        self.remember(intention, outcome);
    }

    /// The work of undoing what is half done, the latest first; `None` if nothing need be.
    fn undoing(&self, intention: &Intention) -> Option<Agenda> {
        if intention.orphaned {
            return None;
        }
        let problem = self.problem_of(Some(intention));
        let tasks = intention
            .records
            .iter()
            .fold(TaskList::empty(), |tasks, record| {
                let undo = continuations(&problem, &record.id, record.step.purpose())
                    .and_then(|continuations| continuations.rollback);
                undo.map_or(tasks.clone(), |undo| tasks.prepend(undo, None))
            });
        (!tasks.is_empty()).then_some(Agenda {
            tasks,
            origin: Origin::RollBack,
        })
    }

    /// Whether the running goal is cancelled and its agenda is only to undo.
    pub(super) fn is_undoing(&self) -> bool {
        self.running.as_ref().is_some_and(|running| {
            let intention = &running.intention;
            intention.cancelled.is_some()
                && intention
                    .agendas
                    .iter()
                    .all(|a| a.origin == Origin::RollBack)
        })
    }

    /// The running goal was cancelled and has stopped.
    pub(super) fn roll_back_or_give_up(&mut self) {
        let Some(running) = &self.running else {
            return;
        };
        let Some(agenda) = self.undoing(&running.intention) else {
            let reason = running.intention.cancelled.clone().unwrap_or_default();
            return self.give_up(&reason, Vec::new());
        };
        if let Some(running) = &mut self.running {
            running.intention.plans.clear();
            running.intention.agendas = vec![agenda];
            running.resumed = false;
        }
        self.plan();
    }
}

fn not_now(goal: &GoalId, why: &str) -> Rejection {
    Rejection::NotNow {
        goal: goal.clone(),
        why: why.to_owned(),
    }
}
