//! Superiors and world come, go, and lose their memories.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Event, Happening, Output};

use super::Controller;
use crate::WORLD;
use crate::memory::Record;

impl Controller {
    /// A superior or the world has appeared or vanished.
    pub(super) fn neighbour(&mut self, now: Time, name: Symbol, there: bool) {
        self.unseen.take_if(|superior| *superior == name);
        let news = if there {
            self.gone.remove(&name)
        } else {
            self.gone.insert(name.clone())
        };
        if news {
            self.changed(now, name, there);
        }
        self.begin_what_waits(now);
    }

    fn changed(&mut self, now: Time, name: Symbol, there: bool) {
        if !there {
            // Who cannot be stopped must not move. What cannot be stopped runs to its end.
            if self.is_superior_of_active(&name) {
                let _ = self.try_to_stop(now);
            }
        }
        let what = if there {
            Happening::NeighbourBack { name }
        } else {
            Happening::NeighbourLost { name }
        };
        self.outputs.push_back(Output::Event(Event {
            at: now,
            goal: None,
            stack_depth: self.memory.depth(),
            what,
        }));
    }

    /// A superior or the world has lost its memory.
    pub(super) fn reborn(&mut self, now: Time, name: &Symbol) {
        if name == WORLD {
            self.world_reborn();
            return;
        }
        for record in self.memory.forget(name) {
            let (id, action) = (record.id.clone(), record.action.clone());
            self.event(now, &record, Happening::RecordCleared { id, action });
        }
        self.waiting
            .take_if(|waiting| waiting.job.superior == *name);
        if self.is_superior_of_active(name) {
            let _ = self.try_to_stop(now);
            if let Some(active) = &mut self.active {
                active.begun.disowned = true;
            }
        }
    }

    fn is_superior_of_active(&self, name: &Symbol) -> bool {
        let active = self.active.as_ref();
        active.is_some_and(|active| active.begun.job.superior == *name)
    }

    /// What nobody knows of any more is over; where the robot stands is news to all.
    pub(super) fn drop_disowned(&mut self, job: &Record) {
        let mut facts = Vec::new();
        if self.stands() {
            facts = self.surroundings.tell(job.rest.arc());
        }
        if !facts.is_empty() {
            self.outputs.push_back(Output::Observed {
                facts,
                reported_to: None,
            });
        }
    }
}
