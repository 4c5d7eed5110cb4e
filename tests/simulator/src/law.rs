//! What must hold, whatever happens: the invariants of `docs/reliability.md`, checked by somebody
//! who sees everything and takes no part.

mod answers;

use std::collections::{BTreeMap, BTreeSet};

use agent_core::agent::Agent;
use agent_core::model::{Symbol, Time};
use agent_core::planner::AnyPlanner;
use agent_core::protocol::{
    ActionId, Answer, Effect, Envelope, Event, Happening, Instruction, Report, ReportBody,
};
use executor_sim::Sensor;

use crate::process::{AnyEffect, Role};
use crate::scenario::Who;

/// What stops has stopped after that long, if nothing goes wrong.
pub const BOUND: Time = Time(5_000_000);
/// So long after something has gone wrong it may still have consequences.
const RECOVERY: Time = Time(5_000_000);

/// What a superior has been told of an execution.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Known {
    Running,
    Suspended,
    Cleared,
    Ended,
}

/// The onlooker.
#[derive(Clone, Debug, Default)]
pub struct Law {
    /// The first thing that was wrong.
    pub broken: Option<String>,
    /// Of each acknowledged goal the line of the parent that has acknowledged it.
    pub acked: BTreeMap<Symbol, u64>,
    /// What the parent has told, by its line and by number.
    told: BTreeMap<(u64, u64), Event>,
    /// How goals have ended.
    ends: BTreeMap<Symbol, BTreeMap<(u64, u64), Happening>>,
    known: BTreeMap<ActionId, Known>,
    actions: BTreeMap<ActionId, String>,
    /// Which execution of a superior an execution is a part of.
    part_of: BTreeMap<ActionId, ActionId>,
    /// The execution that the controller has said it begins.
    begins: Option<ActionId>,
    tickets: BTreeMap<(u64, u64), ActionId>,
    /// What the robot is doing.
    active: Option<(u64, u64)>,
    begun: BTreeSet<ActionId>,
    completed: BTreeSet<ActionId>,
    deeds: BTreeMap<String, u32>,
    reported: BTreeSet<(Symbol, u64, u64)>,
    /// By each process, since it was started.
    sent_to_start: [BTreeMap<ActionId, Time>; 6],
    stopped_ahead: [BTreeSet<ActionId>; 6],
    heard: BTreeMap<(Who, Who), (u64, u64)>,
    instructed: BTreeMap<(Who, Symbol), (u64, u64)>,
    /// Who has been told by its process that whom is gone, and not that it is back.
    gone: BTreeSet<(Who, Symbol)>,
    /// What each is having done.
    doing: [Option<ActionId>; 6],
    /// What was answered to which instruction.
    answers: BTreeMap<answers::Told, Answer>,
    /// What is to stop, since when that was promised.
    promised: BTreeMap<ActionId, Time>,
    /// What has said that it cannot stop, and ends by itself.
    refused: BTreeSet<ActionId>,
    /// When it was last told to stop.
    told_to_stop: BTreeMap<ActionId, Time>,
    /// Until then, or still, things go wrong that may make stopping take longer.
    trouble_until: Time,
    /// Whether somebody's journal was lost: then some of this cannot be asked for.
    pub memory_lost: bool,
    /// Whether the parent's was.
    pub goals_lost: bool,
}

impl Law {
    /// Notes what is wrong, if nothing was before.
    pub fn broken(&mut self, now: Time, what: impl FnOnce() -> String) {
        if self.broken.is_none() {
            self.broken = Some(format!("at {:.3} s: {}", now.secs(), what()));
        }
    }

    /// S1: the parent says yes to a goal.
    pub fn acknowledged(&mut self, goal: &Symbol, line: u64) {
        self.acked.insert(goal.clone(), line);
    }

    /// The acknowledged goals that a parent of that line must know.
    pub fn owed(&self, line: u64) -> impl Iterator<Item = &Symbol> {
        self.acked
            .iter()
            .filter(move |(_, of)| **of == line)
            .map(|(goal, _)| goal)
    }

    /// Whether that goal was told to have ended.
    pub fn has_ended(&self, goal: &Symbol) -> bool {
        self.ends.contains_key(goal)
    }

    /// A role has taken something in. Its agent is in order, and what it does belongs to somebody
    /// who is there.
    pub fn handled(&mut self, now: Time, who: Who, role: &Role) {
        if let Some(agent) = role.as_agent() {
            agent.check();
            if let (Some((id, ..)), Some(intention)) = (agent.executing(), agent.running())
                && let Some((_, above)) = &intention.goal.superior
            {
                self.part_of.insert(id.clone(), above.clone());
            }
            self.holds(now, who, agent);
        }
    }

