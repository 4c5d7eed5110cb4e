//! Mistakes in execution models, and what must not be taken for one.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod beyond;

use super::*;
use crate::language::{
    parse_domain, parse_effects, parse_literal, parse_number, parse_parameter, parse_pattern,
};
use crate::model::{
    ActionModel, Domain, ExecutionModel, Projection, Suspension, Symbol, TaskModel,
};

const WALK: &str = "(define (domain walk)
  (:types node arc - object exhibit - node)
  (:constants home - node)
  (:predicates (at ?n - node) (on ?a - arc) (left ?n - node) (link ?x ?y - node ?a - arc)
    (free ?a - arc) (lit))
  (:functions (length ?a - arc))
  (:task reach :parameters (?n - node))
  (:method there :parameters (?n - node) :task (reach ?n) :precondition (at ?n)
    :ordered-subtasks ())
  (:action move :parameters (?x ?y - node ?a - arc)
    :precondition (and (at ?x) (link ?x ?y ?a))
    :effect (and (not (at ?x)) (at ?y)))
  (:action resume-move :parameters (?x ?y - node ?a - arc)
    :precondition (on ?a)
    :effect (and (not (on ?a)) (not (left ?x)) (at ?y)))
  (:action return :parameters (?x - node ?a - arc)
    :precondition (and (on ?a) (left ?x))
    :effect (and (not (on ?a)) (not (left ?x)) (at ?x)))
  (:action jump :parameters (?y - node)
    :effect (and (forall (?x - node) (not (at ?x))) (at ?y)))
  (:action resume-jump :parameters (?y - node)
    :effect (and (forall (?x - node) (not (at ?x))) (at ?y))))";

const SUSPENDED: &[&str] = &["(not (at ?x))", "(on ?a)", "(left ?x)"];

#[test]
fn an_action_that_sensors_have_to_confirm_needs_a_time_out() {
    let domain = walk();
    let parameters = &domain.operators["move"].parameters;
    let mut model = suspended(&domain, "move", SUSPENDED, "(resume-move ?x ?y ?a)");
    let action = model.actions.get_mut("move").unwrap();
    action.goal_states = vec![parse_literal("(at ?y)", parameters).unwrap()];
    let errors = check_model(&domain, &model);
    let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(
        errors,
        [
            "`move` is done only when sensors confirm it; add a `timeout_s`, after which it counts as failed"
        ]
    );
    model.actions.get_mut("move").unwrap().timeout_s = Some(parse_number("5", parameters).unwrap());
    assert_eq!(check_model(&domain, &model), []);
}

/// The domain with one piece replaced.
fn walk_with(piece: &str, replacement: &str) -> Domain {
    assert!(WALK.contains(piece), "{piece}");
    parse_domain(&WALK.replacen(piece, replacement, 1)).unwrap()
}

fn walk() -> Domain {
    parse_domain(WALK).unwrap()
}

/// A model in which `action` is suspended like this, and nothing else is said.
fn suspended(domain: &Domain, action: &str, effect: &[&str], resume: &str) -> ExecutionModel {
    let parameters = &domain.operators[action].parameters;
    let suspension = Suspension {
        effect: parse_effects(effect, parameters, domain).unwrap(),
        resume: parse_pattern(resume, parameters).unwrap(),
        rollback: None,
        reach: None,
    };
    let action_model = ActionModel {
        suspension: Some(suspension),
        ..ActionModel::default()
    };
    let mut model = ExecutionModel::default();
    model.actions.insert(Symbol::from(action), action_model);
    model
}

fn move_model(domain: &Domain) -> ExecutionModel {
    suspended(domain, "move", SUSPENDED, "(resume-move ?x ?y ?a)")
}

/// The one suspension of the model.
fn suspension_of(model: &mut ExecutionModel) -> &mut Suspension {
    let action = model.actions.values_mut().next().unwrap();
    action.suspension.as_mut().unwrap()
}

#[track_caller]
fn refused(domain: &Domain, model: &ExecutionModel, key: &str, words: &[&str]) {
    let errors = check_model(domain, model);
    let messages: Vec<String> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(errors.len(), 1, "{messages:#?}");
    assert_eq!(errors[0].key(), key, "{messages:#?}");
    for word in words {
        assert!(messages[0].contains(word), "{word} is not in {messages:#?}");
    }
}

#[test]
fn a_move_that_is_resumed_from_the_middle_is_accepted() {
    let domain = walk();
    assert_eq!(check_model(&domain, &move_model(&domain)), []);
}

#[test]
fn an_effect_on_all_objects_is_the_same_on_both_ways() {
    let domain = walk();
    let everywhere = &["(forall (?x - node) (not (at ?x)))"];
    let model = suspended(&domain, "jump", everywhere, "(resume-jump ?y)");
    assert_eq!(check_model(&domain, &model), []);
    let model = suspended(&domain, "jump", &[], "(resume-jump ?y)");
    assert_eq!(check_model(&domain, &model), []);
}

