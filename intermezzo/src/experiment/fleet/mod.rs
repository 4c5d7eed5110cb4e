//! Many robots at once: how often they can be interrupted, how fast each stops, what each costs.

mod crowd;
mod host;
mod usage;

use std::process::Stdio;
use std::time::{Duration, Instant};

use agent_link::session::{self, Role};
use agent_link::{Clock, Session};
use experiments::{Cell, Chart, Line, Onlooker, Report, Summary, Table};
use maps::Place;
use tokio::process::{Child, Command};

use super::stamps::{Interval, Stamps};
use crate::cli::FleetArgs;
use crate::exit::Failure;
use crowd::{Crowd, Tally};
use host::{Part, keys};
use usage::Usage;

pub(crate) use host::{HostArgs, run as host};

/// The machines of each robot: parent, child, controller and world.
const MACHINES: usize = 4;

/// All robots of a fleet are there within this, and as much again for each hundred.
const PATIENCE: Duration = Duration::from_secs(60);

/// Before anything is measured, robots drive for so long.
const WARM_UP: Duration = Duration::from_secs(2);

/// What was interrupted goes on within this, in seconds of the world: the robot has driven back, and the
/// way to there is short.
const LAST_INTERRUPTIONS_S: f64 = 120.0;

/// A process that is told to end has ended within this, or is killed.
const PATIENCE_AT_THE_END: Duration = Duration::from_secs(20);

/// What is measured, and for how long.
#[derive(Clone, Debug)]
pub(crate) struct Fleet {
    /// How many robots, one fleet after the other.
    pub(crate) robots: Vec<u32>,
    /// How long each fleet is interrupted.
    pub(crate) time: Duration,
    /// Seconds between two interruptions of a robot, on average.
    pub(crate) every_s: f64,
    /// Seconds of the world in one.
    pub(crate) speed: f64,
    /// Of what is interrupted when, and where tours go.
    pub(crate) seed: u64,
}

/// What was measured of one fleet.
#[derive(Clone, Debug)]
struct Measured {
    robots: u32,
    /// Until every machine was there.
    start: Duration,
    time: Duration,
    tally: Tally,
    /// Of the processes with the robots.
    machines: Usage,
    /// Of this one: router, and whoever interrupts.
    router: Usage,
}

impl Fleet {
    /// As it was typed.
    pub(crate) fn of(args: &FleetArgs) -> Self {
        Self {
            robots: args.robots.clone(),
            time: args.seconds,
            every_s: args.every.as_secs_f64(),
            speed: args.speed,
            seed: args.seed,
        }
    }

    /// Measures one fleet after the other. What was measured until `interrupted` is reported.
    ///
    /// # Errors
    /// If a process cannot be started or ends, or a robot is not there in time.
    pub(crate) async fn run(
        &self,
        onlooker: &mut impl Onlooker,
        interrupted: impl Future<Output = ()>,
    ) -> Result<Report, Failure> {
        let mut interrupted = std::pin::pin!(interrupted);
        let (mut all, mut too_many) = (Vec::new(), Vec::new());
        for (place, robots) in self.robots.iter().enumerate() {
            let (done, of) = (place as u64, self.robots.len() as u64);
            let mut tell = |what: &str| onlooker.see(done, of, &format!("{robots} robots: {what}"));
            let mut hosts = Vec::new();
            let role = Role::Router { listen: Vec::new() };
            let router = session::open(&role, None).await.map_err(Failure::failed)?;
            let measured = tokio::select! {
                measured = self.measure(*robots, &router, &mut hosts, &mut tell) => Some(measured),
                () = &mut interrupted => None,
            };
            end(hosts).await;
            session::close(router).await;
            match measured {
                Some(Ok(measured)) => all.push(measured),
                // What was measured of smaller fleets counts all the same.
                Some(Err(failure)) if !all.is_empty() => {
                    too_many.push(format!("{robots} robots: {}.", failure.what));
                }
                Some(Err(failure)) => return Err(failure),
                None => break,
            }
        }
        let mut report = self.report(&all);
        report.remarks.append(&mut too_many);
        Ok(report)
    }

