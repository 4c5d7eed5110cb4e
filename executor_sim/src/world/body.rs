//! The body of the robot: where it is and how it moves.

use agent_core::model::{Symbol, Time};
use nalgebra::{Isometry2, UnitComplex};

use crate::profile::Profile;
use crate::{Floor, MoverSpec, Place, Sensor, Ticket};

/// Nearer to a node than this is at the node: two roundings of one way must end at one place.
const AT_NODE_M: f64 = 1e-7;

/// Whoever drives gets there.
const SLOWEST_PACE: f64 = 0.01;

/// One body on the floor. It moves between events by formula, never by ticks.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Where it stands, or stood when the motion began.
    place: Place,
    heading: UnitComplex<f64>,
    motion: Option<Motion>,
    odometer_m: f64,
}

/// Turn on the spot, then go along one arc.
#[derive(Clone, Debug)]
struct Motion {
    ticket: Ticket,
    arc: Symbol,
    to: Symbol,
    /// The end of the arc that the body will have come from, should it stop on the way.
    left: Symbol,
    length_m: f64,
    /// How far the drive went before this stretch: braking begins a new one.
    before_m: f64,
    /// Where this stretch began.
    from_m: f64,
    /// 1 away from the first end of the arc, or -1 towards it.
    sense: f64,
    begun: Time,
    heading: UnitComplex<f64>,
    turn_rad: f64,
    turn_s: f64,
    profile: Profile,
    ending: Ending,
}

/// What the body will say when it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ending {
    Arrived,
    Stopped,
    Obstructed(Symbol),
    Halted,
}

/// How a drive has ended.
pub(super) struct Settled {
    pub(super) ticket: Ticket,
    pub(super) arc: Symbol,
    pub(super) to: Symbol,
    pub(super) driven_m: f64,
    pub(super) arrived: bool,
    /// What the body says of it.
    pub(super) sensor: Option<Sensor>,
}

/// What can be seen of the body at one moment.
pub(super) struct Seen {
    pub(super) place: Place,
    pub(super) isometry: Isometry2<f64>,
    pub(super) speed_m_s: f64,
    pub(super) odometer_m: f64,
}

impl Body {
    /// Standing at a place of the floor.
    pub(super) fn new(place: Place, heading_rad: f64, odometer_m: f64) -> Self {
        Self {
            place,
            heading: UnitComplex::new(heading_rad),
            motion: None,
            odometer_m,
        }
    }

    /// Whether nothing moves, not even on the spot.
    pub(super) fn stands(&self) -> bool {
        self.motion.is_none()
    }

    /// Whether it is coming to rest before it was to.
    pub(super) fn is_braking(&self) -> bool {
        let motion = self.motion.as_ref();
        motion.is_some_and(|motion| motion.ending != Ending::Arrived)
    }

    /// Where it stands; where it stood last, if it moves.
    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// When the motion ends.
    pub(super) fn due(&self) -> Option<Time> {
        self.motion.as_ref().map(Motion::end)
    }

    /// What an onlooker sees.
    pub(super) fn seen(&self, floor: &Floor, now: Time) -> Seen {
        let (place, heading, speed_m_s, since_m) = match &self.motion {
            None => (self.place.clone(), self.heading, 0.0, 0.0),
            Some(motion) => {
                let (gone_m, speed_m_s) = motion.at(now);
                let place = motion.place(&self.place, gone_m);
                (
                    place,
                    motion.heading(now),
                    speed_m_s,
                    motion.before_m + gone_m,
                )
            }
        };
        // A body stands only at places of the floor: `Place`s are checked when a world is made,
        // and driving leads from one to the next.
        let point = floor.point(&place).unwrap_or_default();
        Seen {
            isometry: Isometry2::from_parts(point.into(), heading),
            place,
            speed_m_s,
            odometer_m: self.odometer_m + since_m,
        }
    }

