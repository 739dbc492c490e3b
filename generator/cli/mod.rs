//! The command line: the only code that prints and exits.

mod commands;
mod destination;
mod failure;
mod interrupt;
mod own_file;
mod progress;
mod staged;
mod store;
mod tables;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::core::TEST_SEED;
use crate::cosim::exhaustive::Shard;
use crate::registry::Registry;

/// Specular-shading hardware from Rust descriptions: Verilog, co-simulation, accuracy.
///
/// Without a command, Glint does its main job: it generates every configuration in `configs/` into
/// `rtl_out/` and `testbench/`, co-simulates each with the built-in simulator against its golden model,
/// clock by clock, and prints what it found. The exit code is 0 only if everything holds.
#[derive(Parser)]
#[command(name = "glint", version, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Main job only: print for each configuration what was compared, and where the largest error is
    #[arg(long)]
    details: bool,
    /// How many threads to use at most [default: the number of processors]
    #[arg(long, value_name = "N", global = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    output: Output,
}

const EXAMPLES: &str = "\
Examples:
  glint                                         generate and check everything in configs/
  glint new rough > my_core.toml                a commented configuration to edit
  glint generate my_core.toml --out build       Verilog, ROMs, manifest and bench into build/
  glint cosim my_core.toml --points 1000000     golden model against hardware, every clock
  glint cosim my_core.toml --simulator icarus   the emitted Verilog in Icarus Verilog
  glint cosim my_core.toml --points 20 --vcd wave.vcd
  glint mutate my_core.toml                     are faults noticed? Plants thousands, one at a time
  glint eval my_core.toml cos_gamma=0.99 exponent=20 red=255
  glint describe my_core.toml                   ports, blocks, microprogram, accuracy: a page
  glint datasheet my_core.toml                  the same as a product guide in HTML
  glint synth my_core.toml                      area, frequency and critical path
  glint compare --exponent 100                  all devices side by side
  glint verify my_core.toml                     every proof and test there is, and a page about it
  glint render my_core.toml --out sphere.png    a picture through the bit-accurate device

Exit codes: 0 everything holds; 1 something does not hold or could not be done; 2 wrong usage.";