    async fn measure(
        &self,
        robots: u32,
        router: &Session,
        hosts: &mut Vec<Child>,
        mut progress: impl FnMut(&str),
    ) -> Result<Measured, Failure> {
        let begun = Instant::now();
        let endpoint = session::endpoints(router).await.into_iter().next();
        let endpoint = endpoint.ok_or_else(|| Failure::failed("the router listens nowhere"))?;
        progress("starting");
        let mut there = there(router).await?;
        for part in Part::ALL {
            hosts.push(self.host(part, robots, &endpoint)?);
        }
        let patience = PATIENCE * (1 + robots / 100);
        let all = robots as usize * MACHINES;
        let come = tokio::time::timeout(patience, async {
            let mut count = 0;
            while count < all {
                there.recv().await;
                count += 1;
                if count % MACHINES == 0 {
                    progress(&format!("starting, {count} of {all} machines are there"));
                }
            }
        });
        come.await.map_err(|_| {
            Failure::failed(format_args!(
                "not all of {robots} robots were there within {patience:?}"
            ))
        })?;
        let start = begun.elapsed();
        let place = Place::museum();
        let clock = Clock::of_world(router, &keys(0)?, PATIENCE).await;
        let clock = clock.map_err(Failure::failed)?;
        let site = place.site();
        let mut crowd = Crowd::new(router, clock, site, robots, self.every_s, self.seed).await?;
        crowd.set_out().await?;
        progress("setting out");
        let set_out = tokio::time::timeout(patience, async {
            while crowd.driving() < robots as usize / 2 {
                crowd.watch(Duration::from_millis(100)).await?;
            }
            crowd.watch(WARM_UP).await
        });
        set_out.await.map_err(|_| {
            Failure::failed(format_args!(
                "fewer than half of {robots} robots drive after {patience:?}"
            ))
        })??;
        progress("interrupting");
        let pids: Vec<u32> = hosts.iter().filter_map(Child::id).collect();
        let (before, router_before) = (taken(&pids), usage::of(std::process::id()));
        let begun = Instant::now();
        crowd.interrupt(self.time).await?;
        let time = begun.elapsed();
        let (machines, router_after) = (taken(&pids), usage::of(std::process::id()));
        progress("waiting for the last interruptions to end");
        let patience = Duration::from_secs_f64(LAST_INTERRUPTIONS_S / self.speed);
        crowd.settle(patience.max(PATIENCE)).await?;
        let since = |before: Usage, after: Usage| Usage {
            cpu: after.cpu.saturating_sub(before.cpu),
            ..after
        };
        Ok(Measured {
            robots,
            start,
            time,
            tally: crowd.tally.clone(),
            machines: since(before, machines),
            router: since(router_before, router_after),
        })
    }

    /// A process with the machines of one kind of all robots.
    fn host(&self, part: Part, robots: u32, endpoint: &str) -> Result<Child, Failure> {
        let name = part.name();
        let failed = |error| Failure::failed(format_args!("cannot start the {name}: {error}"));
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command
            .args(["role", "host", name, "--until-stdin-ends"])
            .args(["--robots", &robots.to_string()])
            .args(["--speed", &self.speed.to_string()])
            .args(["--connect", endpoint])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .kill_on_drop(true);
        // Ctrl-C in a terminal is for this process, which then ends the others in order.
        #[cfg(unix)]
        command.process_group(0);
        command.spawn().map_err(failed)
    }

