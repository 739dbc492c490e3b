//! The command line as a user meets it: the built program, in a directory of its own; messages, exit
//! codes, and what is in the directory afterwards.

mod compare;
mod configurations;
mod cosim;
mod describe;
mod generate;
mod output;
mod place;
mod questions;
mod refusals;
mod render;
mod report;
mod verify;
