//! One role as a process.

use std::fmt;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use agent_core::model::Symbol;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::{Child, ChildStdin, Command};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

use super::Setup;
use super::back_off::End;
use crate::exit::Failure;

/// A role that has been told to end may take this long: it stops what moves, writes its journal, and
/// says good-bye.
const PATIENCE: Duration = Duration::from_secs(10);

/// A role of a robot, or of a restaurant.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum RoleKind {
    /// Doors, body, clock.
    World,
    /// The robot's controller.
    Executor,
    /// The node level.
    Child,
    /// The area level.
    Parent,
    /// The room that all vehicles of a restaurant are in, and its clock.
    Room,
    /// A vehicle of a restaurant.
    Vehicle(Symbol),
}

impl RoleKind {
    /// Those of a robot, from below.
    pub const ALL: [Self; 4] = [Self::World, Self::Executor, Self::Child, Self::Parent];

    /// Its name, as in the keys.
    pub fn name(&self) -> &str {
        match self {
            Self::World => executor_sim::program::WORLD,
            Self::Executor => executor_sim::program::EXECUTOR,
            Self::Child => child_agent::NAME,
            Self::Parent => parent_agent::NAME,
            Self::Room => executor_sim::ROOM,
            Self::Vehicle(name) => name.as_str(),
        }
    }

    /// As people speak of it: vehicles have names of their own.
    pub fn in_words(&self) -> String {
        match self {
            Self::Vehicle(name) => name.to_string(),
            role => format!("the {role}"),
        }
    }

    /// Whether it is reality, and has the clock: it begins first, and ends last.
    pub fn is_reality(&self) -> bool {
        matches!(self, Self::World | Self::Room)
    }

    /// What `intermezzo role` calls it.
    fn word(&self) -> &str {
        match self {
            Self::Vehicle(_) => "vehicle",
            role => role.name(),
        }
    }
}

impl fmt::Display for RoleKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a process does beside its role.
#[derive(Clone, Debug)]
pub(super) enum ProcessNews {
    /// A line on its standard error.
    Said(RoleKind, String),
    /// It has ended: how, and in words.
    Ended(RoleKind, End, String),
}

/// What a process is told.
#[derive(Clone, Copy, Debug)]
enum Order {
    /// To end; it is killed if it does not within [`PATIENCE`].
    End,
    /// It is killed.
    Kill,
}

/// A role's process. It ends when this is dropped, and when this process dies: the process sees
/// the end of its standard input.
#[derive(Debug)]
pub(super) struct RoleProcess {
    pub(super) pid: u32,
    stdin: Option<ChildStdin>,
    orders: mpsc::UnboundedSender<Order>,
    watching: JoinHandle<()>,
}

impl RoleProcess {
    pub(super) fn start(
        kind: &RoleKind,
        setup: &Setup,
        state: &Path,
        endpoints: &[String],
        news: &mpsc::UnboundedSender<ProcessNews>,
    ) -> Result<Self, Failure> {
        let failed = |error| Failure::failed(format_args!("cannot start the {kind}: {error}"));
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command
            .args(["role", kind.word(), "--until-stdin-ends"])
            .args(["--robot", &setup.robot]);
        command.arg("--state").arg(state);
        for endpoint in endpoints {
            command.args(["--connect", endpoint]);
        }
        if let Some(place) = &setup.place {
            command.arg("--place").arg(place);
        }
        if let Some(file) = setup.zenoh_config_of(kind.name()) {
            command.arg("--zenoh-config").arg(file);
        }
        if !matches!(kind, RoleKind::Room | RoleKind::Vehicle(_)) {
            command.args(["--start", &setup.start]);
        }
        match kind {
            RoleKind::World => {
                command.args(["--speed", &setup.speed.to_string()]);
            }
            RoleKind::Room => {
                command.args(["--speed", &setup.speed.to_string()]);
                if let Some(seed) = setup.faults {
                    command.args(["--faults", &seed.to_string()]);
                }
            }
            RoleKind::Vehicle(name) => {
                command.args(["--name", name.as_str()]);
                command.args(setup.planner.to_args());
                command.args(setup.limits.to_args());
                if let Some(together) = setup.together {
                    command.args(["--together", &together.to_string()]);
                }
            }
            RoleKind::Executor => {
                if let Some(seed) = setup.faults {
                    command.args(["--faults", &seed.to_string()]);
                }
            }
            RoleKind::Child => {
                command.args(setup.planner.to_args());
            }
            RoleKind::Parent => {
                command.args(setup.planner.to_args());
                command.args(setup.limits.to_args());
            }
        }
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .kill_on_drop(true);
        // Ctrl-C in a terminal goes to a whole group of processes. It is for this one, which then
        // ends the others in order.
        #[cfg(unix)]
        command.process_group(0);
        let mut child = command.spawn().map_err(failed)?;
        let (orders, ordered) = mpsc::unbounded_channel();
        Ok(Self {
            // A process that has just been started has not been waited for.
            pid: child.id().unwrap_or_default(),
            stdin: child.stdin.take(),
            orders,
            watching: tokio::spawn(watch(kind.clone(), child, news.clone(), ordered)),
        })
    }

    /// Tells it to end. Its end is told as news.
    pub(super) fn tell_to_end(&mut self) {
        self.stdin = None;
        // If nobody listens any more, it has ended.
        let _ = self.orders.send(Order::End);
    }

    /// Kills it, since it does not answer. Its end is told as news.
    pub(super) fn kill(&self) {
        let _ = self.orders.send(Order::Kill);
    }

    /// Returns when it has ended.
    pub(super) async fn ended(self) {
        // The task does not panic; if it was cancelled, the runtime is going down.
        let _ = self.watching.await;
    }
}

/// Passes on what a process says, until it ends.
async fn watch(
    kind: RoleKind,
    mut child: Child,
    news: mpsc::UnboundedSender<ProcessNews>,
    orders: mpsc::UnboundedReceiver<Order>,
) {
    let stderr = child.stderr.take();
    let saying = async {
        let Some(stderr) = stderr else { return };
        let mut lines = BufReader::new(stderr).lines();
        while let Ok(Some(line)) = lines.next_line().await {
            let _ = news.send(ProcessNews::Said(kind.clone(), line));
        }
    };
    let ended = async {
        let status = tokio::select! {
            status = child.wait() => Some(status),
            () = until_it_is_to_be_killed(orders) => None,
        };
        let (status, killed) = match status {
            Some(status) => (status, false),
            None => {
                // By its id, which is its own as long as it has not been waited for.
                let _ = child.start_kill();
                (child.wait().await, true)
            }
        };
        match status {
            Ok(_) if killed => (End::Killed, "killed, since it did not answer".to_owned()),
            Ok(status) if status.code().is_some() => (End::Own, status.to_string()),
            Ok(status) => (End::Killed, status.to_string()),
            Err(error) => (End::Killed, format!("lost sight of it: {error}")),
        }
    };
    // Its last words come before the news of its end.
    let ((), (end, how)) = tokio::join!(saying, ended);
    let _ = news.send(ProcessNews::Ended(kind, end, how));
}

async fn until_it_is_to_be_killed(mut orders: mpsc::UnboundedReceiver<Order>) {
    match orders.recv().await {
        Some(Order::Kill) => {}
        // The sender is dropped with the process's owner, which wants the end just as well.
        Some(Order::End) | None => {
            let killed = async {
                while let Some(order) = orders.recv().await {
                    if matches!(order, Order::Kill) {
                        return;
                    }
                }
                std::future::pending().await
            };
            let _ = tokio::time::timeout(PATIENCE, killed).await;
        }
    }
}
