//! `intermezzo status`: what a robot does, has set aside, waits for and believes.

use std::fmt::Write;
use std::time::{SystemTime, UNIX_EPOCH};

use agent_link::{Client, ClientError, View};
use executor_sim::program::{ROOM, WORLD};
use serde_json::{Map, Value, json};

use crate::cli::StatusArgs;
use crate::exit::{Exit, Failure};
use crate::show::alternatives;
use crate::style::{ASIDE, BAD, BOLD, DIM, GOOD, URGENT};
use crate::target::{Connection, nobody, unanswered};

/// The order in which agents are shown; others follow.
const ORDER: [&str; 4] = ["parent", "child", "executor", "world"];
/// More facts than this are counted, not shown.
const FACTS_SHOWN: usize = 12;

pub(crate) async fn run(args: StatusArgs) -> Result<Exit, Failure> {
    let connection = Connection::open(&args.target).await?;
    let looked = look_at_all(&connection, args.plans).await;
    let Seen { agents, processes } = connection.close(looked).await?;
    if args.json {
        let seen = json!({
            "v": agent_link::wire::VERSION, "agents": agents, "processes": processes,
        });
        anstream::println!("{seen}");
    } else {
        anstream::print!("{}", for_people(&agents, &processes, args.plans));
    }
    Ok(Exit::Done)
}

/// What there is to see of a robot.
struct Seen {
    /// Name and views of every agent that answers; `null` for one that does not, or is gone.
    agents: Map<String, Value>,
    /// How the processes of the roles are; `null` where nobody looks after them.
    processes: Value,
}

async fn look_at_all(connection: &Connection, plans: bool) -> Result<Seen, Failure> {
    let client = &connection.client;
    let mut names: Vec<String> = client
        .alive()
        .await
        .map_err(unanswered)?
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    names.sort();
    names.dedup();
    let processes = client.supervisor().await.map_err(unanswered)?;
    if names.is_empty() && processes.is_none() {
        return Err(nobody(&connection.keys));
    }
    let mut agents = Map::new();
    for name in &names {
        // Whoever has died or hangs since must not keep the others from being seen.
        let views = match look_at(client, name, plans).await {
            Ok(views) => views,
            Err(ClientError::NoAnswer { .. }) => Value::Null,
            Err(error) => return Err(unanswered(error)),
        };
        agents.insert(name.clone(), views);
    }
    let processes = processes.map_or(Value::Null, |mut status| status["roles"].take());
    // A robot with agents of other names may well do without those of these.
    if names.iter().all(|name| ORDER.contains(&name.as_str()))
        && !processes.get(ROOM).is_some_and(Value::is_object)
    {
        for name in ORDER {
            agents.entry(name).or_insert(Value::Null);
        }
    }
    Ok(Seen { agents, processes })
}

/// Alternatives take the agent some planning: they are asked for only if they are wanted.
async fn look_at(client: &Client, agent: &str, plans: bool) -> Result<Value, ClientError> {
    let mut views = Map::new();
    let wanted = |view: &View| plans || *view != View::Alternatives;
    for view in View::ALL.into_iter().filter(wanted) {
        let seen = client.look(agent, view).await?;
        views.insert(view.name().to_owned(), seen);
    }
    Ok(views.into())
}

fn for_people(agents: &Map<String, Value>, processes: &Value, plans: bool) -> String {
    let mut text = String::new();
    let others = agents.keys().map(String::as_str);
    let others = others.filter(|name| !ORDER.contains(name));
    for name in ORDER.into_iter().chain(others) {
        let Some(views) = agents.get(name) else {
            continue;
        };
        let process = &processes[name];
        if views.is_null() {
            let _ = writeln!(
                text,
                "{BOLD}{name:<9}{BOLD:#}{BAD}{}{BAD:#}",
                absent(process)
            );
        } else {
            agent(&mut text, name, views, plans);
        }
        if let Some(words) = lives(process) {
            let _ = writeln!(text, "           {DIM}{words}{DIM:#}");
        }
    }
    text
}

/// Why there is nothing to see of an agent.
fn absent(process: &Value) -> String {
    match process["state"].as_str() {
        Some("down") => format!(
            "is down; next start in {:.1} s",
            process["next_start_s"].as_f64().unwrap_or_default()
        ),
        Some("starting") => "is starting".to_owned(),
        Some("given_up") => "is down, and is not started again".to_owned(),
        Some(_) => "does not answer".to_owned(),
        None => "is gone".to_owned(),
    }
}

