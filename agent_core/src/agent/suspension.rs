//! Algorithm 1: modifications of belief and plans when an action was suspended.

use super::{Agent, Execution, Intention, Phase, Record};
use crate::model::{Action, FactChange};
use crate::planner::{self, Item, Plan, Planner, Problem, Step};
use crate::protocol::{ActionId, Happening};

/// What may follow a suspended action, as the execution model declares it.
pub(super) struct Continuations {
    pub resume: Item,
    pub rollback: Option<Item>,
    pub reach: Option<Item>,
}

/// The continuations of a suspended action; `None` if it cannot be suspended.
pub(super) fn continuations(
    problem: &Problem,
    id: &ActionId,
    suspended: &Action,
) -> Option<Continuations> {
    let model = problem.model.actions.get(&suspended.name)?;
    let suspension = model.suspension.as_ref()?;
    let instance = |pattern| planner::instance(pattern, suspended);
    let rollback = suspension.rollback.as_ref().and_then(instance);
    Some(Continuations {
        resume: Item::Resume {
            id: id.clone(),
            original: suspended.clone(),
            action: instance(&suspension.resume)?,
        },
        rollback: rollback.map(|action| Item::RollBack {
            id: id.clone(),
            action,
        }),
        reach: suspension.reach.as_ref().and_then(instance).map(Item::Task),
    })
}

impl<P: Planner> Agent<P> {
    /// The executor stands still (Algorithm 2, step 7c).
    pub(super) fn suspended(&mut self, execution: Execution, facts: &[FactChange]) {
        if let Some(reason) = self.failure_of(&execution) {
            return self.stopped_for_good(execution, reason, facts);
        }
        let step = execution.step;
        // Step 1.
        let declared = planner::effect_of_suspension(&self.problem(), step.purpose());
        let mut changes = self.learn(&declared);
        let facts = self.known(facts);
        changes.extend(self.learn(&facts));
        let problem = self.problem();
        if let Some(running) = &mut self.running {
            running.phase = Phase::Planning;
            running.surprised = true;
            fit(&problem, &mut running.intention, &execution.id, &step);
            running.intention.records.push(Record {
                id: execution.id.clone(),
                executor: execution.executor,
                step: step.clone(),
            });
        }
        let goal = self.running_goal();
        self.emit(
            goal.as_ref(),
            Happening::ActionSuspended {
                id: execution.id,
                action: step.purpose().clone(),
            },
        );
        self.believed(changes);
        self.conclude();
    }
}

/// Fits the plans that are kept to a suspension (step 3). Plans made afterwards need no fitting:
/// they are made from the belief as it is then, by way of the agendas that this leaves (step 2).
/// Done in the other order, as the paper has it, step 3b would put a rollback in front of plans
/// that need none (decision 2).
fn fit(problem: &Problem, intention: &mut Intention, id: &ActionId, step: &Step) {
    let suspended = step.purpose().clone();
    let Some(next) = continuations(problem, id, &suspended) else {
        // Suspended although the domain does not say how: all that is known is to do it again.
        intention.around(step, None, None);
        intention.plans.clear();
        return;
    };
    let plans = std::mem::take(&mut intention.plans);
    for mut plan in plans {
        let first = match plan.steps.first() {
            Some(first) if *first.purpose() == suspended => {
                // Step 3a.
                plan.steps.remove(0);
                Some(next.resume.clone())
            }
            // Step 3b.
            _ => next.rollback.clone(),
        };
        if let Some(item) = first {
            plan.steps.insert(
                0,
                Step {
                    item,
                    cost: crate::model::Cost::ZERO,
                    frame: step.frame.clone(),
                    rest: rest_before(&plan, step),
                },
            );
        }
        // Step 3c: what does not hold now may hold again when the plan is taken up; whoever
        // selects a plan carries it out in mind first.
        if let Ok(cost) = planner::simulate(problem, &plan.steps, false) {
            plan.cost = cost;
        }
        intention.plans.push(plan);
    }
    intention.around(step, Some((next.resume, next.reach)), next.rollback);
}

/// What is to be done after a step that is put in front of a plan.
fn rest_before(plan: &Plan, suspended: &Step) -> planner::TaskList {
    plan.steps.first().map_or_else(
        || suspended.rest.clone(),
        |next| next.rest.prepend(next.item.clone(), next.frame.clone()),
    )
}