#[test]
fn an_effect_on_all_objects_is_not_replaced_by_one_on_some() {
    let domain = walk_with(
        "(:action resume-jump :parameters (?y - node)
    :effect (and (forall (?x - node) (not (at ?x))) (at ?y)))",
        "(:action resume-jump :parameters (?y - node)
    :effect (and (not (at home)) (at ?y)))",
    );
    let model = suspended(&domain, "jump", &[], "(resume-jump ?y)");
    let key = "action.jump.suspension.resume";
    let words = "`(at ?other)` is false after `jump`, but as it was before after suspending";
    refused(&domain, &model, key, &[words]);
}

#[test]
fn a_resuming_action_whose_precondition_nobody_provides_is_refused() {
    let domain = walk_with(
        "(on ?a)\n    :effect",
        "(and (on ?a) (free ?a))\n    :effect",
    );
    let words = [
        "`move` is suspended",
        "(resume-move ?x ?y ?a)",
        "`(free ?a)` is true",
    ];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
}

#[test]
fn a_precondition_that_the_suspension_undoes_is_refused() {
    let domain = walk_with("(on ?a)\n    :effect", "(and (on ?a) (at ?x))\n    :effect");
    let words = ["`(at ?x)` is true"];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
}

#[test]
fn a_precondition_that_the_action_had_and_nobody_undoes_is_accepted() {
    let domain = walk_with(
        "(on ?a)\n    :effect",
        "(and (on ?a) (link ?x ?y ?a))\n    :effect",
    );
    assert_eq!(check_model(&domain, &move_model(&domain)), []);
}

#[test]
fn a_precondition_that_something_is_false_must_be_provided_too() {
    let domain = walk_with(
        "(on ?a)\n    :effect",
        "(and (on ?a) (not (at ?x)))\n    :effect",
    );
    assert_eq!(check_model(&domain, &move_model(&domain)), []);
    let domain = walk_with(
        "(on ?a)\n    :effect",
        "(and (on ?a) (not (lit)))\n    :effect",
    );
    let words = ["`(lit)` is false"];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
}

#[test]
fn an_inequality_must_be_one_of_the_suspended_action() {
    let resume = "(and (on ?a) (not (= ?x ?y)))\n    :effect";
    let domain = walk_with("(on ?a)\n    :effect", resume);
    let words = ["`?x` and `?x` differ when `?x` and `?y` are the same"];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
    let both = WALK
        .replacen("(on ?a)\n    :effect", resume, 1)
        .replace("(and (at ?x) (link", "(and (at ?x) (not (= ?x ?y)) (link");
    let domain = parse_domain(&both).unwrap();
    assert_eq!(check_model(&domain, &move_model(&domain)), []);
}

#[test]
fn a_mark_of_the_suspension_that_stays_is_refused() {
    let domain = walk_with(
        "(not (on ?a)) (not (left ?x)) (at ?y)",
        "(not (on ?a)) (at ?y)",
    );
    let words = ["`(left ?x)` is as it was before after `move`, but true after suspending"];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
}

#[test]
fn a_result_that_the_resuming_action_forgets_is_refused() {
    let domain = walk_with("(at ?y)))\n  (:action return", "(lit)))\n  (:action return");
    let errors = check_model(&domain, &move_model(&domain));
    let messages: Vec<String> = errors.iter().map(ToString::to_string).collect();
    assert_eq!(errors.len(), 2, "{messages:#?}");
    assert!(messages[0].contains("`(at ?y)` is true after `move`, but as it was"));
    assert!(messages[1].contains("`(lit)` is as it was before after `move`, but true"));
}

#[test]
fn arguments_in_another_order_are_noticed() {
    let domain = walk();
    let model = suspended(&domain, "move", SUSPENDED, "(resume-move ?y ?x ?a)");
    let errors = check_model(&domain, &model);
    assert!(!errors.is_empty());
    assert!(
        errors
            .iter()
            .all(|error| error.key() == "action.move.suspension.resume")
    );
}

#[test]
fn a_fact_of_the_precondition_must_not_be_lost_on_the_way() {
    let domain = walk_with("(and (at ?x) (link", "(and (at ?x) (on ?a) (link");
    let words = ["`(on ?a)` is true after `move`, but false after suspending"];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
}

#[test]
fn a_fact_that_only_the_resuming_action_removes_must_be_observable() {
    let domain = walk_with(
        "(not (on ?a)) (not (left ?x))",
        "(not (free ?a)) (not (on ?a)) (not (left ?x))",
    );
    let mut model = move_model(&domain);
    let words = ["`(free ?a)` is as it was before after `move`, but false"];
    refused(&domain, &model, "action.move.suspension.resume", &words);
    model.observable.push(Symbol::from("free"));
    assert_eq!(check_model(&domain, &model), []);
}

#[test]
fn a_difference_that_shows_only_if_two_arguments_are_the_same_is_found() {
    let domain = parse_domain(
        "(define (domain marks) (:predicates (m ?x) (p ?x))
           (:action a :parameters (?x ?y) :precondition (and (not (m ?y)) (p ?x))
             :effect (m ?x))
           (:action r :parameters (?x ?y) :effect (not (m ?y))))",
    )
    .unwrap();
    // When `?x` is `?y`, what the suspension has added is removed by resuming.
    let model = suspended(&domain, "a", &["(m ?x)"], "(r ?x ?y)");
    let words = [
        "`(m ?x)` is true after `a`, but false",
        "when `?x` and `?y` are the same",
    ];
    refused(&domain, &model, "action.a.suspension.resume", &words);
}

