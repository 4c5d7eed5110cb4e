//! How long it takes until a robot is there again.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use crate::chance::{Blow, How, Stroke};

/// What was measured.
#[derive(Debug, Default)]
pub struct Times {
    strokes: BTreeMap<String, usize>,
    measured: BTreeMap<Kind, Recoveries>,
}

/// From what a robot recovers.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Kind {
    /// From the kill of a role or two.
    Roles,
    /// From that of `up`, by a new one.
    Up,
    /// From the moment at which the last that was frozen is woken up.
    Thawed,
    /// From the moment at which a role is frozen that nobody wakes up.
    Frozen,
}

/// Of one kind.
#[derive(Debug, Default)]
struct Recoveries {
    /// Until all are there.
    ready: Vec<Duration>,
    /// … and until the robot is seen to move after that.
    moved: Vec<Duration>,
}

impl Kind {
    fn of(blow: &Blow) -> Self {
        let any = |what: fn(&Stroke) -> bool| blow.strokes.iter().any(what);
        if any(|stroke| stroke.whom == "up" && matches!(stroke.how, How::Kill)) {
            Self::Up
        } else if any(|stroke| matches!(stroke.how, How::Freeze(None))) {
            Self::Frozen
        } else if any(|stroke| matches!(stroke.how, How::Freeze(Some(_)))) {
            Self::Thawed
        } else {
            Self::Roles
        }
    }
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
    pub fn recovered(&mut self, blow: &Blow, ready: Duration, moved: Option<Duration>) {
        let recoveries = self.measured.entry(Kind::of(blow)).or_default();
        recoveries.ready.push(ready);
        recoveries.moved.extend(moved);
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (what, times) in &self.strokes {
            writeln!(f, "{times:>5} × {what}")?;
        }
        for (kind, recoveries) in &self.measured {
            let from = match kind {
                Kind::Roles => "roles killed",
                Kind::Up => "`up` killed",
                Kind::Thawed => "woken up",
                Kind::Frozen => "frozen for good",
            };
            let (ready, moved) = (summary(&recoveries.ready), summary(&recoveries.moved));
            writeln!(f, "{from}, all there again: {ready}")?;
            writeln!(f, "{from}, robot moves again: {moved}")?;
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
            "median {} ms, p95 {} ms, longest {} ms ({count} times)",
            at(50),
            at(95),
            at(100)
        ),
    }
}
