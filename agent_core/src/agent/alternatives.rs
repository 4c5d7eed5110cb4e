//! What an agent could do instead, and why it does what it does, for whoever asks.

use super::{Agent, Intention};
use crate::model::{Action, Cost};
use crate::planner::{
    Considered, Item, Plan, Planner, Reliance, Settings, WhatIf, consider, hangs_on, if_mended,
    is_detour, simulate,
};

/// So many slices of planning an answer may take where the map is small.
const SLICES: u64 = 3;
/// A map with so many objects is small. On a larger one each expansion takes longer and more of them
/// find less: as many times fewer are made as the root of how many times it is larger.
const SMALL: usize = 25;

/// Where a goal is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum GoalPlace {
    /// It is pursued at present.
    Running,
    /// On the stack.
    Suspended,
    /// Its turn has not come.
    Waiting,
    /// It waits for the user, or for a fact.
    Aside,
}

/// A goal with the plans for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternatives<'a> {
    /// The goal, and what is kept for it.
    pub intention: &'a Intention,
    /// Where it is.
    pub place: GoalPlace,
    /// The plan that is followed, or was when the goal was set aside, and then the others, cheapest first.
    /// Empty if there is none as yet.
    pub plans: Vec<Alternative>,
    /// Why the first of them is the one that is followed.
    pub choice: Option<Choice>,
    /// A cheaper plan that there is not now, and what it would take.
    pub what_if: Option<WhatIf>,
    /// Whether all was looked at. If not, there may be more and better plans than these.
    pub complete: bool,
}

/// One of the plans for a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// The plan.
    pub plan: Plan,
    /// What it costs now; what it was last seen to cost, if it does not hold.
    pub cost: Cost,
    /// Why it cannot be followed as things are, in words.
    pub broken: Option<String>,
    /// What it hangs on.
    pub hangs_on: Vec<Reliance>,
    /// Whether it was kept. Others were found for the answer, and forgotten again.
    pub kept: bool,
}

/// Why a plan is the one that is followed.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Choice {
    /// What it costs against the best of the others that could be followed.
    pub against_others: Against,
    /// The suspended action that it takes up again, to begin with.
    pub resumes: Option<Action>,
    /// The action by which it undoes what is half done, to begin with.
    pub undoes: Option<Action>,
}

/// A plan against the best of the others.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Against {
    /// There is no other.
    None,
    /// It costs so much less.
    Less(Cost),
    /// It costs the same. Nothing changes without a reason.
    Same,
    /// It costs so much more: things have changed, and it is not time to choose again.
    More(Cost),
}