#[test]
fn constants_may_be_what_an_argument_is() {
    let domain = walk_with(
        "(not (on ?a)) (not (left ?x)) (at ?y)",
        "(not (on ?a)) (not (left ?x)) (not (at home)) (at ?y)",
    );
    let words = ["`(at home)` is as it was before after `move`, but false"];
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &words,
    );
}

#[test]
fn a_resuming_action_must_be_a_declared_action_that_fits() {
    let domain = walk();
    let resume = |text: &str, words: &str| {
        let model = suspended(&domain, "move", SUSPENDED, text);
        refused(&domain, &model, "action.move.suspension.resume", &[words]);
    };
    resume("(resume-mvoe ?x ?y ?a)", "did you mean `resume-move`?");
    resume("(resume-move ?x ?y)", "takes 3 argument(s) and is given 2");
    resume(
        "(reach ?x)",
        "`move` needs an action here, but `reach` is a task",
    );
    resume(
        "(resume-move ?x ?y hom)",
        "`hom` is not declared among the constants",
    );
}

#[test]
fn an_argument_that_only_sometimes_fits_cannot_resume() {
    // Not every node is an exhibit.
    let domain = walk_with(
        "resume-move :parameters (?x ?y - node",
        "resume-move :parameters (?x ?y - exhibit",
    );
    let errors = check_model(&domain, &move_model(&domain));
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(
        errors[0]
            .to_string()
            .contains("`?x` is of type node, but `resume-move` takes exhibit")
    );
}

#[test]
fn what_rolls_back_or_reaches_must_be_declared_and_fit() {
    let domain = walk();
    let parameters = &domain.operators["move"].parameters;
    let mut model = move_model(&domain);
    let pattern = |text| Some(parse_pattern(text, parameters).unwrap());
    suspension_of(&mut model).rollback = pattern("(return ?x ?a)");
    suspension_of(&mut model).reach = pattern("(reach ?x)");
    assert_eq!(check_model(&domain, &model), []);
    suspension_of(&mut model).rollback = pattern("(return ?x)");
    refused(
        &domain,
        &model,
        "action.move.suspension.rollback",
        &["takes 2 argument(s)"],
    );
    suspension_of(&mut model).rollback = pattern("(reach ?x)");
    refused(
        &domain,
        &model,
        "action.move.suspension.rollback",
        &["`reach` is a task"],
    );
    suspension_of(&mut model).rollback = None;
    suspension_of(&mut model).reach = pattern("(reach ?a)");
    refused(
        &domain,
        &model,
        "action.move.suspension.reach",
        &["`?a` is of type arc"],
    );
}

#[test]
fn every_name_of_an_entry_is_looked_up() {
    let domain = walk();
    let parameters = domain.operators["move"].parameters.clone();
    let number = |text| Some(parse_number(text, &parameters).unwrap());
    let action = ActionModel {
        duration_s: number("(lenght ?a)"),
        timeout_s: number("(+ 1 (* 2 (length ?x)))"),
        protected: vec![parse_literal("(fre ?a)", &parameters).unwrap()],
        ..ActionModel::default()
    };
    let node = parse_parameter("?n - node").unwrap();
    let task = TaskModel {
        parameters: vec![node.clone(), parse_parameter("?m - nod").unwrap()],
        given: vec![parse_literal("(at ?n)", std::slice::from_ref(&node)).unwrap()],
        estimate: parse_number("(gap ?n)", std::slice::from_ref(&node)).unwrap(),
        establishes: vec![parse_pattern("(at)", &[]).unwrap()],
    };
    let mut model = ExecutionModel::default();
    for name in ["move", "mve"] {
        model.actions.insert(Symbol::from(name), action.clone());
    }
    for name in ["reach", "move"] {
        model.tasks.insert(Symbol::from(name), task.clone());
    }
    model.observable = vec![Symbol::from("frei"), Symbol::from("at")];
    model.projections = vec![Projection {
        parameters: vec![node.clone()],
        when: vec![parse_literal("(att ?n)", &[node]).unwrap()],
        then: parse_pattern("(anything at all)", &[]).unwrap(),
    }];
    let errors = check_model(&domain, &model);
    let mut keys: Vec<&str> = errors.iter().map(DomainError::key).collect();
    keys.dedup();
    assert_eq!(
        keys,
        [
            "action.move.duration_s",
            "action.move.timeout_s",
            "action.move.protected",
            "action.mve",
            "task.move",
            "task.reach.variables",
            "task.reach.estimate",
            "task.reach.establishes",
            "observable",
            "projection.1.when",
        ],
        "{errors:#?}"
    );
    let words = |index: usize| errors[index].to_string();
    assert_eq!(
        words(0),
        "action.move.duration_s: `lenght` is not a declared function; did you mean `length`?"
    );
    assert_eq!(
        words(4),
        "task.move: `move` is not a declared task; it is an action"
    );
}
