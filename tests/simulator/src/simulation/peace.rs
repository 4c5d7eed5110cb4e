//! When nothing goes wrong any more, everything comes to its end.

use agent_core::model::{Symbol, Time};

use crate::ground::DOORS;
use crate::process::Role;
use crate::scenario::{Who, Wish};

use super::{Due, Simulation};

impl Simulation<'_> {
    /// Nothing goes wrong any more, and nothing is in anybody's way.
    pub(super) fn make_peace(&mut self) {
        let first = !self.peace;
        self.peace = true;
        self.weather.clear();
        self.tell(|| "--------- nothing goes wrong any more".to_owned());
        for who in self.roles() {
            let node = &mut self.nodes[who.index()];
            node.armed = None;
            node.full_until = Time::ZERO;
            node.slow = None;
            if let Some((_, until)) = &mut node.frozen {
                *until = self.now;
                self.thaw(who);
            }
            self.after(Time::ZERO, Due::Start { who });
        }
        let cuts = std::mem::take(&mut self.cuts);
        for cut in cuts {
            self.look_soon(cut.one, cut.other);
            self.look_soon(cut.other, cut.one);
        }
        if first {
            // Once everybody is there.
            self.after(Time::from_secs(10.0), Due::Peace);
            return;
        }
        for door in DOORS {
            self.door(door, true);
        }
        for goal in 0..self.goals.len() {
            if self.requests.iter().any(|request| request.goal == goal) {
                self.request(goal, Some(Wish::Resume), true);
            }
        }
    }

    /// All is quiet: nothing is left.
    pub(super) fn judge(&mut self) {
        let line = self.nodes[Who::Parent.index()]
            .role
            .as_ref()
            .map_or(0, Role::line);
        let tasks: Vec<(Symbol, String)> = self
            .goals
            .iter()
            .map(|(id, task, _)| (id.clone(), task.clone()))
            .collect();
        self.law.at_the_end(self.now, &tasks, line);
        for who in self.roles() {
            let node = &self.nodes[who.index()];
            let Some(role) = &node.role else {
                self.broken(|| format!("{who} was not started again"));
                continue;
            };
            let waiting: usize = node.channels.iter().map(|c| c.queue.len()).sum();
            if role.held() > 0 || waiting > 0 {
                let held = role.held();
                self.broken(|| {
                    format!("L3: {who} holds {held} effect(s), {waiting} message(s) wait")
                });
                continue;
            }
            if let Some(agent) = role.as_agent() {
                let left: usize = agent.counts().values().sum();
                if left > 0 {
                    let counts = format!("{:?}", agent.counts());
                    self.broken(|| format!("L3: something is left at {who}: {counts}"));
                }
            }
        }
        if !self.world.stands() {
            self.broken(|| "the robot has not come to rest".to_owned());
        }
    }
}
