//! `intermezzo status`: what a robot does, has set aside, waits for and believes.

use std::fmt::Write;

use agent_link::{Client, View};
use executor_sim::program::WORLD;
use serde_json::{Map, Value, json};

use crate::cli::StatusArgs;
use crate::exit::{Exit, Failure};
use crate::show::alternatives;
use crate::style::{ASIDE, BOLD, DIM, GOOD, URGENT};
use crate::target::{Connection, unanswered};

/// The order in which agents are shown; others follow.
const ORDER: [&str; 4] = ["parent", "child", "executor", "world"];
/// More facts than this are counted, not shown.
const FACTS_SHOWN: usize = 12;

pub(crate) async fn run(args: StatusArgs) -> Result<Exit, Failure> {
    let connection = Connection::open(&args.target).await?;
    let looked = look_at_all(&connection, args.plans).await;
    let agents = connection.close(looked).await?;
    if args.json {
        anstream::println!(
            "{}",
            json!({ "v": agent_link::wire::VERSION, "agents": agents })
        );
    } else {
        anstream::print!("{}", for_people(&agents, args.plans));
    }
    Ok(Exit::Done)
}

/// Name and views of every agent that is there.
async fn look_at_all(connection: &Connection, plans: bool) -> Result<Map<String, Value>, Failure> {
    let mut names: Vec<String> = connection
        .client
        .alive()
        .await
        .map_err(unanswered)?
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    names.sort_by_key(|name| {
        let place = ORDER.iter().position(|known| known == name);
        (place.unwrap_or(ORDER.len()), name.clone())
    });
    names.dedup();
    if names.is_empty() {
        return Err(Failure::nobody_there(format_args!(
            "nobody of robot `{}` is there",
            connection.keys.robot()
        ))
        .advice("check the name (--robot) and the address (--connect)"));
    }
    let mut agents = Map::new();
    for name in names {
        let views = look_at(&connection.client, &name, plans).await?;
        agents.insert(name, views);
    }
    Ok(agents)
}

/// Alternatives take the agent some planning: they are asked for only if they are wanted.
async fn look_at(client: &Client, agent: &str, plans: bool) -> Result<Value, Failure> {
    let mut views = Map::new();
    let wanted = |view: &View| plans || *view != View::Alternatives;
    for view in View::ALL.into_iter().filter(wanted) {
        let seen = client.look(agent, view).await.map_err(unanswered)?;
        views.insert(view.name().to_owned(), seen);
    }
    Ok(views.into())
}

fn for_people(agents: &Map<String, Value>, plans: bool) -> String {
    let mut text = String::new();
    for name in ORDER {
        if let Some(views) = agents.get(name) {
            agent(&mut text, name, views, plans);
        }
    }
    for (name, views) in agents {
        if !ORDER.contains(&name.as_str()) {
            agent(&mut text, name, views, plans);
        }
    }
    text
}

/// Writing to text does not fail.
fn agent(text: &mut String, name: &str, views: &Value, with_plans: bool) {
    if name == WORLD {
        world(text, views);
        return;
    }
    let status = &views["status"];
    let _ = write!(text, "{BOLD}{name:<9}{BOLD:#}");
    let running = &status["running"];
    let action = status["action"]["action"].as_str();
    match (goal_words(running), action) {
        (Some(goal), Some(action)) if status["phase"] == "stopping" => {
            let _ = writeln!(text, "{goal}: {ASIDE}stopping{ASIDE:#} {action}");
        }
        (Some(goal), Some(action)) => {
            let _ = writeln!(text, "{GOOD}▶{GOOD:#} {goal}: {action}");
        }
        (Some(goal), None) => {
            let _ = writeln!(text, "{GOOD}▶{GOOD:#} {goal}: planning");
        }
        (None, Some(action)) => {
            let _ = writeln!(text, "{GOOD}▶{GOOD:#} {action}");
        }
        (None, None) => {
            let _ = writeln!(text, "{DIM}nothing to do{DIM:#}");
        }
    }
    if with_plans {
        text.push_str(&of_goal(views, &running["id"]));
    } else {
        show_plan(text, &views["plans"]);
    }
    let stack = list(&views["stack"]);
    for entry in stack.iter().rev() {
        suspended(text, entry);
        if with_plans {
            text.push_str(&of_goal(views, &entry["id"]));
        }
    }
    for waiting in list(&status["waiting"]) {
        let goal = goal_words(waiting).unwrap_or_default();
        let _ = writeln!(text, "         {DIM}…{DIM:#} waits for its turn: {goal}");
        if with_plans {
            text.push_str(&of_goal(views, &waiting["id"]));
        }
    }
    for aside in list(&status["aside"]) {
        let goal = goal_words(aside).unwrap_or_default();
        let facts = words(&aside["blocked_by"]);
        let _ = if facts.is_empty() {
            writeln!(
                text,
                "         {ASIDE}■ set aside by the user{ASIDE:#}: {goal}"
            )
        } else {
            writeln!(
                text,
                "         {ASIDE}■ blocked{ASIDE:#}: {goal} waits for {facts}"
            )
        };
        if with_plans {
            text.push_str(&of_goal(views, &aside["id"]));
        }
    }
    belief(text, &views["belief"]);
}

