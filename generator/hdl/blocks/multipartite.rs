//! A smooth function of one operand by tables that are added: the symmetric multipartite method of Schulte
//! and Stine, and of de Dinechin and Tisserand. No multiplication.
//!
//! The operand x, a fraction of X bits, is a leading part A and fields B₁, B₂, … below it. One table holds
//! the value at the middle of the interval that A stands for; each field has a table of its own, which
//! holds what the field adds: its distance from its middle times the slope, where for the slope only a few
//! leading bits of A are looked at. The lower the field, the fewer suffice. What a field adds is odd about
//! its middle, so its table has one half; the other half is its inverse.

use crate::dsl::{Designer, Signal};
use glint_base::fixed::{Format, exp2};

/// How the operand is cut.
#[derive(Clone, Debug)]
pub struct Cut {
    /// Bits of A.
    pub address: u32,
    /// The fields below it, from the top.
    pub offsets: Vec<Offset>,
}

/// A field of the operand.
#[derive(Clone, Copy, Debug)]
pub struct Offset {
    /// Bits of the field, at least 2.
    pub bits: u32,
    /// The leading bits of A by which its slope is chosen, at most all.
    pub address: u32,
}

impl Cut {
    /// X: bits of the operand.
    pub fn bits(&self) -> u32 {
        self.address + self.offsets.iter().map(|offset| offset.bits).sum::<u32>()
    }
}

/// The contents of the tables, in ulps of the sum.
struct Tables {
    values: Vec<i128>,
    offsets: Vec<Vec<i128>>,
}

/// `function` over 0 … 1 at an ulp of 2^−`fraction`.
///
/// An operand stands for the interval of an ulp above it, and the tables aim at its middle. An entry t of a
/// field's table stands for t + ½ ulp, so that the inverse −t − 1 is exactly its opposite; the halves
/// are taken from the values.
fn tables(cut: &Cut, fraction: i32, function: &impl Fn(f64) -> f64) -> Tables {
    let scale = exp2(fraction);
    let mut below = cut.bits() - cut.address;
    let offsets = cut.offsets.iter().map(|offset| {
        below -= offset.bits;
        let unit = exp2(below as i32 - cut.bits() as i32);
        let (slopes, half) = (1u32 << offset.address, 1u32 << (offset.bits - 1));
        let width = 1.0 / f64::from(slopes);
        (0..slopes)
            .flat_map(|at| {
                let from = f64::from(at) * width;
                let slope = (function(from + width) - function(from)) / width;
                (0..half).map(move |step| {
                    (slope * (f64::from(step) + 0.5) * unit * scale).floor() as i128
                })
            })
            .collect()
    });
    let offsets: Vec<Vec<i128>> = offsets.collect();
    let halves = offsets.len() as f64 / 2.0;
    let width = exp2(-(cut.address as i32));
    let values = (0..1u32 << cut.address)
        .map(|at| {
            let from = f64::from(at) * width;
            // Within an interval the function bends to one side of the line: the middle of the bend.
            let chord = (function(from) + function(from + width)) / 2.0;
            let middle = (function(from + width / 2.0) + chord) / 2.0;
            (middle * scale - halves + 0.5).floor() as i128
        })
        .collect();
    Tables { values, offsets }
}

/// The tables as hardware: `x` is `u0.X` with X = [`Cut::bits`]; the result has `fraction` fraction bits.
///
/// `doc` names the function. With `synchronous` the ROMs are registered, and the result belongs to the `x`
/// of the clock before.
#[track_caller]
pub fn evaluate<'d>(
    d: &'d Designer,
    name: &str,
    x: Signal<'d>,
    cut: &Cut,
    fraction: i32,
    synchronous: bool,
    (doc, function): (&str, impl Fn(f64) -> f64),
) -> Signal<'d> {
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let bits = cut.bits();
    let Tables { values, offsets } = tables(cut, fraction, &function);
    let holding = |words: &[i128]| {
        let low = words.iter().copied().min().unwrap_or(0);
        let high = words.iter().copied().max().unwrap_or(0);
        Format::holding(low, high, fraction)
    };
    let leading = x.bits(bits - cut.address, integer(cut.address));
    let mut sum = d
        .rom(&format!("{name}_value"), leading, holding(&values), &values, synchronous)
        .doc(&format!(
            "{doc} at the middle of each of {} intervals of x, in units of 2^-{fraction}",
            values.len()
        ))
        .out();
    let mut below = bits - cut.address;
    for (number, (offset, words)) in (1..).zip(cut.offsets.iter().zip(&offsets)) {
        below -= offset.bits;
        let part = format!("{name}_offset{number}");
        let upper = x.bit(below + offset.bits - 1);
        let inner = x.bits(below, integer(offset.bits - 1));
        let mirrored = d.not(&format!("{part}_mirrored"), inner);
        let distance = d
            .choose(&format!("{part}_distance"), upper, [mirrored, inner])
            .doc("distance from the middle of the field");
        let address = if offset.address == 0 {
            distance
        } else {
            let slope = x.bits(bits - offset.address, integer(offset.address));
            let name = format!("{part}_address");
            let format = integer(offset.address + offset.bits - 1);
            d.join(&name, &[slope, distance], format).named(&name)
        };
        let word = d
            .rom(&part, address, holding(words), words, synchronous)
            .doc(&format!(
                "slope of {doc} over 2^-{} of x, times the distance from the middle of bits {} to {below} of x, \
                 in units of 2^-{fraction}, less a half",
                offset.address,
                below + offset.bits - 1
            ))
            .out();
        let upper = if synchronous { d.pipeline(&format!("{part}_upper"), upper) } else { upper };
        // As a signed number, of which the inverse is the opposite, less an ulp.
        let word = word.as_signed();
        let opposite = d.not(&format!("{part}_opposite"), word);
        let term = d
            .choose(&format!("{part}_term"), upper, [opposite, word])
            .doc("what the field adds, less half an ulp");
        sum = d.add(&format!("{part}_sum"), sum, term);
    }
    sum
}
