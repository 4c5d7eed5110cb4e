//! The curves of the restaurant.

use super::Evenings;
use super::setting::Way;
use crate::{Chart, Line, Summary};

/// How long guests wait, over how many there are.
pub(super) fn of_evenings(evenings: &[Evenings]) -> Vec<Chart> {
    let mut lines: Vec<Line> = Vec::new();
    for kind in evenings {
        let carriers = match kind.carriers {
            1 => "1 carrier".to_owned(),
            many => format!("{many} carriers"),
        };
        // The rest is in the table: ten curves are two too many.
        if kind.way == Way::Sequential && kind.carriers % 2 == 0 {
            continue;
        }
        let name = format!("{carriers}, {}", kind.way.name());
        let waited = Summary::of(kind.waited_s.iter().copied());
        let point = (f64::from(kind.guests), waited.median);
        match lines.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => lines.push(Line {
                name,
                points: vec![point],
            }),
        }
    }
    vec![Chart {
        name: "restaurant_evenings".to_owned(),
        title: "How long guests wait for their drink".to_owned(),
        across: "guests of an evening".to_owned(),
        rows: Vec::new(),
        up: "median, seconds".to_owned(),
        lines,
    }]
}
