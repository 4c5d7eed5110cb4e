//! What users ask for, and what they are told.

use agent_core::language::parse_tasks;
use agent_core::model::{Task, Time};
use agent_core::protocol::{Command, GoalId, GoalRequest, Rejection, Urgency};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{USER_LIMIT_BYTES, VERSION, WireError, from_value, text};

/// Ids are shown in every event about a goal; longer ones are mistakes.
const MAX_ID_LENGTH: usize = 64;

/// A goal in its long form. An unknown field is an error: who writes `prioritiy` means something.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct GoalMessage {
    #[serde(default = "version")]
    v: u32,
    /// `"(go n4)"`, or several to be done in this order: `"(and (go n4) (wait))"`.
    task: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    id: Option<String>,
    #[serde(default)]
    priority: i32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    deadline_s: Option<f64>,
}

fn version() -> u32 {
    VERSION
}

/// A goal as people type it: `(go n4)`, or
/// `{"task":"(go n4)","priority":1,"id":"fetch","deadline_s":30}`.
pub fn goal_from_user(urgency: Urgency, bytes: &[u8]) -> Result<GoalRequest, WireError> {
    let text = text("goal", bytes, USER_LIMIT_BYTES)?;
    let message = if text.starts_with(['{', '"']) {
        let value: Value =
            serde_json::from_str(text).map_err(|error| WireError::malformed("goal", error))?;
        match value {
            Value::String(task) => plain(task),
            value => from_value("goal", value)?,
        }
    } else {
        plain(text.to_owned())
    };
    let tasks = parse_tasks(&message.task).map_err(|error| WireError::malformed("goal", error))?;
    Ok(GoalRequest {
        id: message.id.map(goal_id).transpose()?,
        tasks,
        urgency,
        priority: message.priority,
        deadline: message.deadline_s.map(deadline).transpose()?,
    })
}

fn plain(task: String) -> GoalMessage {
    GoalMessage {
        v: VERSION,
        task,
        id: None,
        priority: 0,
        deadline_s: None,
    }
}

fn goal_id(id: String) -> Result<GoalId, WireError> {
    let fits = !id.is_empty() && id.len() <= MAX_ID_LENGTH && !id.contains(char::is_whitespace);
    if fits && !id.contains(char::is_control) {
        Ok(id.into())
    } else {
        Err(WireError::malformed(
            "goal",
            format_args!("an id is one word of at most {MAX_ID_LENGTH} bytes"),
        ))
    }
}

fn deadline(seconds: f64) -> Result<Time, WireError> {
    if seconds > 0.0 {
        Ok(Time::from_secs(seconds))
    } else {
        Err(WireError::malformed(
            "goal",
            format_args!("deadline_s is {seconds}, but must be more than nothing"),
        ))
    }
}

/// As [`parse_tasks`] reads them.
fn tasks_as_text(tasks: &[Task]) -> String {
    match tasks {
        [task] => task.to_string(),
        _ => {
            let tasks: Vec<String> = tasks.iter().map(ToString::to_string).collect();
            format!("(and {})", tasks.join(" "))
        }
    }
}

/// A goal as [`goal_from_user`] reads it, for programs that send one.
pub fn goal_to_wire(goal: &GoalRequest) -> Result<String, WireError> {
    super::write(&GoalMessage {
        v: VERSION,
        task: tasks_as_text(&goal.tasks),
        id: goal.id.as_ref().map(ToString::to_string),
        priority: goal.priority,
        deadline_s: goal.deadline.map(Time::secs),
    })
}

/// What became of a goal that was asked for.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    v: u32,
    /// The goal's name, if it has one.
    pub id: Option<String>,
    /// Whether the agent will see to it.
    pub accepted: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// What was asked, as far as it was understood.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<String>,
    /// Who says so, if it is one of a team: whoever wants to know how the goal goes on listens to that
    /// one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
}

impl Verdict {
    /// What the agent said to a goal.
    pub fn on(goal: &GoalRequest, result: &Result<GoalId, Rejection>) -> Self {
        let (id, reason) = match result {
            Ok(id) => (Some(id), None),
            Err(rejection) => (goal.id.as_ref(), Some(rejection.to_string())),
        };
        Self {
            v: VERSION,
            id: id.map(ToString::to_string),
            accepted: result.is_ok(),
            reason,
            task: Some(tasks_as_text(&goal.tasks)),
            by: None,
        }
    }

    /// The agent never saw it, for this reason.
    pub fn refused(goal: &GoalRequest, reason: String) -> Self {
        Self {
            v: VERSION,
            id: goal.id.as_ref().map(ToString::to_string),
            accepted: false,
            reason: Some(reason),
            task: Some(tasks_as_text(&goal.tasks)),
            by: None,
        }
    }

