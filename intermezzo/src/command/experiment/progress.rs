//! How far an experiment is, on the standard error, and how to end it early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use experiments::Onlooker;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::command::plan::stop_at_ctrl_c;
use crate::exit::Failure;

/// Where lines stay, as in a log, there is one for every so much time.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Ctrl-C is looked for so often.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// A bar that moves on a terminal, lines now and then elsewhere. The first Ctrl-C ends the experiment
/// with what there is so far, the second ends the process.
pub(crate) struct Progress {
    bar: ProgressBar,
    begun: Instant,
    last_line: Instant,
    stop: Arc<AtomicBool>,
}

impl Progress {
    pub(super) fn new() -> Result<Self, Failure> {
        let stop = stop_at_ctrl_c()?;
        let target = ProgressDrawTarget::stderr_with_hz(10);
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template(
            "{elapsed:>4} {bar:30.cyan/dim} {percent:>3}%  {wide_msg}",
        );
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let now = Instant::now();
        Ok(Self {
            bar,
            begun: now,
            last_line: now,
            stop,
        })
    }

    /// Returns once Ctrl-C was pressed.
    pub(super) fn stopped(&self) -> impl Future<Output = ()> + use<> {
        let stop = self.stop.clone();
        async move {
            while !stop.load(Ordering::Relaxed) {
                tokio::time::sleep(BETWEEN_LOOKS).await;
            }
        }
    }

    /// Takes the bar away. Returns whether Ctrl-C was pressed.
    pub(super) fn end(self) -> bool {
        self.bar.finish_and_clear();
        self.has_seen_enough()
    }
}

impl Onlooker for Progress {
    fn see(&mut self, done: u64, of: u64, what: &str) {
        if !self.bar.is_hidden() {
            self.bar.set_length(of);
            self.bar.set_position(done);
            self.bar.set_message(what.to_owned());
        } else if self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            let seconds = self.begun.elapsed().as_secs_f64();
            anstream::eprintln!("{seconds:6.1} s  {done} of {of}  {what}");
        }
    }

    fn has_seen_enough(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
