//! The tests that run outside tools: simulators, synthesis, place and route, provers, Python.
//!
//! `bash tools/install` installs the tools. A missing tool fails its test.

#[path = "../common/mod.rs"]
mod common;

mod baseline;
mod bench_fails;
mod book;
mod builder_fuzz;
mod certificate_check;
mod certify;
mod cocotb;
mod delay_lines;
mod equality;
mod example;
mod expressions;
mod external;
mod families;
mod faults;
mod foreign;
mod formal;
mod gate_level;
mod languages;
mod litex;
mod multipliers;
mod mutants;
mod playground;
mod random_configurations;
mod random_expressions;
mod random_netlists;
mod recompute;
mod recompute_expressions;
mod schema;
mod shipped_bench;
mod slurm;
mod soc;
mod software;
mod synth;
mod synthesis;
mod tables;
mod vendor;
mod verilog;
mod video;
mod wheel;
mod wrappers;
