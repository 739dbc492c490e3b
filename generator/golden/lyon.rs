//! `lyon`: `max(0, 1 − β·D²)^m` from a difference vector (US 5 739 820), by formula.

mod contract;
#[cfg(test)]
mod tests;

pub use contract::contract;

use super::frame::{Clocked, Frame, Microinstruction, Slot, idle, step};
use super::highlight::{Keys, Shading, shading};
use super::narrow::Narrow;
use super::{Model, keys};
use crate::base::fixed::{Format, Rounding};
use crate::config::Config;

/// How β is had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scale {
    /// `2^shift/(2·m)`; the operand is `shift`.
    Shift,
    /// `n/(2·m)`; the operand is `exponent`.
    Multiplier,
}

/// What a configuration of the device says.
#[derive(Clone)]
struct Params {
    keys: Keys,
    /// `power`: m, a power of two, 2 … 16.
    power: u32,
    /// `scale`.
    scale: Scale,
    /// `vector.fraction`: fraction bits of dx, dy and dz.
    vector_fraction: u32,
    /// `distance.fraction`: fraction bits of D².
    distance_fraction: u32,
    /// `distance.multipliers`: one for all components, which squares them in turn.
    squares_in_turn: bool,
    /// `distance.rounding`: of D².
    distance_rounding: Rounding,
    /// `intensity.rounding`: of β·D² and of the squares.
    intensity_rounding: Rounding,
}

impl Params {
    fn of(config: &Config) -> Self {
        Self {
            keys: Keys::without_cosine(config),
            power: keys::bits(config, "power"),
            scale: match config.choice("scale") {
                "shift" => Scale::Shift,
                _ => Scale::Multiplier,
            },
            vector_fraction: keys::bits(config, "vector.fraction"),
            distance_fraction: keys::bits(config, "distance.fraction"),
            squares_in_turn: config.choice("distance.multipliers") == "1",
            distance_rounding: keys::rounding(config, "distance.rounding"),
            intensity_rounding: keys::rounding(config, "intensity.rounding"),
        }
    }

    /// s, the number of squarings.
    fn squarings(&self) -> u32 {
        self.power.ilog2()
    }

    fn vector_format(&self) -> Format {
        Format::signed(1, self.vector_fraction as i32)
    }

    /// Of n, or of log₂ n, which is `exponent.bits` at most.
    fn scale_format(&self) -> Format {
        match self.scale {
            Scale::Shift => Format::unsigned(self.keys.exponent_bits.ilog2() as i32 + 1, 0),
            Scale::Multiplier => self.keys.exponent_format(),
        }
    }

    /// The operand `shift` or `exponent` for an exponent: log₂ n to the nearest, or n itself.
    fn scale_operand(&self, n: i64) -> i64 {
        match self.scale {
            Scale::Multiplier => n,
            Scale::Shift => {
                let n = n.max(1);
                let below = n.ilog2();
                // Above the geometric mean of two powers of two, the upper one is nearer.
                i64::from(below) + i64::from(n * n > 2 << (2 * below))
            }
        }
    }

    fn scale_name(&self) -> &'static str {
        match self.scale {
            Scale::Shift => "shift",
            Scale::Multiplier => "exponent",
        }
    }

    /// The domain of that operand.
    fn scale_domain(&self) -> (i64, i64) {
        (self.scale_operand(self.keys.exponents.0), self.scale_operand(self.keys.exponents.1))
    }

    /// The exponent that an operand `shift` or `exponent` stands for.
    fn exponent(&self, operand: i64) -> i64 {
        match self.scale {
            Scale::Shift => 1 << operand,
            Scale::Multiplier => operand,
        }
    }
}

/// The arithmetic of the device, one operation a method.
#[derive(Clone)]
struct Arithmetic {
    params: Params,
    squarings: u32,
    /// 1.0 in the point of f.
    one: i64,
    /// The largest word of the shift register.
    shifted_most: i64,
    /// From the sum of the squares.
    distance: Narrow,
    /// β·D², saturated below 2.0, from the product or the shift register's word.
    scaled: Narrow,
    square: Narrow,
}

impl Arithmetic {
    fn new(params: Params) -> Self {
        let (f, squarings) = (params.keys.intensity_fraction, params.squarings());
        let distance = params.distance_fraction;
        let rounding = params.intensity_rounding;
        // n/2^(s+1) is the integer n with s + 1 fraction bits; the shift register has one more.
        let beta_fraction = match params.scale {
            Scale::Multiplier => squarings + 1,
            Scale::Shift => squarings + 2,
        };
        Self {
            squarings,
            one: 1 << f,
            shifted_most: (2 << (distance + squarings + 2)) - 1,
            distance: Narrow::new(
                2 * params.vector_fraction,
                Format::unsigned(4, distance as i32),
                params.distance_rounding,
            ),
            scaled: Narrow::new(distance + beta_fraction, Format::unsigned(1, f as i32), rounding),
            square: Narrow::new(2 * f, params.keys.f_format(), rounding),
            params,
        }
    }

    /// D² as the register takes it.
    #[inline]
    fn distance(&self, vector: [i64; 3]) -> i64 {
        let [x, y, z] = vector;
        self.distance.apply(x * x + y * y + z * z)
    }

    /// One place of the shift register.
    #[inline]
    fn shifted(&self, word: i64) -> i64 {
        (2 * word).min(self.shifted_most)
    }

