//! A router and a world that nothing happens to, and a robot to which everything does.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use agent_link::session::{self, Role};
use agent_link::{Client, ClientError, Keys, Session};
use nix::errno::Errno;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::{Child, Command};

/// Nothing that is to come takes longer.
const PATIENCE: Duration = Duration::from_secs(60);
/// The roles of a robot, and what else `up` looks after if the world is not elsewhere.
const ROLES: [&str; 4] = ["parent", "child", "executor", "world"];

/// Where the world's process is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Reality {
    /// Nothing happens to it, as nothing happens to reality.
    Safe,
    /// It is one of the roles, and dies with them.
    Mortal,
}

/// Everything that runs.
pub struct Rig {
    pub session: Session,
    pub keys: Keys,
    pub client: Client,
    folder: TempDir,
    endpoint: String,
    place: PathBuf,
    speed: f64,
    /// The seed of what goes wrong with its actions.
    faults: u64,
    /// If it is not one of the roles.
    world: Option<Child>,
    up: Option<Child>,
    /// The processes of the roles, as `up` has told.
    pids: Arc<Mutex<Pids>>,
}

/// Processes that must not be left behind.
#[derive(Debug, Default)]
struct Pids {
    roles: BTreeMap<String, Pid>,
    /// All that there ever were.
    all: Vec<(String, Pid)>,
    /// What `up` has said.
    told: Vec<String>,
}

impl Pids {
    fn note(&mut self, role: &str, pid: &Value) {
        let pid = Pid::from_raw(pid.as_i64().unwrap().try_into().unwrap());
        self.roles.insert(role.to_owned(), pid);
        self.all.push((role.to_owned(), pid));
    }

    fn heard(&mut self, line: &str) {
        self.told.push(line.to_owned());
        let Ok(event) = serde_json::from_str::<Value>(line) else {
            return;
        };
        match event["event"].as_str() {
            Some("ready") => {
                for (role, pid) in event["processes"].as_object().unwrap() {
                    self.note(role, pid);
                }
            }
            Some("role_ready") => self.note(event["role"].as_str().unwrap(), &event["process"]),
            _ => {}
        }
    }
}

impl Rig {
    /// Starts router, world and robot; the museum with `persons` who can be greeted, each greeting a deed
    /// that is done once.
    pub async fn new(persons: usize, speed: f64, faults: u64, reality: Reality) -> Self {
        let folder = TempDir::new().unwrap();
        let place = folder.path().join("place");
        place_with(&place, persons);
        let listen = Role::Router { listen: Vec::new() };
        let session = session::open(&listen, None).await.unwrap();
        let endpoint = session::endpoints(&session).await.remove(0);
        let keys = Keys::new("robot").unwrap();
        let mut rig = Self {
            client: Client::new(&session, &keys),
            session,
            keys,
            folder,
            endpoint,
            place,
            speed,
            faults,
            world: None,
            up: None,
            pids: Arc::default(),
        };
        if reality == Reality::Safe {
            rig.world = Some(rig.start_world());
        }
        rig.start_up();
        rig
    }

    fn start_world(&self) -> Child {
        Command::new(env!("CARGO_BIN_EXE_intermezzo"))
            .args(["role", "world", "--until-stdin-ends"])
            .args(["--robot", "robot", "--connect", &self.endpoint])
            .args(["--speed", &self.speed.to_string(), "--place"])
            .arg(&self.place)
            .stdin(Stdio::piped())
            .kill_on_drop(true)
            .spawn()
            .unwrap()
    }

