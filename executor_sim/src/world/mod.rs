//! The simulated reality: doors, one robot's body, and its voice.

mod body;
mod done;
mod durable;
mod motion;

use std::collections::{BTreeMap, VecDeque};

use agent_core::model::{Action, FactChange, Symbol, Time};
use agent_core::protocol::{Input, Ledger, Machine, Output, Reply};
use nalgebra::Isometry2;

use crate::refusal::refuse;
use crate::{Floor, MotorCommand, MoverSpec, Place, Sensor, SetupError, Ticket};
use body::{Body, Ending};
use done::Chronicle;

pub use done::{Doing, Done};
pub use motion::Motion;

/// What is there whether or not anybody controls it.
///
/// A state machine of its own, apart from the [`Controller`](crate::Controller): when a
/// controller's process dies, the body rolls on and a door that closes is closed all the same.
/// Nothing ticks; between two events everything is a formula of the time.
///
/// [`Input::Observation`] tells it what users and scenarios do: `(open d)` opens a door,
/// `(not (open d))` closes it. Other facts and unknown doors change nothing.
#[derive(Clone, Debug)]
pub struct World {
    floor: Floor,
    spec: MoverSpec,
    doors: BTreeMap<Symbol, bool>,
    /// A building has tens of thousands: they are not gone through for every row that is written.
    doors_are_written: bool,
    body: Body,
    speech: Option<Span>,
    door_work: Option<DoorWork>,
    deed: Option<(Span, Action)>,
    /// Somebody has halted everything and waits for standstill.
    halting: Option<Ticket>,
    /// Whether its sensors can tell afterwards what was done.
    tells: bool,
    chronicle: Chronicle,
    /// When something was last seen to.
    now: Time,
    /// When the motion, or the voice, last changed.
    changed_at: Time,
    outputs: VecDeque<Sensor>,
    ledger: Ledger,
}

#[derive(Clone, Debug)]
struct Span {
    ticket: Ticket,
    begun: Time,
    end: Time,
}

#[derive(Clone, Debug)]
struct DoorWork {
    span: Span,
    door: Symbol,
    open: bool,
}

/// What is due next. In the order in which simultaneous things happen.
#[derive(Clone, Copy, Eq, PartialEq, Ord, PartialOrd)]
enum Due {
    Motion,
    Speech,
    Door,
    Deed,
}

impl World {
    /// A robot that stands at that place, facing along the x axis, and doors as the floor has them.
    pub fn new(floor: Floor, spec: MoverSpec, start: Place) -> Result<Self, SetupError> {
        if !floor.has(&start) {
            return Err(SetupError::UnknownPlace(start));
        }
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !(positive(spec.max_speed_m_s)
            && positive(spec.acceleration_m_s2)
            && positive(spec.deceleration_m_s2)
            && positive(spec.turn_rate_rad_s))
        {
            return Err(SetupError::Immobile(spec));
        }
        let mut world = Self {
            doors: floor.doors().clone(),
            doors_are_written: false,
            floor,
            spec,
            body: Body::new(start, 0.0, 0.0),
            speech: None,
            door_work: None,
            deed: None,
            halting: None,
            tells: true,
            chronicle: Chronicle::default(),
            now: Time::ZERO,
            changed_at: Time::ZERO,
            outputs: VecDeque::new(),
            ledger: Ledger::default(),
        };
        // A controller that outlives the world learns by it that this is another one.
        world.tell_pose(Time::ZERO);
        Ok(world)
    }

    /// One whose sensors cannot tell afterwards what was done: whoever was not there when a deed
    /// ended will never know.
    #[must_use]
    pub fn without_hindsight(mut self) -> Self {
        self.tells = false;
        self
    }

    /// How the body drives from now on. A motion that has begun is not changed.
    pub(crate) fn set_spec(&mut self, spec: MoverSpec) {
        self.spec = spec;
    }

    /// When something was last seen to. A world that is started again goes on from then.
    pub fn time(&self) -> Time {
        self.now
    }

    /// The latest things that were done, oldest first.
    pub fn done(&self) -> impl DoubleEndedIterator<Item = &Done> + ExactSizeIterator {
        self.chronicle.kept.iter()
    }

    /// How many things were done or broken off, over all starts.
    pub fn done_count(&self) -> u64 {
        self.chronicle.head.count
    }

    /// Where the body is at that time, if nothing happens before: on the way, this is the arc and
    /// the offset that it passes.
    pub fn place(&self, now: Time) -> Place {
        self.body.seen(&self.floor, now).place
    }

    /// Position and heading on the floor plan at that time, if nothing happens before.
    pub fn isometry(&self, now: Time) -> Isometry2<f64> {
        self.body.seen(&self.floor, now).isometry
    }

    /// How far the body has driven altogether, in metres.
    pub fn odometer_m(&self, now: Time) -> f64 {
        self.body.seen(&self.floor, now).odometer_m
    }

