//! `intermezzo goal`: ask a robot to do something.

mod wait;

use agent_core::language::parse_tasks;
use agent_core::model::Time;
use agent_core::protocol::{GoalRequest, Urgency};
use agent_link::wire::{self, Verdict};
use serde_json::json;

use crate::cli::GoalArgs;
use crate::exit::{Exit, Failure};
use crate::style::{BAD, GOOD};
use crate::target::{Connection, unanswered, unanswered_by};

pub(crate) async fn run(args: GoalArgs) -> Result<Exit, Failure> {
    let goal = read(&args)?;
    let connection = Connection::open(&args.target).await?;
    if !args.wait {
        let client = &connection.client;
        let verdict = match &args.vehicle {
            None => client.goal(goal).await,
            Some(vehicle) => client.goal_to(vehicle, goal).await,
        };
        let verdict = match (verdict, &args.vehicle) {
            (Err(error), Some(vehicle)) => Err(unanswered_by(client, vehicle, error).await),
            (verdict, _) => verdict.map_err(unanswered),
        };
        let verdict = connection.close(verdict).await?;
        return Ok(tell(&verdict, &args));
    }
    wait::run(connection, goal, &args).await
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

fn tell(verdict: &Verdict, args: &GoalArgs) -> Exit {
    let exit = if verdict.accepted {
        Exit::Done
    } else {
        Exit::Failed
    };
    if args.json {
        anstream::println!("{}", json!(verdict));
        return exit;
    }
    let tasks = args.task.trim();
    let id = verdict.id.as_deref().unwrap_or("the goal");
    if verdict.accepted {
        anstream::println!("{GOOD}accepted{GOOD:#} {id}: {tasks}");
    } else {
        let reason = verdict.reason.as_deref().unwrap_or("no reason given");
        anstream::eprintln!("{BAD}rejected:{BAD:#} {reason}");
    }
    exit
}
