//! Defines the checks of `glint verify` that need no outside tool: design rules, co-simulation, the error bound and faults.
//!
//! Without `--full` ([`super::Effort::full`]), a check does only a part of a long job, or leaves it out, and its finding says so.
//! Random stimulus has a fixed seed, so a repeated run has the same findings.

use std::ops::ControlFlow;

use anyhow::Result;

use super::{Check, CheckSubject, CheckVerdict, Finding};
use crate::mutate::{self, Faults, NetlistFault, Score};
use glint_base::input;
use glint_base::program::Program;
use glint_base::text::{counted, grouped};
use glint_core::core::{TEST_POINTS, TEST_SEED};
use glint_core::cosim::exhaustive::{Job, Proof, Record, Shard, ShardState};
use glint_golden::{Bound, Contract, Sweep};

/// The number of results that are compared without `--full`, and with it.
const POINTS: [u64; 2] = [TEST_POINTS, 100 * TEST_POINTS];

/// The largest number of evaluations of the golden model without `--full`. They take some seconds.
const EVALUATIONS: u64 = 1 << 28;

/// The approximate number of evaluations of `f` that are repeated for a recorded proof.
const AGAIN: u64 = 1 << 24;

/// The largest number of faults that are planted without `--full`. The check then takes a minute or two.
const MOST_FAULTS: usize = 1 << 11;

/// The check of the design rules. Its finding also says whether the error bound is below its limit.
pub const DESIGN: Check = Check {
    id: "design",
    title: "Design rules",
    question: "Is every net driven once, every width explicit, every value within its interval, and is there no loop?",
    reads: "the netlist, of which the files are made",
    tools: &[],
    steps: |_| 1,
    run: |subject, _, _| {
        let (design, bounds) = (&subject.core.design, subject.core.contract.bounds());
        let finding = Finding::new(
            CheckVerdict::Proved,
            "all nets, registers, ROMs and microinstructions",
            format!(
                "{}, {}, {} and {} obey the rules. {}",
                counted(design.nets.len(), "net"),
                counted(design.registers.len(), "register"),
                counted(design.roms.len(), "ROM"),
                counted(design.control.microprogram.len(), "microinstruction"),
                if bounds.are_stated() {
                    format!("The stated bound on an output is {} units.", bounds.words())
                } else {
                    "No bound on an output is stated.".to_owned()
                },
            ),
        );
        Ok(if bounds.keep() {
            finding
        } else {
            let bound = bounds.governing();
            finding.open(format!(
                "The bound of {} is not below {}: the configuration is outside the accuracy contract.",
                bound.output, bound.limit
            ))
        })
    },
};

pub const LOCKSTEP: Check = Check {
    id: "lockstep",
    title: "Golden model against simulation",
    question: "Does every register and output have the value that the golden model predicts, on every clock?",
    reads: "the netlist and the golden model",
    tools: &[],
    steps: points,
    run: |subject, _, progress| lockstep(subject, progress),
};

fn points(subject: &CheckSubject<'_>) -> u64 {
    POINTS[usize::from(subject.effort.full)]
}

fn lockstep(subject: &CheckSubject<'_>, progress: &(dyn Fn(u64) + Sync)) -> Result<Finding> {
    let outcome = subject.core.lockstep(TEST_SEED)?.run(points(subject), progress)?;
    let bounds = subject.core.contract.bounds();
    let worst = outcome.worst.as_ref().map_or_else(String::new, |worst| {
        let bound = bounds.of(&worst.output).map_or_else(String::new, Bound::words);
        format!(
            " The largest error against the formula in f64 is {:.3} units, of `{}`, whose stated bound is {bound}.",
            worst.units, worst.output
        )
    });
    let stimulus = match subject.core.design.pipeline {
        None => "resets, pauses, starts and writes while busy",
        Some(_) => "resets, bubbles and stalls",
    };
    Ok(Finding::new(
        CheckVerdict::Passed,
        format!(
            "{} results in {} clocks, with {stimulus} (seed {TEST_SEED})",
            grouped(outcome.points),
            grouped(outcome.clocks)
        ),
        format!(
            "{} and {} equal the golden model on every clock.{worst}",
            counted(outcome.registers, "register"),
            counted(outcome.outputs, "output"),
        ),
    )
    .failures(outcome.failures(&bounds))
    .open("Operands that were not drawn."))
}

/// The bound's check. A record replaces a long check, and a part of the record is computed again. Without a record, a long check
/// is not run.
pub const CONTRACT: Check = Check {
    id: "contract",
    title: "Golden model against the formula",
    question: "Is no output further from the formula in f64 than the stated bound, for any operands?",
    reads: "the golden model, which another check compares with the simulation of the netlist",
    tools: &[],
    steps: |subject| match evaluations(subject) {
        all if is_short(subject, all) => all,
        _ => record(subject)
            .ok()
            .flatten()
            .map_or(1, |record| record.steps(subject.core.contract.as_ref(), AGAIN)),
    },
    run: |subject, _, progress| contract(subject, progress),
};