    /// β·D² from the word of D² and the operand `shift` or `exponent`.
    #[inline]
    fn beta_distance(&self, distance: i64, operand: i64) -> i64 {
        self.scaled.apply(match self.params.scale {
            Scale::Multiplier => distance * operand,
            Scale::Shift => (distance << (operand + 1)).min(self.shifted_most),
        })
    }

    /// `1.0 − ulp − β·D²`, or 0 where β·D² is not below 1.0.
    #[inline]
    fn base(&self, scaled: i64) -> i64 {
        (self.one - 1 - scaled).max(0)
    }

    #[inline]
    fn square(&self, x: i64) -> i64 {
        self.square.apply(x * x)
    }

    /// f from the word of D².
    #[inline]
    fn f_of(&self, distance: i64, operand: i64) -> i64 {
        let base = self.base(self.beta_distance(distance, operand));
        if base == 0 {
            return 0;
        }
        (0..self.squarings).fold(base, |power, _| self.square(power))
    }
}

/// The golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    Box::new(clocked(&Arithmetic::new(Params::of(config))))
}

/// The device, clock by clock.
struct Device {
    it: Arithmetic,
    vector: [Slot; 3],
    /// `shift` or `exponent`.
    scale: Slot,
    /// The sum of the first squares, where one multiplier makes all.
    sum: Slot,
    /// D², where a multiplier scales it; otherwise the shift register.
    distance: Slot,
    /// β·D² behind the multiplier.
    scaled: Slot,
    accumulator: Slot,
    remaining: Slot,
}

fn clocked(it: &Arithmetic) -> Clocked<Shading<Device>> {
    let (params, squarings) = (&it.params, it.squarings);
    let (vector, scale) = (params.vector_format(), params.scale_format());
    let shift = params.scale == Scale::Shift;
    // The counter counts squarings after the first, and shifts.
    let remaining = match (shift, squarings) {
        (false, _) => 2,
        (true, 3..) => scale.width().max(2),
        (true, _) => scale.width(),
    };
    let point = params.distance_fraction as i32;
    let shifted = Format::unsigned(1, point + squarings as i32 + 2);
    let mut frame = Frame::default();
    let vector = ["dx", "dy", "dz"].map(|name| frame.operand(name, vector));
    let scale = frame.operand(params.scale_name(), scale);
    let mut register_if = |there: bool, name, format| {
        if there { frame.register(name, format) } else { frame.hidden() }
    };
    let sum = Format::unsigned(4, 2 * params.vector_fraction as i32);
    let sum = register_if(params.squares_in_turn, "distance_sum", sum);
    let distance = if shift {
        register_if(true, "shift_register", shifted)
    } else {
        register_if(true, "distance", Format::unsigned(4, point))
    };
    let scaled = Format::unsigned(1, params.keys.intensity_fraction as i32);
    let scaled = register_if(!shift, "scaled", scaled);
    let accumulator = register_if(true, "accumulator", params.keys.f_format());
    let remaining = Format::unsigned(remaining as i32, 0);
    let remaining = register_if(shift || squarings > 1, "remaining", remaining);
    let (it, products) = (it.clone(), params.keys.products());
    let device = Device { it, vector, scale, sum, distance, scaled, accumulator, remaining };
    let distance = step(|d: &Shading<Device>, s| {
        let vector = d.vector.map(|component| s[component]);
        s[d.distance] = if d.it.params.squares_in_turn {
            d.it.distance.apply(s[d.sum] + vector[2] * vector[2])
        } else {
            d.it.distance(vector)
        };
        if d.it.params.scale == Scale::Shift {
            s[d.remaining] = s[d.scale];
        }
    });
    // The accumulator takes the square of the base …
    let base = step(|d: &Shading<Device>, s| {
        let scaled = match d.it.params.scale {
            Scale::Shift => d.it.scaled.apply(s[d.distance]),
            Scale::Multiplier => s[d.scaled],
        };
        s[d.accumulator] = d.it.square(d.it.base(scaled));
        if d.it.squarings > 1 {
            s[d.remaining] = i64::from(d.it.squarings) - 1;
        }
    });
    // … and then its own.
    let square = step(|d: &Shading<Device>, s| {
        s[d.accumulator] = d.it.square(s[d.accumulator]);
        s[d.remaining] -= 1;
    })
    .repeat_while(|d, s| s[d.remaining] > 1);
    let mut program = vec![idle()];
    if params.squares_in_turn {
        program.push(step(|d: &Shading<Device>, s| s[d.sum] = s[d.vector[0]] * s[d.vector[0]]));
        program.push(step(|d: &Shading<Device>, s| s[d.sum] += s[d.vector[1]] * s[d.vector[1]]));
    }
    program.extend([distance, scale_step(params.scale), base]);
    program.extend((squarings > 1).then_some(square));
    shading(frame, device, (products, accumulator), program)
}

/// β·D²: the product, or one place of the shift register.
fn scale_step(scale: Scale) -> Microinstruction<Shading<Device>> {
    match scale {
        Scale::Multiplier => step(|d: &Shading<Device>, s| {
            s[d.scaled] = d.it.scaled.apply(s[d.distance] * s[d.scale])
        }),
        Scale::Shift => step(|d: &Shading<Device>, s| {
            s[d.distance] = d.it.shifted(s[d.distance]);
            s[d.remaining] -= 1;
        })
        .repeat_while(|d, s| s[d.remaining] > 0),
    }
}
