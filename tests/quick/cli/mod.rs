//! Tests the command line as a user sees it: runs the built program in a temporary directory, and checks messages, exit codes
//! and files.
//!
//! Tests that are only a list of commands with their output are text files in `transcripts/`.

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
