//! Runs single computations of a design in the built-in simulator, and records facts for manifests and pages.
//!
//! The runs give the clocks between `start`, `valid` and `done`, a worked example, and a recording of chosen nets. The runs
//! also give a list of computations by which users can check the device without a model.

use anyhow::{Context, Result, ensure};

use super::instances::Instances;
use super::points::length;
use super::ports::Ports;
use super::{PointSource, Random, through};
use crate::observation::{Computation, LineClocks, Linear, Quantity, TimedResult, WorkedExample};
use glint_base::fixed::Format;
use glint_golden::{Contract, Highlight, Operand};
use glint_rtl::netlist::{self, Design, HandshakeTiming, NetId};
use glint_rtl::sim::Simulator;

/// A computation that takes more clocks counts as endless.
const LIMIT: u32 = 1 << 16;

/// The number of sample computations in [`computations`]. The first of them are corners of the domain.
const COMPUTATIONS: usize = 40;

/// The largest length operand of a line among the sample computations.
const SHORT: i64 = 9;

/// The longest measured line has a length operand that is larger by this number than the smallest length operand.
const LONG: i64 = 1000;

/// The number of points in a recording of a pipeline.
const POINTS: usize = 3;

/// The number of clocks for which the first result of such a recording waits.
const PAUSE: usize = 2;

/// The number of operands from [`Contract::hint`] that are tried for a worked example.
const TRIES: u32 = 256;

struct ComputationTrial {
    timing: HandshakeTiming,
    /// The raw results of every clock in which `valid` is high, with the number of the clock.
    results: Vec<(u32, Vec<i64>)>,
    /// The first clock of a microinstruction whose successor depends on an operand.
    decision: Option<u32>,
}

impl ComputationTrial {
    /// Returns the numbers of clocks from each result to the next, without a number that equals the one before it. For
    /// example, results in the clocks 5, 6, 7 and 9 give 1 and 2.
    fn distances(&self) -> Vec<u32> {
        let pairs = self.results.windows(2);
        let mut distances: Vec<u32> = pairs.map(|pair| pair[1].0 - pair[0].0).collect();
        distances.dedup();
        distances
    }
}

/// Measures the numbers of clocks between the events of the handshake, such as `start` and `done`. A number is stated only if
/// the microprogram makes it the same for all bit patterns of the operand ports. `start_to_done_at_most` is an upper limit,
/// stated if `start_to_done` depends on the operands and a limit is known. The clocks from result to result are stated if they
/// are the same for the smallest, the middle and the largest operands.
///
/// # Errors
/// Fails if the design cannot be simulated or does not belong to the contract, if a computation does not end within 65536
/// clocks, or if it never raises `valid`.
pub fn timing(design: &Design, contract: &dyn Contract) -> Result<HandshakeTiming> {
    let mut trials: Vec<ComputationTrial> = Vec::new();
    for operands in corners(contract, |it| (it.format.min_raw(), it.format.max_raw())) {
        trials.push(run(design, contract, &operands, &mut |_| Ok(()))?);
    }
    let seen = &trials[0].timing;
    // Up to the clock `decision`, no operand influences the microinstruction or its effects.
    let decision = trials[0].decision;
    let valid = match (netlist::delay_of_valid(design), seen.start_to_valid) {
        (Some(delay), Some(clock)) if decision.is_none_or(|at| clock - delay <= at) => Some(clock),
        _ => None,
    };
    let fixed = |clock: Option<u32>| clock.filter(|_| decision.is_none());
    let mut distances: Vec<u32> = trials.iter().flat_map(ComputationTrial::distances).collect();
    distances.dedup();
    Ok(HandshakeTiming {
        start_to_valid: valid,
        valid_to_valid: match distances[..] {
            [only] => Some(only),
            _ => None,
        },
        start_to_done: fixed(seen.start_to_done),
        start_to_done_at_most: decision.and_then(|_| netlist::latest_done(design)),
        start_to_start: fixed(seen.start_to_start),
    })
}

/// Returns all operands at the lowest value within `ends`, all at the highest value, and all in the middle.
fn corners(contract: &dyn Contract, ends: fn(&Operand) -> (i128, i128)) -> [Vec<i64>; 3] {
    let mut corners = [Vec::new(), Vec::new(), Vec::new()];
    for operand in contract.operands() {
        let (low, high) = ends(operand);
        corners[0].push(low as i64);
        corners[1].push(high as i64);
        corners[2].push(i128::midpoint(low, high) as i64);
    }
    corners
}

