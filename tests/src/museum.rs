//! The museum with everything that moves in it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use agent_core::agent::{Agent, Configuration};
use agent_core::model::Symbol;
use agent_core::planner::Settings;
use executor_sim::{Faults, Floor, MoverSpec, Place, SimulatedRobot};
use maps::{Level, Site};

use crate::{Planning, Stack, TestPlanner, Wire};

/// The museum, read once, to build stacks from.
pub struct Museum {
    /// Its map.
    pub site: Arc<Site>,
    /// Area level.
    pub area: Level,
    /// Node level.
    pub node: Level,
    /// How the agents of its stacks plan.
    pub planning: Planning,
}

/// Reads the museum.
pub fn museum() -> Museum {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../maps/museum");
    Museum {
        site: Arc::new(
            Site::read(folder.join("map.geojson")).expect("the museum's map is in order"),
        ),
        area: maps::read_level(&folder, "area").expect("the area level is in order"),
        node: maps::read_level(&folder, "node").expect("the node level is in order"),
        planning: Planning::default(),
    }
}

impl Museum {
    /// A parent for a robot that stands at `start`.
    pub fn parent(&self, start: &str) -> Configuration {
        self.parent_of(start, BTreeMap::new())
    }

    /// A parent with a child agent for each of some areas.
    pub fn parent_of(&self, start: &str, wings: BTreeMap<Symbol, Symbol>) -> Configuration {
        parent_agent::configuration(&self.site, &self.area, start, "child", wings, 1)
            .expect("the tests start from nodes of the museum")
    }

    /// A child of that name, for a robot that stands at `start`.
    pub fn child(&self, start: &str, name: &str, executor: &str) -> Configuration {
        child_agent::configuration(&self.site, &self.node, start, executor, name, 1)
            .expect("the tests start from nodes of the museum")
    }

    /// A robot that stands at `start`.
    pub fn robot(&self, start: &str, faults: Faults) -> SimulatedRobot {
        self.robot_of(&self.node, start, faults)
    }

    /// A robot that does the actions of another level.
    pub fn robot_of(&self, level: &Level, start: &str, faults: Faults) -> SimulatedRobot {
        SimulatedRobot::new(
            &level.domain,
            &level.model,
            Floor::try_from(&*self.site).expect("the museum is a floor"),
            MoverSpec::default(),
            Place::at(start),
            faults,
        )
        .expect("the museum is a floor")
    }

    /// Parent, child and robot, with everything as in the product.
    pub fn stack(&self, start: &str) -> Stack {
        self.stack_with(start, Wire::steady(), Faults::none(), |_| {})
    }

    /// As the paper's tables have it: nothing that runs is kept for an emergency (decision 8 off).
    pub fn stack_as_in_the_paper(&self, start: &str) -> Stack {
        self.stack_with(start, Wire::steady(), Faults::none(), |configuration| {
            configuration.policy.keep_what_helps = false;
        })
    }

    /// Parent, child and robot.
    pub fn stack_with(
        &self,
        start: &str,
        wire: Wire,
        faults: Faults,
        change: impl Fn(&mut Configuration),
    ) -> Stack {
        let mut stack = Stack::new(wire);
        let mut parent = self.parent(start);
        let mut child = self.child(start, "child", "executor");
        change(&mut parent);
        change(&mut child);
        stack.add_agent(self.agent(parent), &["child"]);
        stack.add_agent(self.agent(child), &["executor"]);
        stack.add_robot("executor", self.robot(start, faults));
        stack
    }

    /// An agent that plans as the museum says.
    pub fn agent(&self, configuration: Configuration) -> Agent<TestPlanner> {
        agent_planning(configuration, self.planning, Settings::default())
    }
}

/// An agent with the planner that agents have.
pub fn agent(configuration: Configuration) -> Agent<TestPlanner> {
    agent_planning(configuration, Planning::default(), Settings::default())
}

/// An agent that plans in that way.
pub fn agent_planning(
    configuration: Configuration,
    planning: Planning,
    settings: Settings,
) -> Agent<TestPlanner> {
    Agent::new(configuration, TestPlanner::new(planning, settings))
}
