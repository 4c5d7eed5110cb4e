//! How processes start, work, write down, and die.

use agent_core::model::Time;
use agent_core::protocol::{Effect, Rows, Unreadable};

use crate::counts::Counted;
use crate::dice::{Dice, drawn};
use crate::mutant::Mutant;
use crate::process::{AnyArrival, Board, Role, Way};
use crate::scenario::{EVERYONE, Point, Who};

use super::faults::faults;
use super::{Due, RECALL_EVERY, Simulation, TRY_AGAIN};

impl Simulation<'_> {
    pub(super) fn start(&mut self, who: Who) {
        self.epochs += 1;
        let before = self.nodes[who.index()].epoch;
        let forgets = self.mutant == Some(Mutant::ForgetTheEpoch) && before != 0;
        let epoch = if forgets { before } else { self.epochs };
        let found = self.nodes[who.index()].store.open(who.name()).cloned();
        let mut rows = match found {
            Ok(rows) => rows,
            Err(error) => return self.broken(|| format!("the journal of {who}: {error}")),
        };
        if let Some(mutant) = self.mutant
            && !rows.is_empty()
        {
            mutant.found(&mut rows);
        }
        let role = self.role(who, epoch, &rows);
        let role = match role {
            Ok(role) => role,
            Err(error) => {
                return self.broken(|| format!("S10: {who} cannot read its journal: {error}"));
            }
        };
        self.tell(|| format!("{who:<9} starts in epoch {epoch} with {} rows", rows.len()));
        self.law.handled(self.now, who, &role);
        let node = &mut self.nodes[who.index()];
        node.wake = role.wake_at();
        node.role = Some(role);
        node.epoch = epoch;
        node.instructed = false;
        if who == Who::Parent {
            self.witnesses.clear();
            self.owes_nothing();
        }
        for other in EVERYONE {
            self.look_soon(other, who);
            self.look_soon(who, other);
        }
        self.pump(who);
    }

    /// A process of it that starts.
    pub(super) fn role(&self, who: Who, epoch: u64, rows: &Rows) -> Result<Role, Unreadable> {
        let scenario = self.scenario;
        match who {
            Who::Executor => {
                let controller = self.ground.controller(faults(scenario));
                Role::controller(who, epoch, controller, rows, self.mutant)
            }
            Who::Parent => {
                let two = scenario.two_children;
                let agent = self.ground.parent(epoch, scenario.planner, two);
                Role::agent(who, epoch, agent, rows, self.mutant)
            }
            _ => {
                let agent = self.ground.child(who == Who::East, epoch, scenario.planner);
                Role::agent(who, epoch, agent, rows, self.mutant)
            }
        }
    }

    pub(super) fn crash(&mut self, who: Who, kept: bool, down: Time) {
        let node = &mut self.nodes[who.index()];
        if node.role.take().is_none() {
            return;
        }
        node.wake = None;
        let mut interrupted = node.writing.take();
        let mut written = Ok(());
        match (&mut interrupted, self.mutant) {
            (Some(rows), Some(Mutant::TornWriting)) => {
                rows.truncate(rows.len() / 2);
                written = node.store.write(std::mem::take(rows));
                interrupted = None;
            }
            (_, Some(Mutant::SkipTheJournal)) => interrupted = None,
            (Some(rows), _) if kept => {
                written = node.store.write(std::mem::take(rows));
                interrupted = None;
            }
            _ => {}
        }
        let chance = [10, node.epoch, node.writings];
        let mut dice = Dice(drawn(self.scenario.seed, chance));
        node.store.crash(interrupted.as_deref(), &mut dice);
        node.channels.clear();
        node.backlog.clear();
        node.frozen = None;
        node.armed = None;
        node.board = Board::default();
        node.read = [None; 6];
        node.seen = [0; 6];
        if let Err(error) = written {
            self.broken(|| format!("the journal of {who}: {error}"));
        }
        self.law.died(who);
        self.law.trouble(self.now + down);
        self.count(Counted::ProcessesKilled);
        self.tell(|| format!("{who:<9} is killed"));
        for other in EVERYONE {
            self.look_soon(other, who);
        }
        self.after(down, Due::Start { who });
    }

    pub(super) fn thaw(&mut self, who: Who) {
        let node = &mut self.nodes[who.index()];
        let Some((_, until)) = node.frozen else {
            return;
        };
        if until > self.now {
            return;
        }
        node.frozen = None;
        let backlog = std::mem::take(&mut node.backlog);
        self.tell(|| format!("{who:<9} goes on"));
        for other in EVERYONE {
            self.look_soon(other, who);
            self.look_soon(who, other);
        }
        for (from, message) in backlog {
            self.deliver(from, who, message);
        }
    }

    /// Gives a role something, and takes what comes of it.
    pub(super) fn give(&mut self, who: Who, arrival: AnyArrival, way: Option<Way>) {
        let now = self.now;
        let node = &mut self.nodes[who.index()];
        let Some(role) = &mut node.role else {
            return;
        };
        self.trace = drawn(self.trace, [now.0, who.index() as u64, self.messages]);
        role.handle(now, arrival, way);
        node.wake = role.wake_at();
        self.law.handled(now, who, role);
        self.pump(who);
    }

    /// Takes what may go out now, and writes down what has to be.
    pub(super) fn pump(&mut self, who: Who) {
        let now = self.now;
        loop {
            let node = &mut self.nodes[who.index()];
            let epoch = node.epoch;
            let Some(role) = &mut node.role else {
                return;
            };
            if let Some(effect) = role.poll_effect() {
                let line = role.line();
                if self.tick(who, true) {
                    return;
                }
                let late = self.mutant == Some(Mutant::StopWaitsForTheDisk);
                if late && matches!(effect, Effect::StopAhead { .. }) {
                    continue;
                }
                self.law.sent(now, who, line, &effect);
                self.send_effect(who, epoch, effect);
                if self.tick(who, false) {
                    return;
                }
                continue;
            }
            if node.writing.is_some() || !role.wants_writing() {
                return;
            }
            let Some(rows) = role.write_down() else {
                // Nothing was different: what waited is free.
                if role.held() == 0 {
                    continue;
                }
                return;
            };
            let hasty = self.mutant == Some(Mutant::AckBeforePersist);
            if hasty {
                role.release();
            }
            node.writings += 1;
            let writings = node.writings;
            let chance = [11, writings, who.index() as u64];
            if drawn(self.scenario.seed, chance).is_multiple_of(RECALL_EVERY) && !self.lies() {
                self.recalls(who, &rows);
            }
            self.nodes[who.index()].writing = Some(rows);
            if self.begins_writing(who) {
                return;
            }
            let most = self.scenario.writing.0;
            let mut takes = Time(self.draw(1, most + 1));
            if let Some((until, slow)) = self.nodes[who.index()].slow
                && until > now
            {
                takes = slow;
            }
            self.after(takes, Due::Written { who, epoch });
            if !hasty {
                return;
            }
        }
    }

    pub(super) fn written(&mut self, who: Who, epoch: u64) {
        let now = self.now;
        let node = &mut self.nodes[who.index()];
        if node.epoch != epoch || node.role.is_none() {
            return;
        }
        if let Some((_, until)) = node.frozen {
            return self.plan(until, Due::Written { who, epoch });
        }
        if node.full_until > now {
            let rows = node.writing.as_deref().unwrap_or_default();
            if let Err(error) = node.store.write_in_vain(rows) {
                return self.broken(|| format!("the journal of {who}: {error}"));
            }
            // Whoever waits is told that nothing is acknowledged; to us that is as if it were lost.
            if let Some(role) = &mut node.role {
                role.refuse_waiting();
            }
            return self.after(TRY_AGAIN, Due::Written { who, epoch });
        }
        let Some(rows) = node.writing.take() else {
            return;
        };
        let lies = match self.mutant {
            Some(Mutant::SkipTheJournal) => true,
            Some(Mutant::LyingDisk) => node.writings % 8 == 7,
            _ => false,
        };
        if who == Who::Parent {
            self.speaks_anew(&rows);
        }
        let node = &mut self.nodes[who.index()];
        if !lies && let Err(error) = node.store.write(rows) {
            return self.broken(|| format!("the journal of {who}: {error}"));
        }
        if let Some(role) = &mut node.role {
            role.written();
        }
        if who == Who::Parent {
            self.owes_nothing();
        }
        self.count(Counted::Writings);
        self.pump(who);
    }

    /// Whether the journal is not what was written, or was not found so: comparing would tell
    /// nothing of the machines then.
    pub(super) fn lies(&self) -> bool {
        matches!(
            self.mutant,
            Some(
                Mutant::SkipTheJournal
                    | Mutant::LyingDisk
                    | Mutant::TornWriting
                    | Mutant::LoseTheOutbox
                    | Mutant::ResetNumbers
                    | Mutant::ForgetTheInbox
                    | Mutant::NewLineAtEveryStart
                    | Mutant::LoseAGoal
            )
        )
    }

    /// Whether the process dies at this point of sending.
    pub(super) fn tick(&mut self, who: Who, before: bool) -> bool {
        let node = &mut self.nodes[who.index()];
        let Some((_, Point::Sending { nth, after }, down)) = &mut node.armed else {
            return false;
        };
        if *after == before {
            return false;
        }
        if *nth > 0 {
            *nth -= 1;
            return false;
        }
        let down = *down;
        self.crash(who, false, down);
        true
    }

    /// Whether the process dies while it writes this.
    pub(super) fn begins_writing(&mut self, who: Who) -> bool {
        let node = &mut self.nodes[who.index()];
        let Some((_, Point::Writing { nth, kept }, down)) = &mut node.armed else {
            return false;
        };
        if *nth > 0 {
            *nth -= 1;
            return false;
        }
        let (kept, down) = (*kept, *down);
        self.crash(who, kept, down);
        true
    }
}