/// Returns 40 computations with their results and clocks, by which users check the device without a golden model. In the first
/// three, all operands are at the lowest, the highest or the middle value of their domains; the rest are random points of the
/// domain. A line has a length operand of at most 9.
///
/// # Errors
/// Fails if a computation does not end, or if the contract's results and the simulated results differ.
pub fn computations(design: &Design, contract: &dyn Contract) -> Result<Vec<Computation>> {
    let mut random = Random::new(1);
    let mut points = PointSource::new(contract);
    points.shorten(SHORT);
    let corners = corners(contract, |it| (it.domain.0.into(), it.domain.1.into()));
    let mut list = Vec::from(corners.map(|corner| points.clamped(corner)));
    list.resize_with(COMPUTATIONS, || points.of_domain(&mut random));
    list.into_iter().map(|operands| computation(design, contract, operands)).collect()
}

fn computation(
    design: &Design,
    contract: &dyn Contract,
    operands: Vec<i64>,
) -> Result<Computation> {
    let trial = run(design, contract, &operands, &mut |_| Ok(()))?;
    let mut shown = Vec::with_capacity(trial.results.len());
    for (index, (clock, simulated)) in trial.results.iter().enumerate() {
        let mut right = Vec::new();
        contract.results(&operands, index as u64, &mut right);
        ensure!(
            right == *simulated,
            "golden model and simulation of `{}` differ in result {index} for {}: {} in the golden model and \
             {} in the simulation",
            design.name,
            listed(contract.operands().iter().map(|it| it.name.as_str()), &operands),
            listed(contract.outputs().iter().map(|output| output.name.as_str()), &right),
            listed(contract.outputs().iter().map(|output| output.name.as_str()), simulated),
        );
        shown.push(TimedResult { clock: *clock, outputs: right });
    }
    Ok(Computation {
        done: trial.timing.start_to_done.context("the computation never sets `done`")?,
        results: shown,
        operands,
    })
}

/// Returns raw values with their names, in the form `red=#255 green=#0`.
fn listed<'a>(names: impl Iterator<Item = &'a str>, raw: &[i64]) -> String {
    let each: Vec<String> = names.zip(raw).map(|(name, raw)| format!("{name}=#{raw}")).collect();
    each.join(" ")
}

/// Returns the number of clocks from `start` to the earliest next `start`, and the number of results, for one computation with
/// the given raw operands.
///
/// # Errors
/// Fails if the computation does not end.
pub fn throughput(
    design: &Design,
    contract: &dyn Contract,
    operands: &[i64],
) -> Result<(u32, u32)> {
    let trial = run(design, contract, operands, &mut |_| Ok(()))?;
    let clocks = trial.timing.start_to_start.context("the computation does not end")?;
    Ok((clocks, trial.results.len() as u32))
}

/// Measures the clock numbers of a line as linear functions of its length, from the four shortest lines and a long one. Returns
/// `None` for a device of single points, or if the functions are not linear.
///
/// # Errors
/// Fails if a computation does not end.
pub fn line(design: &Design, contract: &dyn Contract) -> Result<Option<LineClocks>> {
    let mut operands = typical(contract, &[]);
    let Some(at) = length(contract) else { return Ok(None) };
    let Operand { name, domain: (low, high), .. } = contract.operands()[at].clone();
    let mut seen: Vec<(i64, [i64; 3])> = Vec::new();
    for length in [low, low + 1, low + 2, low + 3, high.min(low + LONG)] {
        operands[at] = length.min(high);
        let trial = run(design, contract, &operands, &mut |_| Ok(()))?;
        let (last, _) = trial.results.last().context("the computation shows no result")?;
        let done = trial.timing.start_to_done.context("the computation never sets `done`")?;
        let next = trial.timing.start_to_start.context("the computation does not end")?;
        seen.push((operands[at], [*last, done, next].map(i64::from)));
    }
    let [valid, done, next] = [0, 1, 2].map(|event| {
        let each = seen[1].1[event] - seen[0].1[event];
        let clocks = Linear { constant: seen[0].1[event] - each * low, each };
        let holds = seen.iter().all(|(length, at)| clocks.at(*length) == at[event]);
        holds.then_some(clocks)
    });
    let (Some(last_valid), Some(done), Some(next_start)) = (valid, done, next) else {
        return Ok(None);
    };
    Ok(Some(LineClocks { length: name, last_valid, done, next_start }))
}