    /// Sets off along an arc. In words why not, if it cannot; else how long it will take.
    pub(super) fn drive(
        &mut self,
        floor: &Floor,
        spec: &MoverSpec,
        now: Time,
        (ticket, arc, to, pace): (Ticket, Symbol, Symbol, f64),
    ) -> Result<Time, String> {
        if !self.stands() {
            return Err("the body is moving".to_owned());
        }
        let (from_m, to_m, length_m) = self.way(floor, &arc, &to)?;
        let heading_rad = floor.heading_rad(&arc, &to).unwrap_or_default();
        let distance_m = (to_m - from_m).abs();
        let turn_rad = if distance_m > 0.0 {
            shortest_turn_rad(self.heading, heading_rad)
        } else {
            0.0
        };
        let left = match &self.place {
            Place::Node { node } => node.clone(),
            Place::Arc { left, .. } => left.clone(),
        };
        let motion = Motion {
            ticket,
            arc,
            to,
            left,
            length_m,
            before_m: 0.0,
            from_m,
            sense: (to_m - from_m).signum(),
            begun: now,
            heading: self.heading,
            turn_rad,
            turn_s: turn_rad.abs() / spec.turn_rate_rad_s,
            profile: Profile::travel(spec, pace.clamp(SLOWEST_PACE, 1.0), distance_m),
            ending: Ending::Arrived,
        };
        let takes = motion.end().since(now);
        self.motion = Some(motion);
        Ok(takes)
    }

    /// Offset here, offset of the destination, and length of the arc.
    fn way(&self, floor: &Floor, arc: &Symbol, to: &Symbol) -> Result<(f64, f64, f64), String> {
        let passage = floor
            .passage(arc)
            .ok_or_else(|| format!("there is no arc `{arc}`"))?;
        let to_m = passage
            .offset_of(to)
            .ok_or_else(|| format!("`{to}` is not an end of `{arc}`"))?;
        let from_m = floor
            .offset_on(arc, &self.place)
            .ok_or_else(|| format!("the robot stands {}, not on `{arc}`", self.place))?;
        Ok((from_m, to_m, passage.length_m))
    }

    /// The door that lies before the body on its way along `arc` to `to`, from where it stands.
    pub(super) fn door_ahead(&self, floor: &Floor, arc: &Symbol, to: &Symbol) -> Option<Symbol> {
        let (from_m, to_m, _) = self.way(floor, arc, to).ok()?;
        let passage = floor.passage(arc)?;
        if passage.door_lies_between(from_m, to_m) {
            passage.door.clone()
        } else {
            None
        }
    }

    /// Whether this is the drive that goes on.
    pub(super) fn is_driving(&self, ticket: Ticket) -> bool {
        self.motion
            .as_ref()
            .is_some_and(|motion| motion.ticket == ticket)
    }

    /// Stops within the braking distance. Where that is not short of the node, the drive just
    /// goes on, and has arrived when it ends; only a halt is a halt wherever it ends.
    pub(super) fn brake(&mut self, spec: &MoverSpec, now: Time, ending: Ending) {
        let Some(motion) = &mut self.motion else {
            return;
        };
        if motion.ending != Ending::Arrived {
            // Braking already. What was asked for weighs more than what the body did by itself.
            motion.ending = ending;
            return;
        }
        if motion.slow_down(spec, now, None) || ending == Ending::Halted {
            motion.ending = ending;
        }
    }

    /// A door has shut. Brakes if that door is ahead and there is room to stop before it.
    pub(super) fn door_shut(
        &mut self,
        floor: &Floor,
        spec: &MoverSpec,
        now: Time,
        door: &Symbol,
    ) -> bool {
        let Some(motion) = &mut self.motion else {
            return false;
        };
        let Some(passage) = floor.passage(&motion.arc) else {
            return false;
        };
        let (gone_m, _) = motion.at(now);
        let (here_m, to_m) = (
            motion.from_m + motion.sense * gone_m,
            motion.from_m + motion.sense * motion.profile.distance_m(),
        );
        let ahead = passage.door.as_ref() == Some(door) && passage.door_lies_between(here_m, to_m);
        if !ahead || motion.ending != Ending::Arrived {
            return false;
        }
        let room_m = (passage.length_m / 2.0 - here_m).abs();
        if !motion.slow_down(spec, now, Some(room_m)) {
            return false;
        }
        motion.ending = Ending::Obstructed(door.clone());
        true
    }

