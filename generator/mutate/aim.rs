//! Operands that lead to a word of a table.
//!
//! Where an operand register addresses a ROM, that operand is held at the word at fault, and all values of
//! the others that determine `f` are tried: what one value in a million shows is not left to chance.

use anyhow::Result;

use crate::cosim::batch::{Engine, Golden, Points, RustHdl};
use crate::flow::Unit;
use crate::netlist::{Design, Driver, RegisterKind, RomId};

/// At most so many points are tried for a word.
const MOST: u64 = 1 << 21;

/// Points that are computed together.
const CHUNK: u64 = 1 << 16;

/// A point whose result differs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// Raw operands, by name.
    pub operands: Vec<(String, i64)>,
    /// The output.
    pub output: String,
    /// What the golden model says, raw.
    pub golden: i64,
    /// What the simulated hardware says.
    pub simulated: i64,
}

/// The position among the contract's operands of the one whose register addresses a ROM.
fn addressing(unit: &Unit, rom: RomId) -> Option<usize> {
    let design = &unit.design;
    let net = design.net(design.rom(rom).address);
    let Driver::Register(id) = net.driver else {
        return None;
    };
    let operand = net.name.strip_suffix("_reg")?;
    (design.register(id).kind == RegisterKind::Operand)
        .then(|| {
            unit.contract
                .operands()
                .iter()
                .position(|it| it.name == operand)
        })
        .flatten()
}

/// The first point that shows a fault in a word, among all that read it. None too where nothing is tried: no
/// operand is the address, there are too many points, or a computation has many results.
///
/// # Errors
/// The mutant cannot be simulated, or does not end.
pub(super) fn at_word(
    unit: &Unit,
    mutant: &Design,
    rom: RomId,
    word: usize,
) -> Result<Option<Point>> {
    let contract = unit.contract.as_ref();
    let (Some(held), None) = (addressing(unit, rom), contract.length()) else {
        return Ok(None);
    };
    // Colours at their largest show most of f.
    let ends: Vec<(i64, i64)> = contract
        .operands()
        .iter()
        .enumerate()
        .map(|(at, operand)| match (at == held, operand.colour) {
            (true, _) => (word as i64, word as i64),
            (_, true) => (operand.domain.1, operand.domain.1),
            _ => operand.domain,
        })
        .collect();
    let sizes: Vec<u64> = ends
        .iter()
        .map(|(low, high)| high.abs_diff(*low) + 1)
        .collect();
    let total = sizes
        .iter()
        .try_fold(1u64, |total, size| total.checked_mul(*size));
    let Some(total) = total.filter(|total| *total <= MOST) else {
        return Ok(None);
    };
    let mut hardware = RustHdl::new(mutant, contract)?;
    let operands = |place: u64| {
        let mut rest = place;
        let values = ends.iter().zip(&sizes).map(|((low, _), size)| {
            let value = low + (rest % size) as i64;
            rest /= size;
            value
        });
        values.collect::<Vec<_>>()
    };
    for from in (0..total).step_by(CHUNK as usize) {
        let mut points = Points::new(ends.len());
        for place in from..total.min(from + CHUNK) {
            points.push(operands(place), 1);
        }
        let (golden, simulated) = (
            Golden(contract).compute(&points)?,
            hardware.compute(&points)?,
        );
        if let Some(at) = golden.iter().zip(&simulated).position(|(a, b)| a != b) {
            let outputs = contract.outputs();
            let names = contract.operands().iter().map(|it| it.name.clone());
            return Ok(Some(Point {
                operands: names
                    .zip(operands(from + (at / outputs.len()) as u64))
                    .collect(),
                output: outputs[at % outputs.len()].clone(),
                golden: golden[at],
                simulated: simulated[at],
            }));
        }
    }
    Ok(None)
}
