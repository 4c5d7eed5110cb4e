//! What goes beyond facts that are added and removed in any case.

use super::*;

/// The walk in which both actions need more than facts.
fn choosy() -> Domain {
    let text = WALK
        .replace("(at ?x) (link ?x ?y ?a))", "(at ?x) (or (lit) (free ?a)))")
        .replace(
            ":precondition (on ?a)",
            ":precondition (and (on ?a) (or (lit) (free ?a)))",
        );
    assert_ne!(text, WALK);
    parse_domain(&text).unwrap()
}

#[test]
fn a_choice_that_both_actions_need_and_the_suspension_leaves_alone_still_holds() {
    let domain = choosy();
    assert_eq!(check_model(&domain, &move_model(&domain)), []);
}

#[test]
fn a_choice_that_the_suspension_changes_is_not_taken_for_granted() {
    let domain = choosy();
    let effect = [SUSPENDED, &["(not (free ?a))"]].concat();
    let model = suspended(&domain, "move", &effect, "(resume-move ?x ?y ?a)");
    let errors = check_model(&domain, &model);
    assert!(
        matches!(&errors[0], DomainError::CannotResume { condition, .. } if condition.contains("`or`")),
        "{errors:#?}"
    );
}

#[test]
fn a_choice_that_only_the_resuming_action_needs_is_not_taken_for_granted() {
    let domain = walk_with(
        ":precondition (on ?a)",
        ":precondition (and (on ?a) (or (lit) (free ?a)))",
    );
    refused(
        &domain,
        &move_model(&domain),
        "action.move.suspension.resume",
        &["cannot be executed", "`or`, `forall` or `exists`"],
    );
}

#[test]
fn the_same_quantifier_over_other_variables_is_another_condition() {
    let text = WALK
        .replace(
            "(at ?x) (link ?x ?y ?a))",
            "(at ?x) (exists (?z - node) (link ?x ?z ?a)))",
        )
        .replace(
            ":precondition (on ?a)",
            ":precondition (and (on ?a) (exists (?w - node) (link ?x ?w ?a)))",
        );
    let domain = parse_domain(&text).unwrap();
    assert_eq!(check_model(&domain, &move_model(&domain)), []);
    let other = parse_domain(&text.replace("(link ?x ?w ?a)", "(link ?y ?w ?a)")).unwrap();
    assert_eq!(check_model(&other, &move_model(&other)).len(), 1);
}

#[test]
fn of_effects_that_depend_on_the_state_nothing_is_proved() {
    let key = "action.move.suspension";
    let when = walk_with(
        "(not (left ?x)) (at ?y)",
        "(not (left ?x)) (when (lit) (at ?y))",
    );
    refused(
        &when,
        &move_model(&when),
        key,
        &["`resume-move` has an effect with `when`"],
    );
    let domain = walk();
    let effect = [SUSPENDED, &["(when (lit) (left ?x))"]].concat();
    let model = suspended(&domain, "move", &effect, "(resume-move ?x ?y ?a)");
    refused(
        &domain,
        &model,
        key,
        &["the suspension has an effect with `when`"],
    );
}

#[test]
fn of_a_quantifier_over_some_objects_only_nothing_is_proved() {
    let all = "(forall (?z - node) (not (left ?z)))";
    for some in [
        "(forall (?z - exhibit) (not (left ?z)))",
        "(forall (?z - node) (not (link ?z ?z ?a)))",
        "(forall (?z - exhibit) (left ?z))",
    ] {
        let domain = walk_with(
            "(not (left ?x)) (at ?y)",
            &format!("(not (left ?x)) (at ?y) {some}"),
        );
        let errors = check_model(&domain, &move_model(&domain));
        assert!(
            matches!(errors[..], [DomainError::Unproved { .. }]),
            "{some}: {errors:#?}"
        );
    }
    let domain = walk_with("(not (left ?x)) (at ?y)", &format!("{all} (at ?y)"));
    let errors = check_model(&domain, &move_model(&domain));
    assert!(
        !matches!(errors[..], [DomainError::Unproved { .. }]),
        "{errors:#?}"
    );
}
