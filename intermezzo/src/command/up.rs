//! `intermezzo up`: a robot until Ctrl-C.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use agent_core::model::Time;
use agent_link::{Client, View};
use maps::{Place, Site};

use super::team;
use crate::cli::UpArgs;
use crate::exit::{Exit, Failure};
use crate::place;
use crate::robot::{Robot, RoleKind, Setup};
use crate::scenario::{Player, Scenario};
use crate::show::{Ending, ForPeople, JsonLines, Programme, show};
use crate::style::{BAD, BOLD, DIM, GOOD};

/// What is shown, and how.
pub(super) struct Performance {
    pub(super) scenario: Option<Scenario>,
    /// End when all goals of the scenario have ended.
    pub(super) until_done: bool,
    pub(super) json: bool,
    /// Count the time for people from when the robot is ready, and tell nothing of how to talk to
    /// it: it will be gone soon.
    pub(super) from_the_start: bool,
}

pub(crate) async fn run(args: UpArgs) -> Result<Exit, Failure> {
    if let Some((folder, restaurant)) = place::read_restaurant(&args.place)? {
        return team::run(args, folder, &restaurant).await;
    }
    let (folder, place) = place::read(&args.place)?;
    if place.site().node(&args.start).is_none() {
        return Err(no_such_node(&args.start, place.site()));
    }
    let scenario = match &args.scenario {
        None => None,
        Some(file) => Some(read_scenario(file, place.site())?),
    };
    let setup = setup(&args, folder);
    let performance = Performance {
        scenario,
        until_done: args.until_done,
        json: args.json,
        from_the_start: false,
    };
    perform(&setup, &place, performance).await
}

/// What the options say of a robot, or of what is common to a room and its vehicles.
pub(super) fn setup(args: &UpArgs, place: Option<PathBuf>) -> Setup {
    Setup {
        robot: args.robot.clone(),
        place,
        start: args.start.clone(),
        speed: args.speed,
        planner: args.planner,
        faults: args.faults,
        listen: args.listen.clone(),
        connect: args.connect.clone(),
        zenoh_config: args.zenoh_config.clone(),
        state: args.state.clone(),
        world_elsewhere: args.no_world,
        hang_limit: args.hang_limit,
        security: args.security.clone(),
        limits: args.limits,
        vehicles: Vec::new(),
        together: None,
    }
}

/// Starts a robot, shows what it does, and ends it.
pub(super) async fn perform(
    setup: &Setup,
    place: &Place,
    performance: Performance,
) -> Result<Exit, Failure> {
    let mut interrupted = std::pin::pin!(agent_link::interrupted());
    let Some(mut robot) = Robot::start(setup, &mut interrupted).await? else {
        return Ok(Exit::Done);
    };
    let client = Client::new(&robot.session, &robot.keys);
    let ready = robot.clock.now();
    let player = performance
        .scenario
        .map(|scenario| Player::new(scenario, client, ready, BTreeSet::new()));
    let programme = Programme {
        site: place.site(),
        player,
        until_done: performance.until_done,
    };
    let (ending, mut people) = if performance.json {
        JsonLines.ready(&robot);
        let ending = show(&mut robot, programme, &mut interrupted, &mut JsonLines).await;
        (ending, None)
    } else {
        let zero = if performance.from_the_start {
            ready
        } else {
            introduce(setup, place, &robot).await;
            Time::ZERO
        };
        let observable = place.area().model.observable.iter().cloned();
        let mut people = ForPeople::new(zero, observable);
        let ending = show(&mut robot, programme, &mut interrupted, &mut people).await;
        (ending, Some(people))
    };
    let now = robot.clock.now();
    if let Some(table) = people.as_mut().and_then(ForPeople::summary) {
        anstream::println!("\n{table}");
    }
    robot.end().await;
    let ending = ending?;
    let to_the_end = performance.until_done && ending != Ending::Interrupted;
    let (exit, failed) = judge(ending);
    if performance.json {
        // A story that was broken off has not been told.
        let told = to_the_end || !performance.until_done;
        JsonLines.end(now, exit == Exit::Done && told, &failed);
    } else {
        conclude(exit, to_the_end, &failed);
    }
    Ok(exit)
}

