//! Parses the command line and runs the commands. Of the crates in `generator/`, only this one prints and decides the exit code
//! of the process.

mod choice;
mod commands;
mod destination;
mod directories;
mod failure;
mod interrupt;
mod own_file;
mod progress;
mod record_text;
mod report;
mod store;
mod tables;

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use failure::wrong_usage;
use glint_base::program::{self, Program};
use glint_core::registry::Registry;
use tables::say;

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
    /// Only without a command: print for each configuration what was compared, and the operands with the largest error
    #[arg(long)]
    details: bool,
    /// The largest number of threads to use [default: the number of processors]
    #[arg(long, value_name = "N", global = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "\
Examples:
  glint                                         generate and check everything in configs/
  glint new rough > my_core.toml                a configuration to edit
  glint new rsqrt --pipelined --stream --clock 100 > rsqrt.toml
  glint generate my_core.toml --out build       Verilog, ROMs, manifest and bench into build/
  glint cosim my_core.toml --points 1000000     golden model against hardware, every clock
  glint cosim my_core.toml --simulator icarus   the emitted Verilog in Icarus Verilog
  glint cosim my_core.toml --points 20 --vcd wave.vcd
  glint mutate my_core.toml                     plants thousands of faults: does a test notice each?
  glint eval my_core.toml cos_gamma=0.99 exponent=20 red=255
  glint setup my_core.toml gamma=8 exponent=20  operands from angles or vectors
  glint describe my_core.toml                   ports, blocks, microprogram, accuracy: a page
  glint datasheet my_core.toml                  the same as a product guide in HTML
  glint estimate my_core.toml                   area and clock on each FPGA family, without tools
  glint synth my_core.toml                      area, frequency and critical path
  glint compare --exponent 100                  all devices side by side
  glint verify my_core.toml                     every proof and test, and a page with the results
  glint render my_core.toml --out sphere.png    a picture with the highlights of the bit-accurate device

Exit codes: 0 everything holds; 1 something does not hold or could not be done; 2 wrong usage.";

/// Declares the subcommands. Each is a module of [`commands`] with a type `Arguments` and a function `run`.
macro_rules! commands {
    ($($command:ident $module:ident;)*) => {
        #[derive(Subcommand)]
        enum Command {
            $($command(Box<commands::$module::Arguments>),)*
        }

        impl Command {
            fn run(&self, registry: &Registry, output: OutputOptions) -> anyhow::Result<bool> {
                match self {
                    $(Self::$command(arguments) => commands::$module::run(registry, output, arguments),)*
                }
            }
        }
    };
}

commands! {
    Generate generate; Cosim cosim; Merge merge; Worst worst; Mutate mutate; Eval eval; Setup setup;
    Describe describe; Schedule schedule; Estimate estimate; Synth synth; Tune tune; Certify certify;
    Datasheet datasheet; Compare compare; Render render; Verify verify;
    Table table; List list; New new; NewDevice new_device; Schema schema; Explain explain;
}

#[derive(Args, Clone, Copy)]
struct Force {
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct Configs {
    /// Configurations [default: all in configs/]
    #[arg(value_name = "CONFIG")]
    paths: Vec<PathBuf>,
}

#[derive(Args, Clone, Copy)]
struct TimeLimit<const DEFAULT: u64 = 600> {
    /// Time limit of each run of an outside tool, in seconds
    #[arg(
        long = "time-limit",
        value_name = "SECONDS",
        // `default_value_t` would store one text for all values of DEFAULT.
        default_value = DEFAULT.to_string(),
        value_parser = clap::value_parser!(u64).range(1..=1_000_000)
    )]
    seconds: u64,
}

impl<const DEFAULT: u64> TimeLimit<DEFAULT> {
    fn get(self) -> Duration {
        Duration::from_secs(self.seconds)
    }
}

#[derive(Args, Clone, Copy)]
struct OutputOptions {
    /// Print JSON, for scripts
    #[arg(long, global = true)]
    json: bool,
    /// Show no progress bars
    #[arg(long, short, global = true)]
    quiet: bool,
}

/// Parses `arguments`, with the name of the running program in the examples of the help texts. Fails with clap's error for wrong
/// usage, and also for `--help` and `--version`.
fn parse(arguments: &[OsString]) -> Result<Cli, clap::Error> {
    let examples = |command: clap::Command| match command.get_after_help() {
        None => command,
        Some(help) => {
            let help = help.to_string().replace("\n  glint ", &format!("\n  {Program} "));
            command.after_help(help)
        }
    };
    let mut command = examples(Cli::command()).mut_subcommands(examples);
    Cli::from_arg_matches(&command.try_get_matches_from_mut(arguments)?)
}

/// Parses a finite number, such as `0.75` or `12e6`.
fn number(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "expected a number, for example 0.75 or 12e6".to_owned())
}

/// Parses a whole number of at least 1 and at most 64 bits. Exponents are allowed. For example, `1000000`, `1_000_000` and `1e6`
/// are a million, and `1.5e3` is 1500.
fn count(text: &str) -> Result<u64, String> {
    let wanted = || "expected a whole number of at least 1, for example 1000000 or 1e6".to_owned();
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

/// Runs the command line of this process with the devices of `registry`. Messages call the program by the name of its
/// executable file.
pub fn run(registry: &Registry) -> ExitCode {
    let path = std::env::args_os().next().unwrap_or_default();
    let name = Path::new(&path).file_stem().and_then(OsStr::to_str).unwrap_or("glint");
    run_as(name, registry)
}

/// Runs the command line of this process. Messages and written files call the program `program`.
pub fn run_as(program: &str, registry: &Registry) -> ExitCode {
    run_with(program, registry, std::env::args_os())
}

/// Runs the command line `arguments`, for example inside a Python interpreter. `arguments` begins with the program's name.
/// Messages and written files call the program `program`.
pub fn run_with(
    program: &str,
    registry: &Registry,
    arguments: impl IntoIterator<Item = OsString>,
) -> ExitCode {
    program::run_as(program);
    if let Err(error) = interrupt::listen() {
        failure::warn(&format!(
            "cannot handle signals, so an interrupted command may leave temporary files behind: {error}"
        ));
    }
    run_from(registry, arguments)
}

/// Runs a command line without installing a signal handler. `arguments` begins with the program's name.
pub fn run_from(registry: &Registry, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let cli = match parse(&arguments) {
        Ok(cli) => cli,
        Err(error)
            if error.use_stderr() && arguments.iter().any(|argument| argument == "--json") =>
        {
            failure::print_problems(vec![failure::problem(error.render().to_string().trim_end())]);
            return ExitCode::from(error.exit_code() as u8);
        }
        Err(error) => {
            // Help and version go to standard output with exit code 0, and wrong usage goes to standard error with exit code
            // 2. A closed pipe is no error.
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
        None => commands::main_job::run(registry, output, cli.details),
        Some(command) => command.run(registry, output),
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
