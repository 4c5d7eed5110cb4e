//! What becomes of an action if somebody starts anew while it runs (decision 11).

use agent_core::model::{Symbol, Time};
use agent_core::protocol::Output;

use super::active::{Active, Begun, Cut, Run};
use super::surroundings::fact;
use super::{Controller, End, Skill};
use crate::{MotorCommand, Place, Ticket};

/// What the motors say of their commands at standstill.
pub(super) struct Account {
    /// The greatest number that has reached them.
    pub(super) heard: Ticket,
    /// The last that was carried out to its end.
    pub(super) done: Option<Ticket>,
}

/// What is known of an action that was cut off.
enum Trace {
    Done,
    /// It has not been done, and never will be.
    NotDone(&'static str),
    /// Nobody can tell.
    Unclear,
}

impl Controller {
    /// Everything is to stand still, and to say how things stand. Until that has come, nothing is
    /// begun.
    pub(super) fn halt(&mut self) {
        self.last_ticket = self.last_ticket.saturating_add(1);
        let ticket = Ticket(self.last_ticket);
        self.halt = Some(ticket);
        let command = MotorCommand::Halt { ticket };
        self.outputs.push_back(Output::Local(command));
    }

    /// The world has started anew: nothing goes on, and what it had not said yet is lost.
    pub(super) fn world_reborn(&mut self) {
        if let Some(active) = &mut self.active {
            active.begun.cut = Some(Cut::World);
            active.errand_at = None;
        }
        self.surroundings.forget_place();
        self.halt();
    }

    /// Everything stands still, on our word.
    pub(super) fn halted(&mut self, now: Time, place: Place, account: &Account) {
        self.surroundings.stands_at(place);
        // One that remembers nothing must not use a number twice.
        self.last_ticket = self.last_ticket.max(account.heard.0);
        match self.active.take() {
            None => {
                let facts = self.surroundings.tell_again();
                if !facts.is_empty() {
                    self.outputs.push_back(Output::Observed {
                        facts,
                        reported_to: None,
                    });
                }
            }
            Some(active) => match active.begun.cut {
                None => self.stopped(now, active),
                Some(cut) => self.settle(now, active, cut, account),
            },
        }
        self.what_waits_stays_suspended();
        self.begin_what_waits(now);
    }

    /// Decides how an action that was cut off goes on or has ended.
    fn settle(&mut self, now: Time, active: Active, cut: Cut, account: &Account) {
        let begun = active.begun;
        let who = match cut {
            Cut::Controller => "the robot's controller was started anew",
            Cut::World => "the robot's motors were started anew",
        };
        let once = self.vocabulary.is_once(&begun.job.action);
        let trace = self.trace(now, &begun, cut, account, once);
        match trace {
            Trace::Done => self.end(now, begun, End::Success),
            _ if begun.run == Run::Failing => self.fail_by_itself(now, begun),
            Trace::NotDone(_) if begun.suspendable => self.suspended(now, begun),
            Trace::NotDone(how) => {
                let reason = format!("{who} {how}");
                self.fail(now, begun, reason, Vec::new());
            }
            Trace::Unclear if once => {
                let action = &begun.job.action;
                let reason = format!("{who}, and no sensor tells whether {action} was done");
                self.end(now, begun, End::Unknown { reason });
            }
            Trace::Unclear if begun.suspendable => self.suspended(now, begun),
            Trace::Unclear => {
                let reason = format!("{who} before it was known to be over");
                self.fail(now, begun, reason, Vec::new());
            }
        }
    }

    fn trace(&self, now: Time, begun: &Begun, cut: Cut, account: &Account, once: bool) -> Trace {
        let cut_off = Trace::NotDone("before it was done");
        match &begun.job.rest {
            Skill::Drive { to, .. } => match self.surroundings.place() {
                Some(Place::Node { node }) if node == to => Trace::Done,
                _ => cut_off,
            },
            Skill::SetDoor { door, open, .. } => {
                if self.surroundings.doors().get(door) == Some(open) {
                    Trace::Done
                } else {
                    cut_off
                }
            }
            Skill::Speak { duration_s } | Skill::Deed { duration_s, .. } => {
                if account.done == Some(begun.ticket) {
                    return Trace::Done;
                }
                match cut {
                    // It would have been the first thing that the motors had to tell.
                    Cut::Controller if account.heard < begun.ticket => {
                        Trace::NotDone("before it was begun")
                    }
                    Cut::Controller if account.done.is_some() || begun.suspendable => cut_off,
                    Cut::World if !once => cut_off,
                    // What they say of their commands may be old. A speech is known to be told in
                    // part; a deed that is cut off has a sensor that can tell, or has not.
                    Cut::World
                        if !could_have_ended(now, begun, *duration_s)
                            && (begun.suspendable || account.done.is_some()) =>
                    {
                        cut_off
                    }
                    Cut::Controller | Cut::World => Trace::Unclear,
                }
            }
        }
    }

    /// The robot stands before a closed door, of its own accord, or found one when it set off.
    pub(super) fn obstructed(&mut self, now: Time, active: Active, door: &Symbol) {
        let begun = active.begun;
        match begun.run {
            // It stands, as it was asked to. Whether the door still matters is for whoever asked.
            Run::Stopping => self.suspended(now, begun),
            Run::Failing => self.fail_by_itself(now, begun),
            Run::Going => {
                let reason = format!("the door `{door}` is closed");
                self.fail(now, begun, reason, vec![fact("open", [door])]);
            }
        }
    }
}

/// Whether there was time enough for it to be done.
fn could_have_ended(now: Time, begun: &Begun, duration_s: f64) -> bool {
    now.since(begun.at) >= Time::from_secs(duration_s / begun.pace)
}
