//! Defines the checks of `glint verify` that run outside tools: provers, solvers, linters, simulators and synthesis.
//!
//! Most of the checks read the emitted files. [`CERTIFICATE`] reads the netlist and the microprogram, [`EQUALITY`] the netlists
//! of a pipeline and its sequential core, and [`TEXT`] the Verilog and the netlist.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::{Check, CheckSubject, CheckVerdict, Finding};
use crate::certify::{self, ProofOutcome, statements};
use crate::equality;
use glint_base::input;
use glint_base::program::Program;
use glint_base::target::{COMPARED, Family};
use glint_base::text::{counted, grouped};
use glint_core::core::{BENCH_SEED, Core};
use glint_core::package::{self, FileKind, OutputFile};
use glint_rtl::netlist::Role;
use glint_tools::gates;
use glint_tools::gates::cells::{LIBERTY, Start};
use glint_tools::synthesis::synthesise;
use glint_tools::transient::Directory;
use glint_tools::{Limits, PROOF_LIMITS, VerilogSimulator, elaborate, lint, prove, run_bench};

/// The number of results that a bench compares: without `--full`, and with it.
const POINTS: [u64; 2] = [200, 20_000];

/// The time limit for writing the statements for Gappa, and for proving one of them, without `--full`.
const STATEMENT: Duration = Duration::from_secs(10);

/// The time limit of the solver for each of the proofs of [`EQUALITY`] and [`TEXT`], without `--full`.
const EQUAL: Duration = Duration::from_secs(300);

/// The version of cocotb that the benches in Python are written for.
const COCOTB_VERSION: &str = "2.1.0";

/// The number of results of a bench at gate level.
const GATE_POINTS: u64 = 40;

/// The proof of the error bound with Gappa. If the statements cannot be written, or Gappa does not prove one in time, the check
/// is unconfirmed. It does not fail, because another check also shows the bound. It does not apply to a pipeline.
pub const CERTIFICATE: Check = Check {
    id: "certificate",
    title: "Proof of the error bound",
    question: "Does the bound of the contract follow from the netlist and the microprogram, for all operands?",
    reads: "the netlist and the microprogram",
    tools: &["gappa"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let Core { design, contract, .. } = subject.core;
        if design.pipeline.is_some() {
            let why = "The proof needs a microprogram, which a pipeline does not have: verify the sequential \
                       core of the same description.";
            return Ok(Finding::without(CheckVerdict::NotApplicable, why));
        }
        let own = if subject.effort.full { subject.effort.time_limit } else { STATEMENT };
        let limit = own.min(subject.effort.time_limit);
        let statements = match statements(design, contract.as_ref(), limit) {
            Ok(statements) => statements,
            Err(step) => {
                let why = format!("No statements can be written for Gappa: {step}.");
                return Ok(Finding::without(CheckVerdict::Unconfirmed, why));
            }
        };
        let outcome = |statement| (statement, certify::prove(&tools[0], None, statement, limit));
        let empty = AtomicUsize::new(0);
        let open = |(_, outcome): &(_, Result<ProofOutcome>)| {
            if let Ok(ProofOutcome::Proved(_, certify::ProofSubject::Nothing)) = outcome {
                empty.fetch_add(1, Ordering::Relaxed);
            }
            !matches!(outcome, Ok(ProofOutcome::Proved(..)))
        };
        // The first statement without a proof ends the check. `find_first` takes the first one in the list, whichever proof
        // ends first.
        if let Some((statement, outcome)) = statements.par_iter().map(outcome).find_first(open) {
            outcome?;
            let why = format!(
                "Gappa does not prove statement {} of `{}` within {} s; there are {} statements.",
                statement.number,
                statement.output,
                limit.as_secs(),
                statements.len()
            );
            return Ok(Finding::without(CheckVerdict::Unconfirmed, why));
        }
        Ok(Finding::new(
            CheckVerdict::Proved,
            "all operands of the domain",
            format!(
                "Gappa proves {} statements{}: every output differs from its formula by at most {:.3} units.",
                statements.len(),
                match empty.into_inner() {
                    0 => String::new(),
                    empty => format!(", of which {empty} have hypotheses that contradict each other"),
                },
                contract.bounds().governing().units
            ),
        )
        .open("The words of tables: the statements use them unchecked."))
    },
};

