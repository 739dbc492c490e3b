//! `quad-cosine`: cosᵏ(√(n/k)·δ) along a scan line (seed 000, the claimed device), by formula.

mod contract;
#[cfg(test)]
mod tests;

pub use contract::contract;

use super::frame::{Clocked, Datapath, Frame, Slot, State};
use super::highlight::ProductSlots;
use super::line::{CosineTable, LineKeys, Walker, magnitude};
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
#[derive(Clone)]
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
struct Device {
    it: Arithmetic,
    walker: Walker,
    exponent: Slot,
    /// What ROM 9 read at the latest edge.
    root: Slot,
    /// What ROM 12 read.
    cosine: Slot,
    stages: Option<Stages>,
    products: ProductSlots,
}

/// The registers on the way from the angle to the output that a staged line has beyond ROM 9 and ROM 12.
struct Stages {
    /// The magnitude of the angle, or nothing.
    magnitude: Slot,
    within: Slot,
    root: Slot,
    /// The magnitude times the root, and whether there was one.
    scaled: Slot,
    scaled_within: Slot,
    /// The address of ROM 12: the range of n, and the step.
    range: Slot,
    step: Slot,
    /// The word of ROM 12.
    cosine: Slot,
}

impl Stages {
    fn new(frame: &mut Frame) -> Self {
        Self {
            magnitude: frame.hidden(),
            within: frame.hidden(),
            root: frame.hidden(),
            scaled: frame.hidden(),
            scaled_within: frame.hidden(),
            range: frame.hidden(),
            step: frame.hidden(),
            cosine: frame.hidden(),
        }
    }

    /// A rising edge, from the output back to the angle: each takes what the one before it held.
    #[inline]
    fn edge(&self, device: &Device, s: &mut State) {
        let Device { it, walker, exponent, root, cosine, products, .. } = device;
        products.show(s);
        s[self.cosine] = s[*cosine];
        s[*cosine] = it.tables[s[self.range] as usize].words[s[self.step] as usize];
        let scaled = if s[self.scaled_within] == 1 { s[self.scaled] } else { i64::MAX };
        s[self.step] = it.step_of(scaled) as i64;
        s[self.range] = range_of(s[*exponent]) as i64;
        s[self.scaled] = s[self.magnitude] * s[self.root];
        s[self.scaled_within] = s[self.within];
        s[self.root] = s[*root];
        let magnitude = it.magnitude(s[walker.angle]);
        s[self.magnitude] = magnitude.unwrap_or_default();
        s[self.within] = magnitude.is_some().into();
    }
}

impl AsRef<Walker> for Device {
    fn as_ref(&self) -> &Walker {
        &self.walker
    }
}

impl Datapath for Device {
    #[inline]
    fn edge(&self, s: &mut State) {
        let n = s[self.exponent];
        if let Some(stages) = &self.stages {
            stages.edge(self, s);
        } else {
            let magnitude = self.it.magnitude(s[self.walker.angle]);
            s[self.cosine] = self.it.cosine_of(n, magnitude, s[self.root]);
        }
        s[self.root] = self.it.root(n);
    }

    #[inline]
    fn outputs(&self, s: &mut State) {
        // Of a staged line an edge makes them.
        if self.stages.is_none() {
            self.products.show(s);
        }
    }
}

fn clocked(params: Params) -> Clocked<Device> {
    let mut frame = Frame::default();
    let walker =
        Walker::new(&mut frame, params.angle_format(), params.keys.length_bits, params.keys.stages);
    let program = walker.program();
    let exponent = frame.operand("exponent", params.exponent_format());
    let (root, cosine) = (frame.hidden(), frame.hidden());
    let stages = (params.keys.stages > 2).then(|| Stages::new(&mut frame));
    let shown = stages.as_ref().map_or(cosine, |stages| stages.cosine);
    let products = params.keys.products().slots(&mut frame, shown);
    let it = Arithmetic::new(params);
    let device = Device { it, walker, exponent, root, cosine, stages, products };
    frame.model(device, program)
}
