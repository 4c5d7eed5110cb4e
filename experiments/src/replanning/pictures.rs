//! The tables as pictures.

use super::{LEVELS, PLANNERS, Row, spent, us};
use crate::{Chart, Line, Summary};

/// What every row takes, and how many times as long naive takes, beside the paper's figure.
pub(super) fn charts(rows: &[Row]) -> Vec<Chart> {
    let names = || {
        rows.iter()
            .map(|row| row.paper.emergency.0.to_owned())
            .collect()
    };
    let median = |row: &Row, planner: usize, level: usize| {
        let samples = row.samples[planner].iter();
        Summary::of(samples.map(|sample| us(spent(sample, level).resume))).median
    };
    let over_rows = |name: String, of: &dyn Fn(&Row) -> f64| Line {
        name,
        points: (1_u32..).map(f64::from).zip(rows.iter().map(of)).collect(),
    };
    let mut times = Vec::new();
    let mut ratios = Vec::new();
    for (level, level_name) in LEVELS.into_iter().enumerate() {
        for (planner, (planner_name, _)) in PLANNERS.into_iter().enumerate() {
            let name = format!("{level_name}, {planner_name}");
            times.push(over_rows(name, &|row| median(row, planner, level)));
        }
        ratios.push(over_rows(format!("{level_name}, here"), &|row| {
            median(row, 1, level) / median(row, 0, level)
        }));
        ratios.push(over_rows(format!("{level_name}, paper"), &|row| {
            let [online, naive] = row.paper.seconds[level];
            naive / online
        }));
    }
    // What is measured of both levels is the sum of the two.
    times.truncate(2 * PLANNERS.len());
    vec![
        Chart {
            name: "replanning".to_owned(),
            title: "Time to resume the tour".to_owned(),
            across: "node of the emergency".to_owned(),
            rows: names(),
            up: "median, microseconds".to_owned(),
            lines: times,
        },
        Chart {
            name: "replanning_ratios".to_owned(),
            title: "How many times as long naive takes".to_owned(),
            across: "node of the emergency".to_owned(),
            rows: names(),
            up: "naive / online".to_owned(),
            lines: ratios,
        },
    ]
}