    /// The roles whose processes are killed.
    pub fn roles(&self) -> &'static [&'static str] {
        match self.world {
            Some(_) => &ROLES[..3],
            None => &ROLES,
        }
    }

    /// Starts `up`.
    pub fn start_up(&mut self) {
        let world: &[&str] = match self.world {
            Some(_) => &["--no-world"],
            None => &["--speed", &self.speed.to_string()],
        };
        let mut up = Command::new(env!("CARGO_BIN_EXE_intermezzo"))
            .args(["up", "--json", "--hang-limit", "2"])
            .args(["--faults", &self.faults.to_string()])
            .args(world)
            .args(["--robot", "robot", "--connect", &self.endpoint, "--state"])
            .arg(self.folder.path().join("state"))
            .arg(&self.place)
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env_remove("RUST_LOG")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .kill_on_drop(true)
            .spawn()
            .unwrap();
        let said = up.stdout.take().unwrap();
        let pids = self.pids.clone();
        tokio::spawn(async move {
            let mut lines = BufReader::new(said).lines();
            while let Ok(Some(line)) = lines.next_line().await {
                // What the agents tell is heard by the observer.
                if line.contains("\"intermezzo\"") {
                    pids.lock().unwrap().heard(&line);
                }
            }
        });
        let complained = up.stderr.take().unwrap();
        let pids = self.pids.clone();
        tokio::spawn(async move {
            let mut lines = BufReader::new(complained).lines();
            while let Ok(Some(line)) = lines.next_line().await {
                pids.lock().unwrap().told.push(line);
            }
        });
        self.up = Some(up);
    }

    /// The last things that `up` has said of the processes.
    pub fn told(&self) -> String {
        let pids = self.pids.lock().unwrap();
        let from = pids.told.len().saturating_sub(40);
        pids.told[from..].join("\n")
    }

    /// Sends a signal to a role or to `up`; `false` if it has no process at the moment.
    pub fn signal(&self, whom: &str, signal: Signal) -> bool {
        if whom == "up" {
            let pid = self.up.as_ref().and_then(Child::id);
            return pid
                .is_some_and(|pid| kill(Pid::from_raw(pid.try_into().unwrap()), signal).is_ok());
        }
        let pid = self.pids.lock().unwrap().roles.get(whom).copied();
        pid.is_some_and(|pid| is_role(whom, pid) && kill(pid, signal).is_ok())
    }

    /// Whether `up` has ended; then it is gone for good.
    pub async fn up_has_ended(&mut self) {
        if let Some(mut up) = self.up.take() {
            let ended = tokio::time::timeout(PATIENCE, up.wait()).await;
            ended
                .unwrap_or_else(|_| panic!("`up` does not end"))
                .unwrap();
        }
    }

    /// The world's own books, as far back as they go.
    pub async fn done(&self) -> Vec<Value> {
        let begun = tokio::time::Instant::now();
        loop {
            match self.client.look("world", agent_link::View::Belief).await {
                Ok(belief) => return belief["done"].as_array().unwrap().clone(),
                // It is just being started again.
                Err(ClientError::NoAnswer { .. }) if begun.elapsed() < PATIENCE => {}
                Err(error) => panic!("the world does not say what was done to it: {error}"),
            }
        }
    }

    /// Ends `up` in order, and waits until nothing is left of the robot.
    pub async fn end(mut self) {
        self.signal("up", Signal::SIGINT);
        self.up_has_ended().await;
        let all = std::mem::take(&mut self.pids.lock().unwrap().all);
        let gone = async {
            while all.iter().any(|(role, pid)| is_role(role, *pid)) {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
        };
        let gone = tokio::time::timeout(PATIENCE, gone).await;
        assert!(gone.is_ok(), "processes are left: {all:?}");
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        // Which would start others in their place. A process that is stopped would not see that it is
        // gone.
        self.signal("up", Signal::SIGKILL);
        for (role, pid) in &self.pids.lock().unwrap().all {
            if is_role(role, *pid) {
                let _ = kill(*pid, Signal::SIGKILL);
            }
        }
    }
}

/// Whether that process is still a role of that name: numbers are used again.
fn is_role(role: &str, pid: Pid) -> bool {
    if kill(pid, None) == Err(Errno::ESRCH) {
        return false;
    }
    let line = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    let words: Vec<&[u8]> = line.split(|byte| *byte == 0).collect();
    words
        .windows(2)
        .any(|two| two == [b"role", role.as_bytes()])
}

/// A copy of the museum in which people are greeted by deeds that the world counts.
fn place_with(folder: &Path, persons: usize) {
    let museum = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../maps/museum"));
    std::fs::create_dir(folder).unwrap();
    for file in std::fs::read_dir(museum).unwrap() {
        let file = file.unwrap();
        let text = std::fs::read_to_string(file.path()).unwrap();
        let people: String = (0..persons).map(|number| format!(" p{number}")).collect();
        let text = text
            .replace(
                "visitor guest attendant - person",
                &format!("visitor guest attendant{people} - person"),
            )
            .replace("perform = \"(speak 2)\"", "perform = \"(deed greet ?p)\"");
        std::fs::write(folder.join(file.file_name()), text).unwrap();
    }
}