    fn report(&self, all: &[Measured]) -> Report {
        let mut report = Report::new(
            "fleet",
            format!(
                "Robots tour the museum at {} times real time; each is interrupted every {} s on average, at random, by an \
                 emergency that leads it back to where its drive began. All parents are in one process, all children in \
                 another, all controllers and worlds in a third, the router and whoever interrupts in a fourth; without \
                 journals.",
                self.speed, self.every_s
            ),
        );
        let mut table = Table::new(
            "fleet",
            "Many robots",
            [
                "robots",
                "interruptions",
                "unended",
                "interruptions_per_s",
                "put_to_braking_p50_us",
                "put_to_braking_p99_us",
                "end_to_resumed_p50_us",
                "end_to_resumed_p99_us",
                "memory_per_robot_kib",
                "cpu_per_robot_percent",
                "router_memory_kib",
                "router_cpu_percent",
                "start_s",
            ],
        );
        let mut lines = [
            "put to braking, p50",
            "put to braking, p99",
            "end to resumed, p50",
            "end to resumed, p99",
        ]
        .map(|name| Line {
            name: name.to_owned(),
            points: Vec::new(),
        });
        for measured in all {
            let robots = f64::from(measured.robots);
            let percent = |cpu: Duration| cpu.as_secs_f64() / measured.time.as_secs_f64() * 100.0;
            let kib = |bytes: u64| bytes as f64 / 1024.0;
            let of = |interval: Interval| {
                let broken = measured.tally.broken.iter();
                Summary::of(broken.filter_map(|stamps: &Stamps| interval.of(stamps, self.speed)))
            };
            let (braking, resumed) = (of(Interval::PutToBraking), of(Interval::EndToResumed));
            let ended = measured.tally.put - measured.tally.open();
            let row: [Cell; 13] = [
                u64::from(measured.robots).into(),
                measured.tally.put.into(),
                measured.tally.open().into(),
                (ended as f64 / measured.time.as_secs_f64()).into(),
                braking.median.into(),
                braking.p99.into(),
                resumed.median.into(),
                resumed.p99.into(),
                (kib(measured.machines.memory_bytes) / robots).into(),
                (percent(measured.machines.cpu) / robots).into(),
                kib(measured.router.memory_bytes).into(),
                percent(measured.router.cpu).into(),
                measured.start.as_secs_f64().into(),
            ];
            table.push(row);
            let values = [braking.median, braking.p99, resumed.median, resumed.p99];
            for (line, value) in lines.iter_mut().zip(values) {
                line.points.push((robots, value));
            }
        }
        report.tables.push(table);
        report.charts.push(Chart {
            name: "fleet".to_owned(),
            title: "How fast robots stop and go on, by how many there are".to_owned(),
            across: "robots".to_owned(),
            rows: Vec::new(),
            up: "us".to_owned(),
            lines: lines.into(),
        });
        report
    }
}

/// All that these processes have taken.
fn taken(pids: &[u32]) -> Usage {
    let usages = pids.iter().map(|pid| usage::of(*pid));
    usages.fold(Usage::default(), |sum, one| Usage {
        cpu: sum.cpu + one.cpu,
        memory_bytes: sum.memory_bytes + one.memory_bytes,
    })
}

/// Something arrives for each machine that comes.
async fn there(router: &Session) -> Result<tokio::sync::mpsc::UnboundedReceiver<()>, Failure> {
    let (tell, there) = tokio::sync::mpsc::unbounded_channel();
    let subscriber = router
        .liveliness()
        .declare_subscriber("intermezzo/*/alive/**")
        .history(true)
        .callback(move |sample| {
            if sample.kind() == zenoh::sample::SampleKind::Put {
                let _ = tell.send(());
            }
        });
    // For as long as the session lives.
    subscriber.background().await.map_err(Failure::failed)?;
    Ok(there)
}

/// Ends processes, and returns when they have ended.
async fn end(hosts: Vec<Child>) {
    let mut ending = tokio::task::JoinSet::new();
    for mut host in hosts {
        drop(host.stdin.take());
        ending.spawn(async move {
            let ended = tokio::time::timeout(PATIENCE_AT_THE_END, host.wait()).await;
            if ended.is_err() {
                // By its number, which is its own until it has been waited for.
                let _ = host.kill().await;
            }
        });
    }
    ending.join_all().await;
}
