//! The paper's Tables 1, 2 and 3: how long it takes to go on with what was interrupted.

mod beside;
mod paper;
mod pictures;

use agent_core::planner::PlannerKind;
use agent_core::protocol::Resumption;

use crate::drive::{Drive, Ground, Sample, Situation, Spent, interrupt};
use crate::{Cell, ExperimentError, Onlooker, Report, Summary, Table};
pub use paper::{PAPER_MACHINE, PAPER_ROWS, PaperRow};

/// The planners that are compared, by the names that tables have for them.
pub(crate) const PLANNERS: [(&str, PlannerKind); 2] = [
    ("online", PlannerKind::Graph),
    ("naive", PlannerKind::Naive),
];
pub(crate) const LEVELS: [&str; 3] = ["parent", "child", "total"];
/// So often everything is done before it is measured.
const WARM_UP: u32 = 2;

/// So often a measurement is made again if something else was given the processor meanwhile.
const ATTEMPTS: u32 = 20;

const METHOD: &str = "\
Each row is a drive of the paper's: the robot is interrupted half way along the first arc, drives where the emergency \
wants it, and goes on. Parent, child and a simulated robot run in one process and in virtual time, with the code that \
the processes run; every drive begins with agents that know nothing but their maps. Decision 8 (what helps is not \
stopped) is off, as in the paper. Online and naive take turns within each repetition, and both keep as many \
alternatives. A measurement during which the system gave the processor to something else is made again.

median_us, p10_us and p90_us are the time to resume, as the paper measures it: parent, the time spent in the parent \
from the input that ends the emergency until its next instruction for the tour has left; child, the time spent in the \
child from the arrival of that instruction until its own next instruction to the robot has left; total, both. \
upkeep_us (median) is everything else that the agent has spent since the emergency arrived and that is not planning \
for the emergency itself: belief, bookkeeping, suspended plans kept current, telling the planner what has changed, and \
whatever is put off until after the instruction has left. expanded and evaluated count nodes of the planner's search \
during the time to resume.";

/// Measures the six rows, so many times each.
///
/// # Errors
/// If agents or robot do something else than the paper says.
pub fn replanning(
    repetitions: u32,
    onlooker: &mut dyn Onlooker,
) -> Result<Report, ExperimentError> {
    let ground = Ground::museum()?;
    let mut rows = Vec::new();
    for paper in PAPER_ROWS {
        rows.push(Row::new(&ground, paper, None)?);
    }
    for (paper, door) in PAPER_ROWS.into_iter().zip(beside::CLOSES) {
        rows.push(Row::new(&ground, paper, Some(door))?);
    }
    let of = u64::from(WARM_UP + repetitions);
    for repetition in 0..WARM_UP + repetitions {
        if onlooker.has_seen_enough() {
            break;
        }
        onlooker.see(
            u64::from(repetition),
            of,
            "six interruptions, online and naive",
        );
        for row in &mut rows {
            row.measure(&ground, repetition)?;
        }
    }
    onlooker.see(of, of, "done");
    Ok(report(&rows))
}

struct Row {
    paper: PaperRow,
    /// A door that closes meanwhile; then the row is not the paper's.
    closes: Option<&'static str>,
    situation: Situation,
    /// By planner: stacks that stand at the start.
    drives: [Drive; 2],
    samples: [Vec<Sample>; 2],
    /// By planner: metres from where the emergency ended to the goal.
    route_m: [Option<f64>; 2],
}

impl Row {
    fn new(
        ground: &Ground,
        paper: PaperRow,
        closes: Option<&'static str>,
    ) -> Result<Self, ExperimentError> {
        let [online, naive] = PLANNERS.map(|(_, kind)| Drive::new(ground, paper.start.0, kind));
        Ok(Self {
            situation: Situation {
                start: paper.start.0.to_owned(),
                goal: paper.goal.0.to_owned(),
                interruption: paper.interruption.0.to_owned(),
                emergency: paper.emergency.0.to_owned(),
                change: closes.map(beside::closing),
            },
            paper,
            closes,
            drives: [online?, naive?],
            samples: [Vec::new(), Vec::new()],
            route_m: [None, None],
        })
    }

    /// The columns `start` to `emergency`.
    fn words(&self) -> [Cell; 4] {
        let Situation {
            start,
            goal,
            interruption,
            emergency,
            ..
        } = &self.situation;
        [start, goal, interruption, emergency].map(|word| Cell::from(word.as_str()))
    }

    fn measure(&mut self, ground: &Ground, repetition: u32) -> Result<(), ExperimentError> {
        let is_warm_up = repetition < WARM_UP;
        for turn in 0..2 {
            // Each goes first as often as the other.
            let planner = (turn + repetition as usize) % 2;
            let sample = undisturbed(|| {
                let drive = self.drives[planner].clone();
                interrupt(ground, drive, &self.situation, is_warm_up)
            })?;
            let is_revised = sample.how != Resumption::Continued;
            if self.closes.is_none() && is_revised != self.paper.is_revised {
                let why = format!("the parent's plan is {:?}, unlike the paper's", sample.how);
                return Err(ExperimentError::course(&self.situation, why));
            }
            if is_warm_up {
                self.route_m[planner] = sample.route_m;
            } else {
                self.samples[planner].push(sample);
            }
        }
        Ok(())
    }
}

