//! How a device is fed: which of its operands mean what.
//!
//! Nothing here knows a device; its contract names its operands, and those names are what it is known by.

use anyhow::{Result, bail, ensure};

use super::vector::Vector;
use crate::base::fixed::Format;
use crate::golden::{Contract, Operand};
use crate::render::setup::{Arc, raw_angle};

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
    /// The exponent's logarithm to base 2, rounded.
    Shift,
    Difference(usize),
    Colour(usize),
    ZetaStart,
    DeltaZeta,
    Length,
    Amplitude,
}

impl Quantity {
    fn is_colour(self) -> bool {
        matches!(self, Self::Colour(_) | Self::Amplitude)
    }
}

/// Every name that is understood of a device that computes a point.
const OF_POINTS: [(&str, Quantity); 11] = [
    ("cos_gamma", Quantity::CosGamma),
    ("exponent", Quantity::Exponent),
    ("shift", Quantity::Shift),
    ("cos_dgamma", Quantity::CosDgamma),
    ("dgamma_negative", Quantity::DgammaNegative),
    ("dx", Quantity::Difference(0)),
    ("dy", Quantity::Difference(1)),
    ("dz", Quantity::Difference(2)),
    ("red", Quantity::Colour(0)),
    ("green", Quantity::Colour(1)),
    ("blue", Quantity::Colour(2)),
];

/// And of one that walks a line of points, for a colour at a time.
const OF_LINES: [(&str, Quantity); 5] = [
    ("zeta_start", Quantity::ZetaStart),
    ("delta_zeta", Quantity::DeltaZeta),
    ("exponent", Quantity::Exponent),
    ("length", Quantity::Length),
    ("amplitude", Quantity::Amplitude),
];

/// The operands of a device, each with what it takes.
#[derive(Clone, Debug)]
pub struct Feed {
    operands: Vec<(Quantity, Format, (i64, i64))>,
    exponent: u32,
    /// For red, green and blue the place of its output.
    channels: [usize; 3],
    /// For red, green and blue what an output is to be multiplied with, for 255 at full colour.
    scales: [f64; 3],
    /// The most intervals of a line, if it computes lines.
    longest: Option<usize>,
}

/// The exponents that a device takes, if it takes any.
pub fn exponents(contract: &dyn Contract) -> Option<(i64, i64)> {
    let mut operands = contract.operands().iter();
    let exponent = operands.find(|operand| operand.name == "exponent")?;
    Some(exponent.domain)
}

/// Whether a device walks a line of points from one start.
pub fn walks_lines(contract: &dyn Contract) -> bool {
    contract.length().is_some()
}

