//! A robot and its world in virtual time, as a superior sees them.

mod doors;
mod faults;
mod instructions;
mod motion;
mod museum;
mod properties;
mod reality;
mod rig;
mod suspension;
