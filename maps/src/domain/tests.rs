//! The museum's levels, and the same with mistakes in them.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use agent_core::model::{Number, Term};

use super::*;

const AREA: &str = include_str!("../../museum/area.hddl");
const AREA_MODEL: &str = include_str!("../../museum/area.toml");
const NODE: &str = include_str!("../../museum/node.hddl");
const NODE_MODEL: &str = include_str!("../../museum/node.toml");

fn level(hddl: &str, toml: &str) -> Result<Level, Vec<Finding>> {
    level_from_texts(hddl, toml, ["x.hddl", "x.toml"])
}

fn replaced(text: &str, piece: &str, replacement: &str) -> String {
    assert!(text.contains(piece), "{piece}");
    text.replacen(piece, replacement, 1)
}

fn findings_of(result: Result<Level, Vec<Finding>>) -> Vec<String> {
    let findings = result.err().unwrap_or_default();
    findings.iter().map(ToString::to_string).collect()
}

/// What is found in the node level with one piece of its execution model replaced.
fn with_node_model(piece: &str, replacement: &str) -> Vec<String> {
    findings_of(level(NODE, &replaced(NODE_MODEL, piece, replacement)))
}

/// Where a piece of a text stands. Reckoned here, since the files may grow.
fn place(text: &str, piece: &str) -> String {
    let (before, _) = text.split_once(piece).unwrap();
    let line = before.lines().count().max(1);
    let start_of_line = before.ends_with('\n') || before.is_empty();
    let column = before.lines().last().unwrap_or_default().chars().count();
    if start_of_line {
        format!("{}:1", line + usize::from(!before.is_empty()))
    } else {
        format!("{line}:{}", column + 1)
    }
}

/// One finding, in the line of `text` where `piece` stands.
#[track_caller]
fn one(findings: &[String], file: &str, (text, piece): (&str, &str), words: &str) {
    assert_eq!(findings.len(), 1, "{findings:#?}");
    let start = format!("{file}:{}: ", place(text, piece));
    assert!(findings[0].starts_with(&start), "{start} {findings:#?}");
    assert!(findings[0].contains(words), "{findings:#?}");
}

#[test]
fn both_levels_of_the_museum_pass() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("museum");
    assert_eq!(check_domain_dir(&dir).unwrap(), ["area", "node"]);
    let node = read_level(&dir, "node").unwrap();
    assert_eq!(node.domain.name, Symbol::from("museum-nodes"));
}

#[test]
fn an_execution_model_is_read_as_it_is_written() {
    let area = level(AREA, AREA_MODEL).unwrap();
    assert_eq!(area.model.observable, [Symbol::from("open")]);
    let enter = &area.model.actions["enter"];
    assert!(enter.repeatable && enter.achieves_state);
    assert_eq!(enter.map_of, Some(0));
    assert_eq!(enter.protected.len(), 1);
    let suspension = enter.suspension.as_ref().unwrap();
    assert_eq!(suspension.effect.remove[0].fact.args, [Term::Variable(3)]);
    assert_eq!(suspension.resume.args, [0, 1, 2].map(Term::Variable));
    assert!(!area.model.actions["explain"].repeatable);
    assert_eq!(
        area.model.actions["explain"].duration_s,
        Some(Number::Constant(30.0))
    );
    let go = &area.model.tasks["go"];
    let names: Vec<&str> = go.parameters.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["?n", "?a", "?b"]);
    assert_eq!((go.given.len(), go.establishes.len()), (2, 2));

    let node = level(NODE, NODE_MODEL).unwrap();
    assert_eq!(node.model.projections.len(), 4);
    assert_eq!(node.model.projections[3].when.len(), 5);
    let moving = &node.model.actions["move"];
    assert_eq!(moving.perform.as_ref().unwrap().name, Symbol::from("drive"));
    let suspension = moving.suspension.as_ref().unwrap();
    assert_eq!(
        suspension.rollback.as_ref().unwrap().name,
        Symbol::from("return")
    );
    assert_eq!(suspension.reach, None);
}