/// The proof that a pipeline equals its sequential core. It does not apply to a sequential core.
pub const EQUALITY: Check = Check {
    id: "equality",
    title: "Equal to the sequential core",
    question: "Does the pipeline have the same results as the sequential core of the same description, for \
               every point?",
    reads: "the netlists of pipeline and sequential core",
    tools: &["z3"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let (core, effort) = (subject.core, subject.effort);
        if core.design.pipeline.is_none() {
            let why = "This core is the sequential core.";
            return Ok(Finding::without(CheckVerdict::NotApplicable, why));
        }
        let sequential = core.opened.sequential()?;
        let limit = if effort.full { effort.time_limit } else { EQUAL.min(effort.time_limit) };
        Ok(match equality::compare(&sequential, &core.design, &tools[0], limit)? {
            equality::Verdict::Equal(proof) => Finding::new(
                CheckVerdict::Proved,
                "every point: all bits of all operands",
                format!(
                    "{} and {} of the core on the way to the outputs are equal, for any values of {} and of \
                     the words of memories.",
                    counted(proof.outputs, "output"),
                    counted(proof.registers, "register value"),
                    counted(proof.products, "product"),
                ),
            )
            .open("Stalls and resets: the values of a stage depend on this stage alone, and another check \
                   proves the handshake by induction."),
            equality::Verdict::Different(difference) => {
                Finding::default().failures(vec![difference.to_string()])
            }
            equality::Verdict::Open(open) => undecided(subject, open, limit),
        })
    },
};

/// The proof with Yosys and z3 that the emitted Verilog of a pipeline equals its netlist. It does not apply to a sequential core.
pub const TEXT: Check = Check {
    id: "text",
    title: "Emitted Verilog equal to the netlist",
    question: "Does the emitted Verilog of the pipeline, including the memories of delay lines, have the \
               same outputs as its netlist, for every point?",
    reads: "the Verilog and memory files of the core, and the netlist",
    tools: &["yosys", "z3"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let (core, effort) = (subject.core, subject.effort);
        if core.design.pipeline.is_none() {
            let why = "This check is only for pipelines; the Verilog of a core with a microprogram is \
                       simulated.";
            return Ok(Finding::without(CheckVerdict::NotApplicable, why));
        }
        let limit = if effort.full { effort.time_limit } else { EQUAL.min(effort.time_limit) };
        // A word that the table loads would change the results of later points.
        let writes = core.design.port(|role| role == Role::TableWrite);
        let held_low: Vec<&str> =
            writes.iter().map(|port| core.design.net(port.net).name.as_str()).collect();
        let sources = subject.sources("")?;
        let text =
            elaborate(&tools[0], &sources, &core.config().name, &held_low, effort.time_limit)?;
        Ok(match equality::compare_text(&core.design, &text, &tools[1], limit)? {
            equality::TextVerdict::Equal(proof) => Finding::new(
                CheckVerdict::Proved,
                "every point, with stalls, from any state of registers, valid bits and memories after a reset",
                format!(
                    "{} of the emitted Verilog equal the outputs of the netlist{}; the check above is about \
                     the netlist.",
                    counted(proof.outputs, "output"),
                    match proof.delays.len() {
                        0 => String::new(),
                        memories => format!(
                            ", and {} delay by a fixed number of clocks",
                            counted(memories, "memory port")
                        ),
                    }
                ),
            )
            .open("Resets between points, which the proof of the handshake covers; how tools other than \
                   Yosys read the Verilog."),
            equality::TextVerdict::Different(difference) => {
                Finding::default().failures(vec![difference])
            }
            equality::TextVerdict::Open(open) => undecided(subject, open, limit),
            equality::TextVerdict::Unread(why) => Finding::without(CheckVerdict::Undecided, format!("{why}.")),
        })
    },
};

