//! What became of one instance.

use std::fs;
use std::path::Path;

use plan_checker::{Kind, check};

use crate::instances::Instance;
use crate::peers::Peers;
use crate::run::{Limits, Planner, Usage};

/// `intermezzo plan` exits with this if it has proved that there is no plan.
const UNSOLVABLE: i32 = 4;

/// How a run ended.
#[derive(Clone, Debug)]
pub enum End {
    /// A plan that is right, with its length.
    Solved(usize),
    /// A plan that is right, but too late.
    Late(usize),
    /// A plan that is wrong, and why.
    Wrong(String),
    /// The planner says that there is none.
    Unsolvable,
    /// The planner says so, but another one has found a plan.
    Solvable,
    /// The time was over.
    Timeout,
    /// No plan, for another reason.
    NoPlan(String),
}

/// What became of one instance, and what it took.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub end: End,
    pub usage: Usage,
}

impl Outcome {
    /// The plan's length, if there is one that is right and in time.
    pub fn length(&self) -> Option<usize> {
        match self.end {
            End::Solved(length) => Some(length),
            _ => None,
        }
    }

    /// Whether the planner said something that is not true.
    pub fn is_wrong(&self) -> bool {
        matches!(self.end, End::Wrong(_) | End::Solvable)
    }

    /// A word or a few.
    pub fn status(&self) -> String {
        match &self.end {
            End::Solved(_) => "ok".to_owned(),
            End::Late(_) => "late".to_owned(),
            End::Wrong(why) => format!("WRONG PLAN: {why}"),
            End::Unsolvable => "unsolvable".to_owned(),
            End::Solvable => "NOT UNSOLVABLE: a peer solved it".to_owned(),
            End::Timeout => "timeout".to_owned(),
            End::NoPlan(why) => format!("no plan: {why}"),
        }
    }

    /// For the progress.
    pub fn line(&self) -> String {
        let length = match self.end {
            End::Solved(length) | End::Late(length) => format!(", {length} steps"),
            _ => String::new(),
        };
        let usage = &self.usage;
        let (wall, cpu, memory) = (usage.wall_s, usage.cpu_s, usage.memory_mib);
        let status = self.status();
        format!("{status}{length} ({wall:.2} s, CPU {cpu:.2} s, {memory:.0} MiB)")
    }
}

/// Runs the planner and checks what it says.
pub fn judged(
    planner: &Planner,
    instance: &Instance,
    plan: &Path,
    limits: &Limits,
    peers: &Peers,
) -> Outcome {
    // From an earlier run, perhaps.
    let _ = fs::remove_file(plan);
    let usage = match planner.run(instance, plan, limits) {
        Ok(usage) => usage,
        Err(error) => {
            return Outcome {
                end: End::NoPlan(error),
                usage: Usage::default(),
            };
        }
    };
    let late = usage.wall_s > limits.seconds + 0.5;
    let end = if plan.exists() {
        match verdict(instance, plan) {
            Ok(length) if late => End::Late(length),
            Ok(length) => End::Solved(length),
            Err(why) => End::Wrong(why),
        }
    } else if usage.exit == Some(UNSOLVABLE) || usage.last_words.starts_with("unsolvable") {
        if peers.solved(instance) {
            End::Solvable
        } else {
            End::Unsolvable
        }
    } else if usage.wall_s >= limits.seconds - 0.5 {
        End::Timeout
    } else {
        End::NoPlan(usage.last_words.clone())
    };
    Outcome { end, usage }
}

fn verdict(instance: &Instance, plan: &Path) -> Result<usize, String> {
    let read = |file: &Path| {
        fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))
    };
    let (domain, problem) = (read(&instance.domain)?, read(&instance.problem)?);
    match check(&domain, &problem, &read(plan)?) {
        Ok(report) => Ok(report.actions),
        Err(faults) => {
            let fault = faults.first();
            let unjudgeable = fault.is_some_and(|fault| fault.kind == Kind::Unjudgeable);
            let not = if unjudgeable {
                "cannot be judged: "
            } else {
                ""
            };
            Err(fault.map_or_else(String::new, |fault| format!("{not}{fault}")))
        }
    }
}