/// A sample during which nothing else was given the processor, if there is one among some.
pub(crate) fn undisturbed(
    mut measure: impl FnMut() -> Result<Sample, ExperimentError>,
) -> Result<Sample, ExperimentError> {
    let mut sample = measure()?;
    for _ in 0..ATTEMPTS {
        if !sample.is_disturbed {
            break;
        }
        sample = measure()?;
    }
    Ok(sample)
}

fn report(rows: &[Row]) -> Report {
    let mut report = Report::new("replanning", METHOD);
    let (of_the_paper, with_a_door) = rows.split_at(PAPER_ROWS.len().min(rows.len()));
    report.tables = vec![
        ratios(of_the_paper),
        figures(of_the_paper),
        beside::doors(with_a_door),
        beside::routes(rows),
    ];
    report.charts = pictures::charts(of_the_paper);
    report
}

/// What one level has spent.
pub(crate) fn spent(sample: &Sample, level: usize) -> Spent {
    match level {
        0 => sample.parent,
        1 => sample.child,
        _ => sample.parent.and(sample.child),
    }
}

/// The columns `median_us` to `evaluated`.
pub(crate) fn cells(samples: &[Sample], level: usize) -> [Cell; 6] {
    let spent = || samples.iter().map(|sample| spent(sample, level));
    let resume = Summary::of(spent().map(|spent| us(spent.resume)));
    let upkeep = Summary::of(spent().map(|spent| us(spent.upkeep)));
    let count = |count: fn(&Spent) -> u64| {
        let counted = Summary::of(spent().map(|spent| count(&spent) as f64));
        Cell::Count(counted.median as u64)
    };
    [
        resume.median.into(),
        resume.p10.into(),
        resume.p90.into(),
        upkeep.median.into(),
        count(|spent| spent.work.expanded),
        count(|spent| spent.work.evaluated),
    ]
}

pub(crate) fn us(duration: std::time::Duration) -> f64 {
    duration.as_secs_f64() * 1e6
}

fn figures(rows: &[Row]) -> Table {
    let mut table = Table::new("replanning", "Time to resume the tour", COLUMNS);
    for (_, cells) in lines(rows) {
        table.push(cells);
    }
    table
}

/// The columns of `replanning.csv`, and of others after their own.
pub(crate) const COLUMNS: [&str; 13] = [
    "row",
    "start",
    "goal",
    "interruption",
    "emergency",
    "level",
    "planner",
    "median_us",
    "p10_us",
    "p90_us",
    "upkeep_us",
    "expanded",
    "evaluated",
];

/// What stands in [`COLUMNS`], for each row, level and planner.
fn lines(rows: &[Row]) -> Vec<(&Row, Vec<Cell>)> {
    let mut lines = Vec::new();
    for (number, row) in rows.iter().enumerate() {
        for (level, level_name) in LEVELS.into_iter().enumerate() {
            for (planner, (planner_name, _)) in PLANNERS.into_iter().enumerate() {
                let mut cells_of_row = vec![Cell::from(number + 1)];
                cells_of_row.extend(row.words());
                cells_of_row.extend([level_name.into(), planner_name.into()]);
                cells_of_row.extend(cells(&row.samples[planner], level));
                lines.push((row, cells_of_row));
            }
        }
    }
    lines
}

fn ratios(rows: &[Row]) -> Table {
    let mut table = Table::new(
        "replanning_ratios",
        &format!(
            "How many times as long naive takes; beside it the paper's seconds ({PAPER_MACHINE})"
        ),
        [
            "row",
            "emergency",
            "plan",
            "level",
            "online_us",
            "naive_us",
            "ratio",
            "ratio_with_upkeep",
            "emergency_planning_online_us",
            "emergency_planning_naive_us",
            "paper_online_s",
            "paper_naive_s",
            "paper_ratio",
        ],
    );
    for (number, row) in rows.iter().enumerate() {
        for (level, level_name) in LEVELS.into_iter().enumerate() {
            let median = |planner: usize, of: fn(&Spent) -> f64| {
                let samples = row.samples[planner].iter();
                Summary::of(samples.map(|sample| of(&spent(sample, level)))).median
            };
            let ratio = |of| Cell::from(median(1, of) / median(0, of));
            let [paper_online, paper_naive] = row.paper.seconds[level];
            table.push([
                (number + 1).into(),
                row.paper.emergency.0.into(),
                if row.paper.is_revised {
                    "revised"
                } else {
                    "kept"
                }
                .into(),
                level_name.into(),
                median(0, |spent| us(spent.resume)).into(),
                median(1, |spent| us(spent.resume)).into(),
                ratio(|spent| us(spent.resume)),
                ratio(|spent| us(spent.resume + spent.upkeep)),
                median(0, |spent| us(spent.emergency)).into(),
                median(1, |spent| us(spent.emergency)).into(),
                paper_online.into(),
                paper_naive.into(),
                (paper_naive / paper_online).into(),
            ]);
        }
    }
    table
}
