//! Playing a story to a robot.

use std::collections::BTreeSet;

use agent_core::model::{Fact, FactChange, Symbol, Time};
use agent_core::protocol::{Event, GoalId, Happening};
use agent_link::{Client, Clock};
use tokio::sync::mpsc;

use super::{Scenario, ScenarioEvent, What, When};
use crate::snapshot::{Snapshot, Spot};

/// Nearer to either end than this share of the arc, a robot may be about to stop there anyway.
const WELL_ON: std::ops::Range<f64> = 0.35..0.75;

/// On a busy machine at high speed a robot may cross an arc between two pictures. So long after it
/// has been sent along it, it has turned towards it and set off.
const SETTING_OFF: Time = Time(4_500_000);

/// So long after an action has begun it is in full swing.
const IN_FULL_SWING: Time = Time(3_000_000);

/// So long after somebody has learnt something, all have, and the action that has brought it about has ended.
const ALL_KNOW: Time = Time(500_000);

/// What a story has come to.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Told {
    /// Something is said, or happens.
    Said(ScenarioEvent),
    /// The robot does not want it, in its words.
    Refused(ScenarioEvent, String),
}

/// Plays a story: one event after the other, each when its time has come.
///
/// The robot's answers are waited for elsewhere, so that whoever shows what happens goes on.
#[derive(Debug)]
pub(crate) struct Player {
    events: std::vec::IntoIter<ScenarioEvent>,
    next: Option<ScenarioEvent>,
    ready: Time,
    /// When the next event is due, if what it waits for has come: a robot that was sent along an arc is
    /// well on it by then.
    due_at: Option<Time>,
    /// What somebody has learnt so far, and nobody that it is no longer so.
    learnt: BTreeSet<Fact>,
    /// The goals that have not ended.
    open: BTreeSet<GoalId>,
    /// Goals of any vehicle that were accepted and have not ended, whoever gave them.
    at_work: BTreeSet<(Symbol, GoalId)>,
    /// Whoever takes goals, where that is not a parent.
    vehicles: BTreeSet<Symbol>,
    failed: Vec<String>,
    deeds: mpsc::UnboundedSender<ScenarioEvent>,
    refusals: mpsc::UnboundedReceiver<(ScenarioEvent, String)>,
}

impl Player {
    /// Begins to play to a robot, or to these vehicles, which are ready now.
    pub(crate) fn new(
        scenario: Scenario,
        client: Client,
        ready: Time,
        vehicles: BTreeSet<Symbol>,
    ) -> Self {
        let (deeds, mut to_do) = mpsc::unbounded_channel::<ScenarioEvent>();
        let (refuse, refusals) = mpsc::unbounded_channel();
        tokio::spawn(async move {
            while let Some(event) = to_do.recv().await {
                if let Err(reason) = do_it(&client, &event).await {
                    // Nobody listens once the story is over.
                    let _ = refuse.send((event, reason));
                }
            }
        });
        let open = scenario.goals().cloned().collect();
        let mut events = scenario.events.into_iter();
        Self {
            next: events.next(),
            events,
            ready,
            due_at: None,
            learnt: BTreeSet::new(),
            at_work: BTreeSet::new(),
            open,
            vehicles,
            failed: Vec::new(),
            deeds,
            refusals,
        }
    }

