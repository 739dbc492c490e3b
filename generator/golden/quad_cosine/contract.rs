//! The accuracy contract of the device `quad-cosine`: formula, terms of the error bound, and cases of the exhaustive check.

use std::f64::consts::FRAC_PI_2;

use super::{Keys, POWERS, QuadCosineArithmetic, products, range_of};
use crate::contract::{self as shared, ErrorShare};
use crate::formulas;
use crate::highlight::{Highlight, Reflectance};
use crate::line;
use crate::{Contract, Operand, Sweep};
use glint_base::fixed::{Format, exp2};
use glint_config::Config;

/// Returns the accuracy contract. The control operands are `delta_zeta` (the angle from a point to the next), `zeta_start` (the
/// first angle), `exponent` and `length` (the number of intervals).
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let keys = Keys::of(config);
    let mut operands = line::angle_operands(keys.angle_format()).to_vec();
    operands.push(shared::exponent_operand(
        Format::unsigned(keys.exponent_bits as i32, 0),
        keys.domain.exponents(),
    ));
    operands.push(line::length_operand(keys.length_bits));
    let products = products(&keys);
    Box::new(Highlight::new(QuadCosineArithmetic::new(keys), operands, products))
}

impl QuadCosineArithmetic {
    /// Returns two upper limits of the error of the stretched angle √(n/k)·δ for n, in right angles. The first comes from the low
    /// bits that multiplier 11 does not read, the second from the rounding of ROM 9.
    ///
    /// The magnitude m denotes angles from m to m + u. Let s = √(n/k), and s' be ROM 9's word. s'·m is less than s·(m + u) by
    /// at most s·u + (s − s')·m, and more than s·m by at most (s' − s)·m. An angle beyond 1/s is in the table's last word
    /// anyway, and so is an angle beyond 1/s'.
    fn stretching(&self, n: i64) -> (f64, f64) {
        let s = (n as f64 / POWERS[range_of(n)] as f64).sqrt();
        let word = self.root(n) as f64 * exp2(-(self.keys.root_fraction as i32));
        let reach = (1.0 / s.min(word)).min(1.0);
        let cut = s * exp2(-(self.keys.angle_multiplied as i32));
        (cut, (s - word).abs() * reach)
    }
}

impl Reflectance for QuadCosineArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let (angle, n) = (control[1], control[2]);
        self.cosine_of(n, self.magnitude(angle), self.root(n))
    }

    /// Returns the formula's value. The surface faces the viewer from −90° to below 90°; the hardware treats these two ends
    /// differently, as two's complement does.
    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let (angle, n) = (control[1], control[2]);
        let right = 1i64 << self.keys.angle_fraction;
        if angle >= right {
            return 0.0;
        }
        let angle = angle as f64 / right as f64;
        formulas::quad_cosine(angle * FRAC_PI_2, n)
    }

    fn expressions(&self) -> Vec<String> {
        let angle = line::angle_expression(self.keys.angle_format());
        let power = "{1: 1, 2: 2, 3: 4, 4: 4, 5: 4, 6: 4}.get(exponent, 16)";
        let stretched = format!("sqrt(exponent / {power}) * abs({angle})");
        vec![format!("cos(pi / 2 * min({stretched}, 1)) ** {power} if -1 <= {angle} < 1 else 0")]
    }

    fn point(&self, control: &mut [i64], index: u64) {
        control[1] = line::angle_at(self.keys.angle_format(), control[1], control[0], index);
    }

    fn line(&self, first: &[i64], last: &[i64]) -> Vec<i64> {
        let (angle, length) = (first[1], first[3]);
        vec![line::interval(angle, last[1], length, first[0]), angle, first[2], length]
    }

    /// Returns the operands of a line with one point, at the angle `gamma`. Returns `None` if the domain does not contain `n`.
    fn at(&self, operands: &[Operand], gamma: f64, n: f64) -> Option<Vec<i64>> {
        let angle = line::raw_angle(&operands[1], gamma);
        Some(vec![0, angle, shared::exponent_at(&operands[2], n)?, 0])
    }

    fn cosine(&self, _: &[Operand], control: &[i64]) -> Option<f64> {
        let angle = control[1] as f64 * exp2(-(self.keys.angle_fraction as i32));
        Some(libm::cos(angle * FRAC_PI_2).max(0.0))
    }

    fn length(&self) -> Option<&str> {
        Some("length")
    }

    /// Visits every n with every magnitude that multiplier 11 can read, which covers every angle that a line can reach.
    fn sweep(&self) -> Option<Sweep> {
        let magnitudes = 1i64 << self.keys.angle_multiplied;
        Some(Sweep::ranges([
            ("exponent", self.keys.domain.exponents()),
            ("magnitude of the angle", (0, magnitudes - 1)),
        ]))
    }

    /// Returns the largest error, positive or negative, over all angles with the magnitude of `place`.
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let (n, magnitude) = (place[0], place[1]);
        let word = self.cosine_of(n, Some(magnitude), self.root(n));
        let f = word as f64 * exp2(-(self.keys.fraction as i32));
        let ulp = exp2(-(self.keys.angle_multiplied as i32));
        let end = |magnitude: i64| formulas::quad_cosine(magnitude as f64 * ulp * FRAC_PI_2, n);
        Some((end(magnitude) - f).max(f - end(magnitude + 1)))
    }

    /// Returns the contributions for the n with the largest sum. They are the distance of ROM 12 from the formula within a step,
    /// the rounding of ROM 12, and two errors of the stretched angle. The steepest slope of the power multiplies these two
    /// errors.
    fn shares(&self) -> Vec<ErrorShare> {
        let keys = &self.keys;
        let (low, high) = keys.domain.exponents();
        let largest = (1 << keys.exponent_bits) - 1;
        let worst = (low..=high.min(largest))
            .map(|n| {
                let table = &self.tables[range_of(n)];
                let (cut, root) = self.stretching(n);
                [table.step, table.total - table.step, table.slope * cut, table.slope * root]
            })
            .max_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum()))
            .unwrap_or_default();
        let [step, rounding, cut, root] = worst;
        vec![
            ("table.address", "the steps of ROM 12", step),
            ("intensity.fraction", "rounding of ROM 12", rounding),
            ("angle.multiplied", "the angle that multiplier 11 takes", cut),
            ("root.fraction", "rounding of ROM 9", root),
        ]
    }
}
