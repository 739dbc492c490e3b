//! Compares the speed of the built-in simulator with Verilator and Icarus Verilog, which get the same stimulus in alternating
//! rounds.
//!
//! ```text
//! cargo bench -p glint-benches --bench paired [-- CORE ...]
//! ```
//!
//! For each device of the catalogue it measures the default configuration and, if `configs/` has one, the pipeline. The names of
//! cores, such as `rough` or `rough_pipelined`, limit the measurement to these cores. It measures million clocks per second and
//! thread of
//! - *design*: the built-in simulator alone, with [`LANES`] streams side by side;
//! - *golden*: the simulator with the golden model, with architectural registers and outputs compared on every clock
//!   (`Lockstep::replay`);
//! - *cosim*: `Lockstep::run`, as `glint cosim` uses it, which also draws the stimulus and measures every result against the
//!   formula;
//! - Verilator: the emitted Verilog (`-O3`, for this processor) under `paired.cpp`, without the time to build;
//! - Icarus Verilog: `vvp` with the emitted bench, without the time to compile.
//!
//! *design*, *golden*, Verilator and Icarus replay the same recorded streams from memory; Verilator and Icarus replay one
//! stream after the other. Times are processor times, because other programs disturb wall time more. Each number is the median
//! of several rounds, and each ratio is the median of the ratios within a round. The last column is the wall time from a
//! configuration to the verdict on a million points, with all threads.

use std::fmt::Write;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use glint::config;
use glint::core::Core;
use glint::cosim::{Lockstep, Outcome};
use glint::hdl::netlist::{NetId, Role};
use glint::hdl::sim::Simulator;
use glint::package::{FileKind, Vectors};
use glint::registry::Registry;
use glint::tools::Tool;

/// Streams side by side.
const LANES: usize = 64;

/// Results in each stream, about.
const POINTS: u64 = 64;

/// Clocks, at least, in one measurement of the design; in as many replays of all streams, one of Verilator has the same.
const CLOCKS: usize = 4_000_000;

/// Results in one measurement of a whole co-simulation.
const COSIM_POINTS: u64 = 1_000_000;

/// Results in the measurement of the time to a verdict.
const VERDICT_POINTS: u64 = 1_000_000;

/// Rounds of each measurement.
const ROUNDS: usize = 7;

/// More than any run of a tool takes.
const LIMIT: Duration = Duration::from_secs(600);

fn main() -> Result<()> {
    glint_benches::enter_repository();
    println!(
        "million clocks per second of processor time and thread, and ratios: median of {ROUNDS}"
    );
    println!(
        "core                    design  golden   cosim  Verilator  Icarus  design/Verilator  \
         golden/Verilator  cosim/Verilator  design/Icarus  {VERDICT_POINTS} points"
    );
    let named: Vec<String> = std::env::args().skip(1).collect();
    let named: Vec<&String> = named.iter().filter(|it| !it.starts_with('-')).collect();
    for core in cores()? {
        let name = &core.config().name;
        if !named.is_empty() && !named.contains(&name) {
            continue;
        }
        let streams = Streams::record(&core)?;
        let verilator = Verilator::build(&core, &streams)?;
        let icarus = Icarus::build(&core, &streams)?;
        let mut rounds = Vec::new();
        let mut verdicts = Vec::new();
        for _ in 0..ROUNDS {
            let design = streams.design(&core)?;
            let (golden, cosim) = (streams.golden(&core)?, cosim(&core)?);
            let rates = [design, golden, cosim, verilator.run()?, icarus.run()?];
            rounds.push(rates.map(|rate| rate / 1e6));
            verdicts.push(verdict(&core)?);
        }
        let figure = |of: fn(&[f64; 5]) -> f64| median(rounds.iter().map(of).collect());
        let shown =
            |figure: f64| if figure.is_nan() { "–".to_owned() } else { format!("{figure:.2}") };
        println!(
            "{name:22} {:7.2} {:>7} {:7.2} {:10.2} {:7.3} {:17.2} {:>17} {:16.2} {:14.0} {:10.2} s",
            figure(|round| round[0]),
            shown(figure(|round| round[1])),
            figure(|round| round[2]),
            figure(|round| round[3]),
            figure(|round| round[4]),
            figure(|round| round[0] / round[3]),
            shown(figure(|round| round[1] / round[3])),
            figure(|round| round[2] / round[3]),
            figure(|round| round[0] / round[4]),
            median(verdicts),
        );
    }
    Ok(())
}

