//! The accuracy contract of the device `lyon`: formula, terms of the error bound, and cases of the exhaustive check.

use super::{Derived as _, Keys, LyonArithmetic, Scale};
use crate::contract::{self as shared, ErrorShare};
use crate::formulas;
use crate::highlight::{Highlight, Reflectance};
use crate::narrow::rounding_error;
use crate::{Contract, Operand, Sweep};
use glint_base::fixed::{Rounding, exp2};
use glint_config::Config;

/// The largest D²: each of the three components is at least −2.0, so its square is at most 4.
const FARTHEST: i64 = 12;

/// Returns the accuracy contract. The control operands are `dx`, `dy`, `dz`, and `shift` or `exponent`.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    Box::new(of_keys(Keys::of(config)))
}

pub(super) fn of_keys(keys: Keys) -> Highlight {
    let vector = keys.vector_format();
    let component = |name: &str| {
        let domain = (vector.min_raw() as i64, vector.max_raw() as i64);
        let doc = format!("{} of the normal less the half vector", &name[1..]);
        shared::control(name, vector, domain, &doc)
    };
    let doc = match keys.scale {
        Scale::Shift => "log2 of the specular exponent n, rounded",
        Scale::Multiplier => "specular exponent n",
    };
    let mut operands: Vec<Operand> = ["dx", "dy", "dz"].map(component).into();
    let (name, format) = (keys.scale_name(), keys.scale_format());
    operands.push(shared::control(name, format, keys.scale_domain(), doc));
    let products = keys.products();
    Highlight::new(LyonArithmetic::new(keys), operands, products)
}

impl LyonArithmetic {
    /// Returns the exact D² of the raw components, as a value.
    #[inline]
    fn exact_distance(&self, vector: &[i64]) -> f64 {
        let squares = vector[..3].iter().map(|component| component * component);
        squares.sum::<i64>() as f64 * exp2(-2 * self.keys.vector_fraction as i32)
    }

    /// Returns the exact f for a value of D² and the raw operand `shift` or `exponent`.
    #[inline]
    fn formula(&self, distance: f64, operand: i64) -> f64 {
        let power = self.keys.power;
        let beta = self.keys.exponent(operand) as f64 / f64::from(2 * power);
        formulas::lyon(distance, beta, power)
    }
}

