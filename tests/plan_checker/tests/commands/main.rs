//! The two programs, run as users run them, with planners that are a line of shell.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use tempfile::TempDir;

const POST: &str = include_str!("../judging/post.hddl");
const LETTER: &str = include_str!("../judging/letter.hddl");
const DELIVERY: &str = include_str!("../judging/delivery.plan");

/// A folder of benchmarks with one instance.
struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let domain = folder.path().join("domains/post");
        fs::create_dir_all(&domain).unwrap();
        fs::write(domain.join("domain.hddl"), POST).unwrap();
        fs::write(domain.join("letter.hddl"), LETTER).unwrap();
        Self { folder }
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let file = self.folder.path().join(name);
        fs::write(&file, text).unwrap();
        file
    }

    /// Runs the benchmark with a planner that is a script; its first argument is where the plan
    /// is to go.
    fn run(&self, script: &str, args: &[&str]) -> (Option<i32>, String) {
        let script = self.file("planner.sh", script);
        let planner = format!("sh {} {{out}}", script.display());
        let output = Command::new(env!("CARGO_BIN_EXE_bench_plans"))
            .current_dir(self.folder.path())
            .args(["domains", "--planner", &planner])
            .args(args)
            .output()
            .unwrap();
        (output.status.code(), text(&output))
    }
}

fn text(output: &Output) -> String {
    let out = String::from_utf8_lossy(&output.stdout);
    let err = String::from_utf8_lossy(&output.stderr);
    format!("{out}{err}")
}

#[test]
fn a_right_plan_is_counted_and_compared() {
    let bench = Bench::new();
    bench.file("some.plan", DELIVERY);
    let peers = "planner\tdomain\tinstance\tstatus\twall_s\tcpu_s\tplan_len\n\
                 hypertension\tpost\tletter.hddl\tok\t5.0\t4.0\t8\n\
                 other\tpost\tletter.hddl\ttimeout\t60.0\t60.0\t\n";
    bench.file("peers.tsv", peers);
    let (code, text) = bench.run(
        "cp some.plan $1",
        &["--peers", "peers.tsv", "--out", "rows.csv"],
    );
    assert_eq!(code, Some(0), "{text}");
    assert!(
        text.contains("  1 of   1 (hypertension 1, any peer 1)"),
        "{text}"
    );
    assert!(text.contains("geometric mean of 1: 0.50"), "{text}");
    let rows = fs::read_to_string(bench.folder.path().join("rows.csv")).unwrap();
    assert!(rows.contains("post,letter.hddl,\"ok\","), "{rows}");
    assert!(rows.trim_end().ends_with(",4"), "{rows}");
}

#[test]
fn a_wrong_plan_makes_it_fail() {
    let bench = Bench::new();
    bench.file("some.plan", &DELIVERY.replace("1 load", "1 unload"));
    let (code, text) = bench.run("cp some.plan $1", &[]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("WRONG PLAN"), "{text}");
}

#[test]
fn that_there_is_no_plan_must_not_be_said_where_a_peer_has_one() {
    let bench = Bench::new();
    let (code, text) = bench.run("exit 4", &[]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("1 proved unsolvable"), "{text}");
    let peers = "planner\tdomain\tinstance\tstatus\twall_s\tcpu_s\tplan_len\n\
                 other\tpost\tletter.hddl\tok\t5.0\t4.0\t8\n";
    bench.file("peers.tsv", peers);
    let (code, text) = bench.run("exit 4", &["--peers", "peers.tsv"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("NOT UNSOLVABLE"), "{text}");
}

#[test]
fn a_planner_that_does_not_end_is_ended() {
    let bench = Bench::new();
    let (code, text) = bench.run("exec sleep 1000", &["--time-limit", "0.1"]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("timeout"), "{text}");
}

#[test]
fn a_planner_that_fails_is_quoted() {
    let bench = Bench::new();
    let (_, text) = bench.run("echo out of luck >&2; exit 7", &[]);
    assert!(text.contains("no plan: out of luck"), "{text}");
    let (_, text) = bench.run("ulimit -v", &["--memory-gib", "1"]);
    assert!(text.contains("no plan: 1048576"), "{text}");
}

#[test]
fn the_judge_exits_with_its_verdict() {
    let bench = Bench::new();
    bench.file("right.plan", DELIVERY);
    bench.file("wrong.plan", &DELIVERY.replace("m-stay", "m-drive"));
    let domain = "domains/post/domain.hddl";
    let problem = "domains/post/letter.hddl";
    for (args, code, words) in [
        (&[domain, problem, "right.plan"][..], 0, "right: 4 actions"),
        (
            &["--actions-only", domain, problem, "right.plan"],
            0,
            "right: 4",
        ),
        (
            &[domain, problem, "wrong.plan"],
            1,
            "12: `m-drive` has 2 subtasks",
        ),
        (&[domain, problem, "no.plan"], 2, "cannot read no.plan"),
        (
            &[problem, domain, "right.plan"],
            2,
            "expected (define (domain",
        ),
        (&[], 2, "usage"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_check_plan"))
            .current_dir(bench.folder.path())
            .args(args)
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(code),
            "{args:?}: {}",
            text(&output)
        );
        assert!(text(&output).contains(words), "{args:?}: {}", text(&output));
    }
}