    /// Whether nothing moves.
    pub fn stands(&self) -> bool {
        self.body.stands()
    }

    /// Every door, and whether it is open.
    pub fn doors(&self) -> &BTreeMap<Symbol, bool> {
        &self.doors
    }

    fn next_due(&self) -> Option<(Time, Due)> {
        [
            self.body.due().map(|time| (time, Due::Motion)),
            self.speech.as_ref().map(|span| (span.end, Due::Speech)),
            self.door_work
                .as_ref()
                .map(|work| (work.span.end, Due::Door)),
            self.deed.as_ref().map(|(span, _)| (span.end, Due::Deed)),
        ]
        .into_iter()
        .flatten()
        .min()
    }

    /// Lets everything happen that is due.
    fn advance(&mut self, now: Time) {
        while let Some((time, due)) = self.next_due().filter(|(time, _)| *time <= now) {
            match due {
                Due::Motion => {
                    self.settle(time);
                    self.tell_pose(time);
                    self.tell_if_halted();
                }
                Due::Speech => {
                    if let Some(span) = self.speech.take() {
                        self.note_speech(time, &span, true);
                        self.changed_at = time;
                        let ticket = span.ticket;
                        self.outputs.push_back(Sensor::SpeechEnded { ticket });
                    }
                }
                Due::Door => {
                    if let Some(DoorWork { span, door, open }) = self.door_work.take() {
                        let ticket = span.ticket;
                        self.move_door(time, &door, open);
                        let what = Doing::Door {
                            door: door.clone(),
                            open,
                        };
                        self.chronicle.add(ticket, time, true, what);
                        self.outputs
                            .push_back(Sensor::DoorSet { ticket, door, open });
                    }
                }
                Due::Deed => {
                    if let Some((Span { ticket, .. }, what)) = self.deed.take() {
                        let what = Doing::Deed { what };
                        self.chronicle.add(ticket, time, true, what);
                        self.outputs.push_back(Sensor::DeedDone { ticket });
                    }
                }
            }
        }
    }

    /// The motion has ended.
    fn settle(&mut self, now: Time) {
        let Some(settled) = self.body.settle() else {
            return;
        };
        let what = Doing::Drive {
            arc: settled.arc,
            to: settled.to,
            driven_m: settled.driven_m,
        };
        self.chronicle
            .add(settled.ticket, now, settled.arrived, what);
        self.outputs.extend(settled.sensor);
    }

    fn note_speech(&mut self, now: Time, span: &Span, to_the_end: bool) {
        let what = Doing::Speech {
            place: self.place(now),
            spoken_s: now.since(span.begun).secs(),
        };
        self.chronicle.add(span.ticket, now, to_the_end, what);
    }

    /// Stops speaking.
    fn hush(&mut self, now: Time, span: &Span) {
        self.note_speech(now, span, false);
        let ticket = span.ticket;
        let spoken_s = now.since(span.begun).secs();
        self.outputs.push_back(Sensor::Hushed { ticket, spoken_s });
    }

    fn tell_if_halted(&mut self) {
        if let Some(ticket) = self.halting.take_if(|_| self.body.stands()) {
            self.outputs.push_back(Sensor::Halted {
                ticket,
                place: self.body.place().clone(),
                doors: self.doors.clone(),
                heard: self.chronicle.head.heard,
                done: self.tells.then_some(self.chronicle.head.done),
            });
        }
    }

    /// Whether that has changed anything.
    fn move_door(&mut self, now: Time, door: &Symbol, open: bool) -> bool {
        match self.doors.get_mut(door) {
            Some(state) if *state != open => *state = open,
            _ => return false,
        }
        self.doors_are_written = false;
        if !open && self.body.door_shut(&self.floor, &self.spec, now, door) {
            self.tell_pose(now);
        }
        true
    }

    fn somebody_moves_door(&mut self, now: Time, change: &FactChange) {
        let (fact, open) = match change {
            FactChange::Add(fact) => (fact, true),
            FactChange::Remove(fact) => (fact, false),
            FactChange::Set(..) => return,
        };
        let [door] = fact.args.as_slice() else {
            return;
        };
        if fact.name == "open" && self.move_door(now, door, open) {
            self.outputs.push_back(Sensor::DoorChanged {
                door: door.clone(),
                open,
            });
        }
    }

