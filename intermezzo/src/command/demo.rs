//! `intermezzo demo`: a tour with two emergencies.

use agent_link::options::LimitOptions;
use maps::Place;

use super::up::{Performance, perform};
use crate::cli::DemoArgs;
use crate::exit::{Exit, Failure};
use crate::robot::Setup;
use crate::scenario::Scenario;

/// The story.
pub(crate) const STORY: &str = include_str!("../../scenarios/demo.toml");

pub(crate) async fn run(args: DemoArgs) -> Result<Exit, Failure> {
    let place = Place::museum();
    let scenario = Scenario::from_text("demo.toml", STORY, place.site())
        .map_err(|findings| Failure::failed(crate::place::lines(&findings)))?;
    let setup = Setup {
        // Demonstrations can run side by side, and beside a robot that is in use.
        robot: format!("demo-{}", std::process::id()),
        place: None,
        start: "n1".to_owned(),
        speed: args.speed,
        planner: args.planner,
        faults: None,
        listen: Vec::new(),
        connect: Vec::new(),
        zenoh_config: None,
        state: None,
        world_elsewhere: false,
        hang_limit: crate::robot::HANG_LIMIT,
        security: None,
        limits: LimitOptions::default(),
        vehicles: Vec::new(),
        together: None,
    };
    let performance = Performance {
        scenario: Some(scenario),
        until_done: true,
        json: args.json,
        from_the_start: true,
    };
    perform(&setup, &place, performance).await
}
