//! `quad-cosine`: cosᵏ(√(n/k)·δ) along a scan line (seed 000, the claimed device), by formula.

mod contract;
#[cfg(test)]
mod tests;

pub use contract::contract;

use super::frame::{Clocked, Frame};
use super::line::{self, CosineTable, LineKeys, magnitude};
use super::{Model, keys};
use crate::base::fixed::Format;
use crate::config::Config;

/// What a configuration of the device says.
#[derive(Clone)]
struct Params {
    keys: LineKeys,
    /// `angle.multiplied`: those that multiplier 11 takes, A.
    angle_multiplied: u32,
    /// `root.fraction`: fraction bits of ROM 9, G.
    root_fraction: u32,
    /// `exponent.bits`: bits of n.
    exponent_bits: u32,
    /// `domain.exponent_min` and `domain.exponent_max`: the contract's n.
    exponents: (i64, i64),
}

impl Params {
    fn of(config: &Config) -> Self {
        Self {
            keys: LineKeys::new(config),
            angle_multiplied: keys::bits(config, "angle.multiplied"),
            root_fraction: keys::bits(config, "root.fraction"),
            exponent_bits: keys::bits(config, "exponent.bits"),
            exponents: keys::exponents(config),
        }
    }

    fn angle_format(&self) -> Format {
        Format::signed(1, self.keys.angle_fraction as i32)
    }

    fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }
}

/// The power that serves n, as a number of a table: the seed's ranges.
#[inline]
fn range_of(n: i64) -> usize {
    if n == 1 {
        0
    } else if n == 2 {
        1
    } else if (3..=6).contains(&n) {
        2
    } else {
        3
    }
}

/// The power k of each range.
const POWERS: [i64; 4] = [1, 2, 4, 16];

/// The arithmetic of the device, one operation a method.
struct Arithmetic {
    params: Params,
    /// ROM 9, a word for each n.
    roots: Vec<i64>,
    /// ROM 12, a table for each range of n.
    tables: [CosineTable; 4],
}

impl Arithmetic {
    fn new(params: Params) -> Self {
        let f = params.keys.intensity_fraction;
        Self {
            roots: (0..1 << params.exponent_bits)
                .map(|n| root(n, POWERS[range_of(n)], params.root_fraction))
                .collect(),
            tables: POWERS
                .map(|power| CosineTable::new(power as u32, params.keys.table_address, f)),
            params,
        }
    }

    /// What multiplier 11 takes of register 8; `None` where the surface faces away.
    #[inline]
    fn magnitude(&self, angle: i64) -> Option<i64> {
        let params = &self.params;
        magnitude(angle, params.keys.angle_fraction, params.angle_multiplied)
    }

    /// The word of ROM 12 for n, the magnitude, and ROM 9's word.
    #[inline]
    fn cosine_of(&self, n: i64, magnitude: Option<i64>, root: i64) -> i64 {
        let scaled = magnitude.map_or(i64::MAX, |magnitude| magnitude * root);
        self.tables[range_of(n)].words[self.step_of(scaled)]
    }

    /// The step of a table for an angle times ROM 9's word.
    #[inline]
    fn step_of(&self, scaled: i64) -> usize {
        let fraction = self.params.angle_multiplied + self.params.root_fraction;
        CosineTable::address(scaled, fraction, self.params.keys.table_address)
    }

    #[inline]
    fn root(&self, n: i64) -> i64 {
        self.roots[n as usize]
    }
}

/// `√(n/k)` rounded to the nearest word, by integers: the r with (r − ½)² ≤ n·2^2G/k < (r + ½)².
fn root(n: i64, k: i64, fraction: u32) -> i64 {
    let square = n << (2 * fraction);
    let floor = (square / k).isqrt();
    // (2·floor + 1)²·k ≤ 4·square.
    let middle = i128::from(2 * floor + 1);
    floor + i64::from(middle * middle * i128::from(k) <= 4 * i128::from(square))
}

/// The golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    Box::new(clocked(Params::of(config)))
}

/// The device, clock by clock.
fn clocked(params: Params) -> Clocked {
    let mut frame = Frame::default();
    let LineKeys { length_bits, stages, .. } = params.keys;
    let (angle, program) = line::walker(&mut frame, params.angle_format(), length_bits, stages);
    let exponent = frame.operand("exponent", params.exponent_format());
    // What ROM 9 and ROM 12 read at the latest edge.
    let (root, cosine) = (frame.hidden(), frame.hidden());
    let products = params.keys.products();
    let it = Arithmetic::new(params);
    if stages == 2 {
        products.slots(&mut frame, cosine);
        frame.every_edge(move |s| {
            s[cosine] = it.cosine_of(s[exponent], it.magnitude(s[angle]), s[root]);
            s[root] = it.root(s[exponent]);
        });
        return frame.model(program);
    }
    // The magnitude of the angle, or nothing, and the word of ROM 9; the magnitude times the root, and whether there was one.
    let [magnitude, within, held_root, scaled, scaled_within] = [(); 5].map(|()| frame.hidden());
    // The address of ROM 12: the range of n, and the step. Then its word.
    let [range, step, held] = [(); 3].map(|()| frame.hidden());
    products.slots(&mut frame, held);
    // From the output back to the angle: each takes what the one before it held.
    frame.every_edge(move |s| {
        s[held] = s[cosine];
        s[cosine] = it.tables[s[range] as usize].words[s[step] as usize];
        s[step] = it.step_of(if s[scaled_within] == 1 { s[scaled] } else { i64::MAX }) as i64;
        s[range] = range_of(s[exponent]) as i64;
        s[scaled] = s[magnitude] * s[held_root];
        s[scaled_within] = s[within];
        s[held_root] = s[root];
        let taken = it.magnitude(s[angle]);
        s[magnitude] = taken.unwrap_or_default();
        s[within] = taken.is_some().into();
        s[root] = it.root(s[exponent]);
    });
    frame.model(program)
}
