//! How a device is fed: which of its operands mean what.
//!
//! Nothing here knows a device; its contract names its operands, and those names are what it is known by.

use anyhow::{Result, bail};

use super::vector::Vector;
use crate::fixed::Format;
use crate::golden::{Contract, Operand};

/// What is known of a point that a light shines on.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// N·H of the smooth surface.
    pub cos_gamma: f64,
    /// The cosine of dγ, the difference between the angle of H with the perturbed normal and γ.
    pub cos_dgamma: f64,
    /// dγ is negative: the perturbed normal is nearer to H.
    pub dgamma_negative: bool,
    /// N − H of the normal that is shaded.
    pub difference: Vector,
    /// N·H of the normal that is shaded.
    pub cos_shaded: f64,
    /// The colour of the light times the specular coefficient, 0 … 1.
    pub colour: Vector,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    CosGamma,
    CosDgamma,
    DgammaNegative,
    Exponent,
    Difference(usize),
    Colour(usize),
}

/// Every name that is understood; the colours are those of colour operands.
const NAMES: [(&str, Quantity); 10] = [
    ("cos_gamma", Quantity::CosGamma),
    ("exponent", Quantity::Exponent),
    ("cos_dgamma", Quantity::CosDgamma),
    ("dgamma_negative", Quantity::DgammaNegative),
    ("dx", Quantity::Difference(0)),
    ("dy", Quantity::Difference(1)),
    ("dz", Quantity::Difference(2)),
    ("red", Quantity::Colour(0)),
    ("green", Quantity::Colour(1)),
    ("blue", Quantity::Colour(2)),
];

/// The operands of a device, each with what it takes.
#[derive(Clone, Debug)]
pub struct Feed {
    operands: Vec<(Quantity, Format, (i64, i64))>,
    exponent: f64,
    /// For red, green and blue the place of its output.
    channels: [usize; 3],
    /// For red, green and blue what an output is to be multiplied with, for 255 at full colour.
    scales: [f64; 3],
}

/// The exponents that a device takes, if it takes any.
pub fn exponents(contract: &dyn Contract) -> Option<(i64, i64)> {
    let mut operands = contract.operands().iter();
    let exponent = operands.find(|operand| operand.name == "exponent")?;
    Some(exponent.domain)
}

impl Feed {
    /// For a device of that name; `format` gives the format of an output.
    ///
    /// # Errors
    /// It has operands that are not understood, or not the three colours.
    pub fn new(
        device: &str,
        contract: &dyn Contract,
        exponent: u32,
        format: impl Fn(&str) -> Option<Format>,
    ) -> Result<Self> {
        let mut unknown = Vec::new();
        let mut operands = Vec::new();
        for operand in contract.operands() {
            match quantity(operand) {
                Some(quantity) => operands.push((quantity, operand.format, operand.domain)),
                None => unknown.push(format!("`{}` ({})", operand.name, operand.doc)),
            }
        }
        if !unknown.is_empty() {
            let known: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
            bail!(
                "a picture cannot supply {} of the device `{device}`; it supplies {}",
                unknown.join(", "),
                known.join(", ")
            );
        }
        let control = contract.operands().iter().filter(|operand| !operand.colour);
        let control = control.count();
        let mut channels = [0; 3];
        let mut scales = [0.0; 3];
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let at = operands
                .iter()
                .position(|(quantity, ..)| *quantity == Quantity::Colour(channel));
            // Each output is of the colour operand of the same position.
            let output = at.and_then(|at| at.checked_sub(control));
            let format = output
                .and_then(|at| contract.outputs().get(at))
                .and_then(|name| format(name));
            let (Some(at), Some(output), Some(format)) = (at, output, format) else {
                bail!("the device `{device}` has no colour operand `{name}` with an output");
            };
            let (_, colour, (_, most)) = operands[at];
            channels[channel] = output;
            scales[channel] = 255.0 * format.to_f64(1) / colour.to_f64(i128::from(most));
        }
        Ok(Self {
            operands,
            exponent: f64::from(exponent),
            channels,
            scales,
        })
    }

    /// The number of operands.
    pub fn len(&self) -> usize {
        self.operands.len()
    }

    /// Whether the device takes dγ, and so the smooth normal's angle.
    pub fn takes_deviation(&self) -> bool {
        self.takes(Quantity::CosDgamma)
    }

    fn takes(&self, quantity: Quantity) -> bool {
        self.operands.iter().any(|operand| operand.0 == quantity)
    }

    /// The raw operands of a point, and whether dγ was beyond the device's domain.
    pub fn raw<'a>(&'a self, point: &'a Point) -> (impl Iterator<Item = i64> + 'a, bool) {
        let split = self.takes_deviation();
        let value = move |quantity| match quantity {
            Quantity::CosGamma if split => point.cos_gamma,
            Quantity::CosGamma => point.cos_shaded,
            Quantity::CosDgamma => point.cos_dgamma,
            Quantity::DgammaNegative => f64::from(u8::from(point.dgamma_negative)),
            Quantity::Exponent => self.exponent,
            Quantity::Difference(axis) => point.difference.0[axis],
            Quantity::Colour(_) => 0.0,
        };
        let raw = move |&(quantity, format, (low, high)): &(Quantity, Format, (i64, i64))| {
            let raw = match quantity {
                Quantity::Colour(channel) => {
                    // From 0 to the largest, which is full colour.
                    let full = format.to_f64(i128::from(high));
                    format.quantise(point.colour.0[channel] * full)
                }
                _ => format.quantise(value(quantity)),
            };
            raw.clamp(i128::from(low), i128::from(high)) as i64
        };
        let beyond = self.operands.iter().any(|(quantity, format, (low, _))| {
            *quantity == Quantity::CosDgamma && format.quantise(point.cos_dgamma) < i128::from(*low)
        });
        (self.operands.iter().map(raw), beyond)
    }

    /// A result as a colour, 255 at full colour.
    #[inline]
    pub fn colour(&self, outputs: &[i64]) -> Vector {
        let [red, green, blue] = self.channels.map(|at| outputs[at] as f64);
        Vector::new(red, green, blue).times(Vector(self.scales))
    }
}

fn quantity(operand: &Operand) -> Option<Quantity> {
    let found = NAMES.iter().find(|(name, quantity)| {
        operand.name == *name && operand.colour == matches!(quantity, Quantity::Colour(_))
    });
    found.map(|(_, quantity)| *quantity)
}
