//! How long it takes until a robot is there again.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use crate::chance::{How, Stroke};

/// What was measured.
#[derive(Debug, Default)]
pub struct Times {
    strokes: BTreeMap<String, usize>,
    /// Of roles: from the kill until all are there.
    ready: Vec<Duration>,
    /// … and until the robot is seen to move after that.
    moved: Vec<Duration>,
    /// The same where `up` was killed too.
    up_ready: Vec<Duration>,
    up_moved: Vec<Duration>,
}

impl Times {
    /// Something was done.
    pub fn struck(&mut self, stroke: &Stroke) {
        let what = match stroke.how {
            How::Kill => format!("{} killed", stroke.whom),
            How::Freeze(None) => format!("{} frozen for good", stroke.whom),
            How::Freeze(Some(_)) => format!("{} frozen", stroke.whom),
        };
        *self.strokes.entry(what).or_default() += 1;
    }

    /// The robot is there again; it may have had nothing to do.
    pub fn recovered(&mut self, up: bool, ready: Duration, moved: Option<Duration>) {
        let (all_ready, all_moved) = if up {
            (&mut self.up_ready, &mut self.up_moved)
        } else {
            (&mut self.ready, &mut self.moved)
        };
        all_ready.push(ready);
        all_moved.extend(moved);
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (what, times) in &self.strokes {
            writeln!(f, "{times:>5} × {what}")?;
        }
        for (what, times) in [
            ("roles killed, all there again", &self.ready),
            ("roles killed, robot moves again", &self.moved),
            ("`up` killed, all there again", &self.up_ready),
            ("`up` killed, robot moves again", &self.up_moved),
        ] {
            writeln!(f, "{what}: {}", summary(times))?;
        }
        Ok(())
    }
}

fn summary(times: &[Duration]) -> String {
    let mut sorted: Vec<u128> = times.iter().map(Duration::as_millis).collect();
    sorted.sort_unstable();
    let at = |percent: usize| {
        let place = (sorted.len() * percent).div_ceil(100).max(1) - 1;
        sorted.get(place).copied().unwrap_or_default()
    };
    match sorted.len() {
        0 => "never measured".to_owned(),
        count => format!(
            "median {} ms, p99 {} ms, longest {} ms ({count} times)",
            at(50),
            at(99),
            at(100)
        ),
    }
}
