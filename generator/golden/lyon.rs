//! The golden model and the accuracy contract of the device `lyon`, which computes f = max(0, 1 − β·D²)^m.
//!
//! D² is the squared length of the difference D = N − H between the unit normal N and the unit half vector H (operands `dx`,
//! `dy`, `dz`). β = n/(2·m) with the specular exponent n. The configuration chooses m, a power of two. The device takes n
//! itself as the operand `exponent`, or log₂ n, rounded, as the operand `shift`. The source is the patent US 5 739 820, which
//! [seed 000](crate#symbols) cites.

mod contract;
#[cfg(test)]
mod tests;

pub use contract::contract;

use std::sync::Arc;

use super::Model;
use super::frame::{Frame, idle, step, step_by};
use super::highlight::{self, Products};
use super::narrow::Narrow;
use easy_ext::ext;

use glint_base::fixed::Format;
use glint_config::Config;
use glint_keys::lyon::{Keys, Scale};

#[ext(Derived)]
impl Keys {
    fn products(&self) -> Products {
        highlight::products(&self.colours, &self.f)
    }

    fn vector_format(&self) -> Format {
        Format::signed(1, self.vector_fraction as i32)
    }

    /// Returns the format of the operand `shift` or `exponent`. `shift` is log₂ n and at most `exponent.bits`.
    fn scale_format(&self) -> Format {
        match self.scale {
            Scale::Shift => Format::unsigned(self.exponent_bits.ilog2() as i32 + 1, 0),
            Scale::Multiplier => Format::unsigned(self.exponent_bits as i32, 0),
        }
    }

    /// Returns the value of the operand `exponent` or `shift` for the exponent `n`. `shift` is log₂ n, rounded to the nearest
    /// integer (0 for n = 0). For example, n = 6 gives 3.
    fn scale_operand(&self, n: i64) -> i64 {
        match self.scale {
            Scale::Multiplier => n,
            Scale::Shift => {
                let positive = n.max(1);
                let below = positive.ilog2();
                // Above the geometric mean of two powers of two, the upper one is nearer.
                i64::from(below) + i64::from(positive * positive > 2 << (2 * below))
            }
        }
    }

    fn scale_name(&self) -> &'static str {
        match self.scale {
            Scale::Shift => "shift",
            Scale::Multiplier => "exponent",
        }
    }

    fn scale_domain(&self) -> (i64, i64) {
        (self.scale_operand(self.domain.least), self.scale_operand(self.domain.most))
    }

    /// Returns the exponent n that the raw `operand` (`shift` or `exponent`) denotes.
    fn exponent(&self, operand: i64) -> i64 {
        match self.scale {
            Scale::Shift => 1 << operand,
            Scale::Multiplier => operand,
        }
    }
}

struct LyonArithmetic {
    keys: Keys,
    squarings: u32,
    /// The number 1 with the fraction bits of f.
    one: i64,
    /// The largest value of the shift register, which multiplies D² by a power of two.
    shifted_most: i64,
    /// Rounds the sum of the squares to the register of D².
    distance: Narrow,
    /// Rounds β·D², from the product or from the shift register, and limits it to less than 2.0.
    scaled: Narrow,
    square: Narrow,
}

impl LyonArithmetic {
    fn new(keys: Keys) -> Self {
        let (f, squarings) = (keys.f.fraction, keys.squarings());
        let (distance, rounding) = (keys.distance_fraction, keys.f.rounding);
        let squares_fraction = 2 * keys.vector_fraction;
        let distance_format = Format::unsigned(4, distance as i32);
        // n/2^(s+1) is the integer n with s + 1 fraction bits; the shift register has one more.
        let beta_fraction = match keys.scale {
            Scale::Multiplier => squarings + 1,
            Scale::Shift => squarings + 2,
        };
        Self {
            squarings,
            one: 1 << f,
            shifted_most: (2 << (distance + squarings + 2)) - 1,
            distance: Narrow::new(squares_fraction, distance_format, keys.distance_rounding),
            scaled: Narrow::new(distance + beta_fraction, Format::unsigned(1, f as i32), rounding),
            square: Narrow::new(2 * f, keys.f.format(), rounding),
            keys,
        }
    }

    /// Returns the raw D²: the sum of the squared components, rounded to the register's format.
    #[inline]
    fn distance(&self, vector: [i64; 3]) -> i64 {
        let [x, y, z] = vector;
        self.distance.apply(x * x + y * y + z * z)
    }

    /// Returns the shift register's next value: `word` shifted left by one bit, limited to the largest value.
    #[inline]
    fn shifted(&self, word: i64) -> i64 {
        (2 * word).min(self.shifted_most)
    }

    /// Returns β·D², rounded, from D² and the operand `shift` or `exponent`.
    #[inline]
    fn beta_distance(&self, distance: i64, operand: i64) -> i64 {
        self.scaled.apply(match self.keys.scale {
            Scale::Multiplier => distance * operand,
            Scale::Shift => (distance << (operand + 1)).min(self.shifted_most),
        })
    }

    /// Returns the base `1.0 − ulp − β·D²`, or 0 if β·D² is 1.0 or more. `scaled` is β·D².
    #[inline]
    fn base(&self, scaled: i64) -> i64 {
        (self.one - 1 - scaled).max(0)
    }

    #[inline]
    fn square(&self, x: i64) -> i64 {
        self.square.apply(x * x)
    }

    /// Returns f for D² in the register and the operand `shift` or `exponent`.
    #[inline]
    fn f_of(&self, distance: i64, operand: i64) -> i64 {
        let base = self.base(self.beta_distance(distance, operand));
        if base == 0 {
            return 0;
        }
        (0..self.squarings).fold(base, |power, _| self.square(power))
    }
}

pub fn model(config: &Config) -> Box<dyn Model> {
    let it = Arc::new(LyonArithmetic::new(Keys::of(config)));
    let (keys, squarings) = (&it.keys, it.squarings);
    let (shift, in_turn) = (keys.scale == Scale::Shift, keys.squares_in_turn());
    let (vector, scale) = (keys.vector_format(), keys.scale_format());
    // The counter counts squarings after the first, and shifts.
    let remaining = match (shift, squarings) {
        (false, _) => 2,
        (true, 3..) => scale.width().max(2),
        (true, _) => scale.width(),
    };
    let point = keys.distance_fraction as i32;
    let mut frame = Frame::default();
    let vector = ["dx", "dy", "dz"].map(|name| frame.operand(name, vector));
    let operand = frame.operand(keys.scale_name(), scale);
    let mut register_if = |there: bool, name, int: i32, frac: i32| {
        let format = Format::unsigned(int, frac);
        if there { frame.register(name, format) } else { frame.hidden() }
    };
    // The sum of the first squares, if one multiplier computes all three squares.
    let sum = register_if(in_turn, "distance_sum", 4, 2 * keys.vector_fraction as i32);
    // The shift register if the operand is `shift`, otherwise the register of D², which a multiplier scales.
    let distance = if shift {
        register_if(true, "shift_register", 1, point + squarings as i32 + 2)
    } else {
        register_if(true, "distance", 4, point)
    };
    // β·D² behind the multiplier.
    let f = keys.f.fraction as i32;
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
    // β·D² comes from the shift register, which shifts by one place a clock, or from the multiplier.
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
    // … and then its own square, until all squarings are done.
    if squarings > 1 {
        let square = step_by(&it, move |it, s| {
            s[accumulator] = it.square(s[accumulator]);
            s[remaining] -= 1;
        });
        program.push(square.repeat_while(move |s| s[remaining] > 1));
    }
    Box::new(keys.products().behind(frame, accumulator, program))
}
