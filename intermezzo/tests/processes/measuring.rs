//! Experiments with robots that run, small: that they measure, not what.

use std::collections::BTreeMap;

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;
use tempfile::TempDir;
use tokio::time::timeout;

use crate::harness::{PATIENCE, User};

/// The rows of a CSV file, by column.
fn rows(folder: &TempDir, name: &str) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
    let mut lines = text.lines().map(|line| line.split(','));
    let columns: Vec<&str> = lines.next().unwrap().collect();
    lines
        .map(|row| {
            let cells = columns.iter().zip(row);
            cells
                .map(|(column, cell)| ((*column).to_owned(), cell.to_owned()))
                .collect()
        })
        .collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn interruptions_of_a_robot_are_measured_under_both_conditions() {
    let user = User::new().await;
    let out = TempDir::new().unwrap();
    let folder = out.path().to_str().unwrap();
    let said = user
        .ok(&[
            "experiment",
            "latency",
            "--interruptions",
            "5",
            "--nodes",
            "200",
            "--speed",
            "50",
            "--json",
            "--out",
            folder,
        ])
        .await;
    let report: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(report["experiment"], "latency");
    let rows = rows(&out, "latency.csv");
    for condition in ["idle", "planning"] {
        for interval in [
            "bare_round_trip",
            "put_to_braking",
            "put_to_motors",
            "put_to_seen",
            "braking_to_still",
            "still_to_first_action",
            "end_to_resumed",
        ] {
            let of = |row: &&BTreeMap<_, _>| {
                row["condition"] == condition && row["interval"] == interval
            };
            let row = rows.iter().find(of);
            let row = row.unwrap_or_else(|| panic!("no {interval} in {rows:?}"));
            let count: usize = row["count"].parse().unwrap();
            let p50_us: f64 = row["p50_us"].parse().unwrap();
            assert!(p50_us > 0.0, "{row:?}");
            match interval {
                "put_to_braking" => assert_eq!(count, 5, "{row:?}"),
                // A tour may end with the emergency, and what is short may not be seen.
                _ => assert!(count > 0, "{row:?}"),
            }
        }
    }
    assert!(out.path().join("latency.svg").exists());
}

#[tokio::test(flavor = "multi_thread")]
async fn every_interruption_of_a_fleet_comes_to_its_end() {
    let user = User::new().await;
    let out = TempDir::new().unwrap();
    let folder = out.path().to_str().unwrap();
    user.ok(&[
        "experiment",
        "fleet",
        "--robots",
        "1,3",
        "--seconds",
        "3",
        "--every",
        "0.5",
        "--speed",
        "20",
        "--out",
        folder,
    ])
    .await;
    let rows = rows(&out, "fleet.csv");
    let robots: Vec<&str> = rows.iter().map(|row| row["robots"].as_str()).collect();
    assert_eq!(robots, ["1", "3"]);
    for row in rows {
        assert!(row["interruptions"].parse::<u64>().unwrap() > 0, "{row:?}");
        assert_eq!(row["unended"], "0", "{row:?}");
        let memory_kib: f64 = row["memory_per_robot_kib"].parse().unwrap();
        assert!(memory_kib > 0.0, "{row:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn an_experiment_that_is_broken_off_reports_what_there_is_and_leaves_no_robot() {
    let user = User::new().await;
    let many = [
        "experiment",
        "latency",
        "--interruptions",
        "1000000",
        "--speed",
        "50",
    ];
    let experiment = user.start(&many);
    let robot_is_there = async { while user.run(&["status"]).await.code != Some(0) {} };
    timeout(PATIENCE, robot_is_there).await.unwrap();
    let pid = experiment.id().unwrap();
    kill(Pid::from_raw(pid.try_into().unwrap()), Signal::SIGINT).unwrap();
    let output = timeout(PATIENCE, experiment.wait_with_output()).await;
    let output = output.unwrap().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("bare_round_trip"), "{said}");
    assert!(said.contains("Ctrl-C"), "{said}");
    assert_eq!(user.run(&["status"]).await.code, Some(3));
}
