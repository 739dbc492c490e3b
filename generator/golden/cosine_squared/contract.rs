//! The accuracy contract of `cosine-squared`.

use std::f64::consts::FRAC_PI_2;

use super::{Arithmetic, Params};
use crate::base::fixed::{Format, exp2};
use crate::config::Config;
use crate::golden::contract as shared;
use crate::golden::formulas;
use crate::golden::line;
use crate::golden::{Axis, Bound, Contract, Operand, Sweep, Values};

/// The accuracy contract. Control operands: `delta_zeta`, `zeta_start`, `length`; those of a point have its
/// angle for `zeta_start`.
#[derive(Clone, Debug)]
pub struct CosineSquaredContract {
    params: Params,
    arithmetic: Arithmetic,
    operands: Vec<Operand>,
    outputs: Vec<String>,
}

impl CosineSquaredContract {
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
        let mut operands = line::angle_operands(params.angle_format()).to_vec();
        operands.push(line::length_operand(params.length_bits));
        operands.push(shared::amplitude_operand(params.colour_format()));
        Ok(Self {
            arithmetic: Arithmetic::new(params),
            params: params.clone(),
            operands,
            outputs: shared::intensity_output(),
        })
    }
}

impl Contract for CosineSquaredContract {
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
        self.arithmetic.cosine(control[1])
    }

    #[inline]
    fn colour(&self, f: i64, colour: i64) -> i64 {
        self.arithmetic.colour(f, colour)
    }

    #[inline]
    fn reference(&self, control: &[i64]) -> f64 {
        let right = exp2(self.params.angle_fraction as i32);
        formulas::cosine_squared(control[1] as f64 / right * FRAC_PI_2)
    }

    fn expressions(&self) -> Vec<String> {
        let angle = line::angle_expression(self.params.angle_format());
        vec![format!("cos(pi / 2 * min(abs({angle}), 1)) ** 2")]
    }

    fn point(&self, control: &[i64], index: u64) -> Vec<i64> {
        let format = self.params.angle_format();
        let angle = line::angle_at(format, control[1], control[0], index);
        vec![control[0], angle, control[2]]
    }

    /// A line of one point, its angle stretched by `√(n/2)` as the host does it. What the operand denotes is
    /// an angle and n together, so no cosine is told of it.
    fn at(&self, gamma: f64, n: f64) -> Option<Vec<i64>> {
        let stretched = (n / 2.0).sqrt() * gamma;
        Some(vec![0, line::raw_angle(&self.operands[1], stretched), 0])
    }

    fn length(&self) -> Option<&str> {
        Some("length")
    }

    /// Every angle that a line can come to, by the step of ROM 12 that it is in. Beyond a right angle the
    /// word is the table's last, 0, and so is the formula.
    fn sweep(&self) -> Sweep {
        Sweep {
            axes: vec![Axis {
                name: "step of the table".to_string(),
                values: Values::Range(0, (1 << self.params.table_address) - 1),
            }],
            omits: String::new(),
        }
    }

    /// The worst over the step's angles of either sign: the formula falls from one end to the other.
    fn sweep_error(&self, place: &[i64]) -> f64 {
        let step = place[0];
        let word = self.arithmetic.table.words[step as usize];
        let f = self.f_format().to_f64(i128::from(word));
        let ulp = exp2(-(self.params.table_address as i32));
        let end = |step: i64| formulas::cosine_squared(step as f64 * ulp * FRAC_PI_2);
        (end(step) - f).max(f - end(step + 1))
    }

    /// How far ROM 12 is from the formula within a step: the angle itself is exact, and so is its step.
    fn bound(&self) -> Bound {
        let params = &self.params;
        let table = &self.arithmetic.table;
        let shares = [
            ("table.address", "the steps of ROM 12", table.step),
            ("intensity.fraction", "rounding of ROM 12", table.total - table.step),
        ];
        shared::bound(
            &shares,
            params.intensity_fraction,
            params.colour_bits,
            params.output_rounding,
        )
    }
}