fn undecided(subject: &CheckSubject<'_>, open: equality::Open, limit: Duration) -> Finding {
    let limit = limit.as_secs();
    match open {
        equality::Open::Unknown => Finding::without(
            CheckVerdict::Undecided,
            "Unknown: z3 gives up, or proposes impossible values of products. No point with a difference was \
             found.",
        ),
        equality::Open::Limit => Finding {
            complete_with: Some(format!(
                "{Program} verify {} --full --time-limit {}",
                input::label(subject.path),
                limit.saturating_mul(10)
            )),
            ..Finding::without(
                CheckVerdict::LimitReached,
                format!(
                    "z3 finds no proof within {limit} s. No point with a difference was found."
                ),
            )
        },
    }
}

/// The check by linters. Any remark is a failure.
pub const LINT: Check = Check {
    id: "lint",
    title: "Lint",
    question: "Do the linters, with their strictest settings, report nothing about the emitted Verilog?",
    reads: "the Verilog and memory files of the core",
    tools: &["iverilog", "verilator"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let dir = Directory::new().context("cannot make a directory for the linters")?;
        let limit = subject.effort.time_limit;
        let files = subject.files()?;
        let mut sources = Vec::new();
        for file in files.of(FileKind::DESIGN_SOURCES) {
            let name = file.name();
            fs::write(dir.path().join(name), &file.contents)
                .with_context(|| format!("cannot write `{name}` for the linters"))?;
            if file.kind.is_verilog() {
                sources.push(name.to_owned());
            }
        }
        let mut failures = Vec::new();
        for top in files.top_modules() {
            for tool in tools {
                let remarks = lint(tool, dir.path(), &sources, top, limit)?;
                if !remarks.trim().is_empty() {
                    failures.push(format!("{tool}: {}", remarks.trim()));
                }
            }
        }
        Ok(Finding::new(
            CheckVerdict::Passed,
            sources.join(", "),
            "Neither Icarus Verilog nor Verilator reports anything.",
        )
        .failures(failures))
    },
};

pub const ICARUS: Check = Check {
    id: "icarus",
    title: "Emitted Verilog in Icarus Verilog",
    question: "Does the emitted Verilog give, on every clock, the outputs on which golden model and simulation agree?",
    reads: "the Verilog and memory files of the core, and the shipped bench with other points",
    tools: &["iverilog", "vvp"],
    steps: |_| 1,
    run: |subject, _, _| bench(subject, VerilogSimulator::Icarus),
};

pub const VERILATOR: Check = Check {
    id: "verilator",
    title: "Emitted Verilog in Verilator",
    question: ICARUS.question,
    reads: "the Verilog and memory files of the core, and the shipped bench with other points",
    tools: &["verilator"],
    steps: |_| 1,
    run: |subject, _, _| bench(subject, VerilogSimulator::Verilator),
};

/// Simulates the emitted Verilog with each shipped bench, for 200 results, or 20 000 with `--full`.
fn bench(subject: &CheckSubject<'_>, simulator: VerilogSimulator) -> Result<Finding> {
    let (core, effort) = (subject.core, subject.effort);
    let points = POINTS[usize::from(effort.full)];
    let vectors = core.vectors(points, BENCH_SEED)?;
    let clocks = vectors.inputs.len() as u64;
    let files = core.files(subject.path, vectors)?;
    let sources = files.sources(FileKind::SIMULATED);
    let mut failures = Vec::new();
    for bench in files.modules(&[FileKind::Bench]) {
        let outcome = run_bench(simulator, &sources, bench, effort.time_limit)?;
        if !outcome.passed {
            failures.push(outcome.transcript.trim().to_owned());
        }
    }
    Ok(Finding::new(
        CheckVerdict::Passed,
        format!("{} results in {} clocks (seed {BENCH_SEED})", grouped(points), grouped(clocks)),
        "Every output is right on every clock.",
    )
    .failures(failures)
    .open("Operands that were not drawn."))
}

pub const SYNTHESIS: Check = Check {
    id: "synthesis",
    title: "Synthesis",
    question: "Can Yosys synthesise the emitted Verilog for each family of FPGAs, and how many cells does \
               the core take?",
    reads: "the Verilog and memory files of the core",
    tools: &["yosys"],
    steps: |_| COMPARED.len() as u64,
    run: |subject, tools, progress| {
        let (name, limit) = (&subject.core.config().name, subject.effort.time_limit);
        let taken: Vec<String> = COMPARED
            .par_iter()
            .map(|family| {
                let files = subject.sources(family.name())?;
                let usage = synthesise(&tools[0], &files, name, family, limit)?.usage;
                progress(1);
                Ok(format!(
                    "{} LUTs, {} DSP blocks and {} block RAMs of {}",
                    usage.luts, usage.dsps, usage.block_rams, family.title
                ))
            })
            .collect::<Result<_>>()?;
        Ok(Finding::new(
            CheckVerdict::Passed,
            "before placement",
            format!("The core takes {}.", taken.join("; ")),
        ))
    },
};