    /// The motion has ended: stands, and says so, unless it was halted.
    pub(super) fn settle(&mut self) -> Option<Settled> {
        let motion = self.motion.take()?;
        let gone_m = motion.profile.distance_m();
        self.place = motion.place(&self.place, gone_m);
        self.heading = motion.heading(motion.end());
        self.odometer_m += motion.before_m + gone_m;
        let ticket = motion.ticket;
        let place = self.place.clone();
        let driven_m = motion.before_m + gone_m;
        let to = Place::Node {
            node: motion.to.clone(),
        };
        let sensor = match motion.ending {
            Ending::Arrived => Some(Sensor::Arrived {
                ticket,
                node: motion.to.clone(),
                driven_m,
            }),
            Ending::Stopped => Some(Sensor::Stopped {
                ticket,
                place,
                driven_m,
            }),
            Ending::Obstructed(door) => Some(Sensor::Obstructed {
                ticket,
                door,
                place,
                driven_m,
            }),
            // Who halts a body asks no more about its drive.
            Ending::Halted => None,
        };
        Some(Settled {
            ticket,
            arrived: self.place == to,
            arc: motion.arc,
            to: motion.to,
            driven_m,
            sensor,
        })
    }
}

impl Motion {
    fn end(&self) -> Time {
        self.begun + Time::from_secs(self.turn_s + self.profile.duration_s())
    }

    /// Metres gone since this stretch began, and speed.
    fn at(&self, now: Time) -> (f64, f64) {
        self.profile.at(now.since(self.begun).secs() - self.turn_s)
    }

    /// Where one stands that far into this stretch, if the drive began at `origin`.
    fn place(&self, origin: &Place, gone_m: f64) -> Place {
        let offset_m = self.from_m + self.sense * gone_m;
        let to_go_m = if self.sense < 0.0 {
            offset_m
        } else {
            self.length_m - offset_m
        };
        let set_off = match origin {
            Place::Node { .. } => self.before_m + gone_m > AT_NODE_M,
            Place::Arc { .. } => self.before_m + gone_m > 0.0,
        };
        if !set_off {
            origin.clone()
        } else if to_go_m <= AT_NODE_M {
            Place::Node {
                node: self.to.clone(),
            }
        } else {
            Place::Arc {
                arc: self.arc.clone(),
                offset_m,
                left: self.left.clone(),
            }
        }
    }

    fn turned(&self, now: Time) -> f64 {
        if self.turn_s > 0.0 {
            (now.since(self.begun).secs() / self.turn_s).min(1.0)
        } else {
            1.0
        }
    }

    fn heading(&self, now: Time) -> UnitComplex<f64> {
        UnitComplex::new(self.turn_rad * self.turned(now)) * self.heading
    }

    /// Replaces what is left of the stretch by braking, if that ends short of where it would have
    /// ended, and within `room_m`.
    fn slow_down(&mut self, spec: &MoverSpec, now: Time, room_m: Option<f64>) -> bool {
        let (gone_m, speed_m_s) = self.at(now);
        let braking = Profile::braking(spec, speed_m_s);
        let remaining_m = self.profile.distance_m() - gone_m;
        if braking.distance_m() + AT_NODE_M >= remaining_m
            || room_m.is_some_and(|room_m| braking.distance_m() >= room_m)
        {
            return false;
        }
        self.heading = self.heading(now);
        (self.turn_rad, self.turn_s) = (0.0, 0.0);
        self.before_m += gone_m;
        self.from_m += self.sense * gone_m;
        self.begun = now;
        self.profile = braking;
        true
    }
}

/// The angle from one heading to another, within half a turn to either side.
fn shortest_turn_rad(from: UnitComplex<f64>, to_rad: f64) -> f64 {
    let turn_rad = from.angle_to(&UnitComplex::new(to_rad));
    // A difference that is only rounding is no reason to turn.
    if turn_rad.abs() < 1e-9 { 0.0 } else { turn_rad }
}
