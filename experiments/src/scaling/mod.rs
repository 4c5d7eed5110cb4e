//! How replanning grows with the map.

mod situations;

use std::sync::Arc;
use std::time::{Duration, Instant};

use agent_core::protocol::Resumption;
use maps::{Site, scaled_map};

use crate::drive::{Drive, Ground, Sample, Situation, interrupt};
use crate::replanning::{COLUMNS, LEVELS, PLANNERS, cells, spent, undisturbed, us};
use crate::{Cell, Chart, ExperimentError, Line, Onlooker, Report, Summary, Table};
use situations::situations;

/// The museums that are measured unless told otherwise.
pub const SIZES: [u32; 5] = [40, 400, 4_000, 40_000, 100_000];
/// Every situation is measured at least so often …
const LEAST: usize = 3;
/// … and more often as long as a size has not taken so long.
const PATIENCE: Duration = Duration::from_secs(40);
/// The museums are all made from this seed.
const SEED: u64 = 1;

const METHOD: &str = "\
The paper's kinds of interruptions on made-up museums of growing size: the robot is on its way to a node four areas \
away, from the entrance or back to it, and an emergency comes that leads to another node of the same area, to an area \
on the route, or to one off the route; or to another node of the same area while a door closes, on the suspended route \
where it can be gone round, or elsewhere. Everything else is as in the experiment on replanning: whole stacks in \
virtual time, each drive with agents that know nothing but their maps, online and naive in turns, and the columns mean \
the same.

Memory is the most that a process of its own has taken that reads the map, makes the agents and drives through one \
interruption, map and simulated world included.";

/// What is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    /// How many nodes the museums have.
    pub nodes: Vec<u32>,
    /// At most so often each situation is measured, by each planner.
    pub repetitions: usize,
}

/// Measures how large a process of its own becomes: for so many nodes and a planner of this name, in
/// bytes; `None` if that cannot be found out.
pub type MeasureMemory<'a> = &'a mut dyn FnMut(u32, &str) -> Option<u64>;

/// Measures all situations on museums of growing size.
///
/// # Errors
/// If a museum cannot be made.
pub fn scaling(
    what: &Scaling,
    memory: MeasureMemory<'_>,
    onlooker: &mut dyn Onlooker,
) -> Result<Report, ExperimentError> {
    let mut measured = Vec::new();
    let mut remarks = Vec::new();
    let of = what.nodes.len() as u64;
    for (done, nodes) in what.nodes.iter().enumerate() {
        if onlooker.has_seen_enough() {
            break;
        }
        onlooker.see(
            done as u64,
            of,
            &format!("{nodes} nodes: the museum is made"),
        );
        let ground = ground(*nodes)?;
        let begun = Instant::now();
        for (row, situation) in situations(&ground.site) {
            if onlooker.has_seen_enough() {
                break;
            }
            onlooker.see(done as u64, of, &format!("{nodes} nodes: {row}"));
            let late = || begun.elapsed() > PATIENCE;
            match measure(&ground, &situation, what.repetitions, &late, onlooker) {
                Ok(samples) => measured.push(Measured {
                    nodes: *nodes,
                    row,
                    situation,
                    samples,
                }),
                Err(error) => remarks.push(format!("{nodes} nodes, {row}: not measured: {error}")),
            }
        }
    }
    let mut room = Vec::new();
    for (done, nodes) in what.nodes.iter().enumerate() {
        for (planner, _) in PLANNERS {
            if !onlooker.has_seen_enough() {
                onlooker.see(
                    done as u64,
                    of,
                    &format!("{nodes} nodes: memory, {planner}"),
                );
                room.extend(memory(*nodes, planner).map(|bytes| (*nodes, planner, bytes)));
            }
        }
    }
    onlooker.see(of, of, "done");
    let mut report = Report::new("scaling", METHOD);
    report.tables = vec![ratios(&measured), figures(&measured), memory_table(&room)];
    report.charts = charts(&measured, &room);
    report.remarks = remarks;
    Ok(report)
}

/// The most memory that this process has taken so far, in bytes, after one interruption in a museum of
/// so many nodes.
///
/// # Errors
/// If the museum cannot be made, the planner has no such name, or the system does not say.
pub fn memory_after_an_interruption(nodes: u32, planner: &str) -> Result<u64, ExperimentError> {
    let kind = PLANNERS.iter().find(|(name, _)| *name == planner);
    let (_, kind) = kind.ok_or_else(|| ExperimentError::setup("there is no such planner"))?;
    let ground = ground(nodes)?;
    let (_, situation) = situations(&ground.site)
        .into_iter()
        .next()
        .ok_or_else(|| ExperimentError::setup("the museum is too small"))?;
    let drive = Drive::new(&ground, &situation.start, *kind)?;
    interrupt(&ground, drive, &situation, true)?;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let most = status.lines().find_map(|line| {
        let words = line.strip_prefix("VmHWM:")?;
        words.split_whitespace().next()?.parse::<u64>().ok()
    });
    most.map(|kilobytes| kilobytes * 1024)
        .ok_or_else(|| ExperimentError::setup("the system does not say how much memory was taken"))
}

fn ground(nodes: u32) -> Result<Ground, ExperimentError> {
    let text = scaled_map(nodes, SEED);
    let site = Site::from_text("scaled", &text).map_err(|findings| {
        let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
        ExperimentError::setup(lines.join("\n"))
    })?;
    Ground::new(Arc::new(site))
}

