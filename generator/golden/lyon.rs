//! `lyon`: `max(0, 1 − β·D²)^m` from a difference vector (US 5 739 820), by formula.

mod contract;
#[cfg(test)]
mod tests;

pub use contract::contract;

use std::sync::Arc;

use super::frame::{Clocked, Frame, idle, step, step_by};
use super::highlight::Keys;
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
    Box::new(clocked(Params::of(config)))
}

/// The device, clock by clock.
fn clocked(params: Params) -> Clocked {
    let it = Arc::new(Arithmetic::new(params));
    let (params, squarings) = (&it.params, it.squarings);
    let (shift, in_turn) = (params.scale == Scale::Shift, params.squares_in_turn);
    let (vector, scale) = (params.vector_format(), params.scale_format());
    // The counter counts squarings after the first, and shifts.
    let remaining = match (shift, squarings) {
        (false, _) => 2,
        (true, 3..) => scale.width().max(2),
        (true, _) => scale.width(),
    };
    let point = params.distance_fraction as i32;
    let mut frame = Frame::default();
    let vector = ["dx", "dy", "dz"].map(|name| frame.operand(name, vector));
    let operand = frame.operand(params.scale_name(), scale);
    let mut register_if = |there: bool, name, int: i32, frac: i32| {
        let format = Format::unsigned(int, frac);
        if there { frame.register(name, format) } else { frame.hidden() }
    };
    // The sum of the first squares, where one multiplier makes all.
    let sum = register_if(in_turn, "distance_sum", 4, 2 * params.vector_fraction as i32);
    // D², where a multiplier scales it; otherwise the shift register.
    let distance = if shift {
        register_if(true, "shift_register", 1, point + squarings as i32 + 2)
    } else {
        register_if(true, "distance", 4, point)
    };
    // β·D² behind the multiplier.
    let f = params.keys.intensity_fraction as i32;
    let scaled = register_if(!shift, "scaled", 1, f);
    let accumulator = register_if(true, "accumulator", 0, f);
    let remaining = register_if(shift || squarings > 1, "remaining", remaining as i32, 0);
    let mut program = vec![idle()];
    if in_turn {
        program.push(step(move |s| s[sum] = s[vector[0]] * s[vector[0]]));
        program.push(step(move |s| s[sum] += s[vector[1]] * s[vector[1]]));
    }
    program.push(step_by(&it, move |it, s| {
        let [x, y, z] = vector.map(|component| s[component] * s[component]);
        s[distance] = it.distance.apply(z + if in_turn { s[sum] } else { x + y });
        if shift {
            s[remaining] = s[operand];
        }
    }));
    // β·D²: one place of the shift register, or the product.
    program.push(if shift {
        step_by(&it, move |it, s| {
            s[distance] = it.shifted(s[distance]);
            s[remaining] -= 1;
        })
        .repeat_while(move |s| s[remaining] > 0)
    } else {
        step_by(&it, move |it, s| s[scaled] = it.scaled.apply(s[distance] * s[operand]))
    });
    // The accumulator takes the square of the base …
    program.push(step_by(&it, move |it, s| {
        let scaled = if shift { it.scaled.apply(s[distance]) } else { s[scaled] };
        s[accumulator] = it.square(it.base(scaled));
        if squarings > 1 {
            s[remaining] = i64::from(squarings) - 1;
        }
    }));
    // … and then its own.
    if squarings > 1 {
        let square = step_by(&it, move |it, s| {
            s[accumulator] = it.square(s[accumulator]);
            s[remaining] -= 1;
        });
        program.push(square.repeat_while(move |s| s[remaining] > 1));
    }
    params.keys.products().behind(frame, accumulator, program)
}
