//! Conditions and effects mean what HDDL says, as far as a second reading of them can tell.

use std::collections::BTreeSet;
use std::sync::Arc;

use proptest::prelude::*;

use super::Problem;
use super::matching::for_each_binding;
use super::state::{Bindings, Delta, View};
use crate::model::arbitrary::{Choices, condition, domain, effect, instance};
use crate::model::{
    Clause, Domain, Effect, ExecutionModel, Fact, Instance, Map, Parameter, Symbol, Term,
};

/// All that is asked of conditions here: objects with types, and facts.
struct World {
    domain: Domain,
    objects: Vec<(Symbol, Symbol)>,
    facts: BTreeSet<Fact>,
}

impl World {
    fn new(domain: Domain, instance: &Instance) -> Self {
        let objects = domain.constants.iter().chain(&instance.objects);
        Self {
            objects: objects
                .map(|(object, kind)| (object.clone(), kind.clone()))
                .collect(),
            facts: instance.init.facts().cloned().collect(),
            domain,
        }
    }

    fn problem(&self, instance: &Instance) -> Problem {
        Problem {
            domain: Arc::new(self.domain.clone()),
            model: Arc::new(ExecutionModel::default()),
            map: Arc::new(Map {
                objects: instance.objects.clone(),
                ..Map::default()
            }),
            belief: Arc::new(instance.init.clone()),
            forbidden: BTreeSet::new(),
        }
    }

    /// Every way to put objects of their types in the place of variables, by trying.
    fn bindings(&self, variables: &[Parameter], outer: &[Symbol]) -> Vec<Vec<Symbol>> {
        let Some((first, rest)) = variables.split_first() else {
            return vec![outer.to_vec()];
        };
        let fitting = self
            .objects
            .iter()
            .filter(|(_, kind)| self.domain.is_a(kind, &first.kind));
        fitting
            .flat_map(|(object, _)| {
                let outer = [outer, std::slice::from_ref(object)].concat();
                self.bindings(rest, &outer)
            })
            .collect()
    }

    fn all_hold(&self, condition: &[Clause], bound: &[Symbol]) -> bool {
        condition.iter().all(|clause| self.holds(clause, bound))
    }

    fn holds(&self, clause: &Clause, bound: &[Symbol]) -> bool {
        let object = |term: &Term| match term {
            Term::Variable(index) => bound[*index].clone(),
            Term::Constant(object) => object.clone(),
        };
        match clause {
            Clause::Fact(wanted, pattern) => {
                let fact = Fact {
                    name: pattern.name.clone(),
                    args: pattern.args.iter().map(object).collect(),
                };
                self.facts.contains(&fact) == *wanted
            }
            Clause::Equal(wanted, left, right) => (object(left) == object(right)) == *wanted,
            Clause::Any(choices) => choices.iter().any(|choice| self.all_hold(choice, bound)),
            Clause::Every(variables, inner) => self
                .bindings(variables, bound)
                .iter()
                .all(|bound| self.all_hold(inner, bound)),
            Clause::Exists(variables, inner) => self
                .bindings(variables, bound)
                .iter()
                .any(|bound| self.all_hold(inner, bound)),
        }
    }

    fn after(&self, effect: &Effect, bound: &[Symbol]) -> BTreeSet<Fact> {
        let mut facts = self.facts.clone();
        for (changes, adds) in [(&effect.remove, false), (&effect.add, true)] {
            for change in changes {
                for bound in self.bindings(&change.over, bound) {
                    if !self.all_hold(&change.when, &bound) {
                        continue;
                    }
                    let bound: Vec<_> = bound.into_iter().map(Some).collect();
                    let fact = change.fact.ground(&bound).expect("all is bound");
                    if adds {
                        facts.insert(fact);
                    } else {
                        facts.remove(&fact);
                    }
                }
            }
        }
        facts
    }
}

fn scope(domain: &Domain, count: usize, choices: &mut Choices<'_>) -> Vec<Parameter> {
    let kinds: Vec<&Symbol> = domain.types.keys().collect();
    (0..count)
        .map(|index| Parameter {
            name: Symbol::from(format!("?v{index}")),
            kind: kinds[choices.below(kinds.len())].clone(),
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn a_condition_holds_for_just_the_objects_that_trying_finds(
        choices in prop::collection::vec(any::<u16>(), 0..300),
    ) {
        let mut choices = Choices::new(&choices);
        let mut domain = domain(&mut choices);
        let instance = instance(&domain, &mut choices);
        let parameters = scope(&domain, choices.below(4), &mut choices);
        let condition = condition(&mut domain, &parameters, 3, &mut choices);
        let world = World::new(domain, &instance);
        let problem = world.problem(&instance);
        let delta = Delta::new();
        let view = View { problem: &problem, delta: &delta };

        let mut found: Vec<Bindings> = Vec::new();
        for_each_binding(
            view,
            &parameters,
            &condition,
            vec![None; parameters.len()],
            &mut BTreeSet::new(),
            &mut |bindings| found.push(bindings.clone()),
        );
        found.sort();
        found.dedup();

        let all = world.bindings(&parameters, &[]);
        let mut wanted: Vec<Bindings> = Vec::new();
        for bound in all {
            let holds = world.all_hold(&condition, &bound);
            let bound: Bindings = bound.into_iter().map(Some).collect();
            prop_assert_eq!(view.check(&condition, &bound).is_ok(), holds, "{:?}", condition);
            if holds {
                wanted.push(bound);
            }
        }
        wanted.sort();
        prop_assert_eq!(found, wanted, "{:?}", condition);
    }

    #[test]
    fn an_effect_changes_just_the_facts_that_trying_changes(
        choices in prop::collection::vec(any::<u16>(), 0..300),
    ) {
        let mut choices = Choices::new(&choices);
        let mut domain = domain(&mut choices);
        let instance = instance(&domain, &mut choices);
        let parameters = scope(&domain, choices.below(3), &mut choices);
        let effect = effect(&mut domain, &parameters, &mut choices);
        let world = World::new(domain, &instance);
        let problem = world.problem(&instance);
        let delta = Delta::new();
        let view = View { problem: &problem, delta: &delta };
        for bound in world.bindings(&parameters, &[]) {
            let bindings: Bindings = bound.iter().cloned().map(Some).collect();
            let mut facts = world.facts.clone();
            for (fact, holds) in view.after(&effect, &bindings) {
                let news = if holds { facts.insert(fact) } else { facts.remove(&fact) };
                prop_assert!(news, "a delta says only what is different");
            }
            prop_assert_eq!(facts, world.after(&effect, &bound), "{:?}", effect);
        }
    }
}