/// The handshake's proof. Arbitrary values replace products and ROMs, so the check says nothing about results.
pub const FORMAL: Check = Check {
    id: "formal",
    title: "Proof of the handshake",
    question: "Do valid, busy and done come exactly when they should, for all inputs and from any state, and are operands stable meanwhile?",
    reads: "the emitted files, in which products and ROMs of the datapath are replaced by arbitrary values",
    tools: &["yosys", "yosys-smtbmc", "z3"],
    steps: |_| 1,
    run: |subject, _, _| {
        // All files are in one directory, without their folders. Modules for one target only are left out.
        let mut plain = Vec::new();
        for file in subject.files()? {
            if file.kind.folder() != "software" && file.target.is_none() {
                plain.push(OutputFile { path: file.name().to_owned(), ..file.clone() });
            }
        }
        let dir = directory_of(&plain)?;
        let time = subject.effort.time_limit.min(PROOF_LIMITS.time);
        let proofs = subject.files()?.of(&[FileKind::CoreProof, FileKind::WrapperProof]);
        let mut files: Vec<&str> = proofs.iter().map(|file| file.name()).collect();
        files.sort_unstable();
        for file in &files {
            prove(dir.path(), file, Limits { time, ..PROOF_LIMITS })?;
        }
        Ok(Finding::new(
            CheckVerdict::Proved,
            "all inputs, any state, any number of clocks",
            format!("The properties of {} are proved by k-induction.", files.join(", ")),
        )
        .open("Values: products and ROMs of the datapath are replaced by arbitrary values."))
    },
};

/// The check that runs the emitted benches in Python with cocotb. The benches know the core only from its manifest.
pub const COCOTB: Check = Check {
    id: "cocotb",
    title: "Emitted Verilog driven from Python",
    question: "Does the core do what its manifest says, in a Python test bench that knows only the manifest?",
    reads: "the emitted files",
    tools: &["python3", "iverilog"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let limit = subject.effort.time_limit;
        let (python, here) = (&tools[0], std::path::Path::new("."));
        let version =
            python.run(["-c", "import cocotb; print(cocotb.__version__)"], here, limit)?;
        if !version.status.success() {
            let why = format!(
                "{0} has no cocotb; install it with `{0} -m pip install cocotb=={COCOTB_VERSION}`. If the \
                 system manages Python: `python3 -m venv env`, `env/bin/pip install \
                 cocotb=={COCOTB_VERSION}`, and put env/bin first on PATH",
                python.path().display()
            );
            return Ok(Finding::without(CheckVerdict::NotRun, why));
        }
        let dir = written(subject)?;
        let benches = subject.files()?.of(&[FileKind::CocotbBench]);
        let (mut verdicts, mut failures) = (Vec::new(), Vec::new());
        for bench in &benches {
            let run = python.run([&bench.path], dir.path(), limit)?;
            let verdict = run.output.lines().rev().find(|line| line.starts_with("PASS "));
            match verdict.filter(|_| run.status.success()) {
                Some(verdict) => verdicts.push(verdict.to_owned()),
                None => failures.push(run.output.trim().to_owned()),
            }
        }
        let benches: Vec<&str> = benches.iter().map(|file| file.path.as_str()).collect();
        Ok(Finding::new(
            CheckVerdict::Passed,
            format!("{}, with cocotb {}", benches.join(", "), version.output.trim()),
            verdicts.join("; "),
        )
        .failures(failures)
        .open("Operands that were not drawn."))
    },
};

/// Writes all emitted files, and the Python driver, into a new temporary directory, each at its path.
fn written(subject: &CheckSubject<'_>) -> Result<Directory> {
    directory_of(subject.files()?.iter().chain([&package::driver()]))
}

