//! How fast a robot stops: real processes, a router, and a client that interrupts.

mod bare;
mod drill;
mod witness;

use std::path::{Path, PathBuf};
use std::time::Duration;

use agent_link::options::{DepthOption, LimitOptions, PlannerOption, PlannerOptions, RateOption};
use agent_link::session::{self, Role};
use agent_link::{Rate, Session};
use experiments::{Chart, Line, Onlooker, Report, Summary, Table};
use maps::{Place, museum, scaled_map};

use super::follow::Ending;
use super::stamps::{Interval, Measured};
use crate::cli::LatencyArgs;
use crate::exit::Failure;
use crate::robot::{HANG_LIMIT, Robot, Setup};
use drill::{Drill, Emergency};

/// No client asks so often.
const EMERGENCIES_PER_S: f64 = 10_000.0;

/// As many plans are kept as `up` has kept unless told otherwise.
const ALTERNATIVES: usize = 3;

/// What is measured, and how often.
#[derive(Clone, Debug)]
pub(crate) struct Latency {
    /// Under each condition.
    pub(crate) interruptions: usize,
    /// Of the map on which large plans are made.
    pub(crate) nodes: u32,
    /// Seconds of the world in one.
    pub(crate) speed: f64,
    /// Of what is interrupted when, and where tours and emergencies go.
    pub(crate) seed: u64,
    /// Where the journals are; `None` for a temporary directory.
    pub(crate) state: Option<PathBuf>,
}

/// Under what the same is measured.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Condition {
    /// The museum of the paper, and little to plan.
    Idle,
    /// A made-up museum, and emergencies for which a large plan is made.
    Planning,
}

impl Condition {
    fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Planning => "planning",
        }
    }
}

impl Latency {
    /// As it was typed.
    pub(crate) fn of(args: &LatencyArgs) -> Self {
        Self {
            interruptions: args.interruptions as usize,
            nodes: args.nodes,
            speed: args.speed,
            seed: args.seed,
            state: args.state.clone(),
        }
    }

    /// Measures, and what was measured until `interrupted` is reported.
    ///
    /// # Errors
    /// If a robot cannot be started, or does not come to the end of an interruption.
    pub(crate) async fn run(
        &self,
        onlooker: &mut impl Onlooker,
        interrupted: impl Future<Output = ()>,
    ) -> Result<Report, Failure> {
        let mut interrupted = std::pin::pin!(interrupted);
        let mut all = Vec::new();
        for condition in [Condition::Idle, Condition::Planning] {
            let before = all.len() * self.interruptions;
            let of = 2 * self.interruptions as u64;
            let mut tell = |done: usize| onlooker.see((before + done) as u64, of, condition.name());
            let measured = self
                .under(condition, &mut tell, interrupted.as_mut())
                .await?;
            let broken_off = measured.broken_off;
            all.push((condition, measured));
            if broken_off {
                break;
            }
        }
        Ok(self.report(&all))
    }

    async fn under(
        &self,
        condition: Condition,
        mut tell: impl FnMut(usize),
        mut interrupted: impl Future<Output = ()> + Unpin,
    ) -> Result<Measured, Failure> {
        let folder = tempfile::tempdir().map_err(Failure::failed)?;
        let (place, folder) = match condition {
            Condition::Idle => (Place::museum(), None),
            Condition::Planning => {
                let place = made_up(folder.path(), self.nodes, self.seed)?;
                (place, Some(folder.path().to_owned()))
            }
        };
        let mut measured = Measured {
            speed: self.speed,
            ..Measured::default()
        };
        let setup = self.setup(condition, folder)?;
        let Some(robot) = Robot::start(&setup, &mut interrupted).await? else {
            measured.broken_off = true;
            return Ok(measured);
        };
        let drilled = tokio::select! {
            drilled = self.drill(condition, &robot, &place, &mut tell, &mut measured) => drilled.map(|()| false),
            () = interrupted => Ok(true),
        };
        robot.end().await;
        measured.broken_off = drilled?;
        Ok(measured)
    }

    async fn drill(
        &self,
        condition: Condition,
        robot: &Robot,
        place: &Place,
        mut tell: impl FnMut(usize),
        measured: &mut Measured,
    ) -> Result<(), Failure> {
        let client = client(&robot.endpoint).await?;
        let other = client_of(&client, &robot.endpoint).await?;
        let kind = match condition {
            Condition::Idle => Emergency::Near,
            Condition::Planning => Emergency::Far,
        };
        let made = Drill::new(
            &client,
            &other,
            &robot.keys,
            robot.clock,
            place.site(),
            self.seed,
        );
        let mut result = Ok(());
        match made.await {
            Err(failure) => result = Err(failure),
            Ok(mut drill) => {
                while measured.interruptions.len() < self.interruptions {
                    let (ending, bare) = match drill.interrupt(kind).await {
                        Ok(done) => done,
                        Err(failure) => {
                            result = Err(failure);
                            break;
                        }
                    };
                    measured.bare.extend(bare);
                    match ending {
                        Ending::Broken(stamps) => measured.interruptions.push(stamps),
                        Ending::TooLate => measured.too_late += 1,
                        Ending::Kept => measured.kept += 1,
                    }
                    tell(measured.interruptions.len());
                }
            }
        }
        session::close(client).await;
        session::close(other).await;
        result
    }

