//! The command line as a user meets it: the built program, in a directory of its own; messages, exit
//! codes, and what is in the directory afterwards. What a few lines of text can say is in `transcripts/`.

mod compare;
mod configurations;
mod cosim;
mod datasheet;
mod documents;
mod fuzz;
mod generate;
mod interrupt;
mod mutate;
mod output;
mod questions;
pub mod refusals;
mod render;
mod schedule;
mod setup;
mod transcripts;
mod verify;
pub mod workspace;
mod worst;
