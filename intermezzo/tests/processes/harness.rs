//! Running the command, and reading what it says.

use std::collections::{BTreeMap, BTreeSet};
use std::process::{ExitStatus, Stdio};
use std::time::Duration;

use nix::errno::Errno;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, BufReader, Lines};
use tokio::process::{Child, ChildStdout, Command};
use tokio::sync::{Semaphore, SemaphorePermit};
use tokio::time::timeout;

/// Nothing takes longer, even on a machine that is busy with other tests.
pub const PATIENCE: Duration = Duration::from_secs(90);

/// Four processes at fifty times their usual speed are a load: no more robots at a time than this,
/// lest each of them is late for what the others wait for.
static USERS: Semaphore = Semaphore::const_new(2);

/// A user with a directory of their own, for what runs and for what is temporary: robots of other tests are
/// not seen.
pub struct User {
    runtime: TempDir,
    _turn: SemaphorePermit<'static>,
}

/// What a command has said, and how it ended.
#[derive(Debug)]
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl User {
    /// Waits for its turn.
    pub async fn new() -> Self {
        Self {
            runtime: TempDir::new().unwrap(),
            _turn: USERS.acquire().await.unwrap(),
        }
    }

    pub fn path(&self) -> &std::path::Path {
        self.runtime.path()
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_intermezzo"));
        command
            .args(args)
            .env("XDG_RUNTIME_DIR", self.runtime.path())
            // What a killed one leaves behind goes with the user.
            .env("TMPDIR", self.runtime.path())
            .env_remove("RUST_LOG")
            .env_remove("INTERMEZZO_ROBOT")
            .stdin(Stdio::null())
            .kill_on_drop(true);
        command
    }

    /// Runs a command to its end.
    pub async fn run(&self, args: &[&str]) -> Said {
        let output = timeout(PATIENCE, self.command(args).output()).await;
        let output = output
            .unwrap_or_else(|_| panic!("{args:?} does not end"))
            .unwrap();
        Said {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Starts a command.
    pub fn start(&self, args: &[&str]) -> Child {
        let mut command = self.command(args);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().unwrap()
    }

    /// Runs a command that is to succeed.
    pub async fn ok(&self, args: &[&str]) -> Said {
        let said = self.run(args).await;
        assert_eq!(said.code, Some(0), "{args:?}: {said:?}");
        said
    }

    /// Starts a robot, and returns when it is ready.
    pub async fn up(&self, args: &[&str]) -> Up {
        let all: Vec<&str> = ["up", "--json", "--speed", "50"]
            .into_iter()
            .chain(args.iter().copied())
            .collect();
        self.story(&all).await
    }

    /// Starts a command that tells events, and returns when its robot is ready.
    pub async fn story(&self, args: &[&str]) -> Up {
        let mut child = self.command(args).stdout(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut up = Up {
            child,
            lines,
            story: Vec::new(),
            processes: BTreeMap::new(),
            all_processes: BTreeSet::new(),
            endpoint: String::new(),
        };
        let ready = up.until("ready", |event| event["event"] == "ready").await;
        up.endpoint = ready["endpoint"].as_str().unwrap().to_owned();
        for (role, process) in ready["processes"].as_object().unwrap() {
            up.runs(role, process);
        }
        up
    }
}

/// A command that tells events.
pub struct Up {
    pub child: Child,
    lines: Lines<BufReader<ChildStdout>>,
    /// All that was told so far.
    pub story: Vec<Value>,
    /// Of the roles, as they are now, by name.
    pub processes: BTreeMap<String, Pid>,
    /// Of all roles that there ever were.
    all_processes: BTreeSet<Pid>,
    pub endpoint: String,
}

impl Up {
    /// The next line; `None` at the end.
    pub async fn next(&mut self) -> Option<Value> {
        let line = timeout(PATIENCE, self.lines.next_line()).await;
        let line = line.unwrap_or_else(|_| panic!("nothing more is told:\n{}", self.told()));
        let event: Value = serde_json::from_str(&line.unwrap()?).unwrap();
        if event["event"] == "role_ready" {
            self.runs(event["role"].as_str().unwrap(), &event["process"]);
        }
        self.story.push(event.clone());
        Some(event)
    }

    /// Reads on until there is such an event.
    pub async fn until(&mut self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        loop {
            match self.next().await {
                Some(event) if wanted(&event) => return event,
                Some(_) => {}
                None => panic!("it ended before {what}:\n{}", self.told()),
            }
        }
    }

    /// A role has this process from now on.
    fn runs(&mut self, role: &str, process: &Value) {
        let process = Pid::from_raw(process.as_i64().unwrap().try_into().unwrap());
        self.processes.insert(role.to_owned(), process);
        self.all_processes.insert(process);
    }

    /// Sends a signal to the process of a role.
    pub fn signal(&self, role: &str, signal: Signal) {
        kill(self.processes[role], signal).unwrap();
    }

    /// Reads on until the supervisor tells that of a role.
    pub async fn until_role(&mut self, role: &str, event: &str) -> Value {
        self.until(&format!("{event} of the {role}"), |told| {
            told["agent"] == "intermezzo" && told["role"] == role && told["event"] == event
        })
        .await
    }

    /// Reads on until the parent tells that of a goal.
    pub async fn until_goal(&mut self, goal: &str, event: &str) -> Value {
        let what = format!("{event} of {goal}");
        self.until(&what, |told| {
            told["agent"] == "parent" && told["goal"] == goal && told["event"] == event
        })
        .await
    }

    /// Reads on until the robot has begun to do something that contains these words.
    pub async fn until_doing(&mut self, words: &str) -> Value {
        self.until(words, |told| {
            told["agent"] == "executor"
                && told["event"] == "action_started"
                && told["action"].as_str().unwrap().contains(words)
        })
        .await
    }

    /// Reads to the end.
    pub async fn read_to_the_end(&mut self) -> ExitStatus {
        while self.next().await.is_some() {}
        let status = timeout(PATIENCE, self.child.wait()).await;
        status
            .unwrap_or_else(|_| panic!("it does not end"))
            .unwrap()
    }

    /// The same, after a signal.
    pub async fn end_by(&mut self, signal: Signal) -> ExitStatus {
        let pid = self.child.id().unwrap();
        kill(Pid::from_raw(pid.try_into().unwrap()), signal).unwrap();
        self.read_to_the_end().await
    }

    /// The events that the parent told of a goal, in order.
    pub fn of_goal(&self, goal: &str) -> Vec<&str> {
        self.story
            .iter()
            .filter(|told| told["agent"] == "parent" && told["goal"] == goal)
            .map(|told| told["event"].as_str().unwrap())
            .filter(|event| event.starts_with("goal_"))
            .collect()
    }

    /// Waits until no role's process is left.
    pub async fn assert_nobody_is_left(&self) {
        let gone = async {
            while self
                .all_processes
                .iter()
                .any(|pid| kill(*pid, None) != Err(Errno::ESRCH))
            {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
        };
        let gone = timeout(Duration::from_secs(20), gone).await;
        assert!(gone.is_ok(), "some of {:?} are left", self.all_processes);
    }

    fn told(&self) -> String {
        let lines: Vec<String> = self.story.iter().map(ToString::to_string).collect();
        lines.join("\n")
    }
}