/// What has become of an agent's process so far.
fn lives(process: &Value) -> Option<String> {
    let now_s = SystemTime::now().duration_since(UNIX_EPOCH).ok()?;
    let ago = |at: &Value| Some(duration((now_s.as_secs_f64() - at.as_f64()?).max(0.0)));
    let mut words = Vec::new();
    if let Some(pid) = process["process"].as_u64() {
        words.push(format!("process {pid}"));
    }
    if let Some(up) = ago(&process["up_since_unix_s"]) {
        words.push(format!("up for {up}"));
    }
    match process["restarts"].as_u64() {
        None | Some(0) => {}
        Some(1) => words.push("started again once".to_owned()),
        Some(times) => words.push(format!("started again {times} times")),
    }
    if let (Some(how), Some(ago)) = (
        process["last_exit"].as_str(),
        ago(&process["last_exit_unix_s"]),
    ) {
        words.push(format!("the last end {ago} ago: {how}"));
    }
    (!words.is_empty()).then(|| words.join(", "))
}

/// In the unit in which people say it.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Writing to text does not fail.
fn agent(text: &mut String, name: &str, views: &Value, with_plans: bool) {
    if name == WORLD {
        world(text, views);
        return;
    }
    if name == ROOM {
        room(text, views);
        return;
    }
    let status = &views["status"];
    let _ = write!(text, "{BOLD}{name:<9}{BOLD:#}");
    let running = &status["running"];
    let action = status["action"]["action"].as_str();
    let holds = status["holds"] == true;
    match (goal_words(running), action) {
        (Some(goal), Some(action)) if status["phase"] == "stopping" => {
            let _ = writeln!(text, "{goal}: {ASIDE}stopping{ASIDE:#} {action}");
        }
        (Some(goal), Some(action)) => {
            let _ = writeln!(text, "{GOOD}▶{GOOD:#} {goal}: {action}");
        }
        (Some(goal), None) if holds => {
            let _ = writeln!(text, "{goal}");
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
    if holds {
        let missing = match words(&status["absent"]) {
            names if names.is_empty() => "until its superiors are seen".to_owned(),
            names => format!("{} is not there", names.replace(' ', " and ")),
        };
        let _ = writeln!(text, "         {ASIDE}‖ holding: {missing}{ASIDE:#}");
    }
    for other in list(&status["branches"]).iter().skip(1) {
        let goal = goal_words(&other["running"]).unwrap_or_default();
        let action = other["action"]["action"].as_str();
        let doing = action.or(other["phase"].as_str()).unwrap_or_default();
        let _ = writeln!(text, "         {GOOD}▶{GOOD:#} {goal}: {doing}");
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
    tasks(text, name, &status["tasks"]);
    belief(text, &views["belief"]);
}

/// What a vehicle has published.
fn tasks(text: &mut String, name: &str, tasks: &Value) {
    for task in list(tasks).iter().filter(|task| task["by"] == name) {
        let what = task["what"].as_str().unwrap_or_default();
        let _ = match task["to"].as_str() {
            Some(to) => writeln!(text, "         {DIM}→{DIM:#} {to} has {what}"),
            None => writeln!(text, "         {DIM}?{DIM:#} nobody has {what} yet"),
        };
    }
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

fn room(text: &mut String, views: &Value) {
    let status = &views["status"];
    let at_s = status["t_s"].as_f64().unwrap_or_default();
    let _ = writeln!(text, "{BOLD}{ROOM:<9}{BOLD:#}at {at_s:.1} s");
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn words(value: &Value) -> String {
    let words: Vec<&str> = list(value).iter().filter_map(Value::as_str).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(agents: &Value, processes: &Value) -> String {
        let agents = agents.as_object().unwrap();
        anstream::adapter::strip_str(&for_people(agents, processes, false)).to_string()
    }

    #[test]
    fn a_role_that_is_down_is_shown_with_its_next_start_and_how_it_ended() {
        let processes = json!({ "child": {
            "state": "down", "restarts": 3, "next_start_s": 0.4,
            "last_exit": "signal: 9 (SIGKILL)", "last_exit_unix_s": 0.0,
        }});
        let text = plain(&json!({ "child": null }), &processes);
        assert!(text.contains("is down; next start in 0.4 s"), "{text}");
        assert!(text.contains("started again 3 times"), "{text}");
        assert!(text.contains("signal: 9 (SIGKILL)"), "{text}");
    }

    #[test]
    fn without_anybody_who_looks_after_it_a_role_that_is_gone_is_shown_as_gone() {
        let text = plain(&json!({ "parent": null }), &Value::Null);
        assert_eq!(text, "parent   is gone\n");
    }

    #[test]
    fn an_agent_that_holds_says_for_whom_it_waits() {
        let status = json!({ "holds": true, "absent": ["parent"] });
        let text = plain(&json!({ "child": { "status": status } }), &Value::Null);
        assert!(text.contains("holding: parent is not there"), "{text}");
    }
}
