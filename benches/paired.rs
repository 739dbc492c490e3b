//! Built-in simulator against Icarus Verilog, paired: the same stimulus, in turns, as a ratio.
//!
//! ```text
//! cargo bench --bench paired
//! ```
//!
//! Prints, for each device, clocks per second of the built-in simulator through rust_hdl's
//! `simulate()` on one thread, of the same with golden model and comparison of every register on
//! every clock, and of `vvp` running the emitted bench (compilation excluded). Figures are the medians
//! of several rounds; a shared machine disturbs both sides of a round alike.

use std::hint::black_box;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use glint::config::Config;
use glint::cosim::external::Tool;
use glint::emit::Vectors;
use glint::flow::Unit;
use glint::registry::Registry;
use glint::sim::Simulator;

/// Results in the stimulus.
const POINTS: u64 = 4_000;

/// Rounds of each measurement.
const ROUNDS: usize = 7;

fn main() -> Result<()> {
    println!("clocks/s, median of {ROUNDS} rounds; ratios within a round");
    println!("device         clocks  built-in  with golden    icarus  ratio  ratio with golden");
    for device in Registry::catalogue().devices() {
        let schema = (device.schema)();
        let config = Config::defaults(&schema, &device.name.replace('-', "_"));
        let unit = Unit::new(*device, config)?;
        let vectors = unit.vectors(POINTS, 1)?;
        let clocks = vectors.inputs.len();
        let mut icarus = Icarus::new(&unit, &vectors)?;
        let mut rounds = Vec::new();
        for _ in 0..ROUNDS {
            let own = built_in(&unit, &vectors)?;
            let golden = with_golden(&unit)?;
            let outside = icarus.run()?;
            rounds.push([own, golden, outside].map(|time| clocks as f64 / time.as_secs_f64()));
        }
        let figure = |of: fn(&[f64; 3]) -> f64| median(rounds.iter().map(of).collect());
        println!(
            "{:12} {clocks:8}  {:7.2}M  {:10.2}M  {:7.3}M  {:5.0}  {:5.0}",
            device.name,
            figure(|round| round[0]) / 1e6,
            figure(|round| round[1]) / 1e6,
            figure(|round| round[2]) / 1e6,
            figure(|round| round[0] / round[2]),
            figure(|round| round[1] / round[2]),
        );
    }
    Ok(())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The recorded stimulus through the built-in simulator.
fn built_in(unit: &Unit, vectors: &Vectors) -> Result<Duration> {
    let mut simulator: Simulator = Simulator::new(&unit.design)?;
    let output = unit.design.outputs().next().context("an output")?.net;
    let begin = Instant::now();
    let mut sum = 0u64;
    for inputs in &vectors.inputs {
        for (at, &bits) in inputs.iter().enumerate() {
            simulator.set(at, bits);
        }
        simulator.clock()?;
        sum = sum.wrapping_add(simulator.value(output));
    }
    black_box(sum);
    Ok(begin.elapsed())
}

/// The same stimulus again, with the golden model beside it and every register compared.
fn with_golden(unit: &Unit) -> Result<Duration> {
    let mut lockstep = unit.lockstep(1)?;
    let begin = Instant::now();
    let outcome = lockstep.run(POINTS, None, &mut |_| ())?;
    anyhow::ensure!(
        outcome.mismatch.is_none(),
        "golden model and simulation differ"
    );
    Ok(begin.elapsed())
}

/// The emitted bench, compiled for Icarus Verilog.
struct Icarus {
    vvp: Tool,
    place: tempfile::TempDir,
}

impl Icarus {
    fn new(unit: &Unit, vectors: &Vectors) -> Result<Self> {
        let place = tempfile::tempdir()?;
        let mut sources = Vec::new();
        for file in unit.files("bench", vectors.clone())? {
            let name = file.path.rsplit('/').next().context("a name")?.to_owned();
            std::fs::write(place.path().join(&name), &file.contents)?;
            if name.ends_with(".v") {
                sources.push(name);
            }
        }
        let mut arguments = vec!["-g2012".to_owned(), "-o".to_owned(), "bench.vvp".to_owned()];
        arguments.extend(sources);
        let limit = Duration::from_secs(120);
        Tool::find("iverilog")?.run_to_success(arguments, place.path(), limit)?;
        Ok(Self {
            vvp: Tool::find("vvp")?,
            place,
        })
    }

    fn run(&mut self) -> Result<Duration> {
        let begin = Instant::now();
        let limit = Duration::from_secs(600);
        self.vvp
            .run_to_success(["-n", "bench.vvp"], self.place.path(), limit)?;
        Ok(begin.elapsed())
    }
}