    /// Nothing begins while its superior is gone.
    fn holds(&mut self, now: Time, who: Who, agent: &Agent<AnyPlanner>) {
        let doing = agent.executing().map(|(id, ..)| id);
        if self.doing[who.index()].as_ref() == doing {
            return;
        }
        self.doing[who.index()] = doing.cloned();
        if let (Some(id), Some(intention)) = (doing, agent.running())
            && let Some((superior, _)) = &intention.goal.superior
            && self.gone.contains(&(who, superior.clone()))
        {
            self.broken(now, || {
                format!("{who} begins with {id} while {superior} is gone, as it knows")
            });
        }
    }

    /// A process is told that a neighbour of its is there, or not.
    pub fn sees(&mut self, who: Who, neighbour: Symbol, there: bool) {
        if there {
            self.gone.remove(&(who, neighbour));
        } else {
            self.gone.insert((who, neighbour));
        }
    }

    /// Something goes wrong until then.
    pub fn trouble(&mut self, until: Time) {
        self.trouble_until = self.trouble_until.max(until);
    }

    /// L2: what was promised to stop has stopped, unless something was in the way.
    pub fn stop_is_due(&mut self, now: Time, id: &ActionId, promised: Time) {
        let calm = self.trouble_until + RECOVERY <= promised;
        if self.promised.get(id) != Some(&promised) || !calm || self.memory_lost {
            return;
        }
        self.promised.remove(id);
        let Some(active) = self.active.and_then(|ticket| self.tickets.get(&ticket)) else {
            return;
        };
        let is_it = active == id || self.part_of.get(active) == Some(id);
        if is_it && !self.refused.contains(active) {
            let active = active.clone();
            self.broken(now, || {
                format!(
                    "L2: {id} was to stop at {:.3} s, and the robot still does {active}",
                    promised.secs()
                )
            });
        }
    }

    /// A process has died.
    pub fn died(&mut self, who: Who) {
        self.gone.retain(|(of, _)| *of != who);
        self.doing[who.index()] = None;
        self.sent_to_start[who.index()].clear();
        self.stopped_ahead[who.index()].clear();
        if who == Who::Executor {
            self.begins = None;
        }
    }

    /// Something goes out.
    pub fn sent(&mut self, now: Time, who: Who, line: u64, effect: &AnyEffect) {
        match effect {
            Effect::Instruct { to, message } => {
                let id = message.body.id();
                let last = self.instructed.entry((who, to.clone())).or_default();
                if *last >= (message.line, message.seq) {
                    // Once more after a restart.
                    return;
                }
                *last = (message.line, message.seq);
                match &message.body {
                    Instruction::Execute { action, .. } => {
                        self.actions.insert(id.clone(), action.to_string());
                        self.sent_to_start[who.index()].insert(id.clone(), now);
                        self.stopped_ahead[who.index()].remove(id);
                        self.known.entry(id.clone()).or_insert(Known::Running);
                    }
                    Instruction::Resume { .. } => {
                        self.promised.remove(id);
                        self.sent_to_start[who.index()].insert(id.clone(), now);
                        self.stopped_ahead[who.index()].remove(id);
                        let known = self.known.get(id).copied();
                        if known == Some(Known::Cleared) && !self.memory_lost {
                            self.broken(now, || {
                                format!("S5: {who} has {id} resumed, which it knows to be cleared")
                            });
                        }
                        if known == Some(Known::Suspended) {
                            self.known.insert(id.clone(), Known::Running);
                        }
                    }
                    Instruction::Suspend { .. } => {
                        self.told_to_stop.insert(id.clone(), now);
                        // Decision 10. What is told to start only now is stopped right after.
                        let started = self.sent_to_start[who.index()].get(id);
                        if started.is_some_and(|at| *at < now)
                            && !self.stopped_ahead[who.index()].contains(id)
                        {
                            self.broken(now, || {
                                format!("{who} has waited for the disk to have {id} stopped")
                            });
                        }
                    }
                    Instruction::Clear { .. } => {}
                }
            }
            Effect::StopAhead { message, .. } => {
                let id = message.body.id().clone();
                self.stopped_ahead[who.index()].insert(id);
            }
            Effect::Report { to, message } => {
                let ReportBody { id, report } = &message.body;
                // Sent again after a restart it is of yesterday.
                let name = Symbol::from(format!("{who}>{to}").as_str());
                if !self.reported.insert((name, message.line, message.seq)) {
                    return;
                }
                if who == Who::Executor && *report == Report::Started {
                    self.begins = Some(id.clone());
                }
                if report.is_end() || matches!(report, Report::Suspended { .. }) {
                    self.stands(now, who, id, report);
                }
            }
            Effect::Event { number, event } if who == Who::Parent => {
                self.event(now, line, *number, event);
            }
            Effect::Event { .. }
            | Effect::Local(_)
            | Effect::Observed { .. }
            | Effect::Seen { .. }
            | Effect::Respond { .. } => {}
        }
    }

