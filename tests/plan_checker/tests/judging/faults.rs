//! One wrong plan for each kind of fault.

use plan_checker::Kind::{self, *};

use crate::{DELIVERY, LETTER, POST, kinds, with};

#[track_caller]
fn refused(part: &str, other: &str, kind: Kind) {
    let plan = with(DELIVERY, part, other);
    let found = kinds(POST, LETTER, &plan);
    assert!(found.contains(&kind), "{found:?} for {plan}");
}

#[test]
fn the_plan_as_it_is_is_right() {
    let report = plan_checker::check(POST, LETTER, DELIVERY).expect("the plan is right");
    assert_eq!((report.actions, report.decompositions), (4, 6));
    assert_eq!(report.cost, 4.0);
}

#[test]
fn a_text_without_markers_is_no_plan() {
    refused("==>", "", Malformed);
    refused("<==", "", Malformed);
    refused("<==", "<==\n==>\n<==", Malformed);
}

#[test]
fn a_line_that_makes_no_sense_is_found() {
    refused("0 drive v", "drive v", Malformed);
    refused(
        "\n20 deliver letter shop -> m-already-there",
        "\n20",
        Malformed,
    );
    refused("-> m-already-there", "->", Malformed);
    refused("root 10 20", "", Malformed);
    refused("root 10 20", "root 10 20\nroot 10 20", Malformed);
    refused("m-drive 0 12", "m-drive 0 twelve", Malformed);
}

#[test]
fn ids_are_used_once() {
    refused("\n1 load", "\n0 load", DuplicateId);
    refused("\n14 go", "\n13 go", DuplicateId);
    refused("\n14 go", "\n3 go", DuplicateId);
}

#[test]
fn names_have_to_be_declared() {
    refused("1 load", "1 lift", UnknownName);
    refused("1 load letter", "1 load postcard", UnknownName);
    refused("m-stay", "m-idle", UnknownName);
    refused("12 go v", "12 walk v", UnknownName);
    refused("12 go v street -> m-stay", "12 go v street", UnknownName);
    refused(
        "3 unload letter v shop",
        "3 unload letter v shop -> m-stay",
        UnknownName,
    );
}

#[test]
fn arguments_have_their_number_and_types() {
    refused("1 load letter v street", "1 load letter v", WrongArguments);
    refused(
        "1 load letter v street",
        "1 load letter v street shop",
        WrongArguments,
    );
    refused(
        "1 load letter v street",
        "1 load v letter street",
        WrongArguments,
    );
    refused("12 go v street", "12 go letter street", WrongArguments);
}

#[test]
fn children_have_to_exist_and_belong_to_one_parent() {
    refused("m-drive 0 12", "m-drive 0 99", UnknownChild);
    refused("root 10 20", "root 10 99", UnknownChild);
    refused("m-drive 2 14", "m-drive 2 12", ChildUsedTwice);
    refused("root 10 20", "root 10 10", ChildUsedTwice);
    refused("root 10 20", "root 10 12", ChildUsedTwice);
}

#[test]
fn everything_hangs_from_the_root() {
    refused("m-drive 0 12", "m-drive 0", Unreachable);
    refused("root 10 20", "root 10", Unreachable);
    refused("<==", "30 go v shop -> m-stay\n<==", Unreachable);
    refused("<==", "30 drive v shop street\n<==", Unreachable);
}

#[test]
fn circles_beside_the_tree_are_found() {
    let circle = "30 go v shop -> m-drive 31 32\n31 drive v shop street\n32 go v shop -> m-drive 33 30\n33 drive v shop street\n<==";
    refused("<==", circle, Cycle);
    refused("<==", "30 go v shop -> m-drive 30\n<==", Cycle);
}

#[test]
fn the_roots_are_the_tasks_of_the_problem() {
    refused(
        "20 deliver letter shop",
        "20 deliver letter street",
        WrongRoots,
    );
    let one_too_many = "root 10 20 30\n30 deliver letter shop -> m-already-there";
    refused("root 10 20", one_too_many, WrongRoots);
}

#[test]
fn decompositions_are_instances_of_their_methods() {
    // The method of another task.
    refused(
        "12 go v street -> m-stay",
        "12 go v street -> m-already-there",
        NotAnInstance,
    );
    // A subtask is missing, and hangs elsewhere.
    refused("11 1 13 3\n", "11 1 13\n", Unreachable);
    let plan = with(DELIVERY, "11 1 13 3\n", "11 1 13\n");
    let plan = with(&plan, "-> m-already-there", "-> m-already-there 3");
    assert_eq!(kinds(POST, LETTER, &plan), [NotAnInstance, NotAnInstance]);
    // Another place than the head says.
    refused("12 go v street", "12 go v shop", NotAnInstance);
    // A subtask of another kind.
    refused(
        "3 unload letter v shop",
        "3 drive v street shop",
        NotAnInstance,
    );
}

#[test]
fn the_order_of_the_actions_is_that_of_the_methods() {
    let text = "2 drive v street shop\n3 unload letter v shop";
    let other = "3 unload letter v shop\n2 drive v street shop";
    refused(text, other, WrongOrder);
    refused("root 10 20", "root 20 10", MethodPrecondition);
}

#[test]
fn children_may_be_listed_in_any_order() {
    let plan = with(DELIVERY, "m-deliver 11 1 13 3", "m-deliver 3 1 13 11");
    assert_eq!(kinds(POST, LETTER, &plan), []);
}

#[test]
fn preconditions_of_methods_hold_where_they_begin() {
    let problem = with(
        LETTER,
        "(lies letter street)",
        "(full v) (lies letter street)",
    );
    assert_eq!(kinds(POST, &problem, DELIVERY), [MethodPrecondition]);
    let problem = with(LETTER, "(road depot street)", "");
    assert_eq!(kinds(POST, &problem, DELIVERY), [MethodPrecondition]);
}

#[test]
fn preconditions_of_actions_hold_where_they_are_done() {
    let domain = with(
        POST,
        "(and (in ?t ?v) (at ?v ?p))",
        "(and (in ?t ?v) (not (at ?v ?p)))",
    );
    let faults = plan_checker::check(&domain, LETTER, DELIVERY).expect_err("it is wrong");
    assert_eq!(faults[0].kind, Precondition);
    assert_eq!(faults[0].id, Some(3));
    assert_eq!(
        faults[0].to_string(),
        "3: the precondition (not (at v shop)) of (unload letter v shop) does not hold here"
    );
}

#[test]
fn the_goal_holds_at_the_end() {
    let problem = with(LETTER, "(at v shop))", "(at v street))");
    assert_eq!(kinds(POST, &problem, DELIVERY), [Goal]);
}

#[test]
fn a_domain_that_cannot_be_read_gives_no_verdict() {
    assert_eq!(kinds(POST, "(define", DELIVERY), [Unjudgeable]);
    assert_eq!(kinds(&"(".repeat(100_000), LETTER, DELIVERY), [Unjudgeable]);
    let domain = with(POST, "(full ?v)", "(fool ?v)");
    assert_eq!(kinds(&domain, LETTER, DELIVERY), [Unjudgeable]);
    let domain = with(POST, "(< first then)", "(< first then) (< then first)");
    assert_eq!(kinds(&domain, LETTER, DELIVERY), [Unjudgeable]);
}