pub(super) fn directory_of<'f>(
    files: impl IntoIterator<Item = &'f OutputFile>,
) -> Result<Directory> {
    let dir = Directory::new().context("cannot make a directory for the emitted files")?;
    for file in files {
        let path = dir.path().join(&file.path);
        path.parent()
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| fs::write(&path, &file.contents))
            .with_context(|| format!("cannot write `{}` for a tool", file.path))?;
    }
    Ok(dir)
}

/// The check of netlists after synthesis: for the FPGA families with cell models, and of 0.18 µm cells if their library is
/// installed.
pub const GATES: Check = Check {
    id: "gates",
    title: "Netlists at gate level",
    question: "Do the netlists that Yosys makes for FPGAs and of standard cells, including ROM contents, \
               pass the bench of the emitted Verilog?",
    reads: "netlists that Yosys makes of the Verilog and memory files of the core, and the shipped bench with other points",
    tools: &["yosys", "iverilog", "vvp"],
    steps: |_| simulated().count() as u64 + 1,
    run: |subject, tools, progress| {
        let (name, limit) = (&subject.core.config().name, subject.effort.time_limit);
        let vectors = subject.core.vectors(GATE_POINTS, BENCH_SEED)?;
        let clocks = vectors.inputs.len() as u64;
        let emitted = subject.core.files(subject.path, vectors)?;
        let sources = emitted.sources(FileKind::SIMULATED);
        let benches = emitted.modules(&[FileKind::Bench]);
        let bench = benches.first().context("the core has no bench")?;
        let families: Vec<_> = simulated().collect();
        let failures: Vec<Option<String>> = families
            .par_iter()
            .map(|family| {
                let rtl = subject.sources(family.name())?;
                let names: Vec<String> = rtl.iter().map(|(name, _)| name.clone()).collect();
                let netlist = gates::netlist(&tools[0], &rtl, name, family, limit)?;
                let files = gates::bench(&tools[0], sources.clone(), &names, netlist, family)?;
                let outcome = run_bench(VerilogSimulator::Icarus, &files, bench, limit)?;
                progress(1);
                let failure = || format!("{}: {}", family.title, outcome.transcript.trim());
                Ok((!outcome.passed).then(failure))
            })
            .collect::<Result<_>>()?;
        let titles: Vec<&str> = families.iter().map(|family| family.title).collect();
        let mut failures: Vec<String> = failures.into_iter().flatten().collect();
        // Standard cells have no memory whose contents are known before they are written.
        let is_written = subject.core.design.has_write_port();
        let cells = Path::new(LIBERTY).is_file() && !is_written;
        if cells {
            let rtl = subject.core.verilog()?;
            let names: Vec<String> = rtl.iter().map(|(name, _)| name.clone()).collect();
            let netlist = gates::cells::netlist(&tools[0], &rtl, name, limit)?;
            for &start in Start::of(subject.core.design.pipeline.is_some()) {
                let models = gates::cells::models(start)?;
                let files = gates::around(sources.clone(), &names, netlist.clone(), models);
                let outcome = run_bench(VerilogSimulator::Icarus, &files, bench, limit)?;
                if !outcome.passed {
                    failures.push(format!("cells, {start:?}: {}", outcome.transcript.trim()));
                }
            }
        }
        progress(1);
        let cells = if cells { ", and of cells of 0.18 µm" } else { "" };
        Ok(Finding::new(
            CheckVerdict::Passed,
            format!(
                "{} results in {} clocks (seed {BENCH_SEED}) of the netlists for {}{cells}",
                grouped(GATE_POINTS),
                grouped(clocks),
                titles.join(" and ")
            ),
            "Every output is right on every clock.",
        )
        .failures(failures)
        .open(match is_written {
            true => {
                "Timing: the models of the cells have no delays. Families for which not all cells have models. Standard \
                 cells, in which a table that can be written has no words at power-up."
            }
            false => {
                "Timing: the models of the cells have no delays. Families for which not all cells have models."
            }
        }))
    },
};

fn simulated() -> impl Iterator<Item = &'static Family> {
    COMPARED.iter().filter(|family| gates::is_simulated(family))
}
