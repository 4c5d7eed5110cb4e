//! How planning goes, on the standard error, once it takes long enough for anybody to wonder.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Before this nobody is impatient.
const PATIENCE: Duration = Duration::from_secs(2);
/// Where lines stay, as in a log, there is one for every so much time.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// A line that moves on a terminal, lines now and then elsewhere.
pub(super) struct Progress {
    bar: ProgressBar,
    next_line: Duration,
    best: Option<usize>,
}

impl Progress {
    pub(super) fn new() -> Self {
        let target = ProgressDrawTarget::stderr_with_hz(10);
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template("{spinner:.cyan} {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        Self {
            bar,
            next_line: PATIENCE,
            best: None,
        }
    }

    pub(super) fn show(&mut self, now: &offline_planner::Progress) {
        let line = || {
            let best = match &now.best {
                Some((length, cost)) => {
                    format!(", best plan: {length} actions, cost {}", cost.units())
                }
                None => String::new(),
            };
            let seconds = now.elapsed.as_secs_f64();
            let (phase, expanded) = (now.phase, now.expanded);
            format!("{seconds:6.1} s  {phase}, {expanded} nodes{best}")
        };
        if now.elapsed < PATIENCE {
            return;
        }
        let length = now.best.map(|(length, _)| length);
        let better = length != self.best;
        self.best = length;
        if !self.bar.is_hidden() {
            self.bar.set_message(line());
            self.bar.tick();
        } else if better || now.elapsed >= self.next_line {
            self.next_line = now.elapsed + BETWEEN_LINES;
            anstream::eprintln!("{}", line());
        }
    }

    /// Takes the line away.
    pub(super) fn end(self) {
        self.bar.finish_and_clear();
    }
}
