//! A simulated world and the mover in it, without any input or output, and the program that drives them
