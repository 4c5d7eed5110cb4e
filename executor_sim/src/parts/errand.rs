//! What a part is to do.

use std::fmt;

use agent_core::model::Symbol;
use serde::{Deserialize, Serialize};

use super::PartName;

/// How long it takes at most to set down what was half lifted, in seconds.
const SET_DOWN_S: f64 = 3.0;

/// What a part is to do: `perform`, with everything bound.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub enum Errand {
    /// `(arm grasp BOTTLE)`: from where it stands into the gripper.
    Grasp {
        /// Which.
        bottle: Symbol,
    },
    /// `(arm stow BOTTLE SLOT)`: from the gripper onto the tray.
    Stow {
        /// Which.
        bottle: Symbol,
        /// Where on the tray.
        slot: Symbol,
    },
    /// `(arm take BOTTLE SLOT)`: from the tray into the gripper.
    Take {
        /// Which.
        bottle: Symbol,
        /// Where on the tray.
        slot: Symbol,
    },
    /// `(arm set-back BOTTLE)`: to its proper place here, from the edge or from the gripper.
    SetBack {
        /// Which.
        bottle: Symbol,
    },
    /// `(arm put-down BOTTLE)`: from the gripper to its proper place here.
    PutDown {
        /// Which.
        bottle: Symbol,
    },
    /// `(arm hand-over BOTTLE GUEST)`: from the gripper to somebody who sits here.
    HandOver {
        /// Which.
        bottle: Symbol,
        /// To whom.
        guest: Symbol,
    },
    /// `(arm wipe PLACE)`: what was spilt here.
    Wipe {
        /// Here.
        place: Symbol,
    },
    /// `(watch SECONDS)`: the eyes look for that long.
    Watch,
    /// `(speak SECONDS)`: the voice speaks for that long.
    Speak,
    /// `(ask GUEST)`: what somebody who is here would like.
    Ask {
        /// Whom.
        guest: Symbol,
    },
}

impl Errand {
    /// Which part does it.
    pub fn part(&self) -> PartName {
        match self {
            Self::Watch => PartName::Eyes,
            Self::Speak | Self::Ask { .. } => PartName::Voice,
            Self::Grasp { .. }
            | Self::Stow { .. }
            | Self::Take { .. }
            | Self::SetBack { .. }
            | Self::PutDown { .. }
            | Self::HandOver { .. }
            | Self::Wipe { .. } => PartName::Arm,
        }
    }

    /// The bottle that it is about.
    pub fn bottle(&self) -> Option<&Symbol> {
        match self {
            Self::Grasp { bottle }
            | Self::Stow { bottle, .. }
            | Self::Take { bottle, .. }
            | Self::SetBack { bottle }
            | Self::PutDown { bottle }
            | Self::HandOver { bottle, .. } => Some(bottle),
            Self::Wipe { .. } | Self::Watch | Self::Speak | Self::Ask { .. } => None,
        }
    }

    /// Whether a bottle is in the air that has to be set down where it was, and all is to be done
    /// again.
    pub(crate) fn begins_anew(&self) -> bool {
        matches!(
            self,
            Self::Grasp { .. } | Self::Take { .. } | Self::SetBack { .. }
        )
    }

    /// How long it takes to come to rest if so much of it is done, in seconds.
    pub(crate) fn set_down_s(&self, share: f64) -> f64 {
        if self.begins_anew() {
            SET_DOWN_S * share.clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// An errand, and how much of it is left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// What.
    pub errand: Errand,
    /// How long it takes from here, in the model's seconds.
    pub left_s: f64,
    /// How long it takes after a suspension if it has to be begun anew.
    pub again_s: f64,
}

impl fmt::Display for Errand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grasp { bottle } => write!(f, "(arm grasp {bottle})"),
            Self::Stow { bottle, slot } => write!(f, "(arm stow {bottle} {slot})"),
            Self::Take { bottle, slot } => write!(f, "(arm take {bottle} {slot})"),
            Self::SetBack { bottle } => write!(f, "(arm set-back {bottle})"),
            Self::PutDown { bottle } => write!(f, "(arm put-down {bottle})"),
            Self::HandOver { bottle, guest } => write!(f, "(arm hand-over {bottle} {guest})"),
            Self::Wipe { place } => write!(f, "(arm wipe {place})"),
            Self::Watch => f.write_str("(watch)"),
            Self::Speak => f.write_str("(speak)"),
            Self::Ask { guest } => write!(f, "(ask {guest})"),
        }
    }
}
