//! The accuracy contract of `cosine-power`.

use super::{Arithmetic, Params};
use crate::base::fixed::{Format, Rounding, exp2};
use crate::config::Config;
use crate::golden::contract as shared;
use crate::golden::formulas;
use crate::golden::narrow::rounding_error;
use crate::golden::{Bound, Contract, Operand};

/// The accuracy contract. Control operands: `cos_gamma`, `exponent`.
#[derive(Clone, Debug)]
pub struct CosinePowerContract {
    params: Params,
    arithmetic: Arithmetic,
    /// An ulp of the cosine.
    ulp: f64,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl CosinePowerContract {
    /// The contract of a configuration.
    ///
    /// # Panics
    /// If the configuration is one that [`Params::check`] refuses and the device's schema does not.
    pub fn new(config: &Config) -> Self {
        Self::from_params(&Params::from_config(config))
            .expect("a configuration that its schema accepts")
    }

    /// The contract from parameters.
    ///
    /// # Errors
    /// As [`Params::check`].
    pub fn from_params(params: &Params) -> Result<Self, String> {
        params.check()?;
        let one = params.one();
        let lowest = if params.cosine_signed { -one } else { 0 };
        let mut operands = vec![
            Operand {
                name: "cos_gamma".to_string(),
                format: params.cosine_format(),
                domain: (lowest, one),
                colour: false,
                doc: "cosine of the angle between the normal and the half vector".to_string(),
            },
            Operand {
                name: "exponent".to_string(),
                format: params.exponent_format(),
                domain: params.exponents,
                colour: false,
                doc: "specular exponent n".to_string(),
            },
        ];
        operands.extend(shared::colour_operands(params.colour_format()));
        Ok(Self {
            arithmetic: Arithmetic::new(params),
            ulp: exp2(-(params.cosine_fraction as i32)),
            params: params.clone(),
            operands,
            outputs: shared::colour_outputs(),
        })
    }
}

impl Contract for CosinePowerContract {
    fn operands(&self) -> &[Operand] {
        &self.operands
    }

    fn outputs(&self) -> &[String] {
        &self.outputs
    }

    fn f_format(&self) -> Format {
        Format::unsigned(0, self.params.intensity_fraction as i32)
    }

    #[inline]
    fn f(&self, control: &[i64]) -> i64 {
        let it = &self.arithmetic;
        let cosine = control[0].clamp(0, it.one);
        let base = it.base(cosine, it.scaled(cosine, control[1]));
        (0..it.squarings).fold(base, |power, _| it.square(power))
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let cosine = control[0].clamp(0, self.arithmetic.one) as f64;
        let cosine = cosine * self.ulp;
        formulas::cosine_power(cosine, control[1] as f64, self.params.power)
    }

    fn expressions(&self) -> Vec<String> {
        let power = self.params.power;
        let base = format!("exponent / {power} * (cos_gamma - 1) + 1");
        let base = shared::clamped_at_0(&base);
        vec![shared::where_it_faces(&format!("{base} ** {power}"))]
    }

    /// Every quantity here lies in 0 … 1, hardware's and formula's alike, so by the mean value
    /// theorem an error ε before a power p grows to at most p·ε.
    ///
    /// - Base: the inverse stands for 1.0 − ulp − t where 1.0 − t is meant. With t rounded by an error
    ///   in (−ulp, 0] (truncated) the base is low by (0, ulp]; by ±ulp/2 (nearest), low by up to
    ///   3/2 ulp. Saturation of t at 1.0 − ulp makes the base 0 where the formula has at most as much.
    ///   The base is raised to m.
    /// - The result of squaring number i is rounded, and then raised to m/2^i: m − 1 in sum.
    /// - The output adds its own rounding; it cannot exceed the largest colour, for f < 1.
    fn bound(&self) -> Bound {
        let params = &self.params;
        let (f, power) = (params.intensity_fraction, f64::from(params.power));
        let ulp = exp2(-(f as i32));
        let scaled_fraction = params.cosine_fraction + params.power.ilog2();
        let scaled = rounding_error(scaled_fraction, f, params.intensity_rounding);
        let base = match params.intensity_rounding {
            // Truncation is upward in 1.0 − ulp − t, and so works against the missing ulp.
            Rounding::Truncate => ulp,
            Rounding::Nearest => ulp + scaled,
        };
        let squares = rounding_error(2 * f, f, params.intensity_rounding);
        let shares = [
            ("intensity.fraction", "the base, with the inverse for 1.0 − t", base * power),
            ("intensity.rounding", "rounding of the squares", squares * (power - 1.0)),
        ];
        shared::bound(&shares, f, params.colour_bits, params.output_rounding)
    }
    /// Below n = m, W loses to a smaller m: its base no longer reaches 0 where cosⁿγ does.
    fn remarks(&self) -> Vec<String> {
        let power = self.params.power;
        let (first, last) = self.params.exponents;
        let worse: Vec<(i64, f64, u32, f64)> = (first.max(1)..=last.min(i64::from(power) - 1))
            .filter_map(|n| {
                let own = formula_error(n, power);
                let (error, other) = [2, 4, 8, 16]
                    .into_iter()
                    .filter(|&other| other < power)
                    .map(|other| (formula_error(n, other), other))
                    .min_by(|a, b| a.0.total_cmp(&b.0))?;
                (error < own).then_some((n, own, other, error))
            })
            .collect();
        let Some(&(n, own, other, error)) =
            worse.iter().max_by(|a, b| (a.1 - a.3).total_cmp(&(b.1 - b.3)))
        else {
            return Vec::new();
        };
        let exponents: Vec<String> = worse.iter().map(|entry| entry.0.to_string()).collect();
        vec![format!(
            "power = {power} is above some n of the domain: for n = {} a smaller power is closer to cos^n; \
             at n = {n} the formula is off by {own:.4} with power = {power}, by {error:.4} with power = {other} \
             (raise domain.exponent_min, or choose the smaller power)",
            exponents.join(", ")
        )]
    }
}

/// The largest difference between W and cosⁿγ over the cosines from 0 to 1, on a fine grid.
fn formula_error(n: i64, power: u32) -> f64 {
    const GRID: u32 = 512;
    (1..=GRID)
        .map(|step| {
            let cosine = f64::from(step) / f64::from(GRID);
            let n = n as f64;
            (formulas::cosine_power(cosine, n, power) - formulas::blinn(cosine, n)).abs()
        })
        .fold(0.0, f64::max)
}
