//! A robot and its world in virtual time, as a superior sees them.

mod doors;
mod faults;
mod gone;
mod instructions;
mod lives;
mod motion;
mod museum;
mod pair;
mod properties;
mod reality;
mod restart;
mod rig;
mod suspension;