    /// What the story comes to next by the clock, or by what the robot says to it.
    pub(crate) async fn next(&mut self, clock: &Clock) -> Told {
        let due = match self.next.as_ref().map(|event| &event.when) {
            Some(When::Next) => Some(Time::ZERO),
            Some(When::At(at)) => Some(self.ready + *at),
            Some(When::WhileOn(_) | When::WhileDoing { .. } | When::Once(_)) => self.due_at,
            None => None,
        };
        let due = async {
            match due {
                Some(at) => clock.sleep_until(at).await,
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            biased;
            Some((event, reason)) = self.refusals.recv() => self.refused(event, reason),
            () = due => match self.go_on() {
                Some(told) => told,
                // What is due is there.
                None => std::future::pending().await,
            },
        }
    }

    /// The robot was seen.
    pub(crate) fn saw(&mut self, snapshot: &Snapshot) -> Option<Told> {
        let When::WhileOn(wanted) = &self.next.as_ref()?.when else {
            return None;
        };
        match &snapshot.spot {
            Spot::Arc { arc, fraction, .. } if arc == wanted && WELL_ON.contains(fraction) => {
                self.go_on()
            }
            _ => None,
        }
    }

    fn go_on(&mut self) -> Option<Told> {
        let event = std::mem::replace(&mut self.next, self.events.next())?;
        self.due_at = match self.next.as_ref().map(|next| &next.when) {
            // It was learnt before anything waited for it.
            Some(When::Once(fact)) if self.learnt.contains(fact) => Some(Time::ZERO),
            _ => None,
        };
        // The task lives as long as this.
        let _ = self.deeds.send(event.clone());
        Some(Told::Said(event))
    }

    fn refused(&mut self, event: ScenarioEvent, reason: String) -> Told {
        if let Some(What::Goal { request, .. }) = &event.what
            && let Some(id) = &request.id
        {
            self.open.remove(id);
        }
        self.failed.push(format!("line {}: {reason}", event.line));
        Told::Refused(event, reason)
    }

    /// An agent has told something.
    pub(crate) fn heard(&mut self, agent: &Symbol, event: &Event) {
        if let Happening::BeliefChanged { changes } = &event.what {
            self.learn(changes);
        }
        if let Some(due_at) = self
            .next
            .as_ref()
            .and_then(|next| is_due(&next.when, agent, event))
        {
            self.due_at = Some(due_at);
        }
        let Some(goal) = event.goal.as_ref().filter(|_| self.takes_goals(agent)) else {
            return;
        };
        let key = (agent.clone(), goal.clone());
        match &event.what {
            Happening::GoalAccepted { .. } => {
                self.at_work.insert(key);
            }
            Happening::GoalSucceeded
            | Happening::GoalFailed { .. }
            | Happening::GoalUnknown { .. } => {
                self.at_work.remove(&key);
            }
            _ => {}
        }
        match &event.what {
            Happening::GoalSucceeded => {
                self.open.remove(goal);
            }
            Happening::GoalFailed { reason } | Happening::GoalUnknown { reason }
                if self.open.remove(goal) =>
            {
                self.failed.push(format!("goal {goal} failed: {reason}"));
            }
            _ => {}
        }
    }

    fn learn(&mut self, changes: &[FactChange]) {
        for change in changes {
            match change {
                FactChange::Add(fact) => {
                    self.learnt.insert(fact.clone());
                }
                FactChange::Remove(fact) => {
                    self.learnt.remove(fact);
                }
                FactChange::Set(..) => {}
            }
        }
    }

    /// Whether goals that a user gives are this agent's.
    fn takes_goals(&self, agent: &Symbol) -> bool {
        *agent == parent_agent::NAME || self.vehicles.contains(agent)
    }

    /// Whether every goal of the story that was begun has ended, and nothing more comes by itself.
    ///
    /// An event that waits for the robot to be on some arc does not come any more when the robot
    /// has nothing left to do; that counts as a failure.
    pub(crate) fn is_over(&mut self) -> bool {
        let to_come: BTreeSet<&GoalId> = self
            .next
            .iter()
            .chain(self.events.as_slice())
            .filter_map(|event| match &event.what {
                Some(What::Goal { request, .. }) => request.id.as_ref(),
                _ => None,
            })
            .collect();
        if self.open.iter().any(|goal| !to_come.contains(goal)) {
            return false;
        }
        match &self.next {
            None => true,
            Some(event) => match &event.when {
                When::WhileOn(arc) => {
                    self.failed.push(format!(
                        "line {}: the robot was never seen well on {arc}",
                        event.line
                    ));
                    true
                }
                // Others may bring it about.
                When::Next | When::At(_) | When::WhileDoing { .. } | When::Once(_) => false,
            },
        }
    }

    /// Whether somebody still has something to do, though the story may be over.
    pub(crate) fn is_at_work(&self) -> bool {
        !self.at_work.is_empty()
    }

    /// What went otherwise than it should.
    pub(crate) fn failed(&self) -> &[String] {
        &self.failed
    }
}

/// When what an event waits for is due, now that this was heard.
fn is_due(when: &When, agent: &Symbol, event: &Event) -> Option<Time> {
    match (when, &event.what) {
        (
            When::WhileOn(arc),
            Happening::ActionStarted { action, .. } | Happening::ActionResumed { action, .. },
        ) if *agent == executor_sim::program::EXECUTOR && action.args.contains(arc) => {
            Some(event.at + SETTING_OFF)
        }
        (
            When::WhileDoing {
                agent: wanted,
                action: name,
            },
            Happening::ActionStarted { action, .. } | Happening::ActionResumed { action, .. },
        ) if agent == wanted && action.name == *name => Some(event.at + IN_FULL_SWING),
        (When::Once(fact), Happening::BeliefChanged { changes })
            if changes.contains(&FactChange::Add(fact.clone())) =>
        {
            Some(event.at + ALL_KNOW)
        }
        _ => None,
    }
}

/// Has the robot told. In its words why not, if it does not want that.
async fn do_it(client: &Client, event: &ScenarioEvent) -> Result<(), String> {
    let words = |error: agent_link::ClientError| error.to_string();
    let (accepted, reason) = match &event.what {
        None => return Ok(()),
        Some(What::Goal { request, to }) => {
            let request = request.clone();
            let verdict = match to {
                Some(vehicle) => client.goal_to(vehicle.as_str(), request).await,
                None => client.goal(request).await,
            };
            let verdict = verdict.map_err(words)?;
            (verdict.accepted, verdict.reason)
        }
        Some(What::Command(command)) => {
            let verdict = client.command(command).await.map_err(words)?;
            (verdict.accepted, verdict.reason)
        }
        Some(What::Fact(fact)) => {
            let verdict = client.facts(&fact.to_string()).await.map_err(words)?;
            (verdict.accepted, verdict.reason)
        }
    };
    if accepted {
        Ok(())
    } else {
        Err(reason.unwrap_or_else(|| "refused without a reason".to_owned()))
    }
}