/// The last words to people. `to_the_end`: a story has been played, and not been broken off.
pub(super) fn conclude(exit: Exit, to_the_end: bool, failed: &[String]) {
    if exit == Exit::Done {
        if to_the_end {
            anstream::println!("{GOOD}Every goal was reached.{GOOD:#}");
        }
        return;
    }
    for reason in failed {
        anstream::println!("{BAD}✗{BAD:#} {reason}");
    }
}

pub(super) fn judge(ending: Ending) -> (Exit, Vec<String>) {
    match ending {
        Ending::Interrupted => (Exit::Done, Vec::new()),
        Ending::Over(failed) if failed.is_empty() => (Exit::Done, failed),
        Ending::Over(failed) => (Exit::Failed, failed),
        Ending::GivenUp(role, how) => {
            let what = format!("{} ends whenever it is started: {how}", role.in_words());
            (Exit::Failed, vec![what])
        }
    }
}

/// How to talk to the robot, to be copied.
async fn introduce(setup: &Setup, place: &Place, robot: &Robot) {
    let name = robot.keys.robot();
    let mut option = if name == agent_link::options::DEFAULT_ROBOT {
        String::new()
    } else {
        format!(" --robot {name}")
    };
    if let Some(folder) = &setup.security {
        option.push_str(&format!(" --security {}", folder.display()));
    }
    // Not necessarily where it began: it may go on from an earlier state.
    let client = Client::new(&robot.session, &robot.keys);
    let world = client.look(RoleKind::World.name(), View::Status).await;
    let spot = world
        .ok()
        .and_then(|status| Some(status["where"].as_str()?.to_owned()));
    let speed = match setup.speed {
        1.0 => String::new(),
        speed => format!(", {speed} times as fast as real time"),
    };
    anstream::println!(
        "{BOLD}{name}{BOLD:#} is {} in {}{speed}. It is reached at {} and ends on Ctrl-C.",
        spot.as_deref().unwrap_or("somewhere"),
        place.name(),
        robot.endpoint,
    );
    anstream::println!("{DIM}In another terminal:{DIM:#}");
    let task = place.area().domain.tasks.contains_key("go");
    let node = place.site().nodes().last();
    let goal = match node.filter(|_| task) {
        Some(node) => format!("(go {})", node.name()),
        None => "(…)".to_owned(),
    };
    for (command, what) in [
        (format!("goal '{goal}'"), "give it something to do"),
        (
            format!("goal '{goal}' --emergency"),
            "and something more urgent",
        ),
        (
            "status".to_owned(),
            "what it does, and what it has set aside",
        ),
        ("watch --json".to_owned(), "all events, for programs"),
    ] {
        let command = format!("intermezzo {command}{option}");
        anstream::println!("  {command:<52} {DIM}{what}{DIM:#}");
    }
    anstream::println!();
}

fn no_such_node(node: &str, site: &Site) -> Failure {
    let nodes = site.nodes().map(|node| node.name().as_str());
    let failure = Failure::bad_input(format_args!(
        "there is no node `{node}` on this map to start from"
    ));
    match agent_core::language::nearest(node, nodes) {
        Some(near) => failure.advice(format_args!("--start {near}")),
        None => failure,
    }
}

pub(super) fn read_scenario(file: &Path, site: &Site) -> Result<Scenario, Failure> {
    let text = std::fs::read_to_string(file).map_err(|error| {
        Failure::bad_input(format_args!("cannot read {}: {error}", file.display()))
    })?;
    let name = file.display().to_string();
    Scenario::from_text(&name, &text, site).map_err(|findings| {
        Failure::bad_input(format_args!(
            "the scenario is not in order:\n{}",
            place::lines(&findings)
        ))
        .advice("`intermezzo up --help` says what a scenario is made of")
    })
}
