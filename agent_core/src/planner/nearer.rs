//! Whether an action may be of use, at a glance.

use super::Problem;
use super::cost::cost_of;
use super::estimate::estimate;
use super::network::TaskList;
use super::state::{Delta, View, bind_arguments};
use crate::model::{Action, Cost};

/// Whether it is worth while to plan in order to find out if the cheapest way to do `tasks` begins with
/// `action`: by the estimates alone, without a plan.
///
/// Less has to be left after the action than before it; and the whole way must not be so long that it
/// takes more than `most` such actions, as then no small budget would show it. Where nothing is
/// estimated, it may be worth while.
pub fn may_begin_with(problem: &Problem, tasks: &TaskList, action: &Action, most: u64) -> bool {
    let Some(operator) = problem.domain.operators.get(&action.name) else {
        return false;
    };
    let now = Delta::new();
    let view = View {
        problem,
        delta: &now,
    };
    let bindings = bind_arguments(&action.args, &operator.parameters);
    let before = estimate(problem, &now, tasks);
    let after = estimate(problem, &view.after(&operator.effect, &bindings), tasks);
    if before == Cost::ZERO && after == Cost::ZERO {
        return true;
    }
    let starts_with_it = tasks
        .items()
        .next()
        .is_some_and(|item| item.atom() == action);
    let long = Cost(cost_of(view, action).0.saturating_mul(most));
    starts_with_it || after < before && (long == Cost::ZERO || before <= long)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Arc;

    use super::*;
    use crate::language::parse_domain;
    use crate::model::{
        Atom, Belief, Clause, ExecutionModel, Fact, FactChange, Map, Number, Parameter, Pattern,
        TaskModel, Term,
    };
    use crate::planner::Item;

    /// A robot at the middle of three rooms in a row, which knows how far it is from each to the goal.
    fn problem(estimated: bool, far: f64) -> Problem {
        let text = "(define (domain d)
          (:requirements :hierarchy :action-costs)
          (:predicates (in ?r))
          (:functions (total-cost) (left ?r))
          (:task reach :parameters ())
          (:method on :parameters (?a ?b) :task (reach) :precondition (in ?a)
            :ordered-subtasks (and (pass ?a ?b) (reach)))
          (:action greet :parameters () :effect (increase (total-cost) 2))
          (:action pass :parameters (?a ?b) :precondition (in ?a)
            :effect (and (not (in ?a)) (in ?b) (increase (total-cost) 5))))";
        let mut belief = Belief::default();
        belief.apply(&FactChange::Add(Fact::new("in", ["middle"])));
        for (room, left) in [("west", far + 5.0), ("middle", far), ("east", far - 5.0)] {
            belief.apply(&FactChange::Set(Fact::new("left", [room]), left));
        }
        let room = || vec![Term::Variable(0)];
        let pattern = |name: &str| Pattern {
            name: name.into(),
            args: room(),
        };
        let reach = TaskModel {
            parameters: vec![Parameter {
                name: "?r".into(),
                kind: "object".into(),
            }],
            given: vec![Clause::Fact(true, pattern("in"))],
            estimate: Number::Function(pattern("left")),
            establishes: Vec::new(),
        };
        let mut model = ExecutionModel::default();
        if estimated {
            model.tasks.insert("reach".into(), reach);
        }
        Problem {
            domain: Arc::new(parse_domain(text).expect("a sound domain")),
            model: Arc::new(model),
            map: Arc::new(Map::default()),
            belief: Arc::new(belief),
            forbidden: BTreeSet::new(),
        }
    }

    fn may(problem: &Problem, task: &str, to: &str) -> bool {
        let tasks = TaskList::empty().prepend(Item::Task(Atom::new(task, [])), None);
        may_begin_with(problem, &tasks, &Atom::new("pass", ["middle", to]), 10)
    }

    #[test]
    fn what_leads_nearer_may_be_of_use_and_what_leads_away_is_not() {
        let near = problem(true, 20.0);
        assert!(may(&near, "reach", "east"));
        assert!(!may(&near, "reach", "west"));
        assert!(!may(&near, "greet", "east"));
    }

    #[test]
    fn no_small_budget_shows_where_a_long_way_begins() {
        assert!(may(&problem(true, 50.0), "reach", "east"));
        assert!(!may(&problem(true, 51.0), "reach", "east"));
    }

    #[test]
    fn where_nothing_is_estimated_only_a_plan_can_tell() {
        assert!(may(&problem(false, 20.0), "reach", "west"));
    }
}