/// Simulates the computation with the operands that [`typical`] chooses; for a highlight, `f` is mostly between 0.4 and 0.8. In
/// the example, `outputs` has the outputs of the first result, and `results` the outputs of all results.
///
/// # Errors
/// Fails if the computation does not end.
pub fn example(design: &Design, contract: &dyn Contract) -> Result<WorkedExample> {
    let operands = typical(contract, &[]);
    let trial = run(design, contract, &operands, &mut |_| Ok(()))?;
    let mut results: Vec<Vec<Quantity>> = Vec::new();
    for (_, outputs) in &trial.results {
        let mut result = Vec::new();
        for (output, &raw) in contract.outputs().iter().zip(outputs) {
            result.push(quantity(&output.name, output.format, raw));
        }
        results.push(result);
    }
    let mut given = Vec::new();
    for (operand, &raw) in contract.operands().iter().zip(&operands) {
        given.push(quantity(&operand.name, operand.format, raw));
    }
    let outputs = results.first().context("the computation shows no result")?.clone();
    Ok(WorkedExample { operands: given, outputs, results })
}

fn quantity(name: &str, format: Format, raw: i64) -> Quantity {
    let raw = i128::from(raw);
    Quantity { name: name.to_owned(), raw, value: format.to_f64(raw) }
}

/// Returns raw operands for a worked example. An operand with a value in `given` keeps it; `given` may be shorter than the
/// operands. For a highlight, the function lowers a control operand with fraction bits, such as a cosine or an angle, until `f`
/// is between 0.4 and 0.8. For lines, the function then also lowers operands such as a step (`slow_down`). For other devices,
/// the function prefers operands from [`Contract::hint`].
pub fn typical(contract: &dyn Contract, given: &[Option<i64>]) -> Vec<i64> {
    let given = |at: usize| given.get(at).copied().flatten();
    let mut colour = 0;
    let mut values: Vec<i64> = Vec::new();
    for (at, operand) in contract.operands().iter().enumerate() {
        let (low, high) = operand.domain;
        values.push(if let Some(raw) = given(at) {
            raw
        } else if operand.colour {
            colour += 1;
            high - high * (colour - 1) / 3
        } else if operand.format.frac > 0 {
            // Close to 1.0 for a cosine, and close to 0 for an operand with a sign.
            if low < 0 { high / 64 } else { high - (high - low) / 64 }
        } else {
            20.clamp(low, high) * i64::from(high > 1)
        });
    }
    let Some(highlight) = contract.highlight() else {
        let hinted = hinted(contract).unwrap_or(values.clone());
        return (0..).zip(hinted).map(|(at, raw)| given(at).unwrap_or(raw)).collect();
    };
    let control = highlight.control();
    let movable = |at: &usize| contract.operands()[*at].format.frac > 0 && given(*at).is_none();
    for at in (0..control).filter(movable) {
        let (low, high) = contract.operands()[at].domain;
        let typical = values[at];
        for step in 0..256 {
            values[at] = if low < 0 {
                // An operand with a sign goes toward 0 in steps of a twentieth of its value, because its scale is unknown.
                (high as f64 * libm::pow(0.95, step as f64)) as i64
            } else {
                high - (high - low) / 256 * step
            };
            let f = highlight.reference(&highlight.point(&values[..control], 0));
            if (0.4..0.8).contains(&f) {
                slow_down(contract, highlight, &mut values, &movable);
                return values;
            }
        }
        values[at] = typical;
    }
    values
}

/// Lowers the operands of a line that change `f` only after the first point, such as a step. An operand stops at the lower end
/// of its domain, at 0, or as soon as `f` in the middle of the line is at least a quarter of `f` at the first point.
fn slow_down(
    contract: &dyn Contract,
    highlight: &Highlight,
    values: &mut [i64],
    movable: &dyn Fn(&usize) -> bool,
) {
    let Some(middle) = length(contract).map(|at| values[at] as u64 / 2) else { return };
    let control = highlight.control();
    let f =
        |values: &[i64], index| highlight.reference(&highlight.point(&values[..control], index));
    let first = f(values, 0);
    for at in (0..control).filter(movable) {
        let typical = values[at];
        let low = contract.operands()[at].domain.0.max(0);
        while f(values, 0) == first && f(values, middle) < first / 4.0 && values[at] > low {
            values[at] = (values[at] - values[at] / 5 - 1).max(low);
        }
        if f(values, 0) != first {
            values[at] = typical;
        }
    }
}