/// The alternatives for the goal of this name.
fn of_goal(views: &Value, id: &Value) -> String {
    let mut goals = list(&views["alternatives"]).iter();
    let goal = goals.find(|goal| !id.is_null() && goal["id"] == *id);
    goal.map(alternatives).unwrap_or_default()
}

fn suspended(text: &mut String, entry: &Value) {
    // A controller's records have no goals.
    let what = goal_words(entry)
        .or_else(|| entry["action"].as_str().map(str::to_owned))
        .unwrap_or_default();
    let records: Vec<&str> = list(&entry["records"])
        .iter()
        .filter_map(|record| record["action"].as_str())
        .collect();
    let in_the_middle = if records.is_empty() {
        String::new()
    } else {
        format!(" in the middle of {}", records.join(" and "))
    };
    let by = match entry["resumed_by"].as_str() {
        Some("superior") => ", for its superior",
        _ => "",
    };
    let holds = match entry["holds"].as_bool() {
        Some(false) => "; its plan no longer holds",
        _ => "",
    };
    let _ = writeln!(
        text,
        "         {ASIDE}‖ set aside{by}{ASIDE:#}: {what}{in_the_middle}{holds}"
    );
}

/// The plan that is followed.
fn show_plan(text: &mut String, plans: &Value) {
    if let Some(plan) = list(plans).first() {
        let rest = match words(&plan["rest"]).as_str() {
            "" => String::new(),
            rest => format!(" … {rest}"),
        };
        let cost = plan["cost"].as_f64().unwrap_or_default();
        let _ = writeln!(
            text,
            "           {DIM}plan{DIM:#} {}{rest} {DIM}cost {cost:.1}{DIM:#}",
            words(&plan["steps"])
        );
    }
}

/// Name and tasks of a goal, if there is one.
fn goal_words(goal: &Value) -> Option<String> {
    let id = goal["id"].as_str()?;
    let tasks = words(&goal["tasks"]);
    if tasks.is_empty() {
        return None;
    }
    let urgent = match goal["urgency"].as_str() {
        Some("emergency") if goal["superior"].is_null() => {
            format!(" {URGENT}urgent{URGENT:#}")
        }
        _ => String::new(),
    };
    // What a superior has asked for has a name that says nothing to people.
    Some(match goal["superior"].as_str() {
        Some(superior) => format!("{tasks} {DIM}for {superior}{DIM:#}"),
        None => format!("{id} {tasks}{urgent}"),
    })
}

fn belief(text: &mut String, belief: &Value) {
    let facts = list(&belief["facts"]);
    if facts.is_empty() {
        return;
    }
    let shown: Vec<&str> = facts
        .iter()
        .filter_map(Value::as_str)
        .take(FACTS_SHOWN)
        .collect();
    let more = facts.len().saturating_sub(FACTS_SHOWN);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    let _ = writeln!(
        text,
        "           {DIM}believes {}{more}{DIM:#}",
        shown.join(" ")
    );
}

/// So many closed doors are named; `--json` names all.
const CLOSED_DOORS: usize = 12;

fn world(text: &mut String, views: &Value) {
    let status = &views["status"];
    let _ = writeln!(
        text,
        "{BOLD}{WORLD:<9}{BOLD:#}the robot is {} at {:.1} s; {:.1} m driven",
        status["where"].as_str().unwrap_or("somewhere"),
        status["t_s"].as_f64().unwrap_or_default(),
        status["odometer_m"].as_f64().unwrap_or_default(),
    );
    let doors = views["belief"]["doors"].as_object();
    let closed: Vec<&str> = doors
        .into_iter()
        .flatten()
        .filter(|(_, open)| **open == json!(false))
        .map(|(door, _)| door.as_str())
        .collect();
    let closed = match closed.as_slice() {
        [] => "no door is closed".to_owned(),
        doors => match doors.split_at_checked(CLOSED_DOORS) {
            Some((first, rest)) if !rest.is_empty() => {
                format!("closed: {} and {} more", first.join(", "), rest.len())
            }
            _ => format!("closed: {}", doors.join(", ")),
        },
    };
    let _ = writeln!(text, "           {DIM}{closed}{DIM:#}");
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn words(value: &Value) -> String {
    let words: Vec<&str> = list(value).iter().filter_map(Value::as_str).collect();
    words.join(" ")
}
