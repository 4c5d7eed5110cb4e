//! The last line of a terminal: where the robot is at this moment.

use agent_core::model::Time;
use agent_core::protocol::GoalId;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Not there where there is no terminal.
pub(super) struct Progress {
    bar: ProgressBar,
    goals: String,
}

impl Progress {
    pub(super) fn new() -> Self {
        // The target hides itself if the standard output is no terminal.
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout_with_hz(20));
        let style = ProgressStyle::with_template("{spinner:.cyan} {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        Self {
            bar,
            goals: "nothing to do".to_owned(),
        }
    }

    /// Prints something above the line.
    pub(super) fn above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    pub(super) fn goals(&mut self, running: Option<&GoalId>, stack: &[GoalId]) {
        self.goals = running.map_or_else(|| "nothing to do".to_owned(), ToString::to_string);
        if !stack.is_empty() {
            let names: Vec<&str> = stack.iter().rev().map(GoalId::as_str).collect();
            self.goals = format!("{}, then {}", self.goals, names.join(", then "));
        }
    }

    pub(super) fn place(&self, at: Time, words: &str, odometer_m: f64) {
        self.bar.set_message(format!(
            "{:>6.1} s  {words:<32} {odometer_m:>6.1} m driven   {}",
            at.secs(),
            self.goals
        ));
        self.bar.tick();
    }

    pub(super) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