#[derive(Subcommand)]
enum Command {
    /// Write Verilog, ROM contents, manifest, FuseSoC core and test bench
    ///
    /// Each configuration gets the directories `rtl_out/<name>/` and `testbench/<name>/`, and with
    /// `package.software` also `software/<name>/`. They are replaced as a whole or not at all. Files that Glint did not
    /// write, or that were edited since, are left alone unless --force is given.
    #[command(after_help = "\
Examples:
  glint generate                              everything in configs/, into rtl_out/ and testbench/
  glint generate my_core.toml --out build     one configuration, into build/
  glint generate --check                      are the files up to date? Writes nothing")]
    Generate {
        #[command(flatten)]
        configs: Configs,
        /// The directory in which `rtl_out/` and `testbench/` are made
        #[arg(long, value_name = "DIR", default_value = ".")]
        out: PathBuf,
        /// Write nothing; fail if a file differs from what would be written
        #[arg(long)]
        check: bool,
        /// Replace files that Glint did not write or that were edited since
        #[arg(long)]
        force: bool,
    },
    /// Compare the golden model with the simulated hardware, every register on every clock
    #[command(after_help = "\
Examples:
  glint cosim                                             everything in configs/, built-in simulator
  glint cosim my_core.toml --points 1000000 --seed 7      more points, another stimulus
  glint cosim my_core.toml --simulator icarus --json      the emitted Verilog, result for scripts
  glint cosim my_core.toml --points 20 --vcd wave.vcd     a waveform for a viewer
  glint cosim my_core.toml --exhaustive                   the accuracy contract, all operands
  glint cosim configs/reduced/rough.toml --exhaustive     and every combination, every clock")]
    Cosim {
        #[command(flatten)]
        configs: Configs,
        /// Results to check for each configuration [default: 100000, or 200 with an external simulator]
        #[arg(long, value_name = "N", value_parser = count)]
        points: Option<u64>,
        /// Seed of the stimulus
        #[arg(long, value_name = "S", default_value_t = TEST_SEED)]
        seed: u64,
        /// What simulates the hardware
        #[arg(long, value_enum, default_value_t = Simulator::RustHdl)]
        simulator: Simulator,
        /// Prove the accuracy contract instead: f for every combination of control operands, and every f with every
        /// colour. If all operands together have at most 26 bits, also compare every register on every clock for
        /// every combination of operands
        #[arg(long, conflicts_with_all = ["points", "seed", "simulator", "vcd"])]
        exhaustive: bool,
        /// With --exhaustive: save progress in FILE, and continue from it
        #[arg(long, value_name = "FILE", requires = "exhaustive")]
        resume: Option<PathBuf>,
        /// With --exhaustive: do part I of N, for a job array; `glint merge` joins the parts
        #[arg(long, value_name = "I/N", requires = "exhaustive", requires = "resume")]
        shard: Option<Shard>,
        /// Write a waveform (VCD) of one configuration (built-in simulator only)
        #[arg(long, value_name = "FILE")]
        vcd: Option<PathBuf>,
        /// Time limit of an external simulator, in seconds
        #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
        time_limit: u64,
    },
    /// Join the parts of a `cosim --exhaustive` that was divided by --shard
    #[command(after_help = "\
Example, on four machines and then on one:
  glint cosim my_core.toml --exhaustive --shard 1/4 --resume part1.json
  glint merge my_core.toml part1.json part2.json part3.json part4.json")]
    Merge {
        /// The configuration
        config: PathBuf,
        /// The files of all parts
        #[arg(value_name = "FILE", required = true)]
        files: Vec<PathBuf>,
    },
    /// Search for the largest error of an output
    ///
    /// From points that the stimulus draws the operands are moved as long as the error grows. What is found is a lower
    /// limit of the largest error there is, as the bound of the contract is an upper one. The same seed finds the same.
    /// The exit code is 0 if the bound holds.
    #[command(after_help = "\
Examples:
  glint worst my_core.toml
  glint worst my_core.toml --starts 1e5 --seed 7      longer, from other points
  glint worst configs/rough.toml --out proofs/worst   a record; one of a larger error stays")]
    Worst(commands::WorstArguments),
    /// Plant faults one at a time, and show which of them the tests notice
    ///
    /// Stuck and inverted bits, swapped mux inputs, wrong operators, constants, enables, every bit of every control
    /// word, a sample of ROM words: each fault is put into the netlist, and the default test of `cosim` is run on this
    /// mutant. The mutant is caught, or proved to change nothing that is compared, or undecided. How many of them the
    /// core's own bench notices is counted as well. The exit code is 0 if at most 1 % of the faults of each
    /// configuration are undecided.
    #[command(after_help = "\
Examples:
  glint mutate my_core.toml                               the score, and what is undecided
  glint mutate my_core.toml --list                        the names of all faults
  glint mutate my_core.toml --only 'result[3]:inverted'   one fault: where it shows, a waveform
  glint mutate my_core.toml --full                        the emitted Verilog too
  glint mutate --out mutation                             a record of each configuration in configs/")]
    Mutate {
        #[command(flatten)]
        configs: Configs,
        /// List the faults, and plant none
        #[arg(long, conflicts_with_all = ["only", "out"])]
        list: bool,
        /// Plant this fault alone; where it is caught, write the waveform around it
        #[arg(long, value_name = "ID", conflicts_with = "out")]
        only: Option<String>,
        /// Plant faults in the emitted Verilog too; needs Icarus Verilog, Verilator and Yosys
        #[arg(long, conflicts_with_all = ["list", "only"])]
        full: bool,
        /// Write the record of each configuration, `<name>.json`, into this directory
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Time limit of each run of an outside tool, in seconds
        #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
        time_limit: u64,
    },
    /// Compute one point: golden registers, outputs and the formula in f64
    #[command(after_help = "\
Examples:
  glint eval my_core.toml cos_gamma=0.99 exponent=20 red=255
  glint eval my_core.toml cos_gamma=#1038090     a raw integer, as the port takes it
  glint eval my_core.toml --batch points.csv     a row of results for each row of operands
  glint eval my_core.toml --json                 the middle of the domain, for scripts")]
    Eval {
        /// A configuration
        config: PathBuf,
        /// Operands: `cos_gamma=0.99` is a value, `cos_gamma=#1038090` a raw integer. An operand that is not
        /// given is the middle of its domain, a colour the largest
        #[arg(value_name = "OPERAND=VALUE")]
        operands: Vec<String>,
        /// Compute many points: a CSV file with the names of operands in its first row, or - for standard input. The
        /// results are CSV, or with --json a list. Operands on the command line hold for all rows
        #[arg(long, value_name = "FILE.csv")]
        batch: Option<PathBuf>,
    },
    /// Print a page of documentation, in Markdown
    ///
    /// Ports, blocks, microprogram, clocks, accuracy, a worked example and the keys of a configuration, from the
    /// description that the Verilog is made of. With --out, each configuration gets the file `DIR/<name>.md`; a page that
    /// Glint did not write, or that was edited since, is left alone unless --force is given.
    #[command(after_help = "\
Examples:
  glint describe my_core.toml
  glint describe configs/rough.toml --out docs/devices")]
    Describe {
        #[command(flatten)]
        configs: Configs,
        /// Write the pages into this directory
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Replace pages that Glint did not write or that were edited since
        #[arg(long, requires = "out")]
        force: bool,
    },
    /// Show the stages of a pipeline
    ///
    /// For each stage: which microinstructions it is made of, what it computes, the delay of its longest path by the
    /// delays of the target, the slack (what the clock period leaves beside that and a register's own delay), and the
    /// bits of the registers behind it.
    #[command(after_help = "\
Examples:
  glint schedule my_pipeline.toml
  glint schedule my_pipeline.toml --svg drawings   a drawing of the stages, drawings/<name>.svg
  glint schedule my_pipeline.toml --json")]
    Schedule {
        #[command(flatten)]
        configs: Configs,
        /// Draw the stages too, a file for each configuration
        #[arg(long, value_name = "DIR")]
        svg: Option<PathBuf>,
        /// Replace drawings that Glint did not write or that were edited since
        #[arg(long, requires = "svg")]
        force: bool,
    },
    /// Measure area and frequency by synthesis, placement and routing
    ///
    /// iCE40 (UP5K) and ECP5 by Yosys and nextpnr over several seeds, Xilinx 7 by Yosys (area alone), 0.18 µm standard cells by
    /// Yosys and OpenSTA (before layout; a gate is a NAND2X1). Registers stand around the core, so that pins do not count; the
    /// delay of a DSP block always counts. Points a second are the median frequency divided by the clocks a
    /// point. The critical path has the names of the description. Results are cached in `.glint/` beside the
    /// configuration, until the Verilog or the tools change.
    #[command(after_help = "\
Examples:
  glint synth my_core.toml                            every target whose tools are installed
  glint synth my_core.toml --target ecp5 --seeds 11   one of them, more seeds
  glint synth --json                                  everything in configs/, for scripts
  glint synth --out synthesis                         a record of each configuration in configs/")]
    Synth(Box<commands::SynthArguments>),
    /// Find the smallest configuration of a device for an error
    ///
    /// The proved bound of the accuracy contract decides, so that the answer keeps the error for every operand of the domain.
    /// Keys that change neither ports nor formula are searched. Formats, domain and formula stay at their defaults, or as
    /// `--set` states them. Area and clock are estimates that were fitted to synthesis; `glint synth` measures the answer.
    #[command(after_help = "\
Examples:
  glint tune cosine-power --error 0.75                     3/4 of the outputs' last bit, on ECP5
  glint tune blinn --error 0.0005 --unit f --target ice40
  glint tune rough --error 0.9 --set cosine.fraction=16 --set exponent.bits=7 --out small_rough.toml
  glint tune gauss --error 0.001 --unit f --csv            the trade-off of error and area")]
    Tune(Box<commands::TuneArguments>),
    /// Prove the error bound of a contract with Gappa, from the netlist and the microprogram
    ///
    /// One computation is unrolled into its values. Each case of saturations, clamps and tables becomes a statement on
    /// real numbers with roundings: the output differs from the contract's formula by the bound at most. Gappa proves
    /// each statement. The cases cover the whole domain, so that the contract is proved if all of them are. With --coq
    /// the kernel of Coq checks each proof again. If a device has a step that cannot be stated so, the command names it,
    /// and the exit code is 1.
    #[command(after_help = "\
Examples:
  glint certify configs/cosine_power.toml
  glint certify configs/cosine_power.toml --out certificates   the scripts too
  glint certify configs/cosine_power.toml --coq                needs coqc, and Gappa's library for it")]
    Certify {
        #[command(flatten)]
        configs: Configs,
        /// Write each script as `DIR/<name>/<output>_<number>.g`
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Have Coq check each of Gappa's proofs
        #[arg(long)]
        coq: bool,
        /// Time limit of each proof, and of writing the statements of a configuration, in seconds
        #[arg(long, value_name = "SECONDS", default_value_t = 60)]
        time_limit: u64,
    },
    /// Write a datasheet, one HTML page that needs no network
    ///
    /// A page as a vendor's product guide: figures at a glance, block diagram, ports and formats, a worked
    /// example, a timing diagram from simulation, the microprogram by control lines, latency and throughput, the error
    /// bound with its proof and plots, a rendered highlight, an instance in Verilog, and the sources. Area,
    /// frequency, points a second and longest paths are those of a record of `glint synth`; without one it says what Yosys,
    /// if on PATH, makes of the device for iCE40, ECP5 and Xilinx 7, which takes a minute or more. A file
    /// that Glint did not write, or that was edited since, is left alone unless --force is given.
    #[command(after_help = "\
Examples:
  glint datasheet                                       all of configs/, into datasheets/
  glint datasheet my_core.toml --no-synthesis           in a second or two
  glint datasheet my_core.toml --out core.html          one page, under this name
  glint datasheet configs/rough.toml --wavedrom         also datasheets/rough.wavedrom.json")]
    Datasheet(commands::DatasheetArguments),
    /// Compare all devices with cos^n gamma at one exponent, side by side
    ///
    /// Every device has its default configuration, with the widths below where it has such a key. Configurations
    /// that you name are compared as they are. Errors are those
    /// of the reflectance f, the largest and the mean over gamma = 0 to 90 degrees, as a whole and by cause: the
    /// source's formula, the quantised operands, the fixed point. LUTs, DSP blocks and block RAMs of iCE40, ECP5 and
    /// Xilinx 7, frequencies and points a second come from records of `glint synth`; without a record Yosys is asked for
    /// the former, if it is on PATH, which takes a minute or more.
    #[command(after_help = "\
Examples:
  glint compare --exponent 100                       errors, clocks, ROM and synthesis at n = 100
  glint compare --no-synthesis --bits 10             in an instant; ten-bit colours
  glint compare --exponent 20 my_core.toml --csv     your configuration beside the devices
  glint compare --cosine-fraction 16 --json          coarser cosines, for scripts")]
    Compare {
        /// Configurations to compare with the devices
        #[arg(value_name = "CONFIG")]
        configs: Vec<PathBuf>,
        /// The specular exponent n
        #[arg(long, short = 'n', value_name = "N", default_value_t = 35)]
        exponent: u32,
        /// Bits of colours and outputs: the key colour.bits
        #[arg(long, value_name = "B", value_parser = clap::value_parser!(i64).range(1..=64))]
        bits: Option<i64>,
        /// Fraction bits of cosines: the key cosine.fraction
        #[arg(long, value_name = "C", value_parser = clap::value_parser!(i64).range(1..=64))]
        cosine_fraction: Option<i64>,
        /// Fraction bits of f: the key intensity.fraction
        #[arg(long, value_name = "F", value_parser = clap::value_parser!(i64).range(1..=64))]
        intensity_fraction: Option<i64>,
        /// Print CSV, for spreadsheets
        #[arg(long)]
        csv: bool,
        /// Where records of `synth --out` are; that of a configuration is found by its digest
        #[arg(long, value_name = "DIR", default_value = crate::synth::DIRECTORY)]
        figures: PathBuf,
        /// Do not ask Yosys what the devices take
        #[arg(long)]
        no_synthesis: bool,
        /// Time limit of each run of Yosys, in seconds
        #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
        time_limit: u64,
    },
    /// Draw a picture whose highlights are bit-accurate results of the device
    ///
    /// Ambient and diffuse light are f64, and so is all geometry; the specular term of every sample and light
    /// is a result of the device. Without a configuration it is the first device of `glint list` with its
    /// defaults. The same command gives the same bytes on every machine, whatever computes the points.
    #[command(after_help = "\
Examples:
  glint render --out sphere.png
  glint render configs/cosine_power.toml --shape group --exponent 80 --samples 4 --out group.png
  glint render core.toml --mesh bunny.obj --light 1,2,3 --light -2,1,1,0.3,0.3,0.5 --out bunny.png
  glint render configs/rough.toml --height grain.png --out rough.png
  glint render core.toml --compare --out beside.png     device, Blinn in f64, and their difference
  glint render core.toml --through verilator --out same.png")]
    Render(Box<commands::RenderArguments>),
    /// Measure all devices and the claims of their sources, and write a page about them
    ///
    /// Writes report.html, one page that needs no network, and report.json with all its figures: error curves of
    /// every device, the plots that the source documents (seeds 000 to 002) describe, and their claims, each with a
    /// verdict. The same tools give the same files. With Yosys on PATH, W and Schlick's function are synthesised.
    #[command(after_help = "\
Examples:
  glint report                            report/report.html and report/report.json
  glint report --out build --benchmark    also build/benchmark.json: W timed against Schlick
  glint report --json                     the claims, for scripts")]
    Report {
        /// Where the files go
        #[arg(long, value_name = "DIR", default_value = "report")]
        out: PathBuf,
        /// Also time W against Schlick's function, into a file of its own
        #[arg(long)]
        benchmark: bool,
        /// Do not ask Yosys what W and Schlick's function take
        #[arg(long)]
        no_synthesis: bool,
        /// Time limit of each run of Yosys, in seconds
        #[arg(long, value_name = "SECONDS", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
        time_limit: u64,
    },
    /// Verify configurations by every means that Glint has, and write a page about each
    ///
    /// Writes `DIR/<name>.html`, one page that needs no network, and `DIR/<name>.json` with the same for scripts: what was
    /// shown, by which check, over which domain, with which tools, and what is left open. Both are the same whenever they are
    /// made with the same tools, but for the page's last section: how long each check took, which `DIR/<name>.timings.json` has too.
    /// The exit code is 0 only if every check that covers the configuration, and that --without-tools does not leave out,
    /// was run and holds: a tool that is missing leaves the verification incomplete. So does a proof of the accuracy
    /// contract that takes more than some seconds, unless --full makes it or its record is in --proofs: that is found
    /// by the configuration's digest and checked again in part.
    #[command(after_help = "\
Examples:
  glint verify my_core.toml                       every check, in a minute or two
  glint verify my_core.toml --full                the whole proof, all faults: minutes to hours
  glint verify my_core.toml --without-tools       what needs no simulator, solver or synthesiser
  glint verify --json                             everything in configs/, for scripts")]
    Verify {
        #[command(flatten)]
        configs: Configs,
        /// Do everything, however long it takes
        #[arg(long)]
        full: bool,
        /// Only the checks that need no tool outside Glint
        #[arg(long)]
        without_tools: bool,
        /// Where the files go
        #[arg(long, value_name = "DIR", default_value = "verification")]
        out: PathBuf,
        /// Where records of `cosim --exhaustive --json` are, which stand for a long proof of the accuracy contract
        #[arg(long, value_name = "DIR", default_value = "proofs")]
        proofs: PathBuf,
        /// Time limit of each run of an outside tool, in seconds
        #[arg(long, value_name = "SECONDS", default_value_t = 3600, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
        time_limit: u64,
    },
    /// List the devices, and the configurations in configs/
    #[command(after_help = "\
Example:
  glint list --json")]
    List,
    /// Print a commented configuration of a device
    #[command(after_help = "\
Example:
  glint new rough --name my_core > my_core.toml")]
    New {
        /// A device of `glint list`
        device: String,
        /// The name of the top module [default: the device's, with _ for -]
        #[arg(long)]
        name: Option<String>,
    },
    /// Print a JSON Schema of the configuration keys, for editors and validators
    ///
    /// It has names, types, ranges, defaults and descriptions. Conditions between keys are checked when a
    /// configuration is read.
    #[command(after_help = "\
Example:
  glint schema > glint.schema.json
  and in the first line of my_core.toml: #:schema ./glint.schema.json")]
    Schema,
}