impl Feed {
    /// For a device of that name.
    ///
    /// # Errors
    /// It has operands that are not understood, or not the colours.
    pub fn new(device: &str, contract: &dyn Contract, exponent: u32) -> Result<Self> {
        let names: &[(&str, Quantity)] = if walks_lines(contract) { &OF_LINES } else { &OF_POINTS };
        let mut unknown = Vec::new();
        let mut operands = Vec::new();
        for operand in contract.operands() {
            match quantity(operand, names) {
                Some(quantity) => operands.push((quantity, operand.format, operand.domain)),
                None if operand.doc.is_empty() => unknown.push(format!("`{}`", operand.name)),
                None => unknown.push(format!("`{}` ({})", operand.name, operand.doc)),
            }
        }
        if !unknown.is_empty() {
            let known: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
            bail!(
                "a picture cannot supply {} of the device `{device}`; it supplies {}",
                unknown.join(", "),
                known.join(", ")
            );
        }
        let mut feed =
            Self { operands, exponent, channels: [0; 3], scales: [0.0; 3], longest: None };
        if walks_lines(contract) {
            for (name, quantity) in OF_LINES {
                ensure!(
                    quantity == Quantity::Exponent || feed.find(quantity).is_some(),
                    "the device `{device}` walks a line, but has no operand `{name}`"
                );
            }
            let length = feed.find(Quantity::Length).map(|(_, _, (_, most))| most);
            feed.longest = length.map(|most| usize::try_from(most).unwrap_or(0));
        }
        let control = contract.operands().iter().filter(|operand| !operand.colour);
        let control = control.count();
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let wanted = match feed.longest {
                None => Quantity::Colour(channel),
                Some(_) => Quantity::Amplitude,
            };
            let mut places = feed.operands.iter();
            let at = places.position(|(quantity, ..)| *quantity == wanted);
            // Each output is of the colour operand of the same position.
            let output = at.and_then(|at| at.checked_sub(control));
            let format = output.and_then(|at| contract.outputs().get(at)).map(|it| it.format);
            let (Some(at), Some(output), Some(format)) = (at, output, format) else {
                bail!("the device `{device}` has no colour operand `{name}` with an output");
            };
            let (_, colour, (_, most)) = feed.operands[at];
            feed.channels[channel] = output;
            feed.scales[channel] = 255.0 * format.to_f64(1) / colour.to_f64(i128::from(most));
        }
        Ok(feed)
    }

    /// The number of operands.
    pub fn len(&self) -> usize {
        self.operands.len()
    }

    /// Whether the device takes dγ, and so the smooth normal's angle.
    pub fn takes_deviation(&self) -> bool {
        self.takes(Quantity::CosDgamma)
    }

    /// The most intervals of a line, if the device computes lines.
    pub fn longest(&self) -> Option<usize> {
        self.longest
    }

    fn takes(&self, quantity: Quantity) -> bool {
        self.find(quantity).is_some()
    }

    fn find(&self, wanted: Quantity) -> Option<(Quantity, Format, (i64, i64))> {
        let mut operands = self.operands.iter();
        operands.find(|operand| operand.0 == wanted).copied()
    }

    /// The raw operands of a point, and whether dγ was beyond the device's domain.
    pub fn raw<'a>(&'a self, point: &'a Point) -> (impl Iterator<Item = i64> + 'a, bool) {
        let split = self.takes_deviation();
        let value = move |quantity| match quantity {
            Quantity::CosGamma if split => point.cos_gamma,
            Quantity::CosGamma => point.cos_shaded,
            Quantity::CosDgamma => point.cos_dgamma,
            Quantity::DgammaNegative => f64::from(u8::from(point.dgamma_negative)),
            Quantity::Exponent => f64::from(self.exponent),
            Quantity::Shift => libm::log2(f64::from(self.exponent)).round(),
            Quantity::Difference(axis) => point.difference.0[axis],
            // The first follow below, and the others a point does not have.
            Quantity::Colour(_) | Quantity::Amplitude => 0.0,
            Quantity::ZetaStart | Quantity::DeltaZeta | Quantity::Length => 0.0,
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

    /// The raw operands of a line with `intervals` intervals, in a light of the strength `light`, 0 … 1.
    ///
    /// A device without an exponent takes the angles times √(n/2).
    ///
    /// # Errors
    /// An angle that such a device has no room for.
    pub fn line(&self, arc: &Arc, light: f64, length: usize) -> Result<Vec<i64>> {
        let full = self.find(Quantity::Amplitude);
        let full = full.map_or(0.0, |(_, format, (_, most))| format.to_f64(i128::from(most)));
        let line = arc.line(full * light, self.exponent, length as u32);
        let stretch = if self.takes(Quantity::Exponent) { 1.0 } else { line.stretch() };
        let raw = |&(quantity, format, (low, high)): &(Quantity, Format, (i64, i64))| {
            let angle = |radians: f64| raw_angle(radians * stretch, format);
            let number =
                |value: f64| format.quantise(value).clamp(i128::from(low), i128::from(high)) as i64;
            match quantity {
                Quantity::ZetaStart => angle(line.zeta_start),
                Quantity::DeltaZeta => angle(line.delta_zeta),
                Quantity::Exponent => number(f64::from(self.exponent)),
                Quantity::Length => number(length as f64),
                Quantity::Amplitude => number(line.amplitude),
                // Not of a line.
                _ => 0,
            }
        };
        if let Some((_, format, _)) = self.find(Quantity::ZetaStart)
            && !self.takes(Quantity::Exponent)
            && let Some(right_angles) = line.beyond(stretch, format)
        {
            bail!(
                "an angle of the picture, times the root of n/2, is {right_angles:.1} right angles, for which the \
                 device has no room; a smaller --exponent helps"
            );
        }
        Ok(self.operands.iter().map(raw).collect())
    }

    /// The results of a point as a colour, 255 at full colour: `outputs` gives those in which red, green and
    /// blue are.
    #[inline]
    pub fn colour<'a>(&self, outputs: impl Fn(usize) -> &'a [i64]) -> Vector {
        let of = |channel: usize| outputs(channel)[self.channels[channel]] as f64;
        Vector::new(of(0), of(1), of(2)).times(Vector(self.scales))
    }
}

fn quantity(operand: &Operand, names: &[(&str, Quantity)]) -> Option<Quantity> {
    let found = names
        .iter()
        .find(|(name, quantity)| operand.name == *name && operand.colour == quantity.is_colour());
    found.map(|(_, quantity)| *quantity)
}