    fn setup(&self, condition: Condition, place: Option<PathBuf>) -> Result<Setup, Failure> {
        let unlimited = Rate::per_second(EMERGENCIES_PER_S).map(RateOption);
        let unlimited = unlimited.ok_or_else(|| Failure::failed("no such rate"))?;
        Ok(Setup {
            robot: format!("latency-{}-{}", condition.name(), std::process::id()),
            place,
            start: "n1".to_owned(),
            speed: self.speed,
            planner: PlannerOptions {
                planner: PlannerOption::default(),
                depth: DepthOption::default(),
                alternatives: ALTERNATIVES,
            },
            faults: None,
            listen: Vec::new(),
            connect: Vec::new(),
            zenoh_config: None,
            state: self.state.clone(),
            world_elsewhere: false,
            hang_limit: HANG_LIMIT,
            security: None,
            limits: LimitOptions {
                emergencies_per_second: unlimited,
                emergencies_in_total: unlimited,
                ..LimitOptions::default()
            },
            vehicles: Vec::new(),
            together: None,
        })
    }

    fn report(&self, all: &[(Condition, Measured)]) -> Report {
        let mut report = Report::new(
            "latency",
            format!(
                "A robot of four processes and a router drives a tour at {} times real time, with journals; another client \
                 puts an emergency while it drives, {} times under each condition.",
                self.speed, self.interruptions
            ),
        );
        let mut table = Table::new(
            "latency",
            "From the word to the wheels",
            [
                "condition",
                "interval",
                "p50_us",
                "p90_us",
                "p99_us",
                "max_us",
                "count",
            ],
        );
        let mut lines = Vec::new();
        for (condition, measured) in all {
            let bare = measured.bare.iter().map(Duration::as_secs_f64);
            let bare: Vec<f64> = bare.map(|s| s * 1e6).collect();
            let mut rows = vec![("bare_round_trip", bare)];
            rows.extend(Interval::ALL.map(|interval| (interval.name(), measured.of(interval))));
            for (name, values) in rows {
                let summary = Summary::of(values.iter().copied());
                table.push([
                    condition.name().into(),
                    name.into(),
                    summary.median.into(),
                    summary.p90.into(),
                    summary.p99.into(),
                    summary.max.into(),
                    summary.count.into(),
                ]);
                if ["bare_round_trip", "put_to_braking"].contains(&name) {
                    lines.push(Line {
                        name: format!("{}, {}", name.replace('_', " "), condition.name()),
                        points: slower_than(values),
                    });
                }
            }
            report.remarks.push(format!(
                "{}: {} times the drive had ended before it could be broken off, and {} times it served the emergency \
                 too and went on.",
                condition.name(),
                measured.too_late,
                measured.kept
            ));
            if measured.broken_off {
                report.remarks.push(format!(
                    "{}: broken off after {} interruptions.",
                    condition.name(),
                    measured.interruptions.len()
                ));
            }
        }
        report.tables.push(table);
        report.charts.push(Chart {
            name: "latency".to_owned(),
            title: "How many take longer".to_owned(),
            across: "us".to_owned(),
            rows: Vec::new(),
            up: "share that takes longer".to_owned(),
            lines,
        });
        report
    }
}

/// For each value, the share of all that is at least as large.
fn slower_than(mut values: Vec<f64>) -> Vec<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let count = values.len() as f64;
    let values = values.into_iter().enumerate();
    values
        .map(|(place, value)| (value, (count - place as f64) / count))
        .collect()
}

async fn client(endpoint: &str) -> Result<Session, Failure> {
    let role = Role::Client {
        connect: vec![endpoint.to_owned()],
    };
    session::open(&role, None).await.map_err(Failure::failed)
}

/// A second client; the first one is closed if there is none.
async fn client_of(first: &Session, endpoint: &str) -> Result<Session, Failure> {
    match client(endpoint).await {
        Ok(session) => Ok(session),
        Err(failure) => {
            session::close(first.clone()).await;
            Err(failure)
        }
    }
}

/// A museum of that many nodes, in a folder of its own.
fn made_up(folder: &Path, nodes: u32, seed: u64) -> Result<Place, Failure> {
    let map = scaled_map(nodes, seed);
    for (name, text) in museum::FILES {
        let is_map = name == museum::FILES[0].0;
        let text = if is_map { &map } else { text };
        std::fs::write(folder.join(name), text).map_err(Failure::failed)?;
    }
    Place::read(folder).map_err(|findings| Failure::failed(crate::place::lines(&findings)))
}
