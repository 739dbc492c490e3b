//! The golden model and the accuracy contract of the device `schlick`. It computes f = c / (n − n·c + c), or 0 if c ≤ 0
//! ([symbols](crate#symbols)). This is Schlick's approximation of cⁿ; the source is seed 002. For example, c = 0.5 and n = 1
//! give 0.5.

use super::contract::{self, ErrorShare};
use super::frame::{Frame, idle, step};
use super::highlight::{self, Highlight, Products, Reflectance, Variation};
use super::{Contract, Model};
use crate::formulas;
use glint_base::fixed::{Format, exp2, mask};
use glint_config::Config;
use glint_keys::schlick::Keys;

/// The integer arithmetic of the device. Cosines, divisors and remainders have the fraction bits of the cosine; the quotient is
/// f.
struct SchlickArithmetic(Keys);

impl SchlickArithmetic {
    /// Returns the divisor `n − n·cos γ + cos γ`, plus an ulp if cos γ is 0, so it is never 0.
    #[inline]
    fn divisor(&self, cosine: i64, exponent: i64) -> i64 {
        exponent * self.0.operands.cosine.one() - exponent * cosine
            + cosine
            + i64::from(cosine == 0)
    }
}

/// Returns the first `bits` fraction bits of the quotient, and the remainder. A quotient of 1.0 gives all ones. For example, 4
/// bits of 1/3 are 5 (1/3 is about 5/16), and the remainder is 16 − 5·3 = 1.
#[inline]
fn divide(dividend: i64, divisor: i64, bits: u32) -> (i64, i64) {
    let quotient = ((dividend << bits) / divisor).min((1 << bits) - 1);
    (quotient, (dividend << bits) - quotient * divisor)
}

fn products(keys: &Keys) -> Products {
    let colours = &keys.operands.colours;
    Products::colours(keys.f_format(), colours.bits, keys.output_rounding)
        .in_turn(colours.in_turn())
}

/// Returns the golden model. The hardware divides one bit a clock; the model divides at once and derives the divider's registers
/// from this division. After k clocks, the low bits of the quotient register are the first k bits of the quotient. The remainder
/// register has the remainder after these bits.
pub fn model(config: &Config) -> Box<dyn Model> {
    let it = SchlickArithmetic(Keys::of(config));
    let (bits, cosine_fraction) = (it.0.fraction, it.0.operands.cosine.fraction);
    let products = products(&it.0);
    let mut frame = Frame::default();
    let [cosine, exponent] = highlight::slots(&it.0.operands, &mut frame);
    // The divisor and the remainder are at most n + 1.0.
    let format = Format::unsigned(it.0.operands.exponent_bits as i32 + 1, cosine_fraction as i32);
    let quotient = frame.register("quotient", it.0.f_format());
    let divisor = frame.register("quotient_divisor", format);
    let remainder = frame.register("quotient_remainder", format);
    let counter = Format::unsigned((bits - 1).ilog2() as i32 + 1, 0);
    let remaining = frame.register("quotient_remaining", counter);
    // The number of bits found, and the value that the quotient's register held before the division.
    let (found, before) = (frame.hidden(), frame.hidden());
    // The divider loads the dividend cos γ and the divisor n − n·cos γ + cos γ.
    let begin = step(move |s| {
        s[divisor] = it.divisor(s[cosine], s[exponent]);
        s[remainder] = s[cosine];
        s[remaining] = i64::from(bits) - 1;
        s[found] = 0;
        s[before] = s[quotient];
    });
    // The divider finds one bit of the quotient a clock, until the quotient is complete.
    let bit = step(move |s| {
        s[found] += 1;
        let (first, rest) = divide(s[cosine], s[divisor], s[found] as u32);
        s[quotient] = ((s[before] << s[found] | first) as u64 & mask(bits)) as i64;
        s[remainder] = rest;
        s[remaining] -= 1;
    });
    let program = vec![idle(), begin, bit.repeat_while(move |s| s[remaining] != 0)];
    Box::new(products.behind(frame, quotient, program))
}

/// Returns the accuracy contract, with the control operands `cos_gamma` and `exponent`.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let keys = Keys::of(config);
    let operands = highlight::operands(&keys.operands, &keys.domain);
    let products = products(&keys);
    Box::new(Highlight::new(SchlickArithmetic(keys), operands, products))
}

impl Reflectance for SchlickArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let cosine = self.0.operands.cosine.clamped(control[0]);
        divide(cosine, self.divisor(cosine, control[1]), self.0.fraction).0
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        formulas::schlick(self.0.operands.cosine.value(control[0]), control[1] as f64)
    }

    fn expressions(&self) -> Vec<String> {
        vec![contract::where_it_faces("cos_gamma / (exponent * (1 - cos_gamma) + cos_gamma)")]
    }

    fn at_cosine(&self, cosine: f64, exponent: i64) -> Option<f64> {
        Some(formulas::schlick(cosine, exponent as f64))
    }

    /// Returns how fast and by which jumps f changes. The largest n is an upper limit of the slope n/(n − n·c + c)². The slope is
    /// largest at an end: n at c = 1, and 1/n at c = 0. At c = 0 the formula is 0, as it is beyond a right angle. With n = 0 the
    /// formula is 1 for every c above 0, and jumps to 0 at a right angle.
    fn variation(&self) -> Option<Variation> {
        let (least, most) = self.0.domain.exponents();
        Some(Variation { slope: most as f64, jump: if least > 0 { 0.0 } else { 1.0 } })
    }

    /// Returns an ulp: dividend and divisor are exact, and the quotient is truncated. The quotient is at most an ulp below the
    /// formula. The largest fraction, which replaces a quotient of 1.0, is an ulp below 1.0.
    fn shares(&self) -> Vec<ErrorShare> {
        let ulp = exp2(-(self.0.fraction as i32));
        vec![("intensity.fraction", "truncation of the quotient", ulp)]
    }
}
