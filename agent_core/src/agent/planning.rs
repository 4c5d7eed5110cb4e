//! Steps 3 to 6 of Algorithm 2: planning, selection, and what becomes of suspended actions.

use super::repair::Reached;
use super::{Agent, Intention, Phase, WaitsFor};
use crate::model::{Cost, Fact};
use crate::planner::{self, Outcome, Plan, Planner, Problem};
use crate::protocol::{ActionId, Happening, Resumption};

const STILL_HOLDS: &str = "the suspended plan still holds";

impl<P: Planner> Agent<P> {
    /// Step 3: begins to plan for the running goal, over everything that is left of it.
    pub(super) fn plan(&mut self) {
        if let Some(running) = &mut self.running {
            running.stage = Reached::default();
        }
        self.plan_in_stage();
    }

    fn plan_in_stage(&mut self) {
        let Some((stage, _)) = self.stage() else {
            return;
        };
        let problem = self.problem_in(&stage);
        if let Some(running) = &mut self.running {
            running.phase = Phase::Planning;
            self.planner.release(&running.intention.goal.id);
            let agendas = stage.agendas(&running.intention);
            self.planner.begin(problem, agendas);
        }
    }

    /// Steps 4 to 6: plans were found, or it is proved that there are none.
    pub(super) fn planned(&mut self, outcome: Outcome) {
        let Some((stage, is_last)) = self.stage() else {
            return;
        };
        let problem = self.problem_in(&stage);
        let Some(running) = &mut self.running else {
            return;
        };
        if outcome.plans.is_empty() && !is_last {
            running.stage.place += 1;
            running.stage.expanded += outcome.expanded;
            return self.plan_in_stage();
        }
        let kept = Kept::judged(&problem, std::mem::take(&mut running.intention.plans));
        // What was kept may be about any of the tasks above.
        let still_valid = if stage.whole {
            kept.valid()
        } else {
            Vec::new()
        };
        let Some((selected, alternatives)) = select(still_valid, outcome.plans) else {
            return self.no_plan(outcome.wanted.into_iter().collect());
        };
        let expanded = running.stage.expanded + outcome.expanded_for_best;
        let how = kept.resumption(&selected);
        let same = how == Resumption::Continued;
        running.intention.fits = true;
        running.intention.plans = vec![selected];
        running.intention.plans.extend(alternatives);
        running.surprised = false;
        let goal = running.intention.goal.id.clone();
        let resumed = std::mem::take(&mut running.resumed);
        if resumed {
            let why = kept.why(how);
            self.emit(Some(&goal), Happening::GoalResumed { how, why, expanded });
        }
        self.clear_what_is_not_resumed();
        if let (why, true) = self.repaired(&stage, same) {
            self.tell_plan(&why, expanded);
        }
        self.execute_next();
    }

    /// Goes on with the plan that was kept for a goal that is taken up, if the planner can tell without
    /// planning that there is no better one. Others that were kept beside it stay: whoever selects one
    /// carries it out in mind first. Returns whether it did.
    pub(super) fn continues(&mut self) -> bool {
        let Some(running) = &mut self.running else {
            return false;
        };
        let intention = &mut running.intention;
        let Some(first) = intention.plans.first_mut() else {
            return false;
        };
        if !running.resumed || intention.cancelled.is_some() || intention.failed.is_some() {
            return false;
        }
        let Some(confirmed) = self.planner.confirm(first) else {
            return false;
        };
        first.cost = confirmed.cost;
        intention.fits = true;
        running.resumed = false;
        running.surprised = false;
        let goal = intention.goal.id.clone();
        self.emit(
            Some(&goal),
            Happening::GoalResumed {
                how: Resumption::Continued,
                why: STILL_HOLDS.to_owned(),
                expanded: confirmed.expanded,
            },
        );
        self.clear_what_is_not_resumed();
        self.execute_next();
        true
    }

    /// Announces the plan that is followed.
    pub(super) fn tell_plan(&mut self, why: &str, expanded: u64) {
        let Some(running) = &self.running else {
            return;
        };
        let Some((selected, others)) = running.intention.plans.split_first() else {
            return;
        };
        let goal = running.intention.goal.id.clone();
        let what = Happening::PlanSelected {
            steps: selected.actions(),
            cost: selected.cost,
            alternatives: others.iter().map(|plan| plan.cost).collect(),
            why: why.to_owned(),
            expanded,
        };
        self.emit(Some(&goal), what);
    }

