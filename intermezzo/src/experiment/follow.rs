//! What a robot that is interrupted does, told from its events.

use agent_core::model::{Action, Atom, Symbol, Time};
use agent_core::protocol::{Event, GoalId, GoalRequest, Happening, Urgency};
use executor_sim::Motion;
use maps::Site;

use super::stamps::Stamps;
use crate::robot::RoleKind;

/// A robot on a tour that is interrupted now and then, as far as its events tell.
#[derive(Debug, Default)]
pub(super) struct Followed {
    /// The goal that is interrupted; `None` once it has ended.
    pub(super) tour: Option<GoalId>,
    /// What its controller does.
    pub(super) doing: Option<Doing>,
    interruption: Option<Interruption>,
}

/// An action of a controller.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Doing {
    /// Which.
    pub(super) action: Action,
    /// When it has begun, on the world's clock.
    pub(super) since: Time,
}

/// How an interruption went.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ending {
    /// What the robot did was broken off.
    Broken(Stamps),
    /// It had ended when it was to be broken off.
    TooLate,
    /// It served the emergency, too, and went on (decision 8).
    Kept,
}

/// An emergency that was put.
#[derive(Debug)]
struct Interruption {
    id: GoalId,
    stamps: Stamps,
    /// When work on the emergency began.
    started: Option<Time>,
    /// When the action ended by itself.
    finished: Option<Time>,
    /// The robot has refused it, in its words.
    rejected: Option<String>,
}

impl Followed {
    /// An emergency of that name is put at that time.
    pub(super) fn interrupted(&mut self, id: GoalId, put: Time) {
        self.interruption = Some(Interruption {
            id,
            stamps: Stamps {
                put,
                ..Stamps::default()
            },
            started: None,
            finished: None,
            rejected: None,
        });
    }

    /// Whether an interruption has not come to its end.
    pub(super) fn is_interrupted(&self) -> bool {
        self.interruption.is_some()
    }

    /// Whether something is done for the emergency, so that it may be cancelled.
    pub(super) fn has_begun(&self) -> bool {
        let begun =
            |one: &Interruption| one.stamps.first_action.is_some() || one.finished.is_some();
        self.interruption.as_ref().is_some_and(begun)
    }

    /// Why the emergency was refused, if it was.
    pub(super) fn rejected(&self) -> Option<&str> {
        self.interruption.as_ref()?.rejected.as_deref()
    }

    /// How the interruption went, once it is over: what was interrupted goes on, or has ended.
    pub(super) fn ended(&mut self, site: &Site) -> Option<Ending> {
        let interruption = self.interruption.as_mut()?;
        let ended = interruption.stamps.ended?;
        let again = self.doing.as_ref().filter(|doing| doing.since > ended);
        let drives = again.filter(|doing| drive(site, &doing.action).is_some());
        interruption.stamps.resumed = drives.map(|doing| doing.since);
        if drives.is_none() && self.tour.is_some() {
            return None;
        }
        let over = self.interruption.take()?;
        let before_it_started = |at: Option<Time>| {
            at.is_some_and(|at| over.started.is_none_or(|started| at <= started))
        };
        // What is stopped later is stopped for another reason.
        Some(if before_it_started(over.stamps.braking) {
            Ending::Broken(over.stamps)
        } else if before_it_started(over.finished) {
            Ending::TooLate
        } else {
            Ending::Kept
        })
    }

    /// The body was seen, at that time, to do this since then.
    pub(super) fn seen(&mut self, motion: Motion, since: Time, at: Time) {
        let Some(Interruption { stamps, .. }) = &mut self.interruption else {
            return;
        };
        // A picture that is late changes nothing.
        if since <= stamps.put {
            return;
        }
        match motion {
            Motion::Braking if stamps.motors.is_none() => {
                stamps.motors = Some(since);
                stamps.seen = Some(at);
            }
            // Who has only turned so far stands at once.
            Motion::Still if stamps.still.is_none() => {
                stamps.motors.get_or_insert(since);
                stamps.seen.get_or_insert(at);
                stamps.still = Some(since);
            }
            _ => {}
        }
    }

    /// An agent has told that.
    pub(super) fn heard(&mut self, agent: &Symbol, event: &Event) {
        if *agent == RoleKind::Executor.name() {
            self.of_controller(event);
        } else if *agent == RoleKind::Parent.name() {
            self.of_parent(event);
        }
    }

    fn of_controller(&mut self, event: &Event) {
        let at = event.at;
        let during = self.interruption.as_mut().filter(|one| at > one.stamps.put);
        match &event.what {
            Happening::ActionStarted { action, .. } | Happening::ActionResumed { action, .. } => {
                let (action, since) = (action.clone(), at);
                self.doing = Some(Doing { action, since });
                if let Some(Interruption { stamps, .. }) = during
                    && stamps.braking.is_some()
                {
                    stamps.first_action.get_or_insert(at);
                }
            }
            Happening::ActionStopping { .. } => {
                if let Some(Interruption { stamps, .. }) = during {
                    stamps.braking.get_or_insert(at);
                }
            }
            Happening::ActionSuspended { .. } => self.doing = None,
            Happening::ActionFinished { .. } => {
                self.doing = None;
                if let Some(one) = during
                    && one.stamps.braking.is_none()
                {
                    one.finished.get_or_insert(at);
                }
            }
            _ => {}
        }
    }

