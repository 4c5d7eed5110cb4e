//! What must hold of the repository itself.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn cargo_tree(package: &str) -> Vec<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--offline", "--edges", "normal", "--prefix", "none"])
        .args(["--format", "{p}", "--package", package])
        .current_dir(root())
        .output()
        .expect("cargo runs, as it runs this test");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines()
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .collect()
}

#[test]
fn the_core_knows_no_runtime_no_network_no_files_and_no_wire_format() {
    let known = cargo_tree("agent_core");
    assert!(
        known.contains(&"serde".to_owned()),
        "the list is read right: {known:?}"
    );
    let strangers = [
        "tokio",
        "zenoh",
        "mio",
        "async-std",
        "futures",
        "serde_json",
        "toml",
        "rand",
        "rand_core",
        "getrandom",
        "tracing",
        "chrono",
        "time",
        "libc",
        "agent_link",
        "maps",
    ];
    for stranger in strangers {
        assert!(
            !known.iter().any(|name| name == stranger),
            "agent_core knows {stranger}"
        );
    }
}

#[test]
fn the_core_reads_no_clock_and_starts_no_thread() {
    let forbidden = [
        "std::time",
        "Instant",
        "SystemTime",
        "std::fs",
        "std::thread",
        "std::net",
        "HashMap",
        "std::env",
    ];
    for (file, text) in sources("agent_core/src") {
        // Tests may ask the environment how long to run.
        if file.components().any(|part| part.as_os_str() == "tests") {
            continue;
        }
        // With a hasher that is the same in every run, and never gone through in its order.
        let text = text.replace("hashbrown::HashMap", "");
        for word in forbidden {
            assert!(!text.contains(word), "{} speaks of {word}", file.display());
        }
    }
}

#[test]
fn the_three_roles_never_name_each_other() {
    let roles = ["parent_agent", "child_agent", "executor_sim", "vehicle"];
    for role in roles {
        let known = cargo_tree(role);
        for other in roles.iter().filter(|other| **other != role) {
            assert!(
                !known.iter().any(|name| name == other),
                "{role} knows {other}"
            );
        }
    }
}

#[test]
fn the_judge_of_plans_knows_none_of_our_crates() {
    let known = cargo_tree("plan_checker");
    assert!(known.contains(&"plan_checker".to_owned()), "{known:?}");
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("it is text");
    let members = manifest.lines().filter_map(|line| {
        let member = line.strip_prefix("    \"")?.strip_suffix("\",")?;
        member.rsplit('/').next()
    });
    let ours: Vec<&str> = members.chain(["intermezzo_tests"]).collect();
    assert!(
        ours.contains(&"agent_core"),
        "the list is read right: {ours:?}"
    );
    for name in known.iter().filter(|name| *name != "plan_checker") {
        assert!(!ours.contains(&name.as_str()), "plan_checker knows {name}");
    }
}

#[test]
fn no_source_file_is_longer_than_it_should_be() {
    let folders = [
        "agent_core/src",
        "agent_link/src",
        "child_agent/src",
        "executor_sim/src",
        "intermezzo/src",
        "maps/src",
        "parent_agent/src",
        "tests/plan_checker/src",
        "tests/src",
        "vehicle/src",
    ];
    for folder in folders {
        for (file, text) in sources(folder) {
            let code = text.lines().filter(|line| {
                let line = line.trim();
                !line.is_empty() && !line.starts_with("//")
            });
            let lines = code.count();
            assert!(lines <= 500, "{} has {lines} lines of code", file.display());
        }
    }
}

fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("the folder is there") {
            let path = entry.expect("it can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "rs") {
                let text = std::fs::read_to_string(&path).expect("it is text");
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty(), "there are sources in {folder}");
    found
}
