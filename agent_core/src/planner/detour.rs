//! Plans that come back to where they were.

use std::collections::BTreeSet;

use super::network::TaskList;
use super::plan::Plan;
use super::state::{Delta, View, bind_arguments};
use super::{Frame, Problem};
use crate::model::{Domain, Symbol};

/// The predicates on which it hangs what can be done. Others are facts to remember, or bear on costs
/// alone.
pub(super) fn decisive(domain: &Domain) -> BTreeSet<Symbol> {
    let methods = domain.methods.iter().map(|method| &method.precondition);
    let operators = domain.operators.values().map(|it| &it.precondition);
    let mut decisive = BTreeSet::new();
    for clause in methods.chain(operators).flatten() {
        clause.each_pattern(&mut |pattern| {
            decisive.insert(pattern.name.clone());
        });
    }
    decisive
}

/// Whether a plan comes back to a state in which the same was to be done already, as far as it hangs
/// on the state what can be done: it goes somewhere, and back, for nothing.
pub fn is_detour(problem: &Problem, plan: &Plan) -> bool {
    let decisive = decisive(&problem.domain);
    let mut delta = Delta::new();
    // By state: what was to be done in it, tasks that had been begun there or before as a whole.
    let mut seen: Vec<(Delta, Vec<TaskList>)> = Vec::new();
    let mut left: Option<&TaskList> = None;
    for step in &plan.steps {
        let of_state: Delta = (delta.iter())
            .filter(|(fact, _)| decisive.contains(&fact.name))
            .map(|(fact, holds)| (fact.clone(), *holds))
            .collect();
        let again = |tasks: &TaskList| {
            let mut same = seen.iter().filter(|(state, _)| *state == of_state);
            same.any(|(_, before)| before.contains(tasks))
        };
        if left.is_some_and(again) {
            return true;
        }
        let frames = std::iter::successors(step.frame.as_deref(), |it| it.parent.as_deref());
        let whole = |it: &Frame| it.rest.prepend(it.task.clone(), it.parent.clone());
        seen.push((of_state, frames.map(whole).chain(left.cloned()).collect()));
        let action = step.action();
        let Some(operator) = problem.domain.operators.get(&action.name) else {
            return false;
        };
        let bindings = bind_arguments(&action.args, &operator.parameters);
        let view = View {
            problem,
            delta: &delta,
        };
        delta = view.after(&operator.effect, &bindings);
        left = Some(&step.rest);
    }
    false
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::language::parse_domain;
    use crate::model::{Atom, Belief, Cost, ExecutionModel, Fact, FactChange, Map};
    use crate::planner::{Item, Step};

    /// The robot goes from room to room until it is at `c`.
    fn way(rooms: &[&str]) -> bool {
        let text = "(define (domain d)
          (:requirements :hierarchy)
          (:constants c)
          (:predicates (in ?r) (been ?r))
          (:task walk :parameters ())
          (:method on :parameters (?a ?b) :task (walk) :precondition (in ?a)
            :ordered-subtasks (and (pass ?a ?b) (walk)))
          (:method there :parameters () :task (walk) :precondition (in c) :ordered-subtasks ())
          (:action pass :parameters (?a ?b) :precondition (in ?a)
            :effect (and (not (in ?a)) (in ?b) (been ?b))))";
        let mut belief = Belief::default();
        belief.apply(&FactChange::Add(Fact::new("in", [rooms[0]])));
        let problem = Problem {
            domain: Arc::new(parse_domain(text).expect("a sound domain")),
            model: Arc::new(ExecutionModel::default()),
            map: Arc::new(Map::default()),
            belief: Arc::new(belief),
            forbidden: BTreeSet::new(),
        };
        let walk = Item::Task(Atom::new("walk", []));
        let mut parent = None;
        let mut steps = Vec::new();
        for pair in rooms.windows(2) {
            let frame = Arc::new(Frame {
                id: 0,
                task: walk.clone(),
                rest: TaskList::empty(),
                parent: parent.take(),
            });
            steps.push(Step {
                item: Item::Task(Atom::new("pass", [pair[0], pair[1]])),
                cost: Cost(1),
                frame: Some(frame.clone()),
                rest: TaskList::empty().prepend(walk.clone(), Some(frame.clone())),
            });
            parent = Some(frame);
        }
        let plan = Plan {
            steps,
            rest: TaskList::empty(),
            cost: Cost(1),
        };
        is_detour(&problem, &plan)
    }

    #[test]
    fn to_go_on_is_no_detour() {
        assert!(!way(&["a", "b", "d", "c"]));
    }

    #[test]
    fn to_go_somewhere_and_back_is_a_detour_from_the_first_step_on() {
        assert!(way(&["a", "b", "a", "c"]));
        assert!(way(&["a", "b", "d", "b", "c"]));
    }
}
