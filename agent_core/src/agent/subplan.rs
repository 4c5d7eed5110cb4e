//! Algorithm 5: subplan suspension, on the instruction of a superior.

use std::sync::Arc;

use super::{Agent, Goal, Intention, ResumedBy};
use crate::model::{FactChange, Map, Symbol, Task};
use crate::planner::Planner;
use crate::protocol::{ActionId, Answer, GoalId, Happening, Instruction, Output, Report, Urgency};

impl<P: Planner> Agent<P> {
    /// Step 1, and what else a superior may instruct.
    pub(super) fn instructed(&mut self, from: &Symbol, instruction: Instruction) -> Answer {
        if let Some(outcome) = self.outcome_of(from, instruction.id()) {
            return match instruction {
                // It was begun, as asked.
                Instruction::Execute { .. } => Answer::Accepted,
                _ => Answer::Finished { outcome },
            };
        }
        match instruction {
            Instruction::Execute { id, action, map } => {
                if self.goal_of(from, &id) {
                    return Answer::Accepted;
                }
                let domain = &self.configuration.domain;
                if !domain.tasks.contains_key(&action.name)
                    && !domain.operators.contains_key(&action.name)
                {
                    let reason = format!("`{}` is no task of {}", action.name, self.name());
                    return Answer::Rejected { reason };
                }
                self.take_map(map);
                self.report(from, &id, Report::Started);
                self.begin_instruction(from, id, action);
                Answer::Accepted
            }
            Instruction::Suspend { id } => self.suspend_for(from, id),
            Instruction::Resume { id, map } => self.resume_for(from, &id, map),
            Instruction::Clear { id } => self.clear_for(from, &id),
        }
    }

    /// A superior's `Execute`: begins at once, even above a goal that the superior holds suspended
    /// here. Read literally, the paper makes it wait for an empty stack (step 4.3), which only the
    /// superior can empty, later (decision 1).
    ///
    /// So it is of the emergencies' kind: it outranks whatever runs when it comes, and an emergency
    /// of the agent's own that comes later outranks it.
    pub(super) fn begin_instruction(&mut self, from: &Symbol, id: ActionId, task: Task) {
        let number = self.next_goal;
        self.next_goal += 1;
        let running = self.running.as_ref().map(|running| &running.intention.goal);
        let emergency = running.filter(|goal| goal.urgency == Urgency::Emergency);
        let goal = Goal {
            id: id.to_string().into(),
            tasks: vec![task],
            urgency: Urgency::Emergency,
            priority: emergency.map_or(i32::MIN, |goal| goal.priority),
            deadline: None,
            number,
            superior: Some((from.clone(), id)),
            map: Arc::clone(&self.map),
        };
        self.waiting.add(Intention::new(goal));
    }

    /// Whether a superior's instruction is known and not over.
    pub(super) fn goal_of(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.all_intentions().any(|intention| {
            intention
                .goal
                .superior
                .as_ref()
                .is_some_and(|(s, i)| s == superior && i == id)
        })
    }

    pub(super) fn outcome_of(&self, superior: &Symbol, id: &ActionId) -> Option<Report> {
        let ended = self.ended.iter().rev();
        let mut of_superior = ended.filter_map(|e| e.superior.as_ref().map(|s| (s, &e.outcome)));
        of_superior
            .find(|((who, what), _)| who == superior && what == id)
            .map(|(_, outcome)| outcome.clone())
    }

    /// The map that came with an instruction (the paper, section 7), and its news.
    fn take_map(&mut self, map: Option<Map>) {
        let Some(mut map) = map else {
            return;
        };
        let news = map.take_changing(&self.configuration.model.observable);
        self.map = Arc::new(map);
        self.observed(&news);
    }

    /// Steps 2 and 3. What runs above the goal, if the agent is busy with one of its own, is
    /// suspended with it (decision 6).
    fn suspend_for(&mut self, from: &Symbol, id: ActionId) -> Answer {
        if !self.goal_of(from, &id) {
            let reason = format!("{id} is not known here");
            return Answer::Rejected { reason };
        }
        let held = self
            .stack
            .place_of(from, &id)
            .is_some_and(|place| self.stack.entries()[place].resumed_by == ResumedBy::Superior);
        // If it is held, it was reported that it is, once: a second report might be taken for one
        // of a later suspension.
        if !held {
            self.hold = Some((from.clone(), id));
            // Nothing runs while the goal waits to be begun or planned for.
            self.hold_if_idle();
        }
        Answer::Suspending
    }

    /// A goal that is asked to be held before anything was done for it.
    fn hold_if_idle(&mut self) {
        if self.running.is_none() {
            self.push_held();
        }
    }