    /// The same, said by one of a team.
    pub fn said_by(self, name: &str) -> Self {
        let by = Some(name.to_owned());
        Self { by, ..self }
    }

    /// It could not be read.
    pub fn unreadable(error: &WireError) -> Self {
        Self {
            v: VERSION,
            id: None,
            accepted: false,
            reason: Some(error.to_string()),
            task: None,
            by: None,
        }
    }
}

/// A command in its long form: `{"command":"suspend","goal":"fetch"}`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CommandMessage {
    #[serde(default = "version")]
    v: u32,
    command: CommandWord,
    goal: String,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum CommandWord {
    Suspend,
    Resume,
    Cancel,
}

/// A command as people type it: `suspend fetch`, or `{"command":"suspend","goal":"fetch"}`.
pub fn command_from_user(bytes: &[u8]) -> Result<Command, WireError> {
    const WHAT: &str = "command";
    let text = text(WHAT, bytes, USER_LIMIT_BYTES)?;
    let value = if text.starts_with('{') {
        serde_json::from_str(text).map_err(|error| WireError::malformed(WHAT, error))?
    } else {
        match *text.split_whitespace().collect::<Vec<_>>() {
            [command, goal] => serde_json::json!({ "command": command, "goal": goal }),
            _ => {
                return Err(WireError::malformed(
                    WHAT,
                    "expected `suspend`, `resume` or `cancel`, then the goal's name",
                ));
            }
        }
    };
    let message: CommandMessage = from_value(WHAT, value)?;
    let goal = goal_id(message.goal)?;
    Ok(match message.command {
        CommandWord::Suspend => Command::Suspend(goal),
        CommandWord::Resume => Command::Resume(goal),
        CommandWord::Cancel => Command::Cancel(goal),
    })
}

/// A command as [`command_from_user`] reads it, for programs that send one.
pub fn command_to_wire(command: &Command) -> Result<String, WireError> {
    let (command, goal) = match command {
        Command::Suspend(goal) => (CommandWord::Suspend, goal),
        Command::Resume(goal) => (CommandWord::Resume, goal),
        Command::Cancel(goal) => (CommandWord::Cancel, goal),
    };
    super::write(&CommandMessage {
        v: VERSION,
        command,
        goal: goal.to_string(),
    })
}

/// What became of a command.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct CommandVerdict {
    v: u32,
    /// Whether it will be followed.
    pub accepted: bool,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl CommandVerdict {
    /// Accepted, or not, for this reason.
    pub fn new<E: std::fmt::Display>(result: &Result<(), E>) -> Self {
        Self {
            v: VERSION,
            accepted: result.is_ok(),
            reason: result.as_ref().err().map(ToString::to_string),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent_core::model::Atom;

    fn read(text: &str) -> Result<GoalRequest, String> {
        goal_from_user(Urgency::Normal, text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_goal_is_a_task_or_an_object_with_more_to_say() {
        let goal = read(" (go n4)\n").unwrap();
        assert_eq!(goal.tasks, [Atom::new("go", ["n4"])]);
        assert_eq!(read("\"(go n4)\"").unwrap(), goal);
        let goal =
            read(r#"{"task":"(and (go n4) (wait))","priority":-1,"id":"fetch","deadline_s":1.5}"#)
                .unwrap();
        assert_eq!(goal.tasks.len(), 2);
        assert_eq!(goal.priority, -1);
        assert_eq!(goal.id, Some("fetch".into()));
        assert_eq!(goal.deadline, Some(Time(1_500_000)));
    }

    #[test]
    fn what_is_wrong_with_a_goal_is_said_in_words() {
        for (text, words) in [
            (r#"{"task":"(go n4)""#, "EOF"),
            (r#"{"task":"(go n4)","prioritiy":1}"#, "prioritiy"),
            (r#"{"task":"(go n4)","v":9}"#, "version 9"),
            (r#"{"task":"(go n4)","deadline_s":-1}"#, "deadline_s is -1"),
            (r#"{"task":"(go n4)","id":"a b"}"#, "one word"),
            (r#"{"tasks":1}"#, "tasks"),
            ("go n4", "cannot read the goal"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
        let error = read(&"x".repeat(1_000_000)).unwrap_err();
        assert_eq!(
            error,
            "the message has 1000000 bytes, but at most 65536 are read"
        );
    }

    #[test]
    fn a_command_is_two_words() {
        let command = Command::Suspend("fetch".into());
        assert_eq!(command_from_user(b"suspend fetch").unwrap(), command);
        let text = command_to_wire(&command).unwrap();
        assert_eq!(command_from_user(text.as_bytes()).unwrap(), command);
        assert!(command_from_user(b"suspend").is_err());
        assert!(command_from_user(b"halt fetch").is_err());
    }
}
