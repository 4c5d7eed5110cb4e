//! The superior: a real agent, in a domain of one action that can be suspended.

use std::sync::Arc;

use agent_core::agent::{Agent, Configuration, Executors, Policy};
use agent_core::language::{parse_domain, parse_parameter, parse_pattern, parse_tasks};
use agent_core::model::{ActionModel, Effect, ExecutionModel, Map, Suspension, Symbol};
use agent_core::planner::{NaivePlanner, Settings};
use agent_core::protocol::{GoalId, GoalRequest, Urgency};

const DOMAIN: &str = "
(define (domain deeds)
  (:requirements :typing :hierarchy)
  (:types thing - object)
  (:predicates (done ?x - thing))
  (:task do :parameters (?x - thing))
  (:method doing :parameters (?x - thing) :task (do ?x) :ordered-subtasks (work ?x))
  (:action work :parameters (?x - thing) :effect (done ?x))
  (:action resume-work :parameters (?x - thing) :effect (done ?x)))
";

/// The superior.
pub type Boss = Agent<NaivePlanner>;

/// Makes superiors.
#[derive(Clone, Debug)]
pub struct Bosses {
    configuration: Configuration,
}

impl Bosses {
    /// With that many things to do.
    pub fn new(goals: usize) -> Self {
        let domain = parse_domain(DOMAIN).expect("the domain is right");
        let x = parse_parameter("?x - thing").expect("a parameter");
        let resume = parse_pattern("(resume-work ?x)", &[x]).expect("a pattern");
        let mut model = ExecutionModel::default();
        let work = ActionModel {
            repeatable: false,
            suspension: Some(Suspension {
                effect: Effect::default(),
                resume,
                rollback: None,
                reach: None,
            }),
            ..ActionModel::default()
        };
        model.actions.insert("work".into(), work);
        let mut map = Map::default();
        for number in 0..goals {
            map.objects.insert(goal(number), "thing".into());
        }
        Self {
            configuration: Configuration {
                name: "boss".into(),
                epoch: 1,
                domain: Arc::new(domain),
                model: Arc::new(model),
                map,
                maps_below: Arc::new(()),
                facts: Vec::new(),
                executors: Executors::one("arm"),
                policy: Policy::default(),
            },
        }
    }

    /// One that starts in that epoch.
    pub fn make(&self, epoch: u64) -> Boss {
        let planner = NaivePlanner::new(Settings::default());
        let configuration = Configuration {
            epoch,
            ..self.configuration.clone()
        };
        Agent::new(configuration, planner)
    }
}

/// The name of a goal and of what is to be done for it.
pub fn goal(number: usize) -> GoalId {
    Symbol::from(format!("g{number}"))
}

/// The first goal is a normal one, the others are emergencies.
pub fn request(number: usize) -> GoalRequest {
    let tasks = parse_tasks(&format!("(do {})", goal(number)));
    GoalRequest {
        id: Some(goal(number)),
        tasks: tasks.expect("a task"),
        urgency: match number {
            0 => Urgency::Normal,
            _ => Urgency::Emergency,
        },
        priority: 0,
        deadline: None,
    }
}

/// Whether it has accepted that goal and knows of it.
pub fn knows(boss: &Boss, id: &GoalId) -> bool {
    let running = boss.running().is_some_and(|running| running.goal.id == *id);
    let stacked = boss.stack().entries().iter();
    running
        || stacked
            .map(|entry| &entry.intention)
            .any(|it| it.goal.id == *id)
        || boss
            .waiting()
            .intentions()
            .iter()
            .any(|it| it.goal.id == *id)
        || boss.aside().goals().iter().any(|(it, _)| it.goal.id == *id)
        || boss.ended_goal(id).is_some()
}
