//! `intermezzo up` for a restaurant: a room and its vehicles until Ctrl-C.

use std::collections::BTreeSet;
use std::path::PathBuf;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::GoalId;
use agent_link::{Client, View};
use maps::Restaurant;
use serde_json::Value;

use super::up::{Performance, conclude, judge, read_scenario};
use crate::cli::UpArgs;
use crate::exit::{Exit, Failure};
use crate::robot::{Robot, Setup};
use crate::scenario::Player;
use crate::security;
use crate::show::{Ending, ForTeam, JsonLines, Programme, show};
use crate::style::{BOLD, DIM};

pub(super) async fn run(
    args: UpArgs,
    folder: Option<PathBuf>,
    restaurant: &Restaurant,
) -> Result<Exit, Failure> {
    let scenario = match &args.scenario {
        None => None,
        Some(file) => Some(read_scenario(file, restaurant.site())?),
    };
    if args.no_world {
        let what = "--no-world: the room of a restaurant cannot be elsewhere";
        return Err(Failure::bad_input(what));
    }
    if args.start != crate::cli::USUAL_START {
        let what = "--start: in a restaurant room.toml says where each vehicle stands at first";
        return Err(Failure::bad_input(what));
    }
    if let Some(folder) = &args.security {
        let vehicles = restaurant.room().vehicles.keys();
        let vehicles = vehicles.map(ToString::to_string).collect();
        security::check_team(folder, &vehicles, &args.place)?;
    }
    let setup = Setup {
        vehicles: restaurant.room().vehicles.keys().cloned().collect(),
        together: args.together,
        ..super::up::setup(&args, folder)
    };
    let performance = Performance {
        scenario,
        until_done: args.until_done,
        json: args.json,
        from_the_start: false,
    };
    perform(&setup, restaurant, performance).await
}

/// Starts a room and its vehicles, shows what they do, and ends them.
pub(super) async fn perform(
    setup: &Setup,
    restaurant: &Restaurant,
    performance: Performance,
) -> Result<Exit, Failure> {
    let mut interrupted = std::pin::pin!(agent_link::interrupted());
    let Some(mut robot) = Robot::start(setup, &mut interrupted).await? else {
        return Ok(Exit::Done);
    };
    let client = Client::new(&robot.session, &robot.keys);
    let ready = robot.clock.now();
    let vehicles: BTreeSet<Symbol> = setup.vehicles.iter().cloned().collect();
    let player = performance
        .scenario
        .map(|scenario| Player::new(scenario, client, ready, vehicles.clone()));
    let programme = Programme {
        site: restaurant.site(),
        player,
        until_done: performance.until_done,
    };
    let ending = if performance.json {
        JsonLines.ready(&robot);
        show(&mut robot, programme, &mut interrupted, &mut JsonLines).await
    } else {
        let zero = match performance.from_the_start {
            true => ready,
            false => {
                introduce(setup, restaurant, &robot);
                Time::ZERO
            }
        };
        let mut screen = ForTeam::new(zero, vehicles.clone());
        if !performance.from_the_start {
            let client = Client::new(&robot.session, &robot.keys);
            for (goal, tasks) in goals_of(&client, &vehicles).await {
                screen.knows(goal, tasks);
            }
        }
        let ending = show(&mut robot, programme, &mut interrupted, &mut screen).await;
        for retold in screen.retold() {
            anstream::println!("\n{retold}");
        }
        ending
    };
    let now = robot.clock.now();
    robot.end().await;
    let ending = ending?;
    let to_the_end = performance.until_done && ending != Ending::Interrupted;
    let (exit, failed) = judge(ending);
    if performance.json {
        JsonLines.end(now, exit == Exit::Done, &failed);
    } else {
        conclude(exit, to_the_end, &failed);
    }
    Ok(exit)
}

/// What vehicles have to do already. Who does not answer has nothing.
pub(super) async fn goals_of(
    client: &Client,
    vehicles: &BTreeSet<Symbol>,
) -> Vec<(GoalId, String)> {
    let mut all = Vec::new();
    for vehicle in vehicles {
        let goals = client.look(vehicle.as_str(), View::Goals).await;
        let goals = goals.unwrap_or_default();
        for goal in goals.as_array().into_iter().flatten() {
            let tasks = goal["tasks"].as_array().into_iter().flatten();
            let tasks: Vec<&str> = tasks.filter_map(Value::as_str).collect();
            if let Some(id) = goal["id"].as_str() {
                all.push((id.into(), tasks.join(" ")));
            }
        }
    }
    all
}

/// How to talk to them, to be copied.
fn introduce(setup: &Setup, restaurant: &Restaurant, robot: &Robot) {
    let name = robot.keys.robot();
    let mut option = match name {
        agent_link::options::DEFAULT_ROBOT => String::new(),
        name => format!(" --robot {name}"),
    };
    if let Some(folder) = &setup.security {
        option.push_str(&format!(" --security {}", folder.display()));
    }
    let vehicles: Vec<&str> = setup.vehicles.iter().map(Symbol::as_str).collect();
    anstream::println!(
        "{BOLD}{name}{BOLD:#}: {} in {}. It is reached at {} and ends on Ctrl-C.",
        vehicles.join(", "),
        restaurant.name(),
        robot.endpoint,
    );
    anstream::println!("{DIM}In another terminal:{DIM:#}");
    let mut commands = Vec::new();
    if let Some((guest, plan)) = restaurant.room().guests.iter().next() {
        let (table, kind) = (&plan.table, &plan.wants);
        commands.push((
            format!("fact '(arrived {guest})'"),
            "a guest comes".to_owned(),
        ));
        commands.push((
            format!("fact '(seated {guest} {table})'"),
            "and sits down".to_owned(),
        ));
        commands.push((
            format!("goal '(serve {kind} {guest})'"),
            "something to do, for whoever can do it".to_owned(),
        ));
    }
    commands.push(("status".to_owned(), "what each of them does".to_owned()));
    commands.push((
        "watch --json".to_owned(),
        "all events, for programs".to_owned(),
    ));
    for (command, what) in commands {
        let command = format!("intermezzo {command}{option}");
        anstream::println!("  {command:<52} {DIM}{what}{DIM:#}");
    }
    anstream::println!();
}
