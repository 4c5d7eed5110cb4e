//! Judges plans in the format of the planning competition of 2020, and shares no code with what
//! makes them.
