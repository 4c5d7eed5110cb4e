//! Where a robot can stand.

use std::fmt;

use agent_core::model::Symbol;
use serde::{Deserialize, Serialize};

/// Where a robot stands: at a node, or somewhere on an arc and then at neither of its ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Place {
    /// At a node.
    Node {
        /// Which.
        node: Symbol,
    },
    /// On an arc.
    Arc {
        /// Which.
        arc: Symbol,
        /// Metres from the first end of the arc.
        offset_m: f64,
        /// The end at which it stood last. Going to and fro on the arc does not change it.
        left: Symbol,
    },
}

impl Place {
    /// At that node.
    pub fn at(node: &str) -> Self {
        Self::Node { node: node.into() }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Node { node } => write!(f, "at {node}"),
            Self::Arc {
                arc,
                offset_m,
                left,
            } => write!(f, "on {arc}, coming from {left}, {offset_m:.2} m along it"),
        }
    }
}
