//! Estimates the area and the clock frequency of a core from its netlist, without synthesis.
//!
//! DSP blocks and block RAMs follow from the bit widths. LUTs are a weighted sum of [`Features`] of the netlist. The frequency
//! follows from the longest path between registers, with the delays of [`Timing`](glint_base::target::Timing).

use std::collections::BTreeSet;

use serde::Serialize;

use crate::synth::Target;
use glint_base::target::{ECP5, Family};
use glint_rtl::area::{Features, slices};
use glint_rtl::netlist::{Design, Driver, NetId, Op, RegId};
use glint_rtl::pipeline::delay_of;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    pub luts: f64,
    pub dsps: u64,
    pub block_rams: u64,
    pub rom_bits: u64,
    /// The clock frequency in MHz.
    pub mhz: f64,
}

/// Returns a target's family. Standard cells have no model of their own and use the model of ECP5, the most similar family.
pub fn family(target: Target) -> &'static Family {
    target.family().unwrap_or(&ECP5)
}

impl Cost {
    /// Estimates the cost of `design` on `target`. Standard cells get the estimate for ECP5.
    pub fn new(design: &Design, target: Target) -> Self {
        let family = family(target);
        let luts = Features::new(design, family).luts(family);
        let mut dsps = 0;
        for net in &design.nets {
            if let Driver::Op(Op::Mul(a, b)) = net.driver
                && family.fabric_product.is_none()
            {
                dsps += dsps_of_product(design, family, a, b);
            }
        }
        Self {
            // The estimate is not exact enough for more than one digit after the point.
            luts: (luts * 10.0).round() / 10.0,
            dsps,
            block_rams: block_rams(design, family),
            rom_bits: design.rom_bits(),
            mhz: (10_000.0 / (family.estimate.scale * period(design, family))).round() / 10.0,
        }
    }

    /// Returns the area in look-up tables ([`area`]).
    pub fn area(&self, target: Target) -> f64 {
        area(target, self.luts, self.dsps, self.block_rams)
    }

    /// Returns the resources that the usual chip of the target lacks, in words. For example, `the core does not fit the iCE40
    /// UP5K: it takes 9 of 8 DSP blocks`. The text is empty if the core fits.
    pub fn excess(&self, target: Target) -> String {
        let chip = &family(target).chips[0];
        let wanted = [self.luts.ceil() as u64, self.dsps, self.block_rams];
        let names = ["look-up tables", "DSP blocks", "block RAMs"];
        let mut lacking: Vec<String> = Vec::new();
        for (at, wanted, has) in chip.lack(wanted) {
            lacking.push(format!("{wanted} of {has} {}", names[at]));
        }
        if lacking.is_empty() {
            return String::new();
        }
        format!("the core does not fit the {}: it takes {}", chip.name, lacking.join(", "))
    }
}

/// Returns an area in look-up tables. A DSP block or block RAM counts for as many look-up tables as the usual chip of the target
/// has for each such block. For example, iCE40 UP5K has 5280 look-up tables and 8 DSP blocks, so a DSP block counts for 660.
pub fn area(target: Target, luts: f64, dsps: u64, block_rams: u64) -> f64 {
    let [all_luts, all_dsps, all_blocks] = family(target).chips[0].has.map(|has| has as f64);
    // On a chip without DSP blocks, a core takes none, so they cost nothing.
    let dsp = if all_dsps == 0.0 { 0.0 } else { (all_luts / all_dsps).round() };
    let block = (all_luts / all_blocks).round();
    luts + dsp * dsps as f64 + block * block_rams as f64
}

/// Returns the number of DSP blocks of a product, with the operands in the order that takes fewer blocks.
fn dsps_of_product(design: &Design, family: &Family, a: NetId, b: NetId) -> u64 {
    let [a, b] = [a, b].map(|net| {
        let sign = if design.net(net).format.signed { family.estimate.sign } else { 0 };
        design.width(net) - sign
    });
    dsps_one_way(family, a, b).min(dsps_one_way(family, b, a))
}

/// Returns the number of DSP blocks for a product of `first` by `second` bits, if the first operand is at the wider input of the
/// blocks.
fn dsps_one_way(family: &Family, first: u32, second: u32) -> u64 {
    let (wide, narrow) = family.timing.multiplier;
    let second_slices = slices(second, narrow);
    let mut blocks = 0;
    for first_slice in slices(first, wide) {
        for second_slice in &second_slices {
            if first_slice + second_slice >= family.estimate.least_product {
                blocks += 1;
            }
        }
    }
    blocks
}

/// Returns the number of partial products, in the better order of the operands. For example, with the 16 by 16 bits of iCE40's
/// blocks, a product of 20 by 12 bits has 2.
fn blocks(family: &Family, a: u32, b: u32) -> u64 {
    let (wide, narrow) = family.timing.multiplier;
    let one_way = count_slices(a, wide) * count_slices(b, narrow);
    let other_way = count_slices(b, wide) * count_slices(a, narrow);
    one_way.min(other_way)
}

