//! One computation of a design in the built-in simulator: its timing, and a worked example.

use anyhow::{Context, Result, ensure};

use crate::emit::{Quantity, Timing, WorkedExample};
use crate::fixed::Format;
use crate::golden::{Contract, Operand};
use crate::netlist::{Design, NetId, Role};
use crate::sim::Simulator;

/// More clocks than any device takes.
const LIMIT: u32 = 1 << 16;

/// What one computation showed.
struct Trial {
    timing: Timing,
    /// The result outputs at `valid`.
    outputs: Vec<u64>,
}

/// The clocks between the events of the handshake, where they are the same for all of some operands
/// from the corners of the domain.
///
/// # Errors
/// A device that never ends, or never raises `valid`.
pub fn timing(design: &Design, contract: &dyn Contract) -> Result<Timing> {
    let corner =
        |pick: fn(&Operand) -> i64| contract.operands().iter().map(pick).collect::<Vec<_>>();
    let corners = [
        corner(|operand| operand.domain.0),
        corner(|operand| operand.domain.1),
        corner(|operand| operand.domain.0.midpoint(operand.domain.1)),
    ];
    let mut common: Option<Timing> = None;
    for operands in corners {
        let seen = run(design, contract, &operands)?.timing;
        common = Some(match common {
            None => seen,
            Some(before) => {
                let same = |a: Option<u32>, b: Option<u32>| if a == b { a } else { None };
                Timing {
                    start_to_valid: same(before.start_to_valid, seen.start_to_valid),
                    start_to_done: same(before.start_to_done, seen.start_to_done),
                    start_to_start: same(before.start_to_start, seen.start_to_start),
                }
            }
        });
    }
    Ok(common.unwrap_or_default())
}

/// A computation with all its numbers: operands of the domain for which f is neither 0 nor 1.
///
/// # Errors
/// Those of [`timing`].
pub fn example(design: &Design, contract: &dyn Contract) -> Result<WorkedExample> {
    let operands = example_operands(contract);
    let trial = run(design, contract, &operands)?;
    let quantity = |name: &str, format: Format, raw: i64| Quantity {
        name: name.to_owned(),
        raw: i128::from(raw),
        value: format.to_f64(i128::from(raw)),
    };
    let results = results(design, contract);
    Ok(WorkedExample {
        operands: contract
            .operands()
            .iter()
            .zip(&operands)
            .map(|(operand, &raw)| quantity(&operand.name, operand.format, raw))
            .collect(),
        outputs: results
            .iter()
            .zip(&trial.outputs)
            .map(|(&net, &bits)| {
                let net = design.net(net);
                quantity(&net.name, net.format, net.format.raw(bits) as i64)
            })
            .collect(),
    })
}

/// Typical operands: the first (a cosine or a component) is lowered until f is well inside 0 … 1.
fn example_operands(contract: &dyn Contract) -> Vec<i64> {
    let mut colour = 0;
    let mut values: Vec<i64> = contract
        .operands()
        .iter()
        .map(|operand| {
            let (low, high) = operand.domain;
            if operand.colour {
                colour += 1;
                high - high * (colour - 1) / 3
            } else if low < 0 && high > 0 {
                // A component of a difference vector: small.
                (high - low) / 512
            } else if operand.format.frac > 0 {
                high - (high - low) / 64
            } else {
                20.clamp(low, high) * i64::from(high > 1)
            }
        })
        .collect();
    let control = contract
        .operands()
        .iter()
        .filter(|operand| !operand.colour)
        .count();
    if let Some(first) = contract.operands().first() {
        let (low, high) = first.domain;
        for step in 0..256 {
            values[0] = high - (high - low) / 256 * step;
            let f = contract.reference(&values[..control]);
            if (0.4..0.8).contains(&f) {
                return values;
            }
        }
        values[0] = high;
    }
    values
}

fn results(design: &Design, contract: &dyn Contract) -> Vec<NetId> {
    contract
        .outputs()
        .iter()
        .filter_map(|name| design.find(name))
        .collect()
}

/// Resets, writes the operands, starts, and waits for the end.
fn run(design: &Design, contract: &dyn Contract, operands: &[i64]) -> Result<Trial> {
    let mut simulator = Simulator::new(design)?;
    let output = |wanted: fn(Role) -> bool| {
        design
            .port(wanted)
            .map(|port| port.net)
            .context("no handshake")
    };
    let valid = output(|role| role == Role::Valid)?;
    let done = output(|role| role == Role::Done)?;
    let busy = output(|role| role == Role::Busy)?;
    let input = |name: &str| {
        let at = design
            .inputs()
            .position(|port| design.net(port.net).name == name);
        at.with_context(|| format!("no input `{name}`"))
    };
    let (reset, start) = (input("rst_n")?, input("start")?);
    simulator.clock()?;
    simulator.set(reset, 1);
    for (operand, &raw) in contract.operands().iter().zip(operands) {
        simulator.set(input(&operand.name)?, operand.format.bits(i128::from(raw)));
        simulator.set(input(&format!("{}_write", operand.name))?, 1);
    }
    simulator.set(start, 1);
    simulator.clock()?;
    for operand in contract.operands() {
        simulator.set(input(&format!("{}_write", operand.name))?, 0);
    }
    simulator.set(start, 0);
    let mut trial = Trial {
        timing: Timing::default(),
        outputs: Vec::new(),
    };
    // Clock 0 was the one that took `start`.
    for clock in 1..LIMIT {
        if simulator.value(valid) == 1 && trial.timing.start_to_valid.is_none() {
            trial.timing.start_to_valid = Some(clock);
            let nets = results(design, contract);
            trial.outputs = nets.iter().map(|&net| simulator.value(net)).collect();
        }
        if simulator.value(done) == 1 {
            trial.timing.start_to_done = Some(clock);
        }
        if simulator.value(busy) == 0 {
            trial.timing.start_to_start = Some(clock);
            ensure!(
                trial.timing.start_to_valid.is_some(),
                "`{}` never raises valid",
                design.name
            );
            return Ok(trial);
        }
        simulator.clock()?;
    }
    anyhow::bail!("`{}` does not end within {LIMIT} clocks", design.name)
}
