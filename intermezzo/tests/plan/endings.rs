//! How planning ends, other than with a plan.

use std::io::{BufRead, BufReader, Read};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;

use crate::{DOMAIN, Desk, PROBLEM, SWITCH, TURNS};

#[test]
fn that_there_is_no_plan_has_its_own_status() {
    // Nobody can leave the kitchen.
    let problem = PROBLEM.replace("(way kitchen ", "(way garden ");
    let desk = Desk::new(DOMAIN, &problem);
    let said = desk.run(&[]);
    assert_eq!((said.code, said.out.as_str()), (Some(4), ""), "{said:?}");
    assert!(said.err.starts_with("unsolvable: "), "{said:?}");
    let said = desk.run(&["--json"]);
    let verdict: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(verdict["verdict"], "unsolvable");
}

#[test]
fn that_nobody_knows_has_another() {
    let desk = Desk::new(SWITCH, TURNS);
    let said = desk.run(&["--time-limit", "0.1"]);
    assert_eq!((said.code, said.out.as_str()), (Some(5), ""), "{said:?}");
    assert!(said.err.starts_with("no plan found: "), "{said:?}");
    let said = desk.run(&["--time-limit", "0.1", "--json"]);
    let verdict: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(verdict["verdict"], "unknown");
    for limit in ["soon", "-1", "nan", "inf"] {
        let said = desk.run(&[&format!("--time-limit={limit}")]);
        assert_eq!(said.code, Some(2), "{said:?}");
    }
}

#[test]
fn ctrl_c_ends_what_takes_long_and_says_how_it_goes() {
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let desk = Desk::new(SWITCH, TURNS);
        let mut child = desk.command(&["--time-limit", "80"]).spawn().unwrap();
        let mut errors = BufReader::new(child.stderr.take().unwrap());
        // It works on it, and says so.
        let mut line = String::new();
        errors.read_line(&mut line).unwrap();
        assert!(line.contains("nodes"), "{line}");
        kill(Pid::from_raw(child.id().cast_signed()), signal).unwrap();
        let mut rest = String::new();
        errors.read_to_string(&mut rest).unwrap();
        assert!(rest.contains("stopped"), "{rest}");
        assert_eq!(child.wait().unwrap().code(), Some(5));
    }
}
