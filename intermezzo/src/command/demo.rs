//! `intermezzo demo`: a tour with two emergencies, or an evening in a restaurant.

use agent_link::options::LimitOptions;
use maps::{Place, Restaurant, Site};

use super::team;
use super::up::{Performance, perform};
use crate::cli::{DemoArgs, DemoOf};
use crate::exit::{Exit, Failure};
use crate::robot::Setup;
use crate::scenario::Scenario;

/// The story.
pub(crate) const STORY: &str = include_str!("../../scenarios/demo.toml");

/// The restaurant's.
pub(crate) const RESTAURANT_STORY: &str = include_str!("../../scenarios/restaurant.toml");

pub(crate) async fn run(args: DemoArgs) -> Result<Exit, Failure> {
    let mut setup = Setup {
        // Demonstrations can run side by side, and beside a robot that is in use.
        robot: format!("demo-{}", std::process::id()),
        place: None,
        start: crate::cli::USUAL_START.to_owned(),
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
    let performance = |scenario| Performance {
        scenario: Some(scenario),
        until_done: true,
        json: args.json,
        from_the_start: true,
    };
    match args.what {
        DemoOf::Museum => {
            let place = Place::museum();
            let scenario = story("demo.toml", STORY, place.site())?;
            perform(&setup, &place, performance(scenario)).await
        }
        DemoOf::Restaurant => {
            let restaurant = Restaurant::of_the_paper();
            let scenario = story("restaurant.toml", RESTAURANT_STORY, restaurant.site())?;
            setup.vehicles = restaurant.room().vehicles.keys().cloned().collect();
            team::perform(&setup, &restaurant, performance(scenario)).await
        }
    }
}

fn story(name: &str, text: &str, site: &Site) -> Result<Scenario, Failure> {
    Scenario::from_text(name, text, site)
        .map_err(|findings| Failure::failed(crate::place::lines(&findings)))
}
