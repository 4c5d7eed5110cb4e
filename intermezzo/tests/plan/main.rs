//! `intermezzo plan` as users run it: real processes, no robot.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on has failed"
)]

mod endings;
mod files;
mod printed;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const DOMAIN: &str = include_str!("../../../docs/examples/ward-domain.hddl");
const PROBLEM: &str = include_str!("../../../docs/examples/ward-problem.hddl");

/// No method ends with the switch on: they all turn it an even number of times, but nobody can
/// tell that by trying.
const SWITCH: &str = "(define (domain switch) (:predicates (on))
    (:task turn :parameters ())
    (:task turns :parameters ())
    (:method up :parameters () :task (turn) :ordered-subtasks (and (turn-on)))
    (:method down :parameters () :task (turn) :ordered-subtasks (and (turn-off)))
    (:method more :parameters () :task (turns) :ordered-subtasks (and (turn) (turns) (turn)))
    (:method enough :parameters () :task (turns) :ordered-subtasks ())
    (:action turn-on :parameters () :precondition (not (on)) :effect (on))
    (:action turn-off :parameters () :precondition (on) :effect (not (on))))";
const TURNS: &str = "(define (problem turns) (:domain switch)
    (:htn :ordered-subtasks (and (turns))) (:init) (:goal (on)))";

/// A folder with a domain and a problem.
struct Desk {
    folder: TempDir,
}

/// What a command has said, and how it ended.
#[derive(Debug)]
struct Said {
    code: Option<i32>,
    out: String,
    err: String,
}

impl Desk {
    fn new(domain: &str, problem: &str) -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("domain.hddl"), domain).unwrap();
        fs::write(folder.path().join("problem.hddl"), problem).unwrap();
        Self { folder }
    }

    fn ward() -> Self {
        Self::new(DOMAIN, PROBLEM)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_intermezzo"));
        command
            .current_dir(self.folder.path())
            .args(["plan", "domain.hddl", "problem.hddl"])
            .args(args)
            .env_remove("RUST_LOG")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    fn run(&self, args: &[&str]) -> Said {
        said(&self.command(args).output().unwrap())
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

fn said(output: &Output) -> Said {
    Said {
        code: output.status.code(),
        out: String::from_utf8(output.stdout.clone()).unwrap(),
        err: String::from_utf8(output.stderr.clone()).unwrap(),
    }
}

/// The text of a file.
fn text(file: &Path) -> String {
    fs::read_to_string(file).unwrap()
}

/// Whether the judge of plans says that this is one.
#[track_caller]
fn judged_right(plan: &str) -> plan_checker::Report {
    plan_checker::check(DOMAIN, PROBLEM, plan).unwrap_or_else(|faults| panic!("{faults:?}\n{plan}"))
}
