//! `software/<name>/`: what a driver's author starts from before there is hardware.
//!
//! The model in C computes what the core computes, bit for bit. It is made of the netlist, by its microprogram, and
//! knows nothing of the golden model, with which tests compare it.

mod litex;
mod model;
mod print;
mod registers;
mod setup;

pub use litex::file as of_litex;
pub use model::files;
pub use registers::files as of_registers;
pub use setup::files as of_lines;
