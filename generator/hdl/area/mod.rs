//! Estimates the number of look-up tables of a netlist, without synthesis: a weighted sum of [`Features`] of the netlist.
//! `benches/tune/fit` fits the weights to records of `glint synth`.

mod bits;

use serde::{Deserialize, Serialize};

use crate::netlist::{Design, Driver, NetId, Op};
use bits::BitSources;
use glint_base::target::Family;

/// Counts of a netlist's logic, from which the number of look-up tables is estimated. Bits that are constants, or copies of other bits
/// (`bits.rs`), do not count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Features {
    /// The number of bits of sums, differences and comparisons.
    pub adder: f64,
    /// The number of bits of muxes, for each input beyond the first. For example, a mux of 3 inputs of 8 bits counts 16. A constant
    /// input counts half.
    pub mux: f64,
    /// The number of bits of gates. A reduction counts a third of its operand's bits, and an equality a third of the bits of
    /// both operands. Inverters do not count.
    pub logic: f64,
    /// The number of bits of the ROMs that are made of look-up tables, divided by 16.
    pub rom: f64,
    /// The number of bits in the sums of partial products: half the width of the product for each multiplier beyond the first.
    /// For a family without DSP blocks, the number of look-up tables of the products.
    pub product: f64,
    /// The number of look-up tables of delay memories.
    pub delay: f64,
}

impl Features {
    /// Counts the logic of a netlist for a family, which decides how products and memories count.
    pub fn new(design: &Design, family: &Family) -> Self {
        let sources = BitSources::of(design);
        let mut sum = Self::default();
        let width = |net: NetId| f64::from(design.width(net));
        for (id, net) in design.iter() {
            let Driver::Op(op) = &net.driver else {
                continue;
            };
            match op {
                Op::Add { a, b, .. } | Op::Sub(a, b) => {
                    sum.adder += sources.added(id, *a, *b) as f64;
                }
                Op::Less(a, _) => sum.adder += width(*a),
                Op::And(..) | Op::Or(..) | Op::Xor(..) => sum.logic += sources.computed(id) as f64,
                Op::Any(a) | Op::All(a) => sum.logic += sources.varying(*a) as f64 / 3.0,
                Op::Equal(a, _) => sum.logic += 2.0 * width(*a) / 3.0,
                Op::Mux { inputs, .. } => sum.mux += sources.chosen(id, inputs),
                Op::Mul(a, b) => {
                    let factors = [*a, *b].map(|factor| sources.varying(factor) as u32);
                    sum.product += luts_of_product(family, factors, width(id));
                }
                Op::Relabel(_) | Op::Extend(_) | Op::Slice { .. } | Op::Concat(_) | Op::Not(_) => {}
            }
        }
        for rom in &design.roms {
            let (words, width) = (rom.words.len() as u64, u64::from(design.width(rom.data)));
            if !rom.synchronous || !family.timing.blocks.takes(words, width) {
                sum.rom += (words * width) as f64 / 16.0;
            }
        }
        if let Some(memory) = family.timing.delay_memory {
            for line in design.delay_lines() {
                let bits: u32 = line.values.iter().map(|value| design.width(value.data)).sum();
                let memories =
                    bits.div_ceil(memory.width) * (line.words() as u32).div_ceil(memory.words);
                sum.delay += f64::from(memories * memory.tables);
            }
        }
        sum
    }

    /// Returns the estimated number of look-up tables of the netlist in a family.
    pub fn luts(&self, family: &Family) -> f64 {
        let Self { adder, mux, logic, rom, product, delay } = *self;
        let mut luts = delay;
        for (part, weight) in
            [adder, mux, logic, rom, product, 1.0].iter().zip(family.estimate.weights)
        {
            luts += part * weight;
        }
        luts
    }
}

/// Returns the number of look-up tables of a product in a family without DSP blocks, otherwise the number of bits in the sums
/// of partial products. `factors` are the factors' numbers of varying bits, and `width` is the product's width.
fn luts_of_product(family: &Family, factors: [u32; 2], width: f64) -> f64 {
    let [a, b] = factors;
    if let Some(product) = family.fabric_product {
        let luts = product.luts;
        return luts(u64::from(a), u64::from(b)) as f64;
    }
    let (wide, narrow) = family.timing.multiplier;
    let one_way = slices(a, wide).len() * slices(b, narrow).len();
    let other_way = slices(b, wide).len() * slices(a, narrow).len();
    one_way.min(other_way).saturating_sub(1) as f64 * width / 2.0
}

/// Returns the widths of the slices into which Yosys divides an operand: slices of the width of a block, and a rest. A rest of
/// a single bit is left out, because it becomes a row of gates. For example, 35 bits for blocks of 16 are 16, 16 and 3, and 33
/// bits are 16 and 16.
pub fn slices(operand: u32, block: u32) -> Vec<u32> {
    let mut slices = vec![block; (operand / block) as usize];
    let rest = operand % block;
    if rest > 1 || operand < block {
        slices.push(rest);
    }
    slices
}
