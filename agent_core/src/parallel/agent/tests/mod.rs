//! A carrier in a small restaurant, in virtual time.

mod bistro;
mod journal;
mod random;
mod room;
mod serving;

use std::num::NonZeroUsize;

use super::ParallelAgent;
use crate::agent::Agent;
use crate::planner::{AnyPlanner, PlannerKind};
use room::{Driver, Room, planner};

impl Driver for ParallelAgent<AnyPlanner> {
    fn check_all(&self) {
        self.check();
    }
}

impl Driver for Agent<AnyPlanner> {
    fn check_all(&self) {
        self.check();
    }
}

/// A room in which a carrier works on so many goals at once.
fn parallel(together: usize, kind: PlannerKind) -> Room<ParallelAgent<AnyPlanner>> {
    let together = NonZeroUsize::new(together).expect("at least one");
    let made = ParallelAgent::new(bistro::configuration(0), together, planner(kind));
    Room::new(move |epoch| made.clone().for_epoch(epoch))
}

/// A room in which an ordinary agent works.
fn ordinary(kind: PlannerKind) -> Room<Agent<AnyPlanner>> {
    let made = Agent::new(bistro::configuration(0), planner(kind));
    Room::new(move |epoch| made.clone().for_epoch(epoch))
}
