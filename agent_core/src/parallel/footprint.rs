//! What an action needs and what it does, as plain facts.

use std::collections::{BTreeMap, BTreeSet};

use crate::model::{Action, Clause, Fact, Symbol, Time};
use crate::planner::{
    Plan, Problem, Step, adds_and_removes, hangs_on, instance, number_of, protected_by,
    with_changes,
};

/// Facts, and whether they have to hold.
pub type Literals = BTreeMap<Fact, bool>;

/// What one action needs and does.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Footprint {
    /// The action.
    pub action: Action,
    /// What must be so when it begins (`pre`).
    pub needs: Literals,
    /// What must be so as long as it runs (`prot`).
    pub protects: Literals,
    /// What holds once it is done (`add`).
    pub adds: BTreeSet<Fact>,
    /// What no longer does (`del`); nothing that it adds.
    pub removes: BTreeSet<Fact>,
    /// What it has for itself alone while it runs.
    pub resources: BTreeSet<Symbol>,
    /// How long it takes, by the execution model; nothing, if that does not say.
    pub duration: Time,
}

impl Footprint {
    /// That of a step, in the present belief. A resuming action has the resources and the protected
    /// states of the action that it resumes.
    ///
    /// Of conditions with `or`, `forall` and `exists`, those facts count that cannot be otherwise now
    /// ([`hangs_on`]).
    pub fn of(problem: &Problem, step: &Step) -> Self {
        let action = step.action();
        let purpose = step.purpose();
        let models = [action, purpose].map(|it| (it, problem.model.actions.get(&it.name)));
        let reliances = hangs_on(problem, std::slice::from_ref(step), false);
        let mut needs: Literals = (reliances.into_iter())
            .map(|reliance| (reliance.fact, reliance.wanted))
            .collect();
        let mut protects = Literals::new();
        for clause in protected_by(problem, step) {
            if let Clause::Fact(wanted, pattern) = clause {
                let fact = instance(pattern, purpose);
                protects.extend(fact.map(|fact| (fact, *wanted)));
            }
        }
        needs.extend(
            protects
                .iter()
                .map(|(fact, wanted)| (fact.clone(), *wanted)),
        );
        let (adds, removes) = adds_and_removes(problem, action);
        let resources = (models.iter())
            .filter_map(|(_, model)| *model)
            .flat_map(|model| model.resources.iter().cloned());
        let mut seconds = models
            .iter()
            .filter_map(|(of, model)| number_of(problem, model.as_ref()?.duration_s.as_ref()?, of));
        Self {
            action: action.clone(),
            needs,
            protects,
            adds,
            removes,
            resources: resources.collect(),
            duration: seconds.next().map_or(Time::ZERO, Time::from_secs),
        }
    }

    /// Whether doing it makes one of these otherwise than it has to be.
    pub fn undoes(&self, literals: &Literals) -> bool {
        literals.iter().any(|(fact, wanted)| match wanted {
            true => self.removes.contains(fact),
            false => self.adds.contains(fact),
        })
    }

    /// Whether doing it makes this so.
    pub fn brings_about(&self, fact: &Fact, wanted: bool) -> bool {
        match wanted {
            true => self.adds.contains(fact),
            false => self.removes.contains(fact),
        }
    }

    /// What is otherwise once it is done.
    pub fn effects(&self) -> impl Iterator<Item = (&Fact, bool)> {
        let removes = self.removes.iter().map(|fact| (fact, false));
        removes.chain(self.adds.iter().map(|fact| (fact, true)))
    }
}

/// An action that could be done next for a goal.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Candidate {
    /// The action.
    pub footprint: Footprint,
    /// Those of its needs that are not so now: it can only join others that bring them about.
    pub missing: Literals,
    /// What the rest of its plan needs once it is done.
    pub later: Literals,
    /// When its goal has failed if it is not done.
    pub deadline: Option<Time>,
}

impl Candidate {
    /// The first action of a plan.
    pub fn of(problem: &Problem, plan: &Plan, deadline: Option<Time>) -> Option<Self> {
        let (first, rest) = plan.steps.split_first()?;
        let footprint = Footprint::of(problem, first);
        let holds = |fact: &Fact| problem.belief.holds(fact) || problem.map.facts.holds(fact);
        let missing = (footprint.needs.iter())
            .filter(|(fact, wanted)| holds(fact) != **wanted)
            .map(|(fact, wanted)| (fact.clone(), *wanted))
            .collect();
        let after = with_changes(problem, footprint.effects());
        let later = (hangs_on(&after, rest, false).into_iter())
            .map(|reliance| (reliance.fact, reliance.wanted))
            .collect();
        Some(Self {
            footprint,
            missing,
            later,
            deadline,
        })
    }

    /// What it is done for: those of its effects that the rest of its plan needs, or all of them if
    /// that needs none.
    pub fn point(&self) -> impl Iterator<Item = (&Fact, bool)> {
        let needed = |(fact, holds): &(&Fact, bool)| self.later.get(*fact) == Some(holds);
        let some = self.footprint.effects().any(|effect| needed(&effect));
        self.footprint
            .effects()
            .filter(move |effect| !some || needed(effect))
    }
}