    fn command(&mut self, now: Time, command: MotorCommand) {
        if self.has_heard(&command) {
            return;
        }
        match command {
            MotorCommand::Drive {
                ticket,
                arc,
                to,
                pace,
            } => self.drive(now, (ticket, arc, to, pace)),
            MotorCommand::Brake { ticket } => {
                if self.body.is_driving(ticket) {
                    self.body.brake(&self.spec, now, Ending::Stopped);
                    self.tell_pose(now);
                }
            }
            MotorCommand::Speak { ticket, duration_s } => {
                let span = Span::new(ticket, now, duration_s);
                if self.speech.is_some() {
                    self.decline(ticket, "the robot is speaking".to_owned());
                } else {
                    self.underway(ticket, span.end.since(now));
                    self.speech = Some(span);
                    self.tell_pose(now);
                }
            }
            MotorCommand::Hush { ticket } => {
                if let Some(span) = self.speech.take_if(|span| span.ticket == ticket) {
                    self.hush(now, &span);
                    self.tell_pose(now);
                }
            }
            MotorCommand::SetDoor {
                ticket,
                door,
                open,
                duration_s,
            } => {
                if !self.doors.contains_key(&door) {
                    self.decline(ticket, format!("there is no door `{door}`"));
                } else if self.door_work.is_some() {
                    self.decline(ticket, "the robot is busy with a door".to_owned());
                } else {
                    let span = Span::new(ticket, now, duration_s);
                    self.underway(ticket, span.end.since(now));
                    self.door_work = Some(DoorWork { span, door, open });
                }
            }
            MotorCommand::Deed {
                ticket,
                what,
                duration_s,
            } => {
                if self.deed.is_some() {
                    self.decline(ticket, "the robot is busy with a deed".to_owned());
                } else {
                    let span = Span::new(ticket, now, duration_s);
                    self.underway(ticket, span.end.since(now));
                    self.deed = Some((span, what));
                }
            }
            MotorCommand::Halt { ticket } => {
                self.halting = Some(ticket);
                self.stop_everything(now);
                self.tell_if_halted();
            }
            MotorCommand::Look => {
                let pose = self.pose(now);
                self.outputs.push_back(Sensor::Pose(pose));
            }
        }
    }

    fn stop_everything(&mut self, now: Time) {
        if let Some(span) = self.speech.take() {
            self.hush(now, &span);
        }
        if let Some(DoorWork { span, door, .. }) = self.door_work.take() {
            let open = self.doors.get(&door) == Some(&true);
            let what = Doing::Door { door, open };
            self.chronicle.add(span.ticket, now, false, what);
        }
        if let Some((span, what)) = self.deed.take() {
            let what = Doing::Deed { what };
            self.chronicle.add(span.ticket, now, false, what);
        }
        self.body.brake(&self.spec, now, Ending::Halted);
    }

    fn drive(&mut self, now: Time, order: (Ticket, Symbol, Symbol, f64)) {
        let (ticket, arc, to, _) = &order;
        let ticket = *ticket;
        let shut = self
            .body
            .door_ahead(&self.floor, arc, to)
            .filter(|door| self.doors.get(door) == Some(&false));
        if let Some(door) = shut.filter(|_| self.body.stands()) {
            // A robot that sees a closed door on its way does not set off.
            self.outputs.push_back(Sensor::Obstructed {
                ticket,
                door,
                place: self.body.place().clone(),
                driven_m: 0.0,
            });
            return;
        }
        match self.body.drive(&self.floor, &self.spec, now, order) {
            Ok(expected) => {
                self.underway(ticket, expected);
                self.tell_pose(now);
            }
            Err(reason) => self.decline(ticket, reason),
        }
    }

    fn underway(&mut self, ticket: Ticket, expected: Time) {
        self.outputs
            .push_back(Sensor::Underway { ticket, expected });
    }

    fn decline(&mut self, ticket: Ticket, reason: String) {
        self.outputs.push_back(Sensor::Declined { ticket, reason });
    }
}

impl Span {
    fn new(ticket: Ticket, begun: Time, duration_s: f64) -> Self {
        Self {
            ticket,
            begun,
            end: begun + Time::from_secs(duration_s),
        }
    }
}

impl Machine for World {
    type In = MotorCommand;
    type Out = Sensor;

    fn handle(&mut self, now: Time, input: Input<MotorCommand>) -> Option<Reply> {
        self.now = self.now.max(now);
        self.advance(now);
        let reply = match input {
            Input::Local(command) => {
                self.command(now, command);
                None
            }
            Input::Observation(changes) => {
                for change in &changes {
                    self.somebody_moves_door(now, change);
                }
                None
            }
            other => refuse(other, "the world"),
        };
        // A drive to where the robot stands, a speech without a word: over as soon as begun.
        self.advance(now);
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Sensor>> {
        self.outputs.pop_front().map(Output::Local)
    }

    fn wake_at(&self) -> Option<Time> {
        self.next_due().map(|(time, _)| time)
    }

    fn wind_down(&mut self, now: Time) {
        // As motors do that hear nothing any more.
        self.advance(now);
        self.stop_everything(now);
        self.advance(now);
    }

    fn rests(&self) -> bool {
        self.stands() && self.next_due().is_none()
    }
}