/// Returns the first operands from [`Contract::hint`] for which no output is 0 or at an end of its format.
fn hinted(contract: &dyn Contract) -> Option<Vec<i64>> {
    let (mut random, points) = (Random::new(1), PointSource::new(contract));
    for _ in 0..TRIES {
        let operands = points.hint(&mut random)?;
        let mut raw = Vec::new();
        contract.results(&operands, 0, &mut raw);
        let is_inside = contract.outputs().iter().zip(raw).all(|(output, raw)| {
            let format = output.format;
            ![0, format.min_raw(), format.max_raw()].contains(&i128::from(raw))
        });
        if is_inside {
            return Some(operands);
        }
    }
    None
}

/// Simulates the computation of [`example`], and returns the bit patterns of `nets`, which must have names, in each clock just
/// before its rising edge. Clock 0 is the clock in which `start` is high. The last clock is the first in which the device is
/// idle again, or the clock of a pipeline's result.
///
/// # Errors
/// Fails if the computation does not end.
pub fn record(design: &Design, contract: &dyn Contract, nets: &[NetId]) -> Result<Vec<Vec<u64>>> {
    let mut clocks = Vec::new();
    run(design, contract, &typical(contract, &[]), &mut |simulator| {
        simulator.settle()?;
        clocks.push(nets.iter().map(|&net| simulator.value(net)).collect());
        Ok(())
    })?;
    Ok(clocks)
}

/// Does the same as [`record`] for three points in a pipeline; the first has the operands of [`example`]. One clock has no
/// point, and the first result waits for two clocks if the pipeline has an `out_ready`.
///
/// # Errors
/// Fails if not all results appear.
pub fn record_points(
    design: &Design,
    contract: &dyn Contract,
    nets: &[NetId],
) -> Result<Vec<Vec<u64>>> {
    let (mut random, points) = (Random::new(1), PointSource::new(contract));
    let mut list = vec![typical(contract, &[])];
    list.resize_with(POINTS, || points.of_domain(&mut random));
    through::record(design, contract, (&list, PAUSE), nets, LIMIT)
}

type Watch<'a> = &'a mut dyn FnMut(&mut Simulator) -> Result<()>;

/// Runs one computation from reset to its end, or to the clock of a pipeline's result. `watch` sees the simulator before each
/// rising edge.
fn run(
    design: &Design,
    contract: &dyn Contract,
    operands: &[i64],
    watch: Watch<'_>,
) -> Result<ComputationTrial> {
    let mut instance = Instances::<1>::new(design, contract)?;
    instance.offer([Some(operands)]);
    watch(&mut instance.simulator)?;
    instance.simulator.clock()?;
    instance.release();
    let Ports { valid, busy, done, overlaps, .. } = instance.ports;
    let decided = busy.map(|_| {
        let address = design.register(design.control.address).q;
        (address, netlist::decided_by_data(design))
    });
    let mut trial = ComputationTrial {
        timing: HandshakeTiming::default(),
        results: Vec::new(),
        decision: None,
    };
    // The clock that took `start` was clock 0.
    for clock in 1..LIMIT {
        watch(&mut instance.simulator)?;
        let high = |net| instance.simulator.value(net) == 1;
        if let Some((address, decided)) = &decided {
            let executed = instance.simulator.value(*address) as usize;
            if decided.contains(&executed) {
                trial.decision.get_or_insert(clock);
            }
        }
        let shows = high(valid);
        if shows {
            trial.timing.start_to_valid.get_or_insert(clock);
            trial.results.push((clock, instance.results(0).collect()));
        }
        if done.map_or(shows, high) {
            trial.timing.start_to_done = Some(clock);
            trial.timing.start_to_start = overlaps.then_some(clock);
        }
        if busy.map_or(shows, |busy| !high(busy)) {
            let interval = design.pipeline.as_ref().map(|pipeline| pipeline.interval as u32);
            let next = interval.unwrap_or(clock);
            trial.timing.start_to_start.get_or_insert(next);
            ensure!(trial.timing.start_to_valid.is_some(), "`{}` never sets `valid`", design.name);
            return Ok(trial);
        }
        instance.simulator.clock()?;
    }
    anyhow::bail!("the computation of `{}` does not end within {LIMIT} clocks", design.name)
}
