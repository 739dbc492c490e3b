//! Prints the result of an exhaustive check, for `glint cosim --exhaustive` and `glint merge`.

use std::collections::BTreeMap;

use anyhow::Result;
use serde_json::{Value, json};

use crate::commands::Loaded;
use crate::commands::mismatch::Reproducer;
use crate::report::{CommandReport, ReportList};
use crate::say;
use glint_base::program::Program;
use glint_base::text;
use glint_core::cosim::exhaustive::{Difference, Job, Proof, Shard, ShardState};
use glint_golden::Values;

/// Prints how much work is ahead, and which parts the check does not cover.
pub fn announce(one: &Loaded, job: &Job<'_>, state: &ShardState) {
    say!("{}: {} ({})", one.path, job.words(), job.f.sweep().words(),);
    if !job.f.sweep().omits.is_empty() {
        say!("  not covered: {}", job.f.sweep().omits);
    }
    if let Some(clocks) = &job.clocks {
        match clocks.count() {
            0 => (),
            count => say!(
                "  every register and output at every clock for {} combinations of {} operand bits",
                text::grouped(count),
                clocks.bits()
            ),
        }
        say!("  not covered: {}", clocks.omits());
    }
    let left = job.remaining(state);
    let all = job.remaining(&ShardState::new("", Shard::WHOLE));
    if left != all {
        say!("  shard {}: {} evaluations to do", state.shard, text::grouped(left));
    }
}

/// Reports a shard's result, and adds it to `list`. Returns whether the errors are within the bound, and model and hardware do
/// not differ.
///
/// # Errors
/// Fails if the design cannot be simulated, or if a difference's waveform cannot be written.
pub fn report(
    one: &Loaded,
    job: &Job<'_>,
    state: &ShardState,
    list: &mut ReportList,
) -> Result<bool> {
    let contract = one.core.contract.as_ref();
    let mut proof = Proof::new(contract, state.f.peak, state.colours.peak);
    let found = found(one, job, state)?;
    if let Some((difference, _)) = &found {
        proof.failures.push(difference.to_string());
    }
    let holds = proof.failures.is_empty();
    list.add(&ProofReport { one, job, state, proof, found })?;
    Ok(holds)
}

struct ProofReport<'a> {
    one: &'a Loaded,
    job: &'a Job<'a>,
    state: &'a ShardState,
    proof: Proof,
    found: Option<(Difference, Reproducer)>,
}

impl CommandReport for ProofReport<'_> {
    fn json(&self) -> Result<Value> {
        Ok(as_json(self.one, self.job, &self.proof, self.state, self.found.as_ref()))
    }

    fn print(&self) -> Result<()> {
        print(self.one, self.job, &self.proof, self.state);
        if let Some((difference, reproducer)) = &self.found {
            say!("  {}", reproducer.text(&difference.mismatch));
        }
        Ok(())
    }
}

/// Returns the first combination for which model and hardware differ, and writes its waveform. Returns `None` if they never
/// differ.
fn found(
    one: &Loaded,
    job: &Job<'_>,
    state: &ShardState,
) -> Result<Option<(Difference, Reproducer)>> {
    let (Some(clocks), Some(place)) = (&job.clocks, state.clocks.differs) else {
        return Ok(None);
    };
    let difference = clocks.difference(place)?;
    let reproducer = Reproducer::of_combination(one, clocks, &difference)?;
    Ok(Some((difference, reproducer)))
}

fn print(one: &Loaded, job: &Job<'_>, proof: &Proof, state: &ShardState) {
    let at: Vec<String> = job
        .f
        .sweep()
        .axes
        .iter()
        .zip(job.f.place(proof.f.place))
        .map(|(axis, value)| format!("{}={value}", axis.name))
        .collect();
    let verdict = match state.shard == Shard::WHOLE {
        true => proof.verdict(one.core.contract.as_ref(), job.f.sweep()).to_owned(),
        false if proof.failures.is_empty() => {
            format!("holds for this shard; `{Program} merge` joins the shards")
        }
        false => "FAILS".to_owned(),
    };
    say!(
        "  {} (bound {}): {verdict}",
        proof.words(&format!(", at raw {}", at.join(" "))),
        one.core.contract.bounds().words(),
    );
    for failure in &proof.failures {
        say!("  FAILS: {failure}");
    }
    if !job.f.sweep().omits.is_empty() {
        say!("  undecided: {}", job.f.sweep().omits);
    }
}

/// Returns the result for scripts and for the records in the repository.
fn as_json(
    one: &Loaded,
    job: &Job<'_>,
    proof: &Proof,
    state: &ShardState,
    found: Option<&(Difference, Reproducer)>,
) -> Value {
    let places = &job.f;
    let axes: Vec<Value> = places
        .sweep()
        .axes
        .iter()
        .map(|axis| match &axis.values {
            Values::Range(low, high) => json!({ "name": axis.name, "from": low, "to": high }),
            Values::List(values) => json!({ "name": axis.name, "values": values }),
        })
        .collect();
    let mut value = json!({
        "config": one.path,
        "device": one.core.device().name,
        "configuration": one.core.contract_digest(),
        "axes": axes,
        "not_covered": places.sweep().omits,
        "evaluations": places.count(),
        "colour_products": job.colours.count(),
        "f": {
            "error": proof.f.error,
            "units": proof.f_units,
            "place": proof.f.place,
            "at": places.place(proof.f.place),
        },
        "colour_units": proof.colours.error,
        "together": proof.together(),
        "bound": one.core.contract.bounds().governing().units,
        "holds": proof.failures.is_empty(),
        "verdict": proof.verdict(one.core.contract.as_ref(), places.sweep()),
        "faults": proof.failures,
    });
    if let Some(clocks) = &job.clocks {
        value["clocks"] = json!({
            "operand_bits": clocks.bits(),
            "combinations": clocks.count(),
            "not_covered": clocks.omits(),
            "mismatch": found.map(mismatch_json),
        });
    }
    if state.shard != Shard::WHOLE {
        value["shard"] = json!(state.shard.to_string());
    }
    value
}

/// Returns a difference as JSON. The object has the keys of a difference in a random run, but `seed` is null, and `combination`,
/// `clock_of_computation` and `operands` are added.
fn mismatch_json((difference, reproducer): &(Difference, Reproducer)) -> Value {
    let mut value = reproducer.json(&difference.mismatch);
    let operands: BTreeMap<&str, String> = difference
        .operands
        .iter()
        .map(|(name, bits)| (name.as_str(), format!("{bits:#x}")))
        .collect();
    value["seed"] = Value::Null;
    value["combination"] = json!(difference.place);
    value["clock_of_computation"] = json!(difference.clock);
    value["operands"] = json!(operands);
    value
}
