//! Legs that run tools outside Glint, on the emitted files.

use std::fs;

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::{Finding, Leg, Subject, Verdict};
use crate::cosim::external::{Simulator, lint, run_bench};
use crate::cosim::synthesis::{FAMILIES, synthesise};
use crate::emit;
use crate::flow::BENCH_SEED;
use crate::words::grouped;

/// Results of a bench, and with full effort.
const POINTS: [u64; 2] = [200, 20_000];

/// The emitted text.
pub const LINT: Leg = Leg {
    id: "lint",
    title: "Lint",
    question: "Have linters at their strictest nothing to say about the emitted Verilog?",
    tools: &["iverilog", "verilator"],
    steps: |_| 1,
    run: |subject, tools, _| {
        let place = tempfile::tempdir().context("cannot make a directory for the linters")?;
        let mut sources = Vec::new();
        for (name, contents) in subject.unit.verilog()? {
            fs::write(place.path().join(&name), contents)
                .with_context(|| format!("cannot write `{name}` for the linters"))?;
            if name.ends_with(".v") {
                sources.push(name);
            }
        }
        let (name, limit) = (&subject.unit.config.name, subject.effort.time_limit);
        let mut faults = Vec::new();
        for tool in tools {
            let remarks = lint(tool, place.path(), &sources, name, limit)?;
            if !remarks.trim().is_empty() {
                faults.push(format!("{tool}: {}", remarks.trim()));
            }
        }
        Ok(Finding::new(
            Verdict::Passed,
            sources.join(", "),
            "Neither has a remark.".to_owned(),
            faults,
        ))
    },
};

/// The emitted Verilog in Icarus Verilog.
pub const ICARUS: Leg = Leg {
    id: "icarus",
    title: "Emitted Verilog in Icarus Verilog",
    question: "Does the emitted Verilog give, on every clock, the outputs on which golden model and simulation agree?",
    tools: &["iverilog", "vvp"],
    steps: |_| 1,
    run: |subject, _, _| bench(subject, Simulator::Icarus),
};

/// The emitted Verilog in Verilator.
pub const VERILATOR: Leg = Leg {
    id: "verilator",
    title: "Emitted Verilog in Verilator",
    question: ICARUS.question,
    tools: &["verilator"],
    steps: |_| 1,
    run: |subject, _, _| bench(subject, Simulator::Verilator),
};

fn bench(subject: &Subject<'_>, simulator: Simulator) -> Result<Finding> {
    let (unit, effort) = (subject.unit, subject.effort);
    let points = POINTS[usize::from(effort.full)];
    let vectors = unit.vectors(points, BENCH_SEED)?;
    let clocks = vectors.inputs.len() as u64;
    let files = emit::sources(unit.files(subject.path, vectors)?);
    let top = format!("{}_tb", unit.config.name);
    let outcome = run_bench(simulator, &files, &top, effort.time_limit)?;
    let faults = match outcome.passed {
        true => Vec::new(),
        false => vec![outcome.transcript.trim().to_owned()],
    };
    Ok(Finding::new(
        Verdict::Passed,
        format!(
            "{} results in {} clocks (seed {BENCH_SEED})",
            grouped(points),
            grouped(clocks)
        ),
        "Every output is right on every clock.".to_owned(),
        faults,
    )
    .open("Operands that were not drawn."))
}

/// What the device takes of FPGAs.
pub const SYNTHESIS: Leg = Leg {
    id: "synthesis",
    title: "Synthesis",
    question: "Is the emitted Verilog synthesised for each family of FPGAs, and what does it take?",
    tools: &["yosys"],
    steps: |_| FAMILIES.len() as u64,
    run: |subject, tools, progress| {
        let (name, limit) = (&subject.unit.config.name, subject.effort.time_limit);
        let files = subject.unit.verilog()?;
        let taken: Vec<String> = FAMILIES
            .par_iter()
            .map(|family| {
                let usage = synthesise(&tools[0], &files, name, family, limit)?;
                progress(1);
                Ok(format!(
                    "{} LUTs, {} DSP blocks and {} block RAMs of {}",
                    usage.luts, usage.dsps, usage.block_rams, family.title
                ))
            })
            .collect::<Result<_>>()?;
        Ok(Finding::new(
            Verdict::Passed,
            "before placement".to_owned(),
            format!("It takes {}.", taken.join("; ")),
            Vec::new(),
        ))
    },
};