    /// Step 5: records that the selected plan does not come back to are dropped. One that it comes
    /// back to later, after reaching the place for it, is not (decision 13).
    fn clear_what_is_not_resumed(&mut self) {
        let Some(running) = &self.running else {
            return;
        };
        let intention = &running.intention;
        let Some(selected) = intention.plans.first() else {
            return;
        };
        let unneeded: Vec<ActionId> = intention
            .records
            .iter()
            .filter(|record| !selected.needs(&record.id))
            .map(|record| record.id.clone())
            .collect();
        for id in unneeded {
            self.clear(&id);
            if let Some(running) = &mut self.running {
                running.intention.forget(&id);
            }
        }
    }

    /// Step 7e, and decision 7: an executor reports failure, so that its superior plans round what
    /// is in the way; at the top the goal is blocked, moved aside, and tried again when that
    /// changes.
    fn no_plan(&mut self, wanted: Vec<Fact>) {
        if self.configuration.policy.asks_leave {
            return self.wait_without_a_plan(wanted);
        }
        self.do_without_a_plan(wanted);
    }

    /// The same, once nobody else is waited for.
    pub(super) fn do_without_a_plan(&mut self, wanted: Vec<Fact>) {
        let Some(running) = &self.running else {
            return;
        };
        let intention = &running.intention;
        if let Some(reason) = &intention.cancelled {
            let reason = format!("{reason}; what was half done cannot be undone from here");
            return self.give_up(&reason, Vec::new());
        }
        let mut blocked_by = wanted;
        let named = intention.blocked_by.iter();
        blocked_by.extend(named.filter(|fact| !self.belief.holds(fact)).cloned());
        blocked_by.sort();
        blocked_by.dedup();
        if intention.goal.superior.is_some() || blocked_by.is_empty() {
            let mut reason = String::from("there is no plan");
            if let Some(failure) = &intention.last_failure {
                reason = format!("{reason}; {failure}");
            }
            return self.give_up(&reason, blocked_by);
        }
        let Some(mut running) = self.take_running() else {
            return;
        };
        running.intention.failures.clear();
        running.intention.failed = None;
        running.intention.blocked_by.clear();
        self.emit(
            Some(&running.intention.goal.id),
            Happening::GoalBlocked {
                blocked_by: blocked_by.clone(),
            },
        );
        let waits_for = WaitsFor::Facts(blocked_by.into_iter().collect());
        self.aside.add(running.intention, waits_for);
    }

    /// Looks whether the first plans of goals that do not run still hold, and says so where that
    /// has changed (the plans in the stack are kept up with the belief).
    pub(super) fn review_plans(&mut self) {
        let mut broken: Vec<(crate::protocol::GoalId, String, usize)> = Vec::new();
        let base = self.problem_of(None);
        let review = |intention: &mut Intention| {
            let mut problem = base.clone();
            problem.map = intention.goal.map.clone();
            let Some(first) = intention.plans.first() else {
                return;
            };
            let verdict = planner::simulate(&problem, &first.steps, false);
            let fits = verdict.is_ok();
            if let (true, Err(why)) = (std::mem::replace(&mut intention.fits, fits), verdict) {
                let others = intention.plans.iter().skip(1);
                let holding =
                    others.filter(|p| planner::simulate(&problem, &p.steps, false).is_ok());
                broken.push((intention.goal.id.clone(), why, holding.count()));
            }
        };
        self.stack.intentions_mut().for_each(review);
        for (goal, why, kept) in broken {
            self.emit(Some(&goal), Happening::PlanRevised { why, kept });
        }
    }

    /// Applies `change` to every goal but the running one.
    pub(super) fn each_other_intention(&mut self, change: impl FnMut(&mut Intention)) {
        self.stack
            .intentions_mut()
            .chain(self.aside.intentions_mut())
            .chain(self.waiting.intentions_mut())
            .for_each(change);
    }
}

