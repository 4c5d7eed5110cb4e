//! Runs a planner as a process with limits, and measures it.
//!
//! Between the benchmark and the planner stands one more process, this program again: what the
//! planner needed is what all children of that process needed, and limits set there bind it alone.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use nix::sys::resource::{Resource, UsageWho, getrusage, setrlimit};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use crate::instances::Instance;

/// The first argument that makes this program the process in between.
pub const RUNNER: &str = "--run-one";

/// A planner that is asked to stop after the time limit gets so much longer before it is ended.
const GRACE_S: f64 = 1.0;

/// What a planner may use.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub seconds: f64,
    /// In bytes.
    pub memory: u64,
}

/// How to call the planner.
#[derive(Debug)]
pub struct Planner(Vec<String>);

/// What one run took.
#[derive(Clone, Debug, Default)]
pub struct Usage {
    pub wall_s: f64,
    pub cpu_s: f64,
    /// Peak of resident memory.
    pub memory_mib: f64,
    /// `None` if it was ended by a signal.
    pub exit: Option<i32>,
    /// The last line that it wrote.
    pub last_words: String,
}

impl Planner {
    pub fn new(command: Option<&str>) -> Result<Self, String> {
        let words: Vec<String> = match command {
            Some(command) => command.split_whitespace().map(str::to_owned).collect(),
            None => {
                let here = std::env::current_exe().map_err(|error| error.to_string())?;
                let planner = here.with_file_name("intermezzo");
                if !planner.is_file() {
                    let planner = planner.display();
                    return Err(format!("{planner} is not built; or say --planner COMMAND"));
                }
                let path = planner.to_string_lossy().into_owned();
                vec![path, "plan".to_owned()]
            }
        };
        if words.is_empty() {
            return Err("--planner needs a command".to_owned());
        }
        let mut words = words;
        if !words.iter().any(|word| word.contains('{')) {
            let usual = "{domain} {problem} -o {out} --time-limit {limit}";
            words.extend(usual.split(' ').map(str::to_owned));
        }
        Ok(Self(words))
    }

    fn words(&self, instance: &Instance, plan: &Path, limits: &Limits) -> Vec<String> {
        let fill = |word: &String| {
            word.replace("{domain}", &instance.domain.to_string_lossy())
                .replace("{problem}", &instance.problem.to_string_lossy())
                .replace("{out}", &plan.to_string_lossy())
                .replace("{limit}", &limits.seconds.to_string())
        };
        self.0.iter().map(fill).collect()
    }

    /// Runs the planner on an instance.
    pub fn run(&self, instance: &Instance, plan: &Path, limits: &Limits) -> Result<Usage, String> {
        let here = std::env::current_exe().map_err(|error| error.to_string())?;
        let log = plan.with_extension("log");
        let output = Command::new(here)
            .arg(RUNNER)
            .arg(limits.seconds.to_string())
            .arg(limits.memory.to_string())
            .arg(&log)
            .args(self.words(instance, plan, limits))
            .output()
            .map_err(|error| error.to_string())?;
        let text = String::from_utf8_lossy(&output.stdout);
        let numbers: Vec<f64> = (text.split_whitespace())
            .filter_map(|word| word.parse().ok())
            .collect();
        let [wall_s, cpu_s, memory_mib, exit] = numbers[..] else {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        };
        let words = std::fs::read_to_string(&log).unwrap_or_default();
        let last_words = words.lines().rev().find(|line| !line.trim().is_empty());
        // If it stays behind, it is one small file in a temporary folder.
        let _ = std::fs::remove_file(&log);
        Ok(Usage {
            wall_s,
            cpu_s,
            memory_mib,
            exit: (exit >= 0.0).then_some(exit as i32),
            last_words: last_words.unwrap_or_default().trim().to_owned(),
        })
    }
}

/// The process in between: `SECONDS BYTES LOG COMMAND…`. Prints what the command needed.
pub fn run(arguments: &[String]) -> ExitCode {
    match measured(arguments) {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("cannot run it: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measured(arguments: &[String]) -> Result<String, Box<dyn std::error::Error>> {
    let [seconds, memory, log, program, rest @ ..] = arguments else {
        return Err("too few arguments".into());
    };
    let (seconds, memory): (f64, u64) = (seconds.parse()?, memory.parse()?);
    setrlimit(Resource::RLIMIT_AS, memory, memory)?;
    let log = File::create(PathBuf::from(log))?;
    let start = Instant::now();
    let child = Command::new(program)
        .args(rest)
        .stdin(Stdio::null())
        .stdout(log.try_clone()?)
        .stderr(log)
        .spawn()?;
    let exit = wait(child, Duration::from_secs_f64(seconds + GRACE_S))?;
    let wall_s = start.elapsed().as_secs_f64();
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN)?;
    let time = |time: nix::sys::time::TimeVal| time.tv_sec() as f64 + time.tv_usec() as f64 / 1e6;
    let cpu_s = time(usage.user_time()) + time(usage.system_time());
    let memory_mib = usage.max_rss() as f64 / 1024.0;
    Ok(format!("{wall_s} {cpu_s} {memory_mib} {exit}"))
}

/// Waits for a process, and ends it after a while. -1 if it did not end by itself.
fn wait(mut child: Child, longest: Duration) -> Result<i32, Box<dyn std::error::Error>> {
    let id = Pid::from_raw(i32::try_from(child.id())?);
    let (over, is_over) = mpsc::channel::<()>();
    let watchdog = std::thread::spawn(move || {
        if is_over.recv_timeout(longest) == Err(mpsc::RecvTimeoutError::Timeout) {
            // It may just have ended by itself.
            let _ = kill(id, Signal::SIGKILL);
        }
    });
    let status = child.wait()?;
    drop(over);
    // It panics nowhere.
    let _ = watchdog.join();
    Ok(status.code().unwrap_or(-1))
}
