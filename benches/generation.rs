//! Measures the cost of generating two devices: from the text of a configuration to all files in memory, including the vectors
//! of the bench and the proof of the error bound.
//!
//! It also measures the building of one large design. On Linux it prints the peak memory of the process.

use std::fs;
use std::hint::black_box;

use anyhow::{Context, Result};
use criterion::{Criterion, criterion_group, criterion_main};
use glint::config;
use glint::core::Core;
use glint::dsl::{Designer, end, step, valid};
use glint::fixed::{Format, Overflow, Rounding};
use glint::hdl::netlist::Design;
use glint::package::OutputFiles;
use glint::registry::Registry;

/// One configuration of each device.
const CONFIGS: [&str; 2] = ["configs/rough.toml", "configs/cosine_power.toml"];

fn generate(registry: &Registry, path: &str, text: &str) -> Result<OutputFiles> {
    let config = config::parse(path, text, &registry.schemas())?;
    let device = registry.device(&config.device).context("a device")?;
    let core = Core::new(*device, config)?;
    black_box(core.contract.bounds());
    core.files(path, core.shipped_vectors()?)
}

fn both(registry: &Registry, texts: &[(&str, String)]) -> Result<Vec<OutputFiles>> {
    let all = texts.iter();
    all.map(|(path, text)| generate(registry, path, text)).collect()
}

/// Returns the most memory that the process has had, where the system tells.
fn peak_memory() -> Option<String> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().to_owned())
}

fn all(criterion: &mut Criterion) {
    glint_benches::enter_repository();
    let registry = Registry::catalogue();
    let texts = CONFIGS.map(|path| (path, fs::read_to_string(path).expect("a configuration")));
    let files = both(&registry, &texts).expect("files");
    let count = files.iter().map(OutputFiles::len).sum::<usize>();
    let peak = peak_memory().unwrap_or_else(|| "unknown".to_owned());
    println!("{count} files of {CONFIGS:?}; peak memory of the process: {peak}");
    criterion.bench_function("generate both devices", |bencher| {
        bencher.iter(|| black_box(both(&registry, &texts).expect("files, as before")));
    });
}

/// Returns a chain of sums and narrowings between two registers: about 20 000 nets, as unrolled arithmetic has them.
fn long_chain() -> Design {
    let d = Designer::new("chain");
    let format = Format::unsigned(8, 0);
    let x = d.operand("x", format).q();
    let mut last = x;
    for number in 0..5_000 {
        let sum = d.add(&format!("sum{number}"), last, x);
        last = d.narrow(&format!("part{number}"), sum, format, Rounding::Truncate, Overflow::Wrap);
    }
    let y = d.register("y", format);
    y.takes(last);
    d.output("y_out", y.q());
    let wait = (0..3).map(|at| step(&format!("wait{at}"), []));
    let end = [step("load", [y.load()]), step("shown", [valid(), end()])];
    d.microprogram([step("idle", [])].into_iter().chain(wait).chain(end));
    d.finish().expect("a right description")
}

fn large(criterion: &mut Criterion) {
    let nets = long_chain().nets.len();
    let mut group = criterion.benchmark_group("large");
    group.sample_size(10);
    group.bench_function(format!("describe and finish {nets} nets"), |bencher| {
        bencher.iter(|| black_box(long_chain()));
    });
}

criterion_group!(benches, all, large);
criterion_main!(benches);