#[test]
fn a_number_needs_no_quotation_marks() {
    let bare = replaced(AREA_MODEL, "duration_s = \"30\"", "duration_s = 30");
    assert_eq!(
        level(AREA, &bare).unwrap(),
        level(AREA, AREA_MODEL).unwrap()
    );
    let list = replaced(AREA_MODEL, "duration_s = \"30\"", "duration_s = [30]");
    one(
        &findings_of(level(AREA, &list)),
        "x.toml",
        (&list, "[30]"),
        "action.explain.duration_s: expected a number",
    );
}

#[test]
fn a_fault_inside_a_text_is_found_at_its_letter() {
    assert_eq!(place("ab\ncd\n", "d"), "2:2");
    one(
        &with_node_model(
            "(resume-move ?from ?to ?arc)",
            "(resume-move ?from ?tu ?arc)",
        ),
        "x.toml",
        (NODE_MODEL, "?to ?arc)\"\nrollback"),
        "action.move.suspension.resume: the variable `?tu` is not declared; did you mean `?to`?",
    );
    one(
        &with_node_model("\"(telling ?e)\"", "\"(teling ?e)\""),
        "x.toml",
        (NODE_MODEL, "telling ?e"),
        "action.narrate.suspension.effect: `teling` is not a declared predicate; did you mean",
    );
}

#[test]
fn a_suspension_that_cannot_be_resumed_is_found_at_its_line() {
    let findings = with_node_model("[\"(replying ?e)\"]", "[]");
    assert_eq!(findings.len(), 2, "{findings:#?}");
    let start = format!("x.toml:{}: ", place(NODE_MODEL, "\"(resume-reply ?e)"));
    assert!(findings[0].starts_with(&start), "{findings:#?}");
    let words = "action.reply.suspension.resume: `reply` is suspended, but then `(resume-reply \
                 ?e)` cannot be executed: nothing makes sure that `(replying ?e)` is true";
    assert!(findings[0].contains(words), "{findings:#?}");
    let two = with_node_model("\"(on ?arc)\", \"(left ?from)\"]", "\"(left ?from)\"]");
    assert_eq!(two.len(), 2, "{two:#?}");
}

#[test]
fn resuming_as_another_action_is_refused() {
    let findings = with_node_model(
        "(resume-pass ?from ?to ?arc ?d)",
        "(resume-move ?from ?to ?arc)",
    );
    assert_eq!(findings.len(), 2, "{findings:#?}");
    let words = "`(free ?arc ?from)` is as it was before after `pass`, but true";
    assert!(findings[0].contains(words), "{findings:#?}");
}

#[test]
fn a_key_that_nobody_knows_is_refused_with_its_table() {
    let timeout = "timeout_s = \"(+ 30 (* 8 (length ?arc)))\"";
    one(
        &with_node_model(timeout, "timeout = 30"),
        "x.toml",
        (NODE_MODEL, timeout),
        "action.move: unknown field `timeout`",
    );
    one(
        &with_node_model("[action.hail]", "[action.haill]"),
        "x.toml",
        (NODE_MODEL, "hail]"),
        "action.haill: `haill` is not an action of the domain; did you mean `hail`?",
    );
    one(
        &with_node_model("[task.reach]", "[task.raech]"),
        "x.toml",
        (NODE_MODEL, "reach]"),
        "task.raech: `raech` is not a task of the domain; did you mean `reach`?",
    );
}

#[test]
fn broken_toml_is_reported_with_its_place() {
    let broken = replaced(
        NODE_MODEL,
        "perform = \"(speak 2)\"",
        "perform = \"(speak 2)",
    );
    one(
        &findings_of(level(NODE, &broken)),
        "x.toml",
        (&broken, "\n\n[action.announce]"),
        "action.hail: ",
    );
}