/// Returns the defaults of every device, and the pipelines of `configs/`.
fn cores() -> Result<Vec<Core>> {
    let registry = Registry::catalogue();
    let mut cores = Vec::new();
    for device in registry.devices() {
        let name = device.name.replace('-', "_");
        for path in [format!("configs/{name}.toml"), format!("configs/{name}_pipelined.toml")] {
            if Path::new(&path).exists() {
                let config = config::read(Path::new(&path), &registry.schemas())?;
                cores.push(Core::new(*device, config)?);
            }
        }
    }
    Ok(cores)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Seconds of processor time that this thread has used, or where the system does not tell, of wall time.
fn processor_time(since: Instant) -> f64 {
    let told = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let used = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    used.map_or_else(|| since.elapsed().as_secs_f64(), |nanoseconds| nanoseconds / 1e9)
}

/// As [`processor_time`], of programs that this one has run.
fn children_time(since: Instant) -> f64 {
    let told = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name, which may hold spaces: user and system time are numbers 13 and 14, in hundredths.
    let fields = told.rsplit(')').next().unwrap_or_default().split_whitespace();
    let times: Vec<f64> = fields.skip(13).take(2).filter_map(|field| field.parse().ok()).collect();
    match times[..] {
        [user, system] => (user + system) / 100.0,
        _ => since.elapsed().as_secs_f64(),
    }
}

/// Returns the result of `work`, and this thread's processor time in seconds.
fn timed<T>(work: impl FnOnce() -> Result<T>) -> Result<(f64, T)> {
    let since = Instant::now();
    let begin = processor_time(since);
    let done = work()?;
    Ok((processor_time(since) - begin, done))
}

/// The recorded inputs of [`LANES`] streams of the same length.
struct Streams {
    /// By stream, then by clock, then by input.
    inputs: Vec<Vec<Vec<u64>>>,
    valid: NetId,
    /// One of the results.
    result: NetId,
    /// The sum of the results of all streams.
    sum: u64,
}

impl Streams {
    fn record(core: &Core) -> Result<Self> {
        let role = |wanted| core.design.port(move |role| role == wanted);
        let mut streams = Self {
            inputs: (1..=LANES as u64)
                .map(|seed| Ok(core.vectors(POINTS, seed)?.inputs))
                .collect::<Result<_>>()?,
            valid: role(Role::Valid).context("an output `valid`")?.net,
            result: role(Role::Result).context("a result")?.net,
            sum: 0,
        };
        let clocks = streams.inputs.iter().map(Vec::len).min().unwrap_or(0);
        for stream in &mut streams.inputs {
            stream.truncate(clocks);
        }
        streams.sum = streams.replay(&core.design, 1)?.1;
        Ok(streams)
    }

    fn clocks(&self) -> usize {
        self.inputs.iter().map(Vec::len).sum()
    }

    /// Replays in one measurement.
    fn passes(&self) -> usize {
        CLOCKS.div_ceil(self.clocks())
    }

    /// Returns all streams, side by side: the seconds it took, and the sum of the results.
    fn replay(&self, design: &glint::hdl::netlist::Design, passes: usize) -> Result<(f64, u64)> {
        let clocks = self.inputs[0].len();
        let inputs = self.inputs[0][0].len();
        let port = |clock: usize, at: usize| {
            std::array::from_fn(|lane: usize| self.inputs[lane][clock][at])
        };
        let row = |clock| (0..inputs).map(|at| port(clock, at)).collect();
        let mut rows: Vec<Vec<[u64; LANES]>> = (0..clocks).map(row).collect();
        let mut simulator = Simulator::<LANES>::new(design)?;
        timed(|| {
            let mut sum = 0u64;
            for _ in 0..passes {
                for row in &mut rows {
                    simulator.clock_with(row)?;
                    let valid = simulator.lanes(self.valid);
                    let result = simulator.lanes(self.result);
                    for lane in 0..LANES {
                        sum = sum.wrapping_add(valid[lane] * result[lane]);
                    }
                }
            }
            Ok(black_box(sum))
        })
    }

    /// Clocks per second of the built-in simulator.
    fn design(&self, core: &Core) -> Result<f64> {
        let passes = self.passes();
        let (seconds, sum) = self.replay(&core.design, passes)?;
        ensure!(sum == self.sum.wrapping_mul(passes as u64), "another sum");
        Ok((passes * self.clocks()) as f64 / seconds)
    }

    /// Clocks per second of one thread with the golden model and the comparison.
    fn golden(&self, core: &Core) -> Result<f64> {
        let clocks = self.passes() * self.inputs[0].len();
        on_one_thread(core, |lockstep| lockstep.replay(&self.inputs, clocks as u64))
    }

    /// Returns all streams one after the other, with the outputs before each edge.
    fn vectors(&self, core: &Core) -> Result<Vectors> {
        let mut simulator: Simulator = Simulator::new(&core.design)?;
        let outputs: Vec<NetId> = core.design.outputs().map(|port| port.net).collect();
        let mut vectors =
            Vectors { known_from: core.vectors(1, 1)?.known_from, ..Vectors::default() };
        for inputs in self.inputs.iter().flatten() {
            for (at, &bits) in inputs.iter().enumerate() {
                simulator.set(at, bits);
            }
            // `in_ready` follows `out_ready` within the clock.
            simulator.settle()?;
            let outputs = outputs.iter().map(|&net| simulator.value(net));
            vectors.expected.push(outputs.collect());
            vectors.inputs.push(inputs.clone());
            simulator.clock()?;
        }
        Ok(vectors)
    }
}

/// Clocks per second of one thread with stimulus, golden model, comparison and formula.
fn cosim(core: &Core) -> Result<f64> {
    on_one_thread(core, |lockstep| lockstep.run(COSIM_POINTS, &|_| ()))
}

/// Clocks per second of one thread of a run that finds no difference.
fn on_one_thread(
    core: &Core,
    run: impl FnOnce(&Lockstep<'_>) -> Result<Outcome> + Send,
) -> Result<f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let lockstep = core.lockstep(1)?;
    let (seconds, outcome) = pool.install(move || timed(move || run(&lockstep)))?;
    ensure!(outcome.mismatch.is_none(), "golden model and simulation differ");
    Ok(outcome.clocks as f64 / seconds)
}

/// Seconds of wall time from the configuration to the verdict, on all threads.
fn verdict(core: &Core) -> Result<f64> {
    let begin = Instant::now();
    let core = Core::new(*core.device(), core.config().clone())?;
    let outcome = core.lockstep(1)?.run(VERDICT_POINTS, &|_| ())?;
    ensure!(outcome.mismatch.is_none(), "golden model and simulation differ");
    Ok(begin.elapsed().as_secs_f64())
}

/// Writes the files that the simulators outside read, and returns the names of the Verilog files of the kinds `compiled`.
fn write(core: &Core, vectors: &Vectors, compiled: &[FileKind], dir: &Path) -> Result<Vec<String>> {
    let mut sources = Vec::new();
    let files = core.files("bench", vectors.clone())?;
    for file in files.of(FileKind::SIMULATED) {
        let (name, contents) = file.source();
        fs::write(dir.join(name), contents)?;
        if compiled.contains(&file.kind) && file.kind.is_verilog() {
            sources.push(name.to_owned());
        }
    }
    Ok(sources)
}

/// The emitted Verilog as a program that replays the streams.
struct Verilator {
    program: Tool,
    dir: tempfile::TempDir,
    clocks: usize,
    passes: usize,
    sum: u64,
}

impl Verilator {
    fn build(core: &Core, streams: &Streams) -> Result<Self> {
        let dir = tempfile::tempdir()?;
        let name = |net: NetId| &core.design.net(net).name;
        let sources = write(core, &streams.vectors(core)?, FileKind::DESIGN_SOURCES, dir.path())?;
        let mut ports = format!(
            "constexpr int INPUTS = {};\n\nstatic void drive(Vtop& top, const uint64_t* row) {{\n",
            core.design.inputs().count()
        );
        for (at, port) in core.design.inputs().enumerate() {
            writeln!(ports, "    top.{} = row[{at}];", name(port.net))?;
        }
        writeln!(ports, "}}")?;
        for (role, net) in [("valid", streams.valid), ("result", streams.result)] {
            let name = name(net);
            writeln!(ports, "\nstatic uint64_t {role}(const Vtop& top) {{ return top.{name}; }}")?;
        }
        fs::write(dir.path().join("ports.h"), ports)?;
        fs::write(dir.path().join("paired.cpp"), include_str!("paired.cpp"))?;
        let words = streams.inputs.iter().flatten().flatten();
        let rows: Vec<u8> = words.flat_map(|word| word.to_ne_bytes()).collect();
        fs::write(dir.path().join("rows"), rows)?;
        let mut arguments: Vec<&str> =
            "--cc --exe --build -j 1 -O3 --x-assign fast --x-initial fast \
             --noassert --prefix Vtop --Mdir build -o paired -CFLAGS -O3 -CFLAGS -march=native \
             -CFLAGS -I.. --top-module"
                .split(' ')
                .filter(|argument| !argument.is_empty())
                .collect();
        arguments.push(&core.config().name);
        arguments.extend(sources.iter().map(String::as_str));
        arguments.push("paired.cpp");
        Tool::find("verilator")?.run_to_success(arguments, dir.path(), LIMIT)?;
        Ok(Self {
            program: Tool::find_in("paired", dir.path().join("build").as_os_str())?,
            dir,
            clocks: streams.clocks(),
            passes: streams.passes(),
            sum: streams.sum,
        })
    }

    /// Clocks per second.
    fn run(&self) -> Result<f64> {
        let passes = self.passes.to_string();
        let arguments = ["rows", &passes];
        let said = self.program.run_to_success(arguments, self.dir.path(), LIMIT)?;
        let numbers: Vec<&str> = said.split_whitespace().collect();
        let [processor, _wall, sum] = numbers[..] else {
            anyhow::bail!("the verilated model said `{said}`");
        };
        ensure!(
            sum.parse() == Ok(self.sum.wrapping_mul(self.passes as u64)),
            "Verilator has another sum of the results"
        );
        Ok((self.passes * self.clocks) as f64 / processor.parse::<f64>()?)
    }
}

/// The emitted bench with the streams, compiled for Icarus Verilog.
struct Icarus {
    vvp: Tool,
    dir: tempfile::TempDir,
    clocks: usize,
}

impl Icarus {
    fn build(core: &Core, streams: &Streams) -> Result<Self> {
        let dir = tempfile::tempdir()?;
        let sources = write(core, &streams.vectors(core)?, FileKind::SIMULATED, dir.path())?;
        let mut arguments = ["-g2012", "-o", "bench.vvp"].map(str::to_owned).to_vec();
        arguments.extend(sources);
        Tool::find("iverilog")?.run_to_success(arguments, dir.path(), LIMIT)?;
        Ok(Self { vvp: Tool::find("vvp")?, dir, clocks: streams.clocks() })
    }

    /// Clocks per second. Starting vvp takes a few milliseconds of it.
    fn run(&self) -> Result<f64> {
        let since = Instant::now();
        let begin = children_time(since);
        let directory = self.dir.path();
        let said = self.vvp.run_to_success(["-n", "bench.vvp"], directory, LIMIT)?;
        ensure!(said.contains("PASS"), "the bench failed: {said}");
        Ok(self.clocks as f64 / (children_time(since) - begin))
    }
}