#[derive(Args)]
struct Configs {
    /// Configurations [default: all in configs/]
    #[arg(value_name = "CONFIG")]
    configs: Vec<PathBuf>,
}

#[derive(Args, Clone, Copy)]
struct Output {
    /// Print JSON, for scripts
    #[arg(long, global = true)]
    json: bool,
    /// No progress bars
    #[arg(long, short, global = true)]
    quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Simulator {
    /// Built in: rust_hdl, inside this program
    RustHdl,
    /// Icarus Verilog, on the emitted files
    Icarus,
    /// Verilator, on the emitted files
    Verilator,
}

/// A number of things, at least one: `1000000`, `1_000_000` or `1e6`.
fn count(text: &str) -> Result<u64, String> {
    let wanted = || "a whole number from 1 on is wanted, as 1000000 or 1e6".to_owned();
    let number = match text.split_once(['e', 'E']) {
        None => text.replace('_', "").parse().ok(),
        Some((digits, zeros)) => {
            let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
            let zeros: u32 = zeros.parse().map_err(|_| wanted())?;
            let shift = zeros.checked_sub(fraction.len() as u32).ok_or_else(wanted)?;
            let digits: Option<u64> = format!("{whole}{fraction}").parse().ok();
            digits.zip(10u64.checked_pow(shift)).and_then(|(digits, by)| digits.checked_mul(by))
        }
    };
    number.filter(|number| *number > 0).ok_or_else(wanted)
}

/// Runs the command line of this process with the devices of `registry`.
pub fn run(registry: &Registry) -> ExitCode {
    if let Err(error) = interrupt::listen() {
        failure::warn(&format!("an interruption may leave temporary files behind: {error}"));
    }
    run_from(registry, std::env::args_os())
}

/// Runs the command line `arguments`, the program's name first.
pub fn run_from(registry: &Registry, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error)
            if error.use_stderr() && arguments.iter().any(|argument| argument == "--json") =>
        {
            failure::print_problems(vec![failure::problem(error.render().to_string().trim_end())]);
            return ExitCode::from(error.exit_code() as u8);
        }
        Err(error) => {
            // Help and version go to standard output with exit code 0, the rest to standard error
            // with 2; a closed pipe is nobody's error.
            let _ = error.print();
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    let output = cli.output;
    if let Some(threads) = cli.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global();
        if let Err(error) = pool {
            failure::print(
                &anyhow::anyhow!("cannot start {threads} threads: {error}"),
                output.json,
            );
            return ExitCode::FAILURE;
        }
    }
    let done = match cli.command {
        None => commands::everything(registry, output, cli.details),
        Some(Command::Generate { configs, out, check, force }) => {
            commands::generate(registry, output, &configs.configs, &out, check, force)
        }
        Some(Command::Cosim { configs, exhaustive: true, resume, shard, .. }) => {
            let request = commands::ExhaustiveRequest { resume, shard };
            commands::exhaustive(registry, output, &configs.configs, &request)
        }
        Some(Command::Merge { config, files }) => {
            commands::merge(registry, output, &config, &files)
        }
        Some(Command::Cosim {
            configs,
            points,
            seed,
            simulator,
            exhaustive: false,
            vcd,
            time_limit,
            ..
        }) => {
            let request = commands::CosimRequest {
                points,
                seed,
                simulator,
                vcd,
                time_limit: std::time::Duration::from_secs(time_limit),
            };
            commands::cosim(registry, output, &configs.configs, &request)
        }
        Some(Command::Worst(arguments)) => commands::worst(registry, output, &arguments),
        Some(Command::Mutate { configs, list, only, full, out, time_limit }) => {
            let request = commands::MutateRequest {
                list,
                only,
                full,
                out,
                time_limit: std::time::Duration::from_secs(time_limit),
            };
            commands::mutate(registry, output, &configs.configs, &request)
        }
        Some(Command::Eval { config, operands, batch }) => {
            commands::eval(registry, output, &config, &operands, batch.as_deref())
        }
        Some(Command::Describe { configs, out, force }) => {
            commands::describe(registry, output, &configs.configs, out.as_deref(), force)
        }
        Some(Command::Certify { configs, out, coq, time_limit }) => {
            let time_limit = std::time::Duration::from_secs(time_limit);
            let request = commands::CertifyRequest { out, coq, time_limit };
            commands::certify(registry, output, &configs.configs, &request)
        }
        Some(Command::Schedule { configs, svg, force }) => {
            commands::schedule(registry, output, &configs.configs, svg.as_deref(), force)
        }
        Some(Command::Synth(arguments)) => commands::synth(registry, output, &arguments),
        Some(Command::Tune(arguments)) => commands::tune(registry, output, &arguments),
        Some(Command::Datasheet(arguments)) => commands::datasheet(registry, output, &arguments),
        Some(Command::Compare {
            configs,
            exponent,
            bits,
            cosine_fraction,
            intensity_fraction,
            csv,
            figures,
            no_synthesis,
            time_limit,
        }) => {
            let widths = [
                ("colour.bits", bits),
                ("cosine.fraction", cosine_fraction),
                ("intensity.fraction", intensity_fraction),
            ];
            let given = |(key, value): (_, Option<i64>)| value.map(|value| (key, value));
            let request = commands::CompareRequest {
                exponent,
                widths: widths.into_iter().filter_map(given).collect(),
                csv,
                figures,
                synthesis: !no_synthesis,
                time_limit: std::time::Duration::from_secs(time_limit),
            };
            commands::compare(registry, output, &configs, &request)
        }
        Some(Command::Render(arguments)) => commands::render(registry, output, &arguments),
        Some(Command::Report { out, benchmark, no_synthesis, time_limit }) => {
            let request = commands::ReportRequest {
                out,
                benchmark,
                synthesis: !no_synthesis,
                time_limit: std::time::Duration::from_secs(time_limit),
            };
            commands::report(registry, output, &request)
        }
        Some(Command::Verify { configs, full, without_tools, out, proofs, time_limit }) => {
            let request = commands::VerifyRequest {
                full,
                without_tools,
                out,
                proofs,
                time_limit: std::time::Duration::from_secs(time_limit),
            };
            commands::verify(registry, output, &configs.configs, &request)
        }
        Some(Command::List) => commands::list(registry, output),
        Some(Command::New { device, name }) => {
            commands::new(registry, output, &device, name.as_deref())
        }
        Some(Command::Schema) => {
            tables::print_json(&crate::config::json_schema(&registry.schemas()));
            Ok(true)
        }
    };
    let code = match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            failure::print(&error, output.json);
            failure::exit_code(&error)
        }
    };
    match tables::finish() {
        Ok(()) => code,
        Err(error) => {
            failure::print(&error, false);
            ExitCode::FAILURE
        }
    }
}
