//! `intermezzo goal`: ask a robot to do something.

use agent_core::language::parse_tasks;
use agent_core::model::Time;
use agent_core::protocol::{Event, GoalRequest, Happening, Urgency};
use agent_link::wire::{self, Verdict};
use agent_link::{Events, Keys, Session};
use serde_json::json;
use zenoh::sample::SampleKind;

use crate::cli::GoalArgs;
use crate::exit::{Exit, Failure};
use crate::style::{AGAIN, ASIDE, BAD, GOOD};
use crate::target::{Connection, unanswered};

pub(crate) async fn run(args: GoalArgs) -> Result<Exit, Failure> {
    let goal = read(&args)?;
    let connection = Connection::open(&args.target).await?;
    let result = ask(&connection, goal, &args).await;
    connection.close(result).await
}

fn read(args: &GoalArgs) -> Result<GoalRequest, Failure> {
    let example = "for example: intermezzo goal '(go n4)'";
    let tasks = parse_tasks(&args.task).map_err(|error| {
        Failure::bad_input(format_args!("`{}` is not a task: {error}", args.task)).advice(example)
    })?;
    let deadline = match args.deadline {
        None => None,
        Some(seconds) if seconds > 0.0 && seconds.is_finite() => Some(Time::from_secs(seconds)),
        Some(seconds) => {
            let what =
                format!("--deadline {seconds}: a deadline is a number of seconds above zero");
            return Err(Failure::bad_input(what));
        }
    };
    let goal = GoalRequest {
        id: args.id.as_deref().map(Into::into),
        tasks,
        urgency: if args.emergency {
            Urgency::Emergency
        } else {
            Urgency::Normal
        },
        priority: args.priority,
        deadline,
    };
    // As the robot reads it: it refuses an id of two words, for one.
    wire::goal_to_wire(&goal)
        .and_then(|text| wire::goal_from_user(goal.urgency, text.as_bytes()))
        .map_err(Failure::bad_input)
}

async fn ask(connection: &Connection, goal: GoalRequest, args: &GoalArgs) -> Result<Exit, Failure> {
    // Listen first: a short goal may have ended before the verdict is here.
    let events = match args.wait {
        true => Some(connection.client.events().await.map_err(unanswered)?),
        false => None,
    };
    let tasks = args.task.trim();
    let verdict = connection.client.goal(goal).await.map_err(unanswered)?;
    tell(&verdict, tasks, args);
    if !verdict.accepted {
        return Ok(Exit::Failed);
    }
    let (Some(events), Some(id)) = (events, &verdict.id) else {
        return Ok(Exit::Done);
    };
    tokio::select! {
        exit = end_of(events, id, args.json) => exit,
        failure = gone(&connection.session, &connection.keys) => Err(failure),
    }
}

fn tell(verdict: &Verdict, tasks: &str, args: &GoalArgs) {
    if args.json {
        anstream::println!("{}", json!(verdict));
        return;
    }
    let id = verdict.id.as_deref().unwrap_or("the goal");
    if verdict.accepted {
        anstream::println!("{GOOD}accepted{GOOD:#} {id}: {tasks}");
    } else {
        let reason = verdict.reason.as_deref().unwrap_or("no reason given");
        anstream::eprintln!("{BAD}rejected:{BAD:#} {reason}");
    }
}

/// Tells how it goes until the goal has ended.
async fn end_of(mut events: Events, id: &str, as_json: bool) -> Result<Exit, Failure> {
    while let Some(event) = events.next().await {
        let Ok((agent, event)) = event else { continue };
        let about_it = event.goal.as_ref().is_some_and(|goal| *goal == id);
        if agent != parent_agent::NAME || !about_it {
            continue;
        }
        if as_json {
            if let Ok(line) = wire::event_to_line(agent.as_str(), &event) {
                anstream::println!("{line}");
            }
        } else if let Some(words) = words(&event) {
            anstream::println!("{words}");
        }
        match event.what {
            Happening::GoalSucceeded => return Ok(Exit::Done),
            Happening::GoalFailed { .. } | Happening::GoalUnknown { .. } => {
                return Ok(Exit::Failed);
            }
            _ => {}
        }
    }
    Err(Failure::nobody_there("the connection is gone"))
}

fn words(event: &Event) -> Option<String> {
    let at = event.at;
    Some(match &event.what {
        Happening::GoalStarted => format!("begun at {at}"),
        Happening::GoalSuspended { why, .. } => {
            format!("{ASIDE}set aside{ASIDE:#} at {at}: {why}")
        }
        Happening::GoalResumed { how, why, .. } => format!(
            "{AGAIN}taken up again{AGAIN:#} at {at}, {}: {why}",
            crate::show::resumption(*how)
        ),
        Happening::GoalBlocked { blocked_by } => {
            let facts: Vec<String> = blocked_by.iter().map(ToString::to_string).collect();
            format!(
                "{ASIDE}blocked{ASIDE:#} at {at}: waits for {}",
                facts.join(" ")
            )
        }
        Happening::GoalSucceeded => format!("{GOOD}done{GOOD:#} at {at}"),
        Happening::GoalFailed { reason } => format!("{BAD}failed{BAD:#} at {at}: {reason}"),
        Happening::GoalUnknown { reason } => {
            format!("{BAD}not known whether it is done{BAD:#} at {at}: {reason}")
        }
        _ => return None,
    })
}

/// Returns when the agent that has the goal is gone.
async fn gone(session: &Session, keys: &Keys) -> Failure {
    let network = |error| Failure::failed(format_args!("cannot see who is there: {error}"));
    let tokens = match session
        .liveliness()
        .declare_subscriber(keys.alive_any())
        .await
    {
        Ok(tokens) => tokens,
        Err(error) => return network(error),
    };
    while let Ok(token) = tokens.recv_async().await {
        let agent = Keys::read_alive(token.key_expr().as_str());
        if token.kind() == SampleKind::Delete
            && agent.is_some_and(|(agent, _)| agent == parent_agent::NAME)
        {
            return Failure::nobody_there("the robot is gone, and nobody knows how the goal ended");
        }
    }
    Failure::nobody_there("the connection is gone")
}