    /// Steps 4 to 6: whatever runs is set aside, and the superior is told that its goal is.
    pub(super) fn push_held(&mut self) {
        let Some((superior, id)) = self.hold.take() else {
            return;
        };
        if let Some(running) = self.take_running() {
            let goal = running.intention.goal.id.clone();
            let action = running
                .intention
                .records
                .last()
                .map(|r| r.step.purpose().clone());
            let intention = running.intention;
            self.planner.keep(&intention.goal.id, &intention.agendas);
            self.stack.push(intention, ResumedBy::Superior);
            let why = format!("{superior} wants it suspended");
            self.emit(Some(&goal), Happening::GoalSuspended { why, action });
        }
        // It may not even have begun.
        if self.stack.place_of(&superior, &id).is_none() {
            let waiting = self.waiting.intentions().iter();
            let goal = waiting
                .map(|intention| &intention.goal)
                .find(|goal| goal.superior.as_ref() == Some(&(superior.clone(), id.clone())))
                .map(|goal| goal.id.clone());
            if let Some(intention) = goal.and_then(|goal| self.waiting.remove(&goal)) {
                self.stack.push(intention, ResumedBy::Superior);
            }
        }
        if let Some(place) = self.stack.place_of(&superior, &id) {
            self.stack.set_resumed_by(place, ResumedBy::Superior);
        }
        let facts = self.tell_superiors();
        self.report(&superior, &id, Report::Suspended { facts });
    }

    /// Steps 7 and 9. What was suspended with the goal goes on first, as it stands above it.
    fn resume_for(&mut self, from: &Symbol, id: &ActionId, map: Option<Map>) -> Answer {
        if self
            .hold
            .as_ref()
            .is_some_and(|(s, i)| s == from && i == id)
        {
            self.hold = None;
            return Answer::Accepted;
        }
        if let Some(place) = self.stack.place_of(from, id) {
            self.take_map(map);
            let map = self.map.clone();
            if let Some(intention) = self.stack.intentions_mut().nth(place) {
                intention.goal.map = map;
            }
            self.stack.release(place);
            self.report(from, id, Report::Started);
            return Answer::Accepted;
        }
        if self.goal_of(from, id) {
            return Answer::Accepted;
        }
        let reason = format!("{id} is not known here: there is nothing to resume");
        Answer::Rejected { reason }
    }

    /// Step 8. What was held only because it stood above the goal is the agent's own again.
    fn clear_for(&mut self, from: &Symbol, id: &ActionId) -> Answer {
        let Some(place) = self.stack.place_of(from, id) else {
            if self.goal_of(from, id) {
                let reason = format!("{id} is under way; suspend it first");
                return Answer::Rejected { reason };
            }
            return Answer::Accepted;
        };
        let goal = self.stack.entries()[place].intention.goal.id.clone();
        if let Some(intention) = self.take_from_stack(&goal) {
            self.clear_all(&intention);
            let action = intention.goal.tasks.first();
            if let Some(action) = action.cloned() {
                let id = id.clone();
                self.emit(Some(&goal), Happening::RecordCleared { id, action });
            }
            let outcome = Report::Failure {
                reason: format!("{from} has cleared it"),
                facts: Vec::new(),
                blocked_by: Vec::new(),
            };
            self.remember(&intention, outcome);
        }
        if self
            .hold
            .as_ref()
            .is_some_and(|(who, what)| who == from && what == id)
        {
            self.hold = None;
        }
        Answer::Accepted
    }

    /// Takes a superior's goal out of the stack. What was held only because it stood above is the
    /// agent's own again.
    pub(super) fn take_from_stack(&mut self, goal: &GoalId) -> Option<Intention> {
        let entries = self.stack.entries();
        let place = entries.iter().position(|e| e.intention.goal.id == *goal)?;
        let intention = self.stack.remove(goal);
        let own = self.stack.entries().iter().skip(place);
        let own_above = own
            .take_while(|entry| entry.intention.goal.superior.is_none())
            .count();
        if place + own_above == self.stack.depth() {
            self.stack.set_resumed_by(place, ResumedBy::Agent);
        }
        intention
    }

    fn report(&mut self, to: &Symbol, id: &ActionId, report: Report) {
        self.outputs.push_back(Output::Report {
            to: to.clone(),
            id: id.clone(),
            report,
        });
    }

    /// Tells superiors of changes at their level that came about without an instruction of theirs.
    pub(super) fn tell_of_surprises(&mut self) {
        let busy = self
            .all_intentions()
            .any(|i| i.goal.superior.is_some() && i.started);
        let before = self.told.clone();
        if busy || crate::planner::project(&self.problem()) == before {
            return;
        }
        let facts: Vec<FactChange> = self.tell_superiors();
        self.outputs.push_back(Output::Observed {
            facts,
            reported_to: None,
        });
    }
}