    /// S8: who says that something has stopped or ended is not doing it.
    fn stands(&mut self, now: Time, who: Who, id: &ActionId, report: &Report) {
        let Some(active) = self.active.and_then(|ticket| self.tickets.get(&ticket)) else {
            return;
        };
        let mine = match who {
            Who::Executor => active == id,
            _ => self.part_of.get(active) == Some(id),
        };
        if mine && !self.memory_lost {
            let (active, word) = (active.clone(), format!("{report:?}"));
            self.broken(now, || {
                format!("S8: {who} reports of {id} {word} while the robot is doing {active}")
            });
        }
    }

    /// The controller commands something that moves.
    pub fn commanded(&mut self, epoch: u64, ticket: u64) {
        if let Some(id) = self.begins.take() {
            self.tickets.insert((epoch, ticket), id);
        }
    }

    /// A superior is given a report.
    pub fn learned(&mut self, now: Time, who: Who, from: Who, message: &Envelope<ReportBody>) {
        let heard = self.heard.entry((who, from)).or_default();
        let due = match *heard {
            (line, seq) if line == message.line => seq + 1,
            (line, _) if line > message.line => return,
            _ => 1,
        };
        if message.seq != due && !self.memory_lost {
            return;
        }
        *heard = (message.line, message.seq);
        let ReportBody { id, report } = &message.body;
        let known = match report {
            Report::Suspended { .. } => Known::Suspended,
            report if report.is_end() => Known::Ended,
            _ => return,
        };
        if self.known.get(id) == Some(&Known::Ended)
            && known == Known::Suspended
            && !self.memory_lost
        {
            self.broken(now, || {
                format!("{who} hears that {id} is suspended, which has ended")
            });
        }
        self.sent_to_start[who.index()].remove(id);
        self.known.insert(id.clone(), known);
    }

    /// A superior has taken in an answer. Whether something was promised to stop from now on.
    pub fn answered(&mut self, now: Time, instruction: &Instruction, answer: &Answer) -> bool {
        if let Instruction::Suspend { id } = instruction {
            let told = self.told_to_stop.get(id);
            let mut starts = self.sent_to_start.iter().filter_map(|sent| sent.get(id));
            if *answer == Answer::Suspending && starts.any(|at| Some(at) > told) {
                // The report that it is suspended was faster, and it is to go on by now.
                return false;
            }
            if *answer == Answer::Suspending {
                self.promised.insert(id.clone(), now);
                return true;
            }
            // What does not stop may be a part of something else that is to, then or later.
            if let Answer::Refused { .. } = answer {
                self.refused.insert(id.clone());
            }
            self.trouble(now + BOUND);
        }
        self.learned_from(instruction, answer);
        false
    }

    fn learned_from(&mut self, instruction: &Instruction, answer: &Answer) {
        let known = match (instruction, answer) {
            (_, Answer::Finished { .. }) => Known::Ended,
            (Instruction::Clear { .. }, Answer::Accepted) => Known::Cleared,
            _ => return,
        };
        self.known.insert(instruction.id().clone(), known);
    }

    /// The world says something. `instructed`: whether the controller has been instructed since it
    /// was started.
    pub fn sensed(&mut self, now: Time, epoch: u64, sensor: &Sensor, instructed: bool) {
        match sensor {
            Sensor::Underway { ticket, .. } => self.begun(now, (epoch, ticket.0), instructed),
            Sensor::Arrived { ticket, .. }
            | Sensor::SpeechEnded { ticket }
            | Sensor::DeedDone { ticket }
            | Sensor::DoorSet { ticket, .. } => self.over(now, (epoch, ticket.0), true),
            Sensor::Stopped { ticket, .. }
            | Sensor::Obstructed { ticket, .. }
            | Sensor::Hushed { ticket, .. } => self.over(now, (epoch, ticket.0), false),
            Sensor::Halted { .. } => self.active = None,
            Sensor::Declined { .. } | Sensor::DoorChanged { .. } | Sensor::Pose(_) => {}
        }
    }

