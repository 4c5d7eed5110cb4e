//! Plans before the judge that shares no code with any planner (`plan_checker`).

use crate::language::{write_domain, write_problem};
use crate::model::{Atom, Domain, FactChange, Instance, Number, Pattern, Symbol, Term};
use crate::planner::{Agenda, Plan, Problem};

/// Whether the actions of `plan` do what one of the agendas asks for, from the belief on: else what
/// is wrong with them, for each agenda.
pub(super) fn judge(problem: &Problem, agendas: &[Agenda], plan: &Plan) -> Result<(), String> {
    // What actions cost the judge need not know: it is compared with planning from scratch.
    let mut domain = Domain::clone(&problem.domain);
    for operator in domain.operators.values_mut() {
        operator.cost = Number::Constant(0.0);
    }
    let domain = write_domain(&domain);
    let actions: Vec<String> = plan.actions().iter().map(Atom::to_string).collect();
    let actions = actions.join("\n");
    let mut faults = String::new();
    for agenda in agendas {
        let text = write_problem(&instance(problem, agenda));
        match plan_checker::check_sequence(&domain, &text, &actions) {
            Ok(_) => return Ok(()),
            Err(wrong) => faults += &format!("{:?}: {wrong:?}\n", agenda.origin),
        }
    }
    Err(format!("{actions}\n{faults}{domain}"))
}

/// The agenda as a problem of its own.
fn instance(problem: &Problem, agenda: &Agenda) -> Instance {
    let mut init = problem.map.facts.clone();
    for fact in problem.belief.facts() {
        init.apply(&FactChange::Add(fact.clone()));
    }
    for (function, value) in problem.belief.values() {
        init.apply(&FactChange::Set(function.clone(), value));
    }
    let tasks = agenda.tasks.items().map(|item| Pattern {
        name: item.atom().name.clone(),
        args: item
            .atom()
            .args
            .iter()
            .cloned()
            .map(Term::Constant)
            .collect(),
    });
    Instance {
        name: Symbol::from("history"),
        domain: problem.domain.name.clone(),
        objects: problem.map.objects.clone(),
        init,
        tasks: tasks.collect(),
        ..Instance::default()
    }
}