fn count_slices(operand: u32, block: u32) -> u64 {
    u64::from(operand.div_ceil(block).max(1))
}

/// Counts the block RAMs. A synchronous ROM takes some if it is large enough and does not share the block of another ROM.
fn block_rams(design: &Design, family: &Family) -> u64 {
    let mut blocks = 0;
    for rom in &design.roms {
        let (words, width) = (rom.words.len() as u64, u64::from(design.width(rom.data)));
        let is_own_block = rom.synchronous && rom.shares.is_none();
        if is_own_block && family.timing.blocks.takes(words, width) {
            blocks += family.timing.blocks.count(words, width);
        }
    }
    blocks
}

/// Returns the longest delay between registers, in nanoseconds, including a register's delay.
fn period(design: &Design, family: &Family) -> f64 {
    let delays = &family.timing;
    let order = design.levelise().unwrap_or_default();
    let mut arrival = vec![0.0_f64; design.nets.len()];
    let mut longest = 0.0_f64;
    // The products that have a register directly behind them, in a registered multiplier.
    let mut registered: BTreeSet<NetId> = BTreeSet::new();
    for at in 0..design.registers.len() {
        if let Some(multiplier) = design.multiplier(RegId(at as u32)) {
            registered.insert(multiplier.product);
        }
    }
    for id in order {
        let mut before = 0.0_f64;
        let mut latest = None;
        for input in design.combinational_inputs(id) {
            if arrival[input.index()] > before {
                before = arrival[input.index()];
                latest = Some(input);
            }
        }
        let is_behind_sum =
            latest.is_some_and(|latest| is_sum(design, behind_wires(design, latest)));
        let delay = match (&design.net(id).driver, delays.registered) {
            (Driver::Op(Op::Mul(..)), Some(multiplier)) if registered.contains(&id) => {
                multiplier.product
            }
            (Driver::Op(Op::Mul(..)), None) if registered.contains(&id) => delays.product,
            (driver, _) if is_behind_sum && is_sum(design, id) => {
                family.estimate.chained_sum * cell_delay(design, family, id, driver)
            }
            (driver, _) => cell_delay(design, family, id, driver),
        };
        arrival[id.index()] = before + delay;
        longest = longest.max(before + delay);
    }
    longest + delays.register
}

fn is_sum(design: &Design, id: NetId) -> bool {
    matches!(design.net(id).driver, Driver::Op(Op::Add { .. } | Op::Sub(..)))
}

/// Returns the net whose cell computes the upper bits of a net.
fn behind_wires(design: &Design, id: NetId) -> NetId {
    match &design.net(id).driver {
        Driver::Op(Op::Relabel(a) | Op::Extend(a) | Op::Slice { of: a, .. }) => {
            behind_wires(design, *a)
        }
        Driver::Op(Op::Concat(parts)) => behind_wires(design, parts[0]),
        _ => id,
    }
}

/// The part of a product's delay in an array of logic that does not depend on the width of the operands.
const FIXED_PART_OF_PRODUCT: f64 = 0.3;

/// Returns the delay of a net's cell, in nanoseconds.
fn cell_delay(design: &Design, family: &Family, id: NetId, driver: &Driver) -> f64 {
    let delays = &family.timing;
    let levels = |inputs: u32| delays.logic * f64::from(inputs.max(2).ilog2().div_ceil(2).max(1));
    match driver {
        Driver::Op(Op::Mul(a, b)) if family.fabric_product.is_some() => {
            let (_, rows) = delays.multiplier;
            let narrow = design.width(*a).min(design.width(*b)).min(rows);
            let part = f64::from(narrow) / f64::from(rows);
            delays.product * (FIXED_PART_OF_PRODUCT + (1.0 - FIXED_PART_OF_PRODUCT) * part)
        }
        Driver::Op(Op::Mul(a, b)) if blocks(family, design.width(*a), design.width(*b)) > 1 => {
            delays.product + delays.chain(design.width(id) / 2)
        }
        // The last fit of the model used these counts of levels. They are smaller than the counts for the schedules of
        // pipelines.
        Driver::Op(Op::Equal(a, _)) => levels(2 * design.width(*a)),
        Driver::Op(Op::Any(a) | Op::All(a)) => levels(design.width(*a)),
        Driver::Op(Op::Mux { inputs, .. }) => levels(inputs.len() as u32),
        Driver::Op(Op::Less(a, _)) => delays.chain(design.width(*a)),
        Driver::Op(op) => delay_of(delays, op, &|operand| design.width(operand)),
        Driver::Rom(rom) => {
            let rom = design.rom(*rom);
            let address = design.width(rom.address).saturating_sub(2).max(1);
            if rom.synchronous { delays.block } else { levels(2 * address) }
        }
        Driver::Undriven
        | Driver::Input
        | Driver::Constant(_)
        | Driver::Register(_)
        | Driver::Field(_) => 0.0,
    }
}