struct Measured {
    nodes: u32,
    row: String,
    situation: Situation,
    /// By planner.
    samples: [Vec<Sample>; 2],
}

fn measure(
    ground: &Ground,
    situation: &Situation,
    repetitions: usize,
    late: &dyn Fn() -> bool,
    onlooker: &dyn Onlooker,
) -> Result<[Vec<Sample>; 2], ExperimentError> {
    let [online, naive] = PLANNERS.map(|(_, kind)| Drive::new(ground, &situation.start, kind));
    let drives = [online?, naive?];
    let mut samples = [Vec::new(), Vec::new()];
    // The first one is for warming up.
    for repetition in 0..=repetitions {
        if repetition > LEAST && late() || repetition > 1 && onlooker.has_seen_enough() {
            break;
        }
        for turn in 0..2 {
            let planner = (turn + repetition) % 2;
            let sample = undisturbed(|| {
                interrupt(ground, drives[planner].clone(), situation, repetition == 0)
            })?;
            if repetition > 0 {
                samples[planner].push(sample);
            }
        }
    }
    Ok(samples)
}

impl Measured {
    fn median(&self, planner: usize, level: usize, of: fn(&crate::drive::Spent) -> f64) -> f64 {
        let samples = self.samples[planner].iter();
        Summary::of(samples.map(|sample| of(&spent(sample, level)))).median
    }

    fn resume(&self, planner: usize, level: usize) -> f64 {
        self.median(planner, level, |spent| us(spent.resume))
    }

    fn verdict(&self) -> &'static str {
        let samples = &self.samples[0];
        match samples
            .iter()
            .all(|sample| sample.how == Resumption::Continued)
        {
            true => "kept",
            false => "revised",
        }
    }
}

fn figures(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "scaling",
        "Time to resume the tour",
        ["nodes"].into_iter().chain(COLUMNS),
    );
    for one in measured {
        for (level, level_name) in LEVELS.into_iter().enumerate() {
            for (planner, (planner_name, _)) in PLANNERS.into_iter().enumerate() {
                let samples = &one.samples[planner];
                let interruption = samples.first().map(|sample| sample.interruption.as_str());
                let mut row: Vec<Cell> = vec![
                    u64::from(one.nodes).into(),
                    one.row.as_str().into(),
                    one.situation.start.as_str().into(),
                    one.situation.goal.as_str().into(),
                    interruption.into(),
                    one.situation.emergency.as_str().into(),
                    level_name.into(),
                    planner_name.into(),
                ];
                row.extend(cells(samples, level));
                table.push(row);
            }
        }
    }
    table
}

fn ratios(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "scaling_ratios",
        "How many times as long naive takes",
        [
            "nodes",
            "row",
            "plan",
            "level",
            "online_us",
            "naive_us",
            "ratio",
            "ratio_with_upkeep",
        ],
    );
    for one in measured {
        for (level, level_name) in LEVELS.into_iter().enumerate() {
            let all = |planner| one.median(planner, level, |spent| us(spent.resume + spent.upkeep));
            table.push([
                u64::from(one.nodes).into(),
                one.row.as_str().into(),
                one.verdict().into(),
                level_name.into(),
                one.resume(0, level).into(),
                one.resume(1, level).into(),
                (one.resume(1, level) / one.resume(0, level)).into(),
                (all(1) / all(0)).into(),
            ]);
        }
    }
    table
}

fn memory_table(room: &[(u32, &str, u64)]) -> Table {
    let columns = ["nodes", "planner", "memory_mb"];
    let mut table = Table::new("scaling_memory", "The most memory of a process", columns);
    for (nodes, planner, bytes) in room {
        let megabytes = *bytes as f64 / 1e6;
        table.push([
            u64::from(*nodes).into(),
            (*planner).into(),
            megabytes.into(),
        ]);
    }
    table
}

fn charts(measured: &[Measured], room: &[(u32, &str, u64)]) -> Vec<Chart> {
    let chart = |name: &str, title: &str, rows: [&str; 2]| Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        across: "nodes of the map".to_owned(),
        rows: Vec::new(),
        up: "parent, time to resume (us)".to_owned(),
        lines: rows
            .into_iter()
            .flat_map(|row| {
                PLANNERS
                    .iter()
                    .enumerate()
                    .map(move |planner| (row, planner))
            })
            .map(|(row, (planner, (name, _)))| Line {
                name: format!("{name}: {row}"),
                points: measured
                    .iter()
                    .filter(|one| one.row == format!("{row}, there"))
                    .map(|one| (f64::from(one.nodes), one.resume(planner, 0)))
                    .collect(),
            })
            .collect(),
    };
    let memory = PLANNERS.map(|(name, _)| Line {
        name: name.to_owned(),
        points: room
            .iter()
            .filter(|(_, planner, _)| *planner == name)
            .map(|(nodes, _, bytes)| (f64::from(*nodes), *bytes as f64 / 1e6))
            .collect(),
    });
    vec![
        chart(
            "scaling_kept",
            "The suspended plan is not affected",
            ["same area", "on the route"],
        ),
        chart(
            "scaling_revised",
            "The suspended plan is revised",
            ["off the route", "door closes on the route"],
        ),
        Chart {
            name: "scaling_memory".to_owned(),
            title: "Memory of a process".to_owned(),
            across: "nodes of the map".to_owned(),
            rows: Vec::new(),
            up: "megabytes".to_owned(),
            lines: memory.to_vec(),
        },
    ]
}