/// Returns the number of evaluations: `f` at every place of the sweep, and the colour products.
fn evaluations(subject: &CheckSubject<'_>) -> u64 {
    let job = Job::new(subject.core.contract.as_ref());
    job.f.count() + job.colours.count()
}

fn is_short(subject: &CheckSubject<'_>, evaluations: u64) -> bool {
    subject.effort.full || evaluations <= EVALUATIONS
}

fn record(subject: &CheckSubject<'_>) -> Result<Option<Record>> {
    let (core, digest) = (subject.core, subject.core.contract_digest());
    Record::find(subject.proofs, &digest, core.contract.as_ref())
}

/// Runs the exhaustive check of the bound. For a long check, the finding comes from its record, and a part of the evaluations
/// is repeated. Without such a record, the verdict is [`CheckVerdict::NotRun`].
fn contract(subject: &CheckSubject<'_>, progress: &(dyn Fn(u64) + Sync)) -> Result<Finding> {
    let contract = subject.core.contract.as_ref();
    if !contract.bounds().are_stated() {
        let why = format!(
            "The contract states no bound; `{Program} certify` can find a bound for some configurations."
        );
        return Ok(Finding::without(CheckVerdict::NotApplicable, &why));
    }
    let all = evaluations(subject);
    if !is_short(subject, all) {
        return Ok(match record(subject)? {
            Some(record) => recorded(&record, contract, progress),
            None => without_record(subject, all),
        });
    }
    let job = Job::new(contract);
    let mut state = ShardState::new("", Shard::WHOLE);
    let whole = job.run(&mut state, progress, &mut |_| ControlFlow::Continue(()))?;
    debug_assert!(whole.is_continue(), "nothing stops it");
    let proof = Proof::new(contract, state.f.peak, state.colours.peak);
    Ok(Finding::new(
        of_sweep(job.f.sweep()),
        domain(&job),
        format!("The stated bound is {} units; {}.", contract.bounds().words(), proof.words("")),
    )
    .failures(proof.failures)
    .open(job.f.sweep().omits.clone()))
}

/// Returns `Passed` for a sweep that leaves out combinations, because such a sweep proves nothing.
fn of_sweep(sweep: &Sweep) -> CheckVerdict {
    if sweep.omits.is_empty() { CheckVerdict::Proved } else { CheckVerdict::Passed }
}

fn domain(job: &Job<'_>) -> String {
    format!("{}: {}", job.words(), job.f.sweep().words())
}

fn recorded(record: &Record, contract: &dyn Contract, progress: &(dyn Fn(u64) + Sync)) -> Finding {
    let job = Job::of_sweep(contract, record.sweep(contract));
    let (again, failures) = record.recheck(contract, AGAIN, progress);
    let path = record.path.display().to_string().replace('\\', "/");
    let words = format!(
        "The stated bound is {} units; according to the record `{path}`, {}. This check repeated {} \
         evaluations of the record, spread evenly, and the evaluation with the largest error{}.",
        contract.bounds().words(),
        record.words(contract),
        grouped(again),
        if job.colours.count() > 0 { ", and all colour products" } else { "" },
    );
    let verdict = of_sweep(job.f.sweep());
    let finding = Finding::new(verdict, domain(&job), words).failures(failures);
    Finding { record: Some(path), ..finding }.open(job.f.sweep().omits.clone())
}

fn without_record(subject: &CheckSubject<'_>, evaluations: u64) -> Finding {
    let without_tools = if subject.effort.without_tools { " --without-tools" } else { "" };
    let why = format!(
        "The check needs {} evaluations, and `{}` has no record of them for this configuration.",
        grouped(evaluations),
        subject.proofs.display(),
    );
    let command = format!("{Program} verify {} --full{without_tools}", input::label(subject.path));
    Finding { complete_with: Some(command), ..Finding::without(CheckVerdict::NotRun, why) }
}

