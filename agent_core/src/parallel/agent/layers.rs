//! Which branches get leave to act.

use super::turns::rank;
use super::{Begun, ParallelAgent, Standing, Who};
use crate::agent::{Agent, Proposal};
use crate::model::Time;
use crate::parallel::layer::{MOST, Underway, choose};
use crate::parallel::{Candidate, Footprint, Layer, Present};
use crate::planner::{Planner, Problem};
use crate::protocol::Happening;

impl<P: Planner> ParallelAgent<P> {
    /// Chooses the next layer, if all branches know what they would do next. Returns whether a branch
    /// got leave to do something.
    pub(super) fn next_layer(&mut self) -> bool {
        if self.foremost.is_busy() || self.branches.iter().any(Agent::is_planning) {
            return false;
        }
        let standing = self.standing();
        if self.considered.as_ref() == Some(&standing) {
            return false;
        }
        let granted = self.grant_some();
        self.considered = (!granted).then_some(standing);
        granted
    }

    fn standing(&self) -> Standing {
        let branches = self.branches.iter().map(|branch| match branch.proposal() {
            Some(Proposal::Plan(plan)) => (1, plan.steps.first().map(|it| it.action().clone())),
            Some(Proposal::NoPlan(_)) => (2, None),
            None => (3, branch.executing().map(|(_, action, _)| action.clone())),
        });
        Standing {
            belief: self.list.belief().fingerprint(),
            branches: branches.collect(),
        }
    }

    fn grant_some(&mut self) -> bool {
        let mut ready: Vec<(usize, Candidate)> = Vec::new();
        let mut stuck: Vec<usize> = Vec::new();
        let mut slots: Vec<usize> = (0..self.branches.len()).collect();
        slots.sort_by_key(|slot| self.branches[*slot].running().map(rank));
        let mut running: Vec<(Footprint, Time)> = Vec::new();
        for slot in slots {
            let branch = &self.branches[slot];
            let problem = branch.present();
            if let Some(step) = branch.executing_step() {
                let begun = self.underway.get(&slot);
                let begun = begun.filter(|it| it.footprint.action == *step.action());
                let footprint = begun.map(|it| it.footprint.clone());
                let footprint = footprint.unwrap_or_else(|| Footprint::of(&problem, step));
                let since = begun.map_or(Time::ZERO, |it| self.now.since(it.at));
                let left = footprint.duration.since(since);
                running.push((footprint, left));
            }
            match branch.proposal() {
                Some(Proposal::Plan(plan)) => {
                    let deadline = branch.running().and_then(|it| it.goal.deadline);
                    let candidate = Candidate::of(&problem, plan, deadline);
                    ready.extend(candidate.map(|candidate| (slot, candidate)));
                }
                Some(Proposal::NoPlan(_)) => stuck.push(slot),
                None => {}
            }
        }
        if ready.is_empty() {
            // Nobody's doing will help: the youngest gives up first.
            return match (running.as_slice(), stuck.last()) {
                ([], Some(slot)) => self.grant(*slot),
                _ => false,
            };
        }
        ready.truncate(MOST);
        let (slots, candidates): (Vec<usize>, Vec<Candidate>) = ready.into_iter().unzip();
        let left_out = slots.iter().map(|slot| self.left_out.get(slot).copied());
        let left_out: Vec<u32> = left_out.map(Option::unwrap_or_default).collect();
        let executed = self.executed.iter().map(|(_, footprint)| footprint.clone());
        let executed: Vec<Footprint> = executed.collect();
        let underway = Underway {
            running: &running,
            executed: &executed,
            left_out: &left_out,
        };
        let problem = Problem {
            forbidden: std::collections::BTreeSet::new(),
            ..self.list.present()
        };
        match choose(&Present(&problem), &candidates, underway) {
            Some(layer) => self.begin(&slots, &candidates, &running, &layer),
            // None of them can be begun as things are, and nobody is at it: whoever is asked to will say
            // why.
            None if running.is_empty() => slots.first().is_some_and(|slot| self.grant(*slot)),
            None => false,
        }
    }

    fn begin(
        &mut self,
        slots: &[usize],
        candidates: &[Candidate],
        running: &[(Footprint, Time)],
        layer: &Layer,
    ) -> bool {
        let first: Vec<usize> = layer.clique.first().collect();
        if first.is_empty() {
            return false;
        }
        self.layer += 1;
        let latest = self.executed.iter().map(|(layer, _)| *layer).max();
        self.executed.retain(|(layer, _)| Some(*layer) == latest);
        for (place, slot) in slots.iter().enumerate() {
            if first.contains(&place) {
                self.left_out.remove(slot);
            } else if !layer.clique.members.contains(&place) {
                *self.left_out.entry(*slot).or_default() += 1;
            }
        }
        if layer.clique.members.len() + running.len() > 1 {
            self.tell_of(candidates, running, layer);
        }
        for place in &first {
            let (slot, footprint) = (slots[*place], candidates[*place].footprint.clone());
            let begun = Begun {
                footprint,
                at: self.now,
                layer: self.layer,
            };
            self.underway.insert(slot, begun);
            self.grant(slot);
        }
        true
    }

    fn grant(&mut self, slot: usize) -> bool {
        let now = self.now;
        if let Some(branch) = self.branches.get_mut(slot) {
            branch.grant(now);
        }
        self.pass_on(Who::Branch(slot), None);
        true
    }

    fn tell_of(&mut self, candidates: &[Candidate], running: &[(Footprint, Time)], layer: &Layer) {
        let clique = &layer.clique;
        let action = |place: &usize| candidates[*place].footprint.action.clone();
        let beside = running.iter().map(|(footprint, _)| &footprint.action);
        let after = clique.after.iter().map(|(place, prefix)| {
            let running = prefix
                .running
                .iter()
                .map(|it| running[*it].0.action.clone());
            let members = prefix.members.iter().map(action);
            (action(place), members.chain(running).collect())
        });
        let saved = clique.saving.secs();
        let mut why = match clique.loss {
            Time::ZERO => format!("together they save {saved:.1} s"),
            loss => format!(
                "they save {saved:.1} s, and {:.1} s are lost by what waits",
                loss.secs()
            ),
        };
        if layer.ban_lifted {
            why.push_str("; something is taken back, as there is nothing else left to do");
        }
        let what = Happening::ActionsCombined {
            actions: clique.members.iter().map(action).collect(),
            beside: beside.cloned().collect(),
            after: after.collect(),
            saving_s: saved,
            why,
        };
        self.emit(what);
    }
}
