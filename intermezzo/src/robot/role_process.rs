//! One role as a process.

use std::fmt;
use std::process::Stdio;
use std::time::Duration;

use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::{Child, ChildStdin, Command};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use super::Setup;
use crate::exit::Failure;

/// A role that has been told to end may take this long to say good-bye.
const PATIENCE: Duration = Duration::from_secs(5);

/// The roles of a robot.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum RoleKind {
    /// Doors, body, clock.
    World,
    /// The robot's controller.
    Executor,
    /// The node level.
    Child,
    /// The area level.
    Parent,
}

impl RoleKind {
    /// All of them, from below.
    pub const ALL: [Self; 4] = [Self::World, Self::Executor, Self::Child, Self::Parent];

    /// Its name, as in the keys.
    pub fn name(self) -> &'static str {
        match self {
            Self::World => executor_sim::program::WORLD,
            Self::Executor => executor_sim::program::EXECUTOR,
            Self::Child => child_agent::NAME,
            Self::Parent => parent_agent::NAME,
        }
    }
}

impl fmt::Display for RoleKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a role's process does beside its role.
#[derive(Clone, Debug)]
pub enum RoleNews {
    /// A line on its standard error.
    Said(RoleKind, String),
    /// It has ended, in words how.
    Ended(RoleKind, String),
}

/// A role's process. It ends when this is dropped, and when this process dies: the process sees
/// the end of its standard input.
#[derive(Debug)]
pub(super) struct RoleProcess {
    pub(super) kind: RoleKind,
    pub(super) pid: u32,
    stdin: Option<ChildStdin>,
    /// Tells the watching task that the end is wanted.
    ending: Option<oneshot::Sender<()>>,
    watching: JoinHandle<()>,
}

impl RoleProcess {
    pub(super) fn start(
        kind: RoleKind,
        setup: &Setup,
        endpoints: &[String],
        news: &mpsc::UnboundedSender<RoleNews>,
    ) -> Result<Self, Failure> {
        let failed = |error| Failure::failed(format_args!("cannot start the {kind}: {error}"));
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command
            .args(["role", kind.name(), "--until-stdin-ends"])
            .args(["--robot", &setup.robot, "--start", &setup.start]);
        for endpoint in endpoints {
            command.args(["--connect", endpoint]);
        }
        if let Some(place) = &setup.place {
            command.arg("--place").arg(place);
        }
        if let Some(file) = &setup.zenoh_config {
            command.arg("--zenoh-config").arg(file);
        }
        match kind {
            RoleKind::World => {
                command.args(["--speed", &setup.speed.to_string()]);
            }
            RoleKind::Executor => {
                if let Some(seed) = setup.faults {
                    command.args(["--faults", &seed.to_string()]);
                }
            }
            RoleKind::Child | RoleKind::Parent => {
                command.args(setup.planner.to_args());
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
        let (ending, wanted) = oneshot::channel();
        Ok(Self {
            kind,
            // A process that has just been started has not been waited for.
            pid: child.id().unwrap_or_default(),
            stdin: child.stdin.take(),
            ending: Some(ending),
            watching: tokio::spawn(watch(kind, child, news.clone(), wanted)),
        })
    }

    /// Tells it to end.
    fn tell_to_end(&mut self) {
        self.stdin = None;
        if let Some(ending) = self.ending.take() {
            // If nobody listens any more, it has ended.
            let _ = ending.send(());
        }
    }
}

/// Passes on what a process says, until it ends.
async fn watch(
    kind: RoleKind,
    mut child: Child,
    news: mpsc::UnboundedSender<RoleNews>,
    wanted: oneshot::Receiver<()>,
) {
    let stderr = child.stderr.take();
    let saying = async {
        let Some(stderr) = stderr else { return };
        let mut lines = BufReader::new(stderr).lines();
        while let Ok(Some(line)) = lines.next_line().await {
            let _ = news.send(RoleNews::Said(kind, line));
        }
    };
    let ended = async {
        let patience = async {
            // The sender is dropped with the process's owner, which wants the end just as well.
            let _ = wanted.await;
            tokio::time::sleep(PATIENCE).await;
        };
        tokio::select! {
            status = child.wait() => match status {
                Ok(status) => status.to_string(),
                Err(error) => format!("lost sight of it: {error}"),
            },
            () = patience => {
                let _ = child.kill().await;
                format!("killed, since it did not end within {PATIENCE:?}")
            }
        }
    };
    // Its last words come before the news of its end.
    let ((), how) = tokio::join!(saying, ended);
    let _ = news.send(RoleNews::Ended(kind, how));
}

/// Ends all of them, and returns when they have ended.
pub(super) async fn end_all(mut roles: Vec<RoleProcess>) {
    for role in &mut roles {
        role.tell_to_end();
    }
    for role in roles {
        // The task does not panic; if it was cancelled, the runtime is going down.
        let _ = role.watching.await;
    }
}
