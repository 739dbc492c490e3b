//! Extracts the finished computations from the vectors of a core's test bench.
//!
//! The test benches of the core's wrappers replay these computations through the wrapper.

use std::collections::VecDeque;

use anyhow::{Context, Result};

use super::fields::Transfer;
use crate::observation::Vectors;
use crate::package::bench::packed;
use glint_base::fixed::mask;
use glint_rtl::netlist::{Design, Port, Role};

/// The largest number of results in the list. A computation with which the list would exceed this number is left out.
const RESULTS: usize = 4096;

/// The bit patterns of a finished computation, in the order of the ports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BenchPoint {
    pub operands: Vec<u64>,
    pub results: Vec<Vec<u64>>,
}

/// Returns the computations in `vectors` that run to their end, in the order in which they end. A computation with which the
/// list would have more than 4096 results is left out.
///
/// # Errors
/// Fails if the design lacks its handshake.
pub fn points(design: &Design, vectors: &Vectors) -> Result<Vec<BenchPoint>> {
    let clocks = vectors.inputs.iter().zip(&vectors.expected);
    let rows = clocks.map(|(inputs, outputs)| PortValues { design, inputs, outputs });
    let all = match &design.pipeline {
        Some(_) => streamed(rows),
        None => computed(design, rows),
    }
    .context("a list of points needs the handshake of a core")?;
    let mut points = Vec::new();
    let mut results = 0;
    for point in all {
        let with_point = results + point.results.len();
        if with_point <= RESULTS {
            results = with_point;
            points.push(point);
        }
    }
    Ok(points)
}

struct PortValues<'a> {
    design: &'a Design,
    inputs: &'a [u64],
    outputs: &'a [u64],
}

impl PortValues<'_> {
    fn all(&self, is: impl Fn(Role) -> bool) -> Vec<(&Port, u64)> {
        let inputs = self.design.inputs().zip(self.inputs);
        let mut ports = Vec::new();
        for (port, value) in inputs.chain(self.design.outputs().zip(self.outputs)) {
            if is(port.role) {
                ports.push((port, *value));
            }
        }
        ports
    }

    fn values(&self, is: impl Fn(Role) -> bool) -> Vec<u64> {
        self.all(is).into_iter().map(|(_, value)| value).collect()
    }

    fn high(&self, role: Role) -> Option<bool> {
        self.values(|it| it == role).first().map(|value| *value == 1)
    }

    fn results(&self) -> Vec<u64> {
        self.values(|role| role == Role::Result)
    }
}

/// Returns the finished computations of a sequential core. Strobes write the operands one by one, and `start` takes
/// them. A computation is left out if a reset interrupts it, or if an operand has not been written since the latest reset.
/// Returns `None` if the design lacks a signal of the handshake.
fn computed<'a>(
    design: &Design,
    rows: impl Iterator<Item = PortValues<'a>>,
) -> Option<Vec<BenchPoint>> {
    let overlaps = design.control.overlaps;
    let mut done = Vec::new();
    let mut written: Vec<Option<u64>> = Vec::new();
    let mut current: Option<BenchPoint> = None;
    let mut known = false;
    for row in rows {
        let operands = row.all(|role| matches!(role, Role::Operand { .. }));
        written.resize(operands.len(), None);
        if !row.high(Role::Reset)? {
            (known, current, written) = (true, None, vec![None; operands.len()]);
            continue;
        }
        if !known {
            continue;
        }
        let busy = row.high(Role::Busy)?;
        let ends = busy && row.high(Role::Done)?;
        if let Some(point) =
            current.as_mut().filter(|_| busy && row.high(Role::Valid) == Some(true))
        {
            point.results.push(row.results());
        }
        if ends {
            done.extend(current.take());
        }
        if overlaps || !busy {
            for ((port, value), written) in operands.iter().zip(&mut written) {
                let Role::Operand { strobe } = port.role else { continue };
                let mut inputs = design.inputs().zip(row.inputs);
                if inputs.any(|(it, high)| it.net == strobe && *high == 1) {
                    *written = Some(*value);
                }
            }
        }
        if row.high(Role::Start)? && (!busy || overlaps && ends) {
            let operands = written.iter().copied().collect::<Option<Vec<u64>>>();
            current = operands.map(|operands| BenchPoint { operands, results: Vec::new() });
        }
    }
    Some(done)
}

/// Returns the finished computations of a pipeline. Results leave in the order in which the points entered, and a reset
/// removes the points inside. Returns `None` if the design lacks a signal of the handshake, or if a result has no point.
fn streamed<'a>(rows: impl Iterator<Item = PortValues<'a>>) -> Option<Vec<BenchPoint>> {
    let mut done = Vec::new();
    let mut inside: VecDeque<Vec<u64>> = VecDeque::new();
    let mut known = false;
    for row in rows {
        if !row.high(Role::Reset)? {
            (known, inside) = (true, VecDeque::new());
            continue;
        }
        if !known {
            continue;
        }
        if row.high(Role::Valid)? && row.high(Role::OutReady).unwrap_or(true) {
            let operands = inside.pop_front()?;
            done.push(BenchPoint { operands, results: vec![row.results()] });
        }
        if row.high(Role::InValid)? && row.high(Role::InReady).unwrap_or(true) {
            inside.push_back(row.values(|role| role == Role::Point));
        }
    }
    Some(done)
}

/// Returns the input file of the wrapper's bench: for each computation a word with all operands, each padded to whole bytes.
/// The padding alternates between zeros and ones from computation to computation, because the wrapper must ignore it.
pub fn sent(points: &[BenchPoint], operands: &Transfer) -> String {
    let mut text = String::new();
    for (number, point) in points.iter().enumerate() {
        let ones = number % 2 == 1;
        let mut values = Vec::new();
        for (value, field) in point.operands.iter().zip(&operands.fields) {
            values.push(if ones { value | !mask(field.width) } else { *value });
        }
        text += &word(values, operands, ones, None);
    }
    text
}

/// Returns the output file of the wrapper's bench: a line for each result, with all outputs padded to whole bytes by their
/// sign or zeros. If `is_line` is set, a further digit in front is 1 for the last result of a computation.
pub fn received(points: &[BenchPoint], results: &Transfer, is_line: bool) -> String {
    let mut text = String::new();
    for point in points {
        let last = point.results.len() - 1;
        for (number, result) in point.results.iter().enumerate() {
            let mut values = Vec::new();
            for (value, field) in result.iter().zip(&results.fields) {
                let is_negative = field.signed && value >> (field.width - 1) & 1 == 1;
                values.push(if is_negative { value | !mask(field.width) } else { *value });
            }
            let last = is_line.then_some(u64::from(number == last));
            text += &word(values, results, false, last);
        }
    }
    text
}

/// Returns a line for `$readmemh`: the `values` of a transfer's fields in hexadecimal, each in whole bytes, the last field
/// first. `ones` says how the bytes above all fields are filled. `top` is a further digit in front of the line.
fn word(values: Vec<u64>, transfer: &Transfer, ones: bool, top: Option<u64>) -> String {
    let (mut row, mut widths) = (Vec::new(), Vec::new());
    for (value, field) in values.into_iter().zip(&transfer.fields) {
        row.push(value & mask(field.padded()));
        widths.push(field.padded());
    }
    for _ in 0..(transfer.bits - transfer.filled()) / 8 {
        row.push(if ones { 0xff } else { 0 });
        widths.push(8);
    }
    if let Some(top) = top {
        row.push(top);
        widths.push(4);
    }
    row.reverse();
    widths.reverse();
    packed(&row, &widths) + "\n"
}
