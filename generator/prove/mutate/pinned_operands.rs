//! Compares a mutant (a design with one fault) with the golden model while some operands keep fixed values.
//!
//! Random operands would rarely read a faulty ROM word. A caller therefore fixes the operands that lead to the word. The
//! module draws the other operands at random ([`drawn`], [`alone`]), or tries all their values ([`all`]).

use anyhow::Result;

use super::coverage::{OperandValues, operand_of};
use super::verdict::SignalDifference;
use glint_core::core::Core;
use glint_core::cosim::exhaustive::Clocks;
use glint_rtl::netlist::{Design, Driver, RegisterKind, RomId};

/// The number of results that are compared if some operands are fixed.
const POINTS: u64 = 1 << 17;

/// The number of results that are compared if all operands are fixed.
const FEW_POINTS: u64 = 64;

const SEED: u64 = 3;

/// The largest number of operand bits for which [`all`] tries every combination, if the operand that addresses the ROM is fixed.
pub(super) const MOST_BITS: u32 = 22;

/// The largest number of operand bits for which [`all`] tries every combination, if no operand is fixed.
pub(super) const NARROW: u32 = 16;

/// Returns the operand that directly addresses `rom`, with the raw value that selects word number `word`. For example, a ROM with
/// the operand `exponent` as its address gives `exponent` and 5 for word 5. Returns `None` for any other address.
pub(super) fn addressing(core: &Core, rom: RomId, word: usize) -> Option<OperandValues> {
    let design = &core.design;
    let net = design.net(design.rom(rom).address);
    let Driver::Register(id) = net.driver else {
        return None;
    };
    let register = Some(design.register(id)).filter(|it| it.kind == RegisterKind::Operand)?;
    Some(vec![(operand_of(design, register)?.to_owned(), word as i64)])
}

/// Returns the first difference between a mutant and the golden model for 131 072 random points. The operands `held` nearly
/// always keep their values.
///
/// # Errors
///
/// Fails if the mutant cannot be simulated.
pub(super) fn drawn(
    core: &Core,
    mutant: &Design,
    held: OperandValues,
) -> Result<Option<SignalDifference>> {
    let lockstep = core.lockstep_of(mutant, SEED)?.holding(&held);
    let mismatch = lockstep.run(POINTS, &|_| ())?.mismatch;
    Ok(mismatch.map(|mismatch| SignalDifference { held, mismatch }))
}

/// Returns the first difference like [`drawn`], but for 64 points.
///
/// # Errors
///
/// Fails if the mutant cannot be simulated.
pub(super) fn alone(
    core: &Core,
    mutant: &Design,
    held: OperandValues,
) -> Result<Option<SignalDifference>> {
    let lockstep = core.lockstep_of(mutant, SEED)?.holding(&held);
    let mismatch = lockstep.run_alone(FEW_POINTS)?.mismatch;
    Ok(mismatch.map(|mismatch| SignalDifference { held, mismatch }))
}

/// The result of [`all`].
pub(super) enum Tried {
    /// The operands have too many values, or the device computes lines of points.
    Nothing,
    /// No register and no output differs for any value.
    All,
    /// A register or an output differs for these operands.
    Differs(OperandValues),
}

/// Compares a mutant with the golden model for all values of the control operands, if they have at most `most_bits` bits
/// together. The operands `held` keep their raw values, and each colour operand has its largest value.
///
/// # Errors
///
/// Fails if the mutant cannot be simulated.
pub(super) fn all(
    core: &Core,
    mutant: &Design,
    mut held: OperandValues,
    most_bits: u32,
) -> Result<Tried> {
    let contract = core.contract.as_ref();
    if contract.length().is_some() {
        return Ok(Tried::Nothing);
    }
    // Only one value of each colour is tried: a colour only multiplies f, and the register of f is compared.
    let colours = contract.operands().iter().filter(|it| it.colour);
    held.extend(colours.map(|it| (it.name.clone(), it.domain.1)));
    let model = core.opened.golden();
    let clocks = Clocks::new(mutant, model, contract)?.holding(&held);
    if clocks.bits() > most_bits {
        return Ok(Tried::Nothing);
    }
    Ok(match clocks.check((0..clocks.blocks()).collect(), &|_| ())? {
        None => Tried::All,
        Some(place) => {
            let bits = clocks.difference(place)?.operands;
            let raw = |(name, bits): (String, u64)| {
                let mut operands = contract.operands().iter();
                let operand = operands.find(|it| it.name == name)?;
                Some((name, operand.format.raw(bits) as i64))
            };
            Tried::Differs(bits.into_iter().filter_map(raw).collect())
        }
    })
}
