//! The command line as a user meets it: the built program, in a directory of its own; messages, exit
//! codes, and what is in the directory afterwards.

#[path = "../common/mod.rs"]
mod common;
mod compare;
mod configurations;
mod cosim;
mod datasheet;
mod describe;
mod fuzz;
mod generate;
mod mutate;
mod output;
mod place;
mod questions;
mod refusals;
mod render;
mod report;
mod verify;
