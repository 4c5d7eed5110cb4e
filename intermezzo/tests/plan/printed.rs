//! What is printed.

use serde_json::Value;

use crate::{DOMAIN, Desk, PROBLEM, judged_right};

#[test]
fn the_plan_is_printed_and_is_right() {
    let said = Desk::ward().run(&[]);
    assert_eq!(said.code, Some(0), "{said:?}");
    judged_right(&said.out);
    assert!(said.err.starts_with("plan: "), "{said:?}");
}

#[test]
fn names_are_spelt_as_their_author_did() {
    let said = Desk::ward().run(&[]);
    assert!(said.out.contains("put lunch Room3"), "{said:?}");
}

#[test]
fn the_cheapest_plan_is_found_if_asked_and_proved_to_be_it() {
    let said = Desk::ward().run(&["--optimal"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    // To the kitchen, back through the hall to Room3, back to the hall, and to Room1.
    assert_eq!(judged_right(&said.out).cost, 6.0 + 23.0 + 17.0 + 12.0);
    assert!(
        said.err.contains("cost 58, and none is cheaper"),
        "{said:?}"
    );
}

#[test]
fn a_plan_as_json_has_its_actions_and_its_tree() {
    let said = Desk::ward().run(&["--json"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let plan: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(plan["verdict"], "plan");
    let actions = plan["actions"].as_array().unwrap();
    assert_eq!(plan["length"], actions.len());
    // Put together again, it is a plan like any other.
    let mut text = "==>\n".to_owned();
    let words = |list: &Value| {
        let words = list.as_array().unwrap().iter();
        let words = words.map(|word| match word.as_str() {
            Some(word) => format!(" {word}"),
            None => format!(" {word}"),
        });
        words.collect::<String>()
    };
    let head = |node: &Value| {
        let name = node["name"].as_str().unwrap();
        format!("{} {name}{}", node["id"], words(&node["arguments"]))
    };
    for action in actions {
        text += &format!("{}\n", head(action));
    }
    text += &format!("root{}\n", words(&plan["roots"]));
    for task in plan["tasks"].as_array().unwrap() {
        let method = task["method"].as_str().unwrap();
        text += &format!("{} -> {method}{}\n", head(task), words(&task["subtasks"]));
    }
    judged_right(&(text + "<=="));
}

#[test]
fn the_tree_says_which_action_serves_which_task() {
    let problem = PROBLEM.replace(
        "(bring lunch Room3) (bring flowers Room1)",
        "(bring flowers corridor)",
    );
    let said = Desk::new(DOMAIN, &problem).run(&["--explain"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let tree = "\
(bring flowers corridor)  by carry-it
├─ (reach hall)  by stay, nothing to do
├─ 0 (take flowers hall)
├─ (reach corridor)  by drive-on
│  ├─ 1 (drive hall corridor)
│  └─ (reach corridor)  by stay, nothing to do
└─ 2 (put flowers corridor)
";
    assert_eq!(said.out, tree);
    let said = Desk::new(DOMAIN, &problem).run(&["--explain=1"]);
    assert_eq!(
        said.out.lines().next(),
        Some("(bring flowers corridor)  by carry-it … 3 actions")
    );
}

#[test]
fn a_large_tree_is_folded_and_says_so() {
    let tasks = "(bring flowers Room1) (bring flowers Room3)".repeat(300);
    let problem = PROBLEM.replace("(bring lunch Room3) (bring flowers Room1)", &tasks);
    let said = Desk::new(DOMAIN, &problem).run(&["--explain"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let lines = said.out.lines().count();
    assert!(lines < 300, "{lines} lines are too many to read");
    assert!(said.out.contains("540 more like these"), "{said:?}");
    assert!(said.out.contains("--explain=DEPTH"), "{said:?}");
}

#[test]
fn whoever_reads_the_plan_may_have_seen_enough() {
    let tasks = "(bring flowers Room1) (bring flowers Room3)".repeat(1000);
    let problem = PROBLEM.replace("(bring lunch Room3) (bring flowers Room1)", &tasks);
    let desk = Desk::new(DOMAIN, &problem);
    let mut child = desk.command(&[]).spawn().unwrap();
    drop(child.stdout.take());
    let said = crate::said(&child.wait_with_output().unwrap());
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(!said.err.contains("error"), "{said:?}");
}
