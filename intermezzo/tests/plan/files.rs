//! Files that are read and written.

use std::fs::{self, File};
use std::process::Stdio;

use crate::{DOMAIN, Desk, PROBLEM, SWITCH, TURNS, judged_right, said, text};

#[test]
fn the_plan_is_written_to_a_file_and_nothing_else_is() {
    let desk = Desk::ward();
    fs::write(desk.path("some.plan"), "an older one").unwrap();
    let said = desk.run(&["-o", "some.plan"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), ""), "{said:?}");
    judged_right(&text(&desk.path("some.plan")));
    assert_eq!(desk.names(), ["domain.hddl", "problem.hddl", "some.plan"]);
}

#[test]
fn without_a_plan_the_file_stays_as_it_is() {
    let desk = Desk::new(SWITCH, TURNS);
    fs::write(desk.path("some.plan"), "an older one").unwrap();
    let said = desk.run(&["-o", "some.plan", "--time-limit", "0.1"]);
    assert_eq!(said.code, Some(5), "{said:?}");
    assert_eq!(text(&desk.path("some.plan")), "an older one");
    assert_eq!(desk.names(), ["domain.hddl", "problem.hddl", "some.plan"]);
}

#[test]
fn a_file_that_cannot_be_written_is_named_before_planning() {
    let desk = Desk::new(SWITCH, TURNS);
    let said = desk.run(&["-o", "no/such/folder.plan"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    let words = "cannot write no/such/folder.plan: No such file";
    assert!(said.err.contains(words), "{said:?}");
    assert!(!said.err.contains("at path"), "nothing of ours: {said:?}");
}

#[test]
fn a_full_disk_is_an_error() {
    let desk = Desk::ward();
    let full = || File::options().write(true).open("/dev/full").unwrap();
    let told = desk.run(&["-o", "/dev/full"]);
    assert_eq!(told.code, Some(1), "{told:?}");
    assert!(told.err.contains("No space left"), "{told:?}");
    let output = desk.command(&[]).stdout(Stdio::from(full())).output();
    let told = said(&output.unwrap());
    assert_eq!(told.code, Some(1), "{told:?}");
    assert!(told.err.contains("No space left"), "{told:?}");
}

#[test]
fn a_fault_is_shown_with_its_line_and_a_marker() {
    let domain = DOMAIN.replace("(put ?i ?to)", "(putt ?i ?to)");
    let said = Desk::new(&domain, PROBLEM).run(&[]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("domain.hddl:27:71"), "{said:?}");
    assert!(said.err.contains("(putt ?i ?to)"), "{said:?}");
    assert!(said.err.contains("^^^^"), "{said:?}");
    let problem = PROBLEM.replace("(robot-at hall)", "(robot-at hell)");
    let said = Desk::new(DOMAIN, &problem).run(&["--json"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("problem.hddl:7:"), "{said:?}");
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let desk = Desk::ward();
    fs::remove_file(desk.path("problem.hddl")).unwrap();
    let said = desk.run(&[]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("cannot read problem.hddl"), "{said:?}");
}