#[test]
fn a_parameter_that_the_action_lacks_has_no_map() {
    let wrong = replaced(AREA_MODEL, "map_of = \"?from\"", "map_of = \"?x\"");
    one(
        &findings_of(level(AREA, &wrong)),
        "x.toml",
        (&wrong, "\"?x\""),
        "action.enter.map_of: `?x` is not a parameter of the action; those are ?from, ?to, ?d",
    );
}

#[test]
fn a_rule_for_the_level_above_is_looked_up() {
    let when = "when = [\"(at ?n)\"]";
    let wrong = replaced(NODE_MODEL, when, "when = [\"(att ?n)\"]");
    one(
        &findings_of(level(NODE, &wrong)),
        "x.toml",
        (&wrong, "\"(att ?n)"),
        "projection.2.when: `att` is not a declared predicate",
    );
    let wrong = replaced(
        NODE_MODEL,
        "variables = [\"?n - node\"]\nwhen",
        "variables = [\"?n - nod\"]\nwhen",
    );
    one(
        &findings_of(level(NODE, &wrong)),
        "x.toml",
        (&wrong, "\"?n - nod\""),
        "projection.2.variables: type `nod` is not declared",
    );
}

/// A directory with these files in it.
fn directory(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    dir
}

fn checked(files: &[(&str, &str)]) -> Vec<String> {
    let dir = directory(files);
    let findings = check_domain_dir(dir.path()).err().unwrap_or_default();
    let prefix = format!("{}/", dir.path().display());
    let short = |finding: &Finding| finding.to_string().replace(&prefix, "");
    findings.iter().map(short).collect()
}

#[test]
fn the_faults_of_all_files_are_reported_at_once() {
    let area = replaced(AREA, "(located ?n ?a) (not", "(lokated ?n ?a) (not");
    let model = replaced(AREA_MODEL, "repeatable = true", "repeatable = maybe");
    let findings = checked(&[
        ("area.hddl", &area),
        ("area.toml", &model),
        ("node.hddl", NODE),
    ]);
    let lokated = format!("area.hddl:{}: `lokated` is not", place(&area, "lokated"));
    let maybe = format!("area.toml:{}: action.enter: ", place(&model, "maybe"));
    let missing = "node.toml: is missing; write it beside the domain".to_owned();
    assert_eq!(findings.len(), 3, "{findings:#?}");
    for (finding, start) in findings.iter().zip([lokated, maybe, missing]) {
        assert!(finding.starts_with(&start), "{start}: {findings:#?}");
    }
}

#[test]
fn an_action_that_nobody_can_execute_is_refused() {
    let alone = checked(&[("area.hddl", AREA), ("area.toml", AREA_MODEL)]);
    assert_eq!(alone.len(), 6, "{alone:#?}");
    let node = NODE.replace(
        "(:task greet :parameters (?p - person))",
        "(:task greet :parameters (?p ?q - person))",
    );
    let node = node.replace(
        "?p - person)\n    :task (greet ?p)",
        "?p - person)\n    :task (greet ?p ?p)",
    );
    let both = |node: &str, model: &str| {
        checked(&[
            ("area.hddl", AREA),
            ("area.toml", AREA_MODEL),
            ("node.hddl", node),
            ("node.toml", model),
        ])
    };
    assert_eq!(both(NODE, NODE_MODEL), [""; 0]);
    one(
        &both(&node, NODE_MODEL),
        "area.hddl",
        (AREA, "(:action greet"),
        "nobody can execute action `greet`: the task of that name takes 2 argument(s), not 1",
    );
    one(
        &both(NODE, &replaced(NODE_MODEL, "perform = \"(speak 2)\"", "")),
        "node.hddl",
        (NODE, "(:action hail"),
        "nobody can execute action `hail`: write a task of that name at another level, or `perform` in the execution model",
    );
}

#[test]
fn a_directory_without_domains_is_refused() {
    assert_eq!(checked(&[]).len(), 1);
    let nowhere = check_domain_dir(Path::new("no/such/place")).unwrap_err();
    assert!(
        nowhere[0]
            .to_string()
            .starts_with("no/such/place: cannot be read")
    );
}
