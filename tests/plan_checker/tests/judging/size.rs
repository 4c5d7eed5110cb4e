//! Plans as long and as deep as planners make them.

use std::fmt::Write;

use crate::{POST, kinds, with};

/// A van that drives in a circle of three places, so often.
fn circles(drives: usize) -> (String, String) {
    let problem = "(define (problem circle) (:domain post)
        (:objects a b c - place v - van)
        (:htn :ordered-subtasks (and (go v depot)))
        (:init (at v a) (road a b) (road b c) (road c a)))";
    let places = ["a", "b", "c"];
    let mut plan = "==>\n".to_owned();
    for step in 0..drives {
        let (from, to) = (places[step % 3], places[(step + 1) % 3]);
        writeln!(plan, "{step} drive v {from} {to}").expect("strings do not fail");
    }
    writeln!(plan, "root {drives}").expect("strings do not fail");
    for step in 0..drives {
        let id = drives + step;
        let next = id + 1;
        writeln!(plan, "{id} go v depot -> m-drive {step} {next}").expect("strings do not fail");
    }
    let last = 2 * drives;
    writeln!(plan, "{last} go v depot -> m-stay\n<==").expect("strings do not fail");
    (problem.to_owned(), plan)
}

#[test]
fn a_very_deep_plan_does_not_exhaust_the_stack() {
    let (problem, plan) = circles(99_999);
    // All that is wrong is that the van does not get there.
    let faults = plan_checker::check(POST, &problem, &plan).expect_err("it never arrives");
    let last = faults.last().expect("there is one");
    assert_eq!(
        last.to_string(),
        "199998: the precondition (at v depot) of `m-stay` for (go v depot) does not hold here"
    );
    let problem = with(&problem, "(road c a)", "(road c a) (road c depot)");
    let plan = with(&plan, "\n99998 drive v c a", "\n99998 drive v c depot");
    assert_eq!(kinds(POST, &problem, &plan), []);
}
