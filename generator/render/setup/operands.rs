//! Quantised operands.

use std::f64::consts::FRAC_PI_2;

use super::{Error, Line};
use crate::base::fixed::{Format, Overflow, Rounding, exp2};
use crate::config::Config;

/// Raw operands of a line, as a host writes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operands {
    /// `amplitude`.
    pub amplitude: i64,
    /// `delta_zeta`.
    pub delta_zeta: i64,
    /// `zeta_start`.
    pub zeta_start: i64,
    /// `length`.
    pub length: i64,
    /// `exponent`, where the device has it.
    pub exponent: Option<i64>,
}

impl Line {
    /// The operands for a configuration of `quad-cosine`. The amplitude saturates; angles are taken modulo a
    /// turn.
    ///
    /// # Errors
    /// [`Error::Beyond`] for an exponent or a length with more bits than the configuration has.
    ///
    /// # Panics
    /// If the configuration is one of another device.
    pub fn quad_cosine(&self, config: &Config) -> Result<Operands, Error> {
        let format = Format::signed(1, fraction(config));
        self.fits("exponent", self.exponent, config, "exponent.bits")?;
        Ok(Operands {
            exponent: Some(i64::from(self.exponent)),
            ..self.stretched(1.0, format, config)?
        })
    }

    /// The operands for a configuration of `cosine-squared`: both angles times a = √(n/2). The amplitude
    /// saturates.
    ///
    /// # Errors
    /// [`Error::Beyond`] for a length or a stretched angle with more bits than the configuration has.
    ///
    /// # Panics
    /// If the configuration is one of another device.
    pub fn cosine_squared(&self, config: &Config) -> Result<Operands, Error> {
        let a = self.stretch();
        let format = Format::signed(config.integer("angle.integer") as i32, fraction(config));
        if let Some(value) = self.beyond(a, format) {
            let operand = "the stretched angle";
            return Err(Error::Beyond { operand, value, key: "angle.integer" });
        }
        self.stretched(a, format, config)
    }

    /// By what a device without an exponent takes the angles: √(n/2).
    pub fn stretch(&self) -> f64 {
        (f64::from(self.exponent) / 2.0).sqrt()
    }

    /// The angle of an end of the line times `by`, in right angles, if a format has no room for it. A right angle is
    /// kept for what rounding may add along the line.
    pub fn beyond(&self, by: f64, format: Format) -> Option<f64> {
        let ends = [self.zeta_start, self.zeta(self.length)].map(|zeta| by * zeta / FRAC_PI_2);
        ends.into_iter().find(|right_angles| right_angles.abs() > exp2(format.int) - 1.0)
    }

    fn stretched(&self, by: f64, format: Format, config: &Config) -> Result<Operands, Error> {
        self.fits("length", self.length, config, "length.bits")?;
        let angle = |radians: f64| raw_angle(radians * by, format);
        let colour = Format::unsigned(config.integer("colour.bits") as i32, 0);
        Ok(Operands {
            amplitude: colour.quantise(self.amplitude) as i64,
            delta_zeta: angle(self.delta_zeta),
            zeta_start: angle(self.zeta_start),
            length: i64::from(self.length),
            exponent: None,
        })
    }

    fn fits(
        &self,
        operand: &'static str,
        value: u32,
        config: &Config,
        key: &'static str,
    ) -> Result<(), Error> {
        if i64::from(value) < 1 << config.integer(key) {
            return Ok(());
        }
        let value = f64::from(value);
        Err(Error::Beyond { operand, value, key })
    }
}

/// An angle in right angles, raw; modulo a turn, which is what an angle without room for more means.
pub fn raw_angle(radians: f64, format: Format) -> i64 {
    let scaled = (radians / FRAC_PI_2 * exp2(format.frac) + 0.5).floor() as i128;
    format.narrow(scaled, format.frac, Rounding::Truncate, Overflow::Wrap) as i64
}

fn fraction(config: &Config) -> i32 {
    config.integer("angle.fraction") as i32
}
