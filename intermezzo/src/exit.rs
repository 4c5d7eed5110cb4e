//! How the command ends: exit status and words.

use std::fmt;
use std::process::ExitCode;

/// The exit statuses, as `--help` documents them.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Exit {
    /// All went as it should.
    Done = 0,
    /// A goal or a robot did not, or a file was found to have faults.
    Failed = 1,
    /// The command cannot be carried out as it was typed.
    BadInput = 2,
    /// No robot, or none that answers.
    NobodyThere = 3,
    /// It is proved that the problem has no plan.
    Unsolvable = 4,
    /// No plan was found, and nobody knows whether there is one.
    Unknown = 5,
    /// It was ended by Ctrl-C before it was done; what shells say of a program that SIGINT has ended.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a command could not be carried out.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Failure {
    /// The status to exit with.
    pub exit: Exit,
    /// What is wrong, and where.
    pub what: String,
    /// What to do about it.
    pub advice: Option<String>,
}

impl Failure {
    /// Something went otherwise than it should.
    pub fn failed(what: impl fmt::Display) -> Self {
        Self::new(Exit::Failed, what)
    }

    /// What was typed makes no sense.
    pub fn bad_input(what: impl fmt::Display) -> Self {
        Self::new(Exit::BadInput, what)
    }

    /// Nobody answers.
    pub fn nobody_there(what: impl fmt::Display) -> Self {
        Self::new(Exit::NobodyThere, what)
    }

    fn new(exit: Exit, what: impl fmt::Display) -> Self {
        Self {
            exit,
            what: without_source_places(&what.to_string()),
            advice: None,
        }
    }

    /// The same, with what to do about it.
    #[must_use]
    pub fn advice(mut self, advice: impl fmt::Display) -> Self {
        self.advice = Some(advice.to_string());
        self
    }
}

/// zenoh says where in its source an error arose, which is of no use to who typed a command:
/// `… Timeout! at /…/orchestrator.rs:388.`
fn without_source_places(text: &str) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(" at /") {
        let (before, after) = rest.split_at(start);
        kept.push_str(before);
        rest = match after.find(".rs:") {
            Some(end) if !after[5..end].contains(' ') => {
                after[end + 4..].trim_start_matches(|c: char| c.is_ascii_digit() || c == '.')
            }
            // A path of the user's.
            _ => {
                kept.push_str(&after[..5]);
                &after[5..]
            }
        };
    }
    kept.push_str(rest);
    kept
}

impl Failure {
    /// On the standard error, in colour if that is a terminal.
    pub fn print(&self) {
        use crate::style::{ADVICE, BAD};
        anstream::eprintln!("{BAD}error:{BAD:#} {}", self.what);
        if let Some(advice) = &self.advice {
            anstream::eprintln!("{ADVICE}  try:{ADVICE:#} {advice}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_s_source_is_nobody_s_business() {
        let failure = Failure::failed("no: Timeout! at /home/x/zenoh-1.0/src/a.rs:388. Go");
        assert_eq!(failure.what, "no: Timeout! Go");
        let failure = Failure::failed("look at /home/x/map.geojson: it is gone");
        assert_eq!(failure.what, "look at /home/x/map.geojson: it is gone");
    }
}
