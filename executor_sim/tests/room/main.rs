//! A room with several vehicles, in virtual time.

mod accidents;
mod death;
mod interruption;
mod properties;
mod rig;
mod serving;
mod words;