    fn begun(&mut self, now: Time, ticket: (u64, u64), instructed: bool) {
        if let Some(active) = self.active {
            self.broken(now, || {
                format!("S3: {ticket:?} begins while {active:?} goes on")
            });
        }
        self.active = Some(ticket);
        let Some(id) = self.tickets.get(&ticket).cloned() else {
            return self.broken(now, || {
                format!("{ticket:?} begins, and belongs to no execution")
            });
        };
        // What was accepted and not begun before the restart may begin once its superior is seen.
        if !self.begun.insert(id.clone()) && !instructed {
            self.broken(now, || {
                format!("S9: {id} goes on, and nobody has told the controller so since it started")
            });
        }
        if self.completed.contains(&id) {
            self.broken(now, || {
                format!("S6: {id} begins again, which was completed")
            });
        }
        if self.memory_lost {
            return;
        }
        let above = self.part_of.get(&id).cloned();
        for id in [Some(id), above].into_iter().flatten() {
            let known = self.known.get(&id).copied();
            if let Some(known) = known.filter(|known| *known != Known::Running) {
                self.broken(now, || {
                    format!("S4, S5: the robot begins with {id}, which is known as {known:?}")
                });
            }
        }
    }

    fn over(&mut self, now: Time, ticket: (u64, u64), done: bool) {
        if self.active == Some(ticket) {
            self.active = None;
        }
        if !done {
            return;
        }
        let Some(id) = self.tickets.get(&ticket).cloned() else {
            return;
        };
        if !self.completed.insert(id.clone()) {
            self.broken(now, || format!("S6: {id} is completed twice"));
        }
        let action = self.actions.get(&id).cloned().unwrap_or_default();
        if ONCE.iter().any(|once| action.starts_with(once)) {
            let times = self.deeds.entry(action.clone()).or_default();
            *times += 1;
            let times = *times;
            if times > 1 && !self.goals_lost {
                self.broken(now, || format!("S6: {action} is done {times} times"));
            }
        }
    }

    /// An event of the parent goes out.
    fn event(&mut self, now: Time, line: u64, number: u64, event: &Event) {
        if let Some(before) = self.told.get(&(line, number)) {
            if before != event {
                let before = format!("{:?}", before.what);
                let what = format!("{:?}", event.what);
                self.broken(now, || {
                    format!("event {number} was {before} and is now {what}")
                });
            }
            return;
        }
        self.told.insert((line, number), event.clone());
        let Some(goal) = &event.goal else {
            return;
        };
        if matches!(
            event.what,
            Happening::GoalSucceeded | Happening::GoalFailed { .. } | Happening::GoalUnknown { .. }
        ) {
            let ends = self.ends.entry(goal.clone()).or_default();
            ends.insert((line, number), event.what.clone());
            let of_line = ends.keys().filter(|(of, _)| *of == line).count();
            if of_line > 1 {
                let goal = goal.clone();
                self.broken(now, || format!("L1: {goal} ends {of_line} times"));
            }
        }
    }

    /// All is quiet: every goal has ended, and what is said to be done is.
    pub fn at_the_end(&mut self, now: Time, tasks: &[(Symbol, String)], line: u64) {
        for (goal, of) in self.acked.clone() {
            if of == line && !self.ends.contains_key(&goal) {
                self.broken(now, || format!("L1: {goal} has not ended"));
            }
        }
        for (goal, task) in tasks {
            let succeeded = self
                .ends
                .get(goal)
                .is_some_and(|ends| ends.values().any(|end| *end == Happening::GoalSucceeded));
            let Some(deed) = deed_of(task).filter(|_| succeeded) else {
                continue;
            };
            if self.deeds.get(&deed).copied().unwrap_or_default() == 0 {
                self.broken(now, || {
                    format!("{goal} is told to have succeeded, and {deed} was never done")
                });
            }
        }
    }
}

/// Actions of the robot that must not be done twice.
const ONCE: [&str; 3] = ["(narrate ", "(reply ", "(hail "];

/// What the robot has done when a goal is reached.
fn deed_of(task: &str) -> Option<String> {
    [
        ("(show ", ONCE[0]),
        ("(answer ", ONCE[1]),
        ("(greet ", ONCE[2]),
    ]
    .into_iter()
    .find_map(|(kind, deed)| Some(format!("{deed}{}", task.strip_prefix(kind)?)))
}
