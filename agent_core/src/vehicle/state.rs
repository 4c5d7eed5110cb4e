//! What the state service wants done, and what it is told.

use super::{Mind, Vehicle};
use crate::model::{FactChange, Symbol, Task};
use crate::planner::Planner;
use crate::protocol::{Happening, Input, Output};
use crate::service::StateOutput;

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// Does what the state service wants done. Returns whether that was anything.
    pub(super) fn serve_states(&mut self) -> bool {
        let mut any = false;
        while let Some(output) = self.states.poll_output() {
            any = true;
            match output {
                StateOutput::Say(message) => self.outputs.push_back(Output::Local(message)),
                StateOutput::Learn { by, changes } => self.learn(by, changes),
                StateOutput::Asked { facts, .. } => self.find_out(&facts),
            }
        }
        any
    }

    /// What another has seen is seen, as far as the agent is concerned: what it does may hang on it.
    fn learn(&mut self, by: Symbol, changes: Vec<FactChange>) {
        let belief = self.mind.belief();
        let news: Vec<FactChange> = changes
            .into_iter()
            .filter(|change| match change {
                FactChange::Add(fact) => !belief.holds(fact),
                FactChange::Remove(fact) => belief.holds(fact),
                FactChange::Set(..) => false,
            })
            .collect();
        if news.is_empty() {
            return;
        }
        let changes = news.clone();
        self.emit(None, Happening::FactsTold { by, changes });
        self.learning = true;
        self.tell_mind(Input::Observation(news));
        self.look_at_the_belief();
        self.learning = false;
    }

    pub(super) fn look_at_the_belief(&mut self) {
        if std::mem::take(&mut self.believes_otherwise) {
            self.look_what_has_come_up();
        }
    }

    /// A vehicle is gone. Of those that are left the first by name says what it had with it.
    pub(super) fn vehicle_lost(&mut self, name: &Symbol) {
        let earlier = |other: &Symbol| other < &self.name && other != name;
        if self.tasks.vehicles().any(earlier) {
            return;
        }
        let held = self.states.about(name);
        let heard = self.tasks.heard_of().values();
        let given = heard.flat_map(|heard| &heard.tasks.awards);
        let given = given.filter(|award| award.to == *name);
        let own = self.tasks.given_to(name);
        let own = own.map(|published| &published.new.what);
        let tasks: Vec<Task> = given.map(|award| &award.what).chain(own).cloned().collect();
        let name = name.clone();
        self.emit(None, Happening::VehicleLost { name, held, tasks });
    }
}