/// Plans that were kept, and of each what it costs now or why it no longer holds.
struct Kept(Vec<(Plan, Result<Cost, String>)>);

impl Kept {
    fn judged(problem: &Problem, plans: Vec<Plan>) -> Self {
        let judged = plans.into_iter().map(|plan| {
            let verdict = planner::simulate(problem, &plan.steps, false);
            (plan, verdict)
        });
        Self(judged.collect())
    }

    /// Those that still hold, with what they cost now.
    fn valid(&self) -> Vec<Plan> {
        let valid = self.0.iter().filter_map(|(plan, verdict)| {
            let cost = verdict.as_ref().ok()?;
            // One of which nothing is known but tasks has to be planned for.
            if plan.steps.is_empty() && !plan.rest.is_empty() {
                return None;
            }
            let mut plan = plan.clone();
            if plan.rest.is_empty() {
                plan.cost = *cost;
            }
            Some(plan)
        });
        valid.collect()
    }

    /// Decision 12, told from the plans themselves, so that it means the same with every planner.
    fn resumption(&self, selected: &Plan) -> Resumption {
        let same = |(plan, verdict): &(Plan, Result<Cost, String>)| {
            verdict.is_ok() && plan.purposes().eq(selected.purposes())
        };
        match self.0.iter().position(same) {
            Some(0) => Resumption::Continued,
            Some(_) => Resumption::Alternative,
            None => {
                let last = selected.purposes().next_back();
                let mut kept = self.0.iter().map(|(plan, _)| plan);
                let shared =
                    kept.any(|plan| !plan.steps.is_empty() && plan.purposes().next_back() == last);
                match shared {
                    true => Resumption::Repaired,
                    false => Resumption::Replanned,
                }
            }
        }
    }

    /// The same in words.
    fn why(&self, how: Resumption) -> String {
        let words = match (how, self.0.first()) {
            (Resumption::Continued, _) => STILL_HOLDS,
            (_, Some((_, Err(why)))) => why,
            (_, Some((_, Ok(_)))) => "another plan is cheaper now",
            (_, None) => "there was no plan yet",
        };
        words.to_owned()
    }
}

/// The cheapest plan first. A kept plan wins against a new one of the same cost, and an earlier
/// kept one against a later: nothing is changed without a reason.
fn select(kept: Vec<Plan>, new: Vec<Plan>) -> Option<(Plan, Vec<Plan>)> {
    let mut plans: Vec<Plan> = Vec::new();
    let wanted = kept.len().max(new.len());
    for plan in kept.into_iter().chain(new) {
        if !plans
            .iter()
            .any(|known| known.purposes().eq(plan.purposes()))
        {
            plans.push(plan);
        }
    }
    plans.sort_by_key(|plan| plan.cost);
    plans.truncate(wanted);
    let mut plans = plans.into_iter();
    Some((plans.next()?, plans.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Atom;
    use crate::planner::{Item, Step, TaskList};

    fn plan(actions: &[&str], cost: u64) -> Plan {
        let step = |action: &&str| Step {
            item: Item::Task(Atom::new(action, [])),
            cost: Cost::ZERO,
            frame: None,
            rest: TaskList::empty(),
        };
        Plan {
            steps: actions.iter().map(step).collect(),
            rest: TaskList::empty(),
            cost: Cost(cost),
        }
    }

    fn chosen(kept: &[Plan], new: &[Plan]) -> String {
        let (selected, _) = select(kept.to_vec(), new.to_vec()).expect("there is a plan");
        selected.purposes().map(ToString::to_string).collect()
    }

    #[test]
    fn the_cheapest_plan_is_selected_whether_kept_or_new() {
        assert_eq!(chosen(&[plan(&["old"], 5)], &[plan(&["new"], 4)]), "(new)");
        assert_eq!(chosen(&[plan(&["old"], 3)], &[plan(&["new"], 4)]), "(old)");
    }

    #[test]
    fn among_plans_of_the_same_cost_nothing_changes_without_a_reason() {
        let kept = [plan(&["first"], 4), plan(&["second"], 4)];
        assert_eq!(chosen(&kept, &[plan(&["new"], 4)]), "(first)");
    }
}
