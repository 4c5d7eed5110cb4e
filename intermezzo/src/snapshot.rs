//! Where the robot is seen to be.

use agent_core::model::{Symbol, Time};
use maps::Site;
use serde::Deserialize;

/// A picture of the world.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Snapshot {
    /// By the world's clock.
    pub(crate) at: Time,
    pub(crate) spot: Spot,
    pub(crate) speaking: bool,
    pub(crate) odometer_m: f64,
}

/// A place, as far as people want to know.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Spot {
    Node(Symbol),
    Arc {
        arc: Symbol,
        /// From the first end.
        offset_m: f64,
        /// From the first end.
        fraction: f64,
        ends: [Symbol; 2],
        length_m: f64,
        /// The end at which it stood last.
        left: Symbol,
    },
    /// Not on this map.
    Elsewhere,
}

#[derive(Deserialize)]
struct Message {
    t_s: f64,
    snapshot: Status,
}

/// What the world shows of itself, as far as it is needed here.
#[derive(Deserialize)]
struct Status {
    place: executor_sim::Place,
    speaking: bool,
    odometer_m: f64,
}

impl Snapshot {
    /// Reads what a world has published. `None` for what makes no sense: the next one will.
    pub(crate) fn read(bytes: &[u8], site: &Site) -> Option<Self> {
        let message: Message = serde_json::from_slice(bytes).ok()?;
        let spot = match message.snapshot.place {
            executor_sim::Place::Node { node } => Spot::Node(node),
            executor_sim::Place::Arc {
                arc,
                offset_m,
                left,
            } => match site.passage(arc.as_str()) {
                None => Spot::Elsewhere,
                Some(passage) => Spot::Arc {
                    offset_m,
                    fraction: offset_m / passage.length_m(),
                    ends: passage.ends().map(Symbol::clone),
                    length_m: passage.length_m(),
                    arc,
                    left,
                },
            },
        };
        Some(Self {
            at: Time::from_secs(message.t_s),
            spot,
            speaking: message.snapshot.speaking,
            odometer_m: message.snapshot.odometer_m,
        })
    }

    /// Where the robot stands, in words.
    pub(crate) fn words_standing(&self) -> String {
        match &self.spot {
            Spot::Elsewhere => "somewhere".to_owned(),
            Spot::Node(node) => format!("at {node}"),
            Spot::Arc {
                arc,
                offset_m,
                ends,
                length_m,
                left,
                ..
            } => {
                let from_left_m = if ends[0] == *left {
                    *offset_m
                } else {
                    length_m - offset_m
                };
                format!("on {arc}, {from_left_m:.1} m from {left}")
            }
        }
    }

    /// Where the robot is, in words, and where it is heading as far as `before` tells.
    pub(crate) fn words(&self, before: Option<&Self>) -> String {
        let speaking = if self.speaking { ", speaking" } else { "" };
        match &self.spot {
            Spot::Elsewhere => "somewhere".to_owned(),
            Spot::Node(node) => format!("at {node}{speaking}"),
            Spot::Arc {
                arc,
                offset_m,
                ends: [first, second],
                length_m,
                ..
            } => {
                let moved_m = match before.map(|before| &before.spot) {
                    Some(Spot::Arc {
                        arc: before,
                        offset_m: before_m,
                        ..
                    }) if before == arc => offset_m - before_m,
                    // It has just come from one of the ends.
                    _ => length_m / 2.0 - offset_m,
                };
                if moved_m.abs() < 1e-9 {
                    format!("on {arc}, standing{speaking}")
                } else if moved_m > 0.0 {
                    format!(
                        "on {arc}, {:.1} m to {second}{speaking}",
                        length_m - offset_m
                    )
                } else {
                    format!("on {arc}, {offset_m:.1} m to {first}{speaking}")
                }
            }
        }
    }
}