impl<P: Planner> Agent<P> {
    /// The alternatives for every goal: the running one first, then the suspended ones, innermost
    /// first, then those that wait. Changes nothing.
    ///
    /// Plans that are kept and what the planner knows besides are judged in the present belief. Only
    /// then it is planned from scratch, with no more expansions for all goals together than take a
    /// few milliseconds, so that an agent that is asked is still an agent that listens (decision 9).
    /// On large maps that is seldom enough, and the answer says that not all was looked at.
    pub fn alternatives(&self) -> Vec<Alternatives<'_>> {
        let slice = self.configuration.policy.expansions_per_slice;
        let larger = (self.map.objects.len() / SMALL).isqrt().max(1) as u64;
        let mut budget = slice.saturating_mul(SLICES) / larger;
        let stacked = self.stack.entries().iter().rev();
        let aside = self.aside.goals().iter();
        let waiting = self.waiting.intentions().iter();
        (self
            .running()
            .map(|it| (it, GoalPlace::Running))
            .into_iter())
        .chain(stacked.map(|entry| (&entry.intention, GoalPlace::Suspended)))
        .chain(waiting.map(|it| (it, GoalPlace::Waiting)))
        .chain(aside.map(|(it, _)| (it, GoalPlace::Aside)))
        .map(|(intention, place)| self.alternatives_of(intention, place, &mut budget))
        .collect()
    }

    fn alternatives_of<'a>(
        &self,
        intention: &'a Intention,
        place: GoalPlace,
        budget: &mut u64,
    ) -> Alternatives<'a> {
        let problem = self.problem_of(Some(intention));
        let wanted = Settings::default().alternatives;
        // The action that runs has begun: the first step of the first plan, if it is still that.
        let executing = match place {
            GoalPlace::Running => self.executing().map(|(_, action, _)| action),
            _ => None,
        };
        let evaluate = |plan: Plan, kept: bool| {
            let first = plan.steps.first();
            let running = kept && executing.is_some() && first.map(|it| it.action()) == executing;
            let verdict = simulate(&problem, &plan.steps, running);
            Alternative {
                cost: match verdict {
                    Ok(cost) if plan.rest.is_empty() => cost,
                    _ => plan.cost,
                },
                hangs_on: hangs_on(&problem, &plan.steps, running),
                broken: verdict.err(),
                plan,
                kept,
            }
        };
        let mut plans: Vec<Alternative> = (intention.plans.iter())
            .map(|plan| evaluate(plan.clone(), true))
            .collect();
        if intention.cancelled.is_none() {
            for plan in self.planner.known(&problem, &intention.agendas) {
                add(&mut plans, evaluate(plan, false));
            }
        }
        let valid = plans.iter().filter(|plan| plan.broken.is_none());
        let best = valid.map(|plan| plan.cost).min();
        // Plans that are not decomposed to the end cost what is estimated: nothing is told from that.
        let in_full = intention.plans.iter().all(|plan| plan.rest.is_empty());
        let Considered {
            plans: found,
            what_if,
            complete,
            expanded,
        } = match in_full && intention.cancelled.is_none() {
            true => {
                // To know what a better plan wants, the best is enough.
                let settings = match plans.iter().filter(|plan| plan.broken.is_none()).count() {
                    valid if valid >= wanted => Settings {
                        alternatives: 1,
                        ..Settings::default()
                    },
                    _ => Settings::default(),
                };
                consider(&problem, &intention.agendas, settings, best, *budget)
            }
            false => Considered::default(),
        };
        *budget = budget.saturating_sub(expanded);
        for plan in found {
            add(&mut plans, evaluate(plan, false));
        }
        let valid = plans.iter().filter(|plan| plan.broken.is_none());
        let best = valid.map(|plan| plan.cost).min();
        let broken = plans.iter().filter(|plan| plan.broken.is_some());
        let what_if = what_if.or_else(|| {
            let mended = broken.filter_map(|it| if_mended(&problem, &it.plan, best));
            let mended = mended.filter(|_| in_full && intention.cancelled.is_none());
            mended.min_by_key(|what_if| what_if.plan.cost)
        });
        let mut index = 0;
        plans.retain(|plan| {
            index += 1;
            // Whatever it is, the first is the one that is followed.
            index == 1 || !is_detour(&problem, &plan.plan)
        });
        if let Some((_, others)) = plans.split_first_mut() {
            others.sort_by_key(|plan| (plan.broken.is_some(), plan.cost));
        }
        plans.truncate(wanted.max(intention.plans.len()));
        Alternatives {
            choice: (intention.plans.first()).and_then(|_| choice(&plans)),
            intention,
            place,
            plans,
            what_if,
            complete,
        }
    }
}

/// Adds a plan that was found, if it is another one and holds.
fn add(plans: &mut Vec<Alternative>, found: Alternative) {
    let same = |known: &Alternative| known.plan.purposes().eq(found.plan.purposes());
    if found.broken.is_none() && !plans.iter().any(same) {
        plans.push(found);
    }
}

/// Why the first is followed.
fn choice(plans: &[Alternative]) -> Option<Choice> {
    let (followed, others) = plans.split_first()?;
    let others = others.iter().filter(|plan| plan.broken.is_none());
    let against_others = match others.map(|plan| plan.cost).min() {
        None => Against::None,
        Some(cost) if cost == followed.cost => Against::Same,
        Some(cost) if cost > followed.cost => Against::Less(Cost(cost.0 - followed.cost.0)),
        Some(cost) => Against::More(Cost(followed.cost.0 - cost.0)),
    };
    let first = followed.plan.steps.first().map(|step| &step.item);
    Some(Choice {
        against_others,
        resumes: match first {
            Some(Item::Resume { original, .. }) => Some(original.clone()),
            _ => None,
        },
        undoes: match first {
            Some(Item::RollBack { action, .. }) => Some(action.clone()),
            _ => None,
        },
    })
}