/// The check of every combination of operands, clock by clock. It does not apply if the operands have too many bits.
pub const CLOCKS: Check = Check {
    id: "clocks",
    title: "Golden model against simulation, every operand",
    question: "Does every register and output have the value that the golden model predicts, on every clock, \
               for every combination of operands?",
    reads: "the netlist and the golden model",
    tools: &[],
    steps: |subject| {
        let clocks = subject.core.clocks();
        clocks.map_or(1, |clocks| clocks.count().max(1))
    },
    run: |subject, _, progress| {
        let clocks = subject.core.clocks()?;
        if clocks.count() == 0 {
            return Ok(Finding::without(CheckVerdict::NotApplicable, clocks.omits()));
        }
        let differs = clocks.check((0..clocks.blocks()).collect(), progress)?;
        let failures = match differs {
            Some(place) => vec![clocks.difference(place)?.to_string()],
            None => Vec::new(),
        };
        Ok(Finding::new(
            CheckVerdict::Proved,
            format!("{} combinations of {} operand bits", grouped(clocks.count()), clocks.bits()),
            "Every register and output equals the golden model on every clock.",
        )
        .failures(failures)
        .open(clocks.omits()))
    },
};

/// The check that the test notices faults. Without `--full` it plants at most 2048 faults. If more than 1 % of the faults are
/// undecided, the verdict is [`CheckVerdict::Undecided`]. The check does not apply to a pipeline.
pub const MUTATION: Check = Check {
    id: "mutation",
    title: "Faults in the netlist",
    question: "Does the test notice each of the faults that are planted in the netlist, one at a time?",
    reads: "the netlist and the golden model",
    tools: &[],
    steps: |subject| match subject.core.design.pipeline {
        None => faults(subject).0.len() as u64,
        Some(_) => 1,
    },
    run: |subject, _, progress| {
        if subject.core.design.pipeline.is_some() {
            let why = format!(
                "This check plants no faults in a pipeline; `{Program} mutate` plants them."
            );
            return Ok(Finding::without(CheckVerdict::NotApplicable, &why));
        }
        let (faults, all_faults) = faults(subject);
        let found = mutate::run(subject.core, faults.iter(), &|| progress(1))?;
        let score = Score::of(&found);
        let all = &score.all;
        let (caught, equivalent) = (all.all_caught(), all.all_equivalent());
        let undecided = named(&score.undecided);
        let mut domain = counted(all.planted, "fault");
        let mut open = vec![undecided];
        if all_faults > all.planted {
            domain += &format!(", spread evenly among {}", grouped(all_faults as u64));
            open.push(format!(
                "The faults that were not planted; `{Program} verify --full` plants all faults."
            ));
        }
        let open = open.into_iter().filter(|it| !it.is_empty()).collect::<Vec<_>>().join(". ");
        let words = format!(
            "{caught} faults are caught, {equivalent} are proved to change nothing that is compared, and {} \
             are undecided ({:.2} %). The shipped bench alone notices {:.1} % of the faults that any test \
             notices.",
            all.undecided,
            100.0 * all.share_undecided(),
            100.0 * all.of_shipped().value()
        );
        if score.holds() {
            let finding = Finding::new(CheckVerdict::Passed, domain, words);
            return Ok(finding.open(open));
        }
        // The fault-free design passes the same test. Too few noticed faults therefore show a weak test, and not a wrong core.
        let unnoticed =
            found.iter().filter(|found| found.verdict == mutate::MutantVerdict::Undecided);
        let unnoticed: Vec<&NetlistFault> = unnoticed.map(|found| &found.fault).collect();
        let unreached = mutate::unreached(subject.core, &unnoticed)?;
        let ids: Vec<String> = unreached.iter().map(|fault| fault.id.clone()).collect();
        // A contract may be the user's own work, or follow from a configuration alone.
        let advice = match subject.core.contract.highlight() {
            Some(_) => {
                "To add stimulus, widen the keys of `domain`, or state in the device's contract where the formula is \
                 largest (`Contract::peak`); "
            }
            None => "",
        };
        let words = format!(
            "{words} More than 1 % are undecided: the test is too weak, but this does not show a mistake in \
             the core. {}{advice}`{Program} mutate --only ID` shows the result of one fault.",
            match ids.is_empty() {
                true => String::new(),
                false => format!(
                    "The stimulus never reaches {} of these faults: {}. ",
                    ids.len(),
                    named(&ids)
                ),
            }
        );
        Ok(Finding::new(CheckVerdict::Undecided, domain, words).open(open))
    },
};

/// Returns the faults to plant, and the number of all faults.
fn faults(subject: &CheckSubject<'_>) -> (Faults, usize) {
    let mut faults = Faults::of(&subject.core.design);
    let all = faults.len();
    if !subject.effort.full {
        faults.thin(MOST_FAULTS);
    }
    (faults, all)
}

/// The largest number of faults that a finding names.
const NAMED: usize = 20;

/// Returns at most 20 of `ids` as text, with the number of the remaining ones. No ids give an empty text.
fn named(ids: &[String]) -> String {
    let named = ids[..ids.len().min(NAMED)].join(", ");
    match ids.len() - ids.len().min(NAMED) {
        0 => named,
        more => format!("{named} and {more} more; `{Program} mutate` lists all"),
    }
}