impl Reflectance for LyonArithmetic {
    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        self.f_of(self.distance([control[0], control[1], control[2]]), control[3])
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        self.formula(self.exact_distance(control), control[3])
    }

    fn expressions(&self) -> Vec<String> {
        let power = self.keys.power;
        let exponent = match self.keys.scale {
            Scale::Shift => "2 ** shift",
            Scale::Multiplier => "exponent",
        };
        let distance = "(dx ** 2 + dy ** 2 + dz ** 2)";
        let base = format!("1 - {exponent} / {} * {distance}", 2 * power);
        vec![format!("{} ** {power}", shared::clamped_at_0(&base))]
    }

    /// Returns the operands for the normal (0, 0, 1) and the half vector (sin γ, 0, cos γ). Returns `None` if `n` is no integer
    /// or not in the domain.
    fn at(&self, operands: &[Operand], gamma: f64, n: f64) -> Option<Vec<i64>> {
        let (first, last) = self.keys.domain.exponents();
        let exponent = n as i64;
        if exponent as f64 != n || !(first..=last).contains(&exponent) {
            return None;
        }
        let component = |value: f64| operands[0].format.quantise(value) as i64;
        // 1 − cos γ.
        let half = libm::sin(gamma / 2.0);
        Some(vec![
            component(-libm::sin(gamma)),
            0,
            component(2.0 * half * half),
            self.keys.scale_operand(exponent),
        ])
    }

    /// Returns the cosine of the angle between two unit vectors at the distance D: 1 − D²/2, or 0 if that is negative.
    fn cosine(&self, _: &[Operand], control: &[i64]) -> Option<f64> {
        Some((1.0 - self.exact_distance(control) / 2.0).max(0.0))
    }

    /// Visits every word of D² with every operand `shift` or `exponent`. These two numbers determine f, since adders 1 and 2 and
    /// multipliers 1 to 3 are exact.
    fn sweep(&self) -> Option<Sweep> {
        let most = FARTHEST << self.keys.distance_fraction;
        Some(Sweep::ranges([
            (self.keys.scale_name(), self.keys.scale_domain()),
            ("word of D^2", (0, most)),
        ]))
    }

    /// Returns the largest error of f over every exact D² that is rounded to the word of `place`.
    #[inline]
    fn sweep_error(&self, place: &[i64]) -> Option<f64> {
        let (operand, word) = (place[0], place[1]);
        let f = self.f_of(word, operand) as f64 * exp2(-(self.keys.f.fraction as i32));
        let word = word as f64;
        let ulp = exp2(-(self.keys.distance_fraction as i32));
        let exact = 2 * self.keys.vector_fraction <= self.keys.distance_fraction;
        let (low, high) = match self.keys.distance_rounding {
            _ if exact => (word, word),
            Rounding::Truncate => (word, word + 1.0),
            Rounding::Nearest => (word - 0.5, word + 0.5),
        };
        let formula = |at: f64| self.formula(at.max(0.0) * ulp, operand);
        let nearest = formula(low);
        // Most words are beyond the formula's zero, where the error is 0.
        if f == 0.0 && nearest == 0.0 {
            return Some(0.0);
        }
        Some((f - nearest).abs().max((f - formula(high)).abs()))
    }

    /// Derives the contributions to the error of f. Base and powers lie in 0 … 1, in the hardware and in the formula. By the mean
    /// value theorem, an error ε before a power p therefore grows to at most p·ε.
    ///
    /// - An error of D² is multiplied by β = n/(2·m), and by at most m when the base is raised to m: n/2 in all.
    /// - Base: as in `cosine-power`, the hardware uses the inverse, 1.0 − ulp − t, instead of 1.0 − t. If t is truncated, the
    ///   base is low by at most an ulp; if t is rounded to the nearest, by at most 3/2 ulp.
    /// - The result of squaring number i is rounded, and then raised to m/2^i. The factors of these errors add up to m − 1.
    ///
    /// If every rounding truncates, the error of D² makes f too large, and the other errors make f too small. Only the larger of
    /// these two sums counts then.
    fn shares(&self) -> Vec<ErrorShare> {
        let keys = &self.keys;
        let (f, power) = (keys.f.fraction, f64::from(keys.power));
        let ulp = exp2(-(f as i32));
        let distance = rounding_error(
            2 * keys.vector_fraction,
            keys.distance_fraction,
            keys.distance_rounding,
        );
        let largest = keys.exponent(keys.scale_domain().1) as f64;
        let scaled_fraction = keys.distance_fraction + keys.squarings() + 1;
        let base = match keys.f.rounding {
            Rounding::Truncate => ulp,
            Rounding::Nearest => ulp + rounding_error(scaled_fraction, f, Rounding::Nearest),
        };
        let squares = rounding_error(2 * f, f, keys.f.rounding);
        let above = [("distance.fraction", "rounding of D², times n/2", distance * largest / 2.0)];
        let below = [
            ("intensity.fraction", "the base, with the inverse for 1.0 − β·D²", base * power),
            ("intensity.rounding", "rounding of the squares", squares * (power - 1.0)),
        ];
        let apart = [keys.distance_rounding, keys.f.rounding] == [Rounding::Truncate; 2];
        match apart {
            true if above[0].2 > below[0].2 + below[1].2 => above.to_vec(),
            true => below.to_vec(),
            false => [&above[..], &below].concat(),
        }
    }

    /// Returns a warning if `scale = "shift"` makes the formula worse, because n is rounded to a power of two.
    fn remarks(&self) -> Vec<String> {
        let (keys, (first, last)) = (&self.keys, self.keys.domain.exponents());
        if keys.scale == Scale::Multiplier {
            return Vec::new();
        }
        let midway = (0..=keys.exponent_bits)
            .map(|octave| (exp2(octave as i32) * std::f64::consts::SQRT_2) as i64);
        let worst = midway
            .flat_map(|n| [n, n + 1])
            .filter(|n| (first.max(1)..=last).contains(n))
            .map(|n| {
                let rounded = keys.exponent(keys.scale_operand(n));
                let errors = [rounded, n].map(|taken| formula_error(n, taken, keys.power));
                (n, rounded, errors)
            })
            .max_by(|a, b| (a.2[0] - a.2[1]).total_cmp(&(b.2[0] - b.2[1])));
        let Some((n, rounded, [error, exact])) = worst.filter(|worst| worst.2[0] > worst.2[1])
        else {
            return Vec::new();
        };
        vec![format!(
            "scale = \"shift\" rounds n to a power of two: at n = {n}, rounded to {rounded}, the formula \
             differs from cos^n by up to {error:.4}; with scale = \"multiplier\", by up to {exact:.4}"
        )]
    }
}

/// Returns the largest difference between the formula with β = `rounded`/(2·m) and cosⁿγ, for unit vectors. The grid of cosines
/// covers the highlight: 1 − cos γ goes from 0 to 8/n, but at most to 1.
fn formula_error(n: i64, rounded: i64, power: u32) -> f64 {
    const GRID: u32 = 1024;
    let beta = rounded as f64 / f64::from(2 * power);
    let reach = (8.0 / n as f64).min(1.0);
    (0..GRID)
        .map(|step| {
            let versine = reach * f64::from(step) / f64::from(GRID);
            let value = formulas::lyon(2.0 * versine, beta, power);
            (value - formulas::blinn(1.0 - versine, n as f64)).abs()
        })
        .fold(0.0, f64::max)
}
