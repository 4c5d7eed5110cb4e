//! Why a robot could not be set up.

use crate::{FloorError, MoverSpec, Place, VocabularyError};

/// Why a world or a robot was refused, to be read after "cannot set up the robot: ".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// The floor plan.
    #[error(transparent)]
    Floor(#[from] FloorError),
    /// What its actions are to the robot.
    #[error(transparent)]
    Vocabulary(#[from] VocabularyError),
    /// It cannot begin there.
    #[error("the floor plan has no such place: {0}")]
    UnknownPlace(Place),
    /// It would never get anywhere.
    #[error("every speed and rate of the mover must be positive: {0:?}")]
    Immobile(MoverSpec),
}
