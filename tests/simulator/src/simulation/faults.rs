//! What goes wrong.

use agent_core::language::parse_fact_change;
use agent_core::model::Time;
use executor_sim::Faults;

use crate::scenario::{EVERYONE, Point, Scenario, What, Who};
use crate::wire::Message;

use super::{Cut, Due, Simulation};

impl Simulation<'_> {
    pub(super) fn happening(&mut self, what: What) {
        if self.peace {
            return;
        }
        if let Some(fault) = what.fault() {
            self.count(fault);
            self.law.trouble(self.now + what.lasts());
        }
        self.tell(|| format!("--------- {what:?}"));
        let now = self.now;
        match what {
            What::Goal { goal, .. } => self.request(goal, None, true),
            What::Again { goal } => self.request(goal, None, false),
            What::Wish { wish, goal } => self.request(goal, Some(wish), false),
            What::Door { door, open } => self.door(door, open),
            What::Weather {
                lasts,
                lost,
                twice,
                late,
            } => self.weather.push((now + lasts, lost, twice, late)),
            What::Cut { one, other, lasts } => {
                self.cuts.push(Cut {
                    one,
                    other,
                    since: now,
                    until: now + lasts,
                });
                self.look_later(one, other);
                self.look_later(other, one);
                // And when it is over.
                self.after(
                    Time(lasts.0 + 5_000),
                    Due::Look {
                        observer: one,
                        subject: other,
                    },
                );
                self.after(
                    Time(lasts.0 + 5_000),
                    Due::Look {
                        observer: other,
                        subject: one,
                    },
                );
            }
            What::Crash { who, point, down } => match point {
                Point::Now => self.crash(who, false, down),
                _ => {
                    self.armings += 1;
                    let armed = self.armings;
                    self.nodes[who.index()].armed = Some((armed, point, down));
                    self.after(Time::from_secs(10.0), Due::CrashAtLast { who, armed });
                }
            },
            What::Freeze { who, lasts } => {
                if self.nodes[who.index()].role.is_some() {
                    self.nodes[who.index()].frozen = Some((now, now + lasts));
                    self.after(lasts, Due::Thaw { who });
                    for other in EVERYONE {
                        self.look_later(other, who);
                    }
                }
            }
            What::FullDisk { who, lasts } => {
                let node = &mut self.nodes[who.index()];
                node.full_until = node.full_until.max(now + lasts);
            }
            What::SlowDisk { who, lasts, takes } => {
                self.nodes[who.index()].slow = Some((now + lasts, takes));
            }
            What::LostJournal { who, down } => {
                self.crash(who, false, down);
                self.nodes[who.index()].store.lose();
                self.law.memory_lost = true;
                self.law.goals_lost |= who == Who::Parent;
            }
            What::Robot { .. } => {}
        }
    }

    pub(super) fn door(&mut self, door: &str, open: bool) {
        let fact = format!("(open {door})");
        let text = if open { fact } else { format!("(not {fact})") };
        let Ok(change) = parse_fact_change(&text) else {
            return;
        };
        for who in EVERYONE {
            if who != Who::User {
                self.send(Who::User, who, Message::Door(change.clone()));
            }
        }
    }
}

pub(super) fn faults(scenario: &Scenario) -> Faults {
    let list = scenario.happenings.iter();
    Faults::list(list.filter_map(|(_, what)| match what {
        What::Robot { action, fault } => Some((*action, *fault)),
        _ => None,
    }))
}

#[cfg(test)]
mod tests {
    use executor_sim::Fault;

    use super::*;

    #[test]
    fn the_robots_faults_are_those_of_the_scenario() {
        let fault = Fault::RefusedSuspension;
        let mut scenario = Scenario::of(1);
        scenario.happenings = vec![(Time::ZERO, What::Robot { action: 2, fault })];
        let mut faults = faults(&scenario);
        assert_eq!(faults.next_action(), None);
        assert_eq!(faults.next_action(), Some(fault));
    }
}
