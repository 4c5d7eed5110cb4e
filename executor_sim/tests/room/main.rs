//! A room with several vehicles, in virtual time.

mod death;
mod interruption;
mod rig;
mod serving;