    fn of_parent(&mut self, event: &Event) {
        let over = matches!(
            event.what,
            Happening::GoalSucceeded | Happening::GoalFailed { .. }
        );
        if over && self.tour.is_some() && event.goal == self.tour {
            self.tour = None;
        }
        let Some(interruption) = &mut self.interruption else {
            return;
        };
        if event.goal.as_ref() != Some(&interruption.id) {
            return;
        }
        if event.what == Happening::GoalStarted {
            interruption.started = Some(event.at);
        }
        if over {
            interruption.stamps.ended = Some(event.at);
        }
        if let Happening::GoalRejected { reason } = &event.what {
            interruption.rejected = Some(reason.clone());
        }
    }
}

/// If that action of a controller is a drive: where its arc begins, and how long that is, in metres.
pub(super) fn drive(site: &Site, action: &Action) -> Option<(Symbol, f64)> {
    let args = || action.args.iter();
    let passage = args().find_map(|arg| site.passage(arg.as_str()))?;
    // Of the nodes among its arguments, the last is where it goes.
    let to = args().rfind(|arg| site.node(arg.as_str()).is_some())?;
    let from = passage.other_end(to.as_str())?;
    Some((from.clone(), passage.length_m()))
}

/// A goal to go there.
pub(super) fn going(id: &GoalId, urgency: Urgency, to: &Symbol) -> GoalRequest {
    GoalRequest {
        id: Some(id.clone()),
        tasks: vec![Atom {
            name: "go".into(),
            args: vec![to.clone()],
        }],
        urgency,
        priority: 0,
        deadline: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use agent_core::protocol::ActionId;
    use maps::Place;

    fn event(at_s: f64, goal: &str, what: Happening) -> Event {
        Event {
            at: Time::from_secs(at_s),
            goal: Some(goal.into()),
            stack_depth: 0,
            what,
        }
    }

    /// A controller's event about a drive, by the name of what has happened.
    fn drives(at_s: f64, what: &str) -> Event {
        let id = ActionId {
            agent: "child".into(),
            epoch: 1,
            number: 1,
        };
        let place = Place::museum();
        let passage = place.site().passages().next().unwrap();
        let [from, to] = passage.ends();
        let action = Atom {
            name: "move".into(),
            args: vec![from.clone(), to.clone(), passage.name().clone()],
        };
        let what = match what {
            "started" => Happening::ActionStarted { id, action },
            "stopping" => Happening::ActionStopping { id, action },
            "suspended" => Happening::ActionSuspended { id, action },
            _ => Happening::ActionFinished {
                id,
                action,
                failure: None,
            },
        };
        event(at_s, "child-1-1", what)
    }

    fn after(told: &[(&str, Event)]) -> Option<Ending> {
        let mut robot = Followed {
            tour: Some("tour".into()),
            ..Followed::default()
        };
        robot.interrupted("e".into(), Time::from_secs(1.0));
        for (agent, event) in told {
            robot.heard(&Symbol::from(*agent), event);
        }
        robot.ended(Place::museum().site())
    }

    #[test]
    fn an_interruption_is_over_when_the_tour_goes_on() {
        let succeeded = || event(5.0, "e", Happening::GoalSucceeded);
        let mut told = vec![
            ("executor", drives(0.5, "started")),
            ("executor", drives(1.2, "stopping")),
            ("executor", drives(2.0, "suspended")),
            ("executor", drives(2.5, "started")),
            ("executor", drives(4.5, "finished")),
            ("parent", succeeded()),
        ];
        assert_eq!(after(&told), None);
        told.push(("executor", drives(5.5, "started")));
        let at = |s| Some(Time::from_secs(s));
        let stamps = Stamps {
            put: Time::from_secs(1.0),
            braking: at(1.2),
            first_action: at(2.5),
            ended: at(5.0),
            resumed: at(5.5),
            ..Stamps::default()
        };
        assert_eq!(after(&told), Some(Ending::Broken(stamps)));
        // Whichever is heard of first.
        told.swap(5, 6);
        assert_eq!(after(&told), Some(Ending::Broken(stamps)));
    }

    #[test]
    fn a_drive_that_ends_by_itself_was_not_broken_off() {
        let ended = [
            ("executor", drives(1.1, "finished")),
            ("parent", event(5.0, "e", Happening::GoalSucceeded)),
            ("executor", drives(5.5, "started")),
        ];
        assert_eq!(after(&ended), Some(Ending::TooLate));
        assert_eq!(after(&ended[1..]), Some(Ending::Kept));
    }

    #[test]
    fn what_goes_on_for_the_emergency_was_not_broken_off_when_that_is_stopped_later() {
        let told = [
            ("parent", event(1.01, "e", Happening::GoalStarted)),
            ("executor", drives(3.0, "finished")),
            ("executor", drives(3.1, "started")),
            ("executor", drives(4.0, "stopping")),
            ("parent", event(5.0, "e", Happening::GoalSucceeded)),
            ("executor", drives(5.5, "started")),
        ];
        assert_eq!(after(&told), Some(Ending::Kept));
    }

    #[test]
    fn what_was_before_the_emergency_is_no_part_of_it() {
        let ended = [
            ("executor", drives(0.9, "stopping")),
            ("parent", event(5.0, "e", Happening::GoalSucceeded)),
            ("executor", drives(5.5, "started")),
        ];
        assert_eq!(after(&ended), Some(Ending::Kept));
    }

    #[test]
    fn every_drive_of_the_museum_begins_somewhere() {
        let place = Place::museum();
        for passage in place.site().passages() {
            let [from, to] = passage.ends().map(Clone::clone);
            let leave = Atom {
                name: "leave".into(),
                args: vec![passage.name().clone(), to],
            };
            let begun = drive(place.site(), &leave);
            assert_eq!(begun, Some((from, passage.length_m())));
        }
        let speech = Atom {
            name: "narrate".into(),
            args: vec!["n1".into()],
        };
        assert_eq!(drive(place.site(), &speech), None);
    }
}
