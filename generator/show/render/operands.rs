//! Converts the geometry at a point or along a line of a picture to raw operands of a device.
//!
//! The name of an operand decides which quantity it gets: for example, `cos_gamma` gets the cosine between normal and half
//! vector.

use std::f64::consts::FRAC_PI_2;

use anyhow::{Result, bail, ensure};

use super::setup::LineParameters;
use super::vector::Vector;
use glint_base::fixed::{Format, Overflow, Rounding, exp2, nearest};
use glint_base::program::Program;
use glint_golden::{Contract, Operand};

/// A point of a surface under one light, with the quantities from which operands are made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    /// The cosine N·H of the angle γ between the smooth normal N and the half vector H.
    pub cos_gamma: f64,
    /// The cosine of dγ: the angle between H and the perturbed normal, minus γ.
    pub cos_dgamma: f64,
    /// Whether dγ is negative: the perturbed normal is nearer to the half vector H than the smooth normal is.
    pub dgamma_negative: bool,
    /// The vector N − H. N is the perturbed normal if the surface has a height map.
    pub difference: Vector,
    /// The cosine N·H. N is the perturbed normal if the surface has a height map.
    pub cos_shaded: f64,
    /// The colour of the light times the specular coefficient, from 0 to 1.
    pub colour: Vector,
    /// The surface, for a device that also computes ambient and diffuse light.
    pub surface: Surface,
    /// The cosines that operands of a formula may get.
    pub cosines: SceneCosines,
}

/// The cosines between the perturbed normal N, the half vector H, the direction L to the light and the direction V to the viewer.
#[derive(Clone, Copy, Debug, Default)]
pub struct SceneCosines {
    pub normal_half: f64,
    pub normal_light: f64,
    pub normal_viewer: f64,
    pub viewer_half: f64,
}

/// One of the [`SceneCosines`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneCosine {
    NormalHalf,
    NormalLight,
    NormalViewer,
    ViewerHalf,
}

impl SceneCosine {
    /// The names of the cosines on the command line.
    const NAMES: [(&'static str, Self); 4] = [
        ("nh", Self::NormalHalf),
        ("nl", Self::NormalLight),
        ("nv", Self::NormalViewer),
        ("vh", Self::ViewerHalf),
    ];

    /// Returns the cosine with the name `name`, such as `nh`; `None` for an unknown name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(own, _)| *own == name).map(|(_, cosine)| *cosine)
    }

    fn of(self, cosines: &SceneCosines) -> f64 {
        match self {
            Self::NormalHalf => cosines.normal_half,
            Self::NormalLight => cosines.normal_light,
            Self::NormalViewer => cosines.normal_viewer,
            Self::ViewerHalf => cosines.viewer_half,
        }
    }
}

/// The user's value for an operand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GivenOperand {
    /// The same value at every point.
    Value(f64),
    /// A cosine of the scene at each point. A cosine outside the operand's domain becomes the nearest value of the domain.
    Cosine(SceneCosine),
}

/// A point of a surface under one light: its normal, its vectors and its light.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surface {
    pub normal: Vector,
    /// The unit vector to the light.
    pub light: Vector,
    /// The half vector H between the directions to the light and to the viewer, of length 1.
    pub half: Vector,
    /// The ambient light that the surface reflects, from 0 to 1.
    pub ambient: Vector,
    /// The share of the light that the surface reflects diffusely, from 0 to 1.
    pub diffuse: Vector,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum OperandMeaning {
    CosGamma,
    CosDgamma,
    DgammaNegative,
    Exponent,
    /// The exponent's logarithm to base 2, rounded to an integer.
    Shift,
    Difference(usize),
    Colour(usize),
    ZetaStart,
    DeltaZeta,
    Length,
    Amplitude,
    Normal(usize),
    Light(usize),
    Half(usize),
    Ambient(usize),
    Diffuse(usize),
    Specular(usize),
    Given(f64),
    Cosine(SceneCosine),
}

impl OperandMeaning {
    fn is_colour(self) -> bool {
        matches!(self, Self::Colour(_) | Self::Amplitude)
    }
}

const OF_POINTS: [(&str, OperandMeaning); 11] = [
    ("cos_gamma", OperandMeaning::CosGamma),
    ("exponent", OperandMeaning::Exponent),
    ("shift", OperandMeaning::Shift),
    ("cos_dgamma", OperandMeaning::CosDgamma),
    ("dgamma_negative", OperandMeaning::DgammaNegative),
    ("dx", OperandMeaning::Difference(0)),
    ("dy", OperandMeaning::Difference(1)),
    ("dz", OperandMeaning::Difference(2)),
    ("red", OperandMeaning::Colour(0)),
    ("green", OperandMeaning::Colour(1)),
    ("blue", OperandMeaning::Colour(2)),
];

const OF_SURFACES: [(&str, OperandMeaning); 19] = [
    ("nx", OperandMeaning::Normal(0)),
    ("ny", OperandMeaning::Normal(1)),
    ("nz", OperandMeaning::Normal(2)),
    ("lx", OperandMeaning::Light(0)),
    ("ly", OperandMeaning::Light(1)),
    ("lz", OperandMeaning::Light(2)),
    ("hx", OperandMeaning::Half(0)),
    ("hy", OperandMeaning::Half(1)),
    ("hz", OperandMeaning::Half(2)),
    ("exponent", OperandMeaning::Exponent),
    ("ambient_red", OperandMeaning::Ambient(0)),
    ("ambient_green", OperandMeaning::Ambient(1)),
    ("ambient_blue", OperandMeaning::Ambient(2)),
    ("diffuse_red", OperandMeaning::Diffuse(0)),
    ("diffuse_green", OperandMeaning::Diffuse(1)),
    ("diffuse_blue", OperandMeaning::Diffuse(2)),
    ("specular_red", OperandMeaning::Specular(0)),
    ("specular_green", OperandMeaning::Specular(1)),
    ("specular_blue", OperandMeaning::Specular(2)),
];

/// The operands of a device that computes a line of points, in one colour channel at a time.
const OF_LINES: [(&str, OperandMeaning); 5] = [
    ("zeta_start", OperandMeaning::ZetaStart),
    ("delta_zeta", OperandMeaning::DeltaZeta),
    ("exponent", OperandMeaning::Exponent),
    ("length", OperandMeaning::Length),
    ("amplitude", OperandMeaning::Amplitude),
];

/// A device's operands, each with the quantity of a scene that supplies its value.
#[derive(Clone, Debug)]
pub struct Feed {
    operands: Vec<(OperandMeaning, Format, (i64, i64))>,
    /// The index of the output for red, green and blue.
    channels: [usize; 3],
    /// The factor for red, green and blue that makes an output 255 at full colour.
    scales: [f64; 3],
    /// The largest number of intervals of a line; `None` if the device computes single points.
    longest: Option<usize>,
    surfaces: bool,
    /// The value of one unit of the first result, if the device has no colours. The result is then the specular light's share.
    term: Option<f64>,
}

/// Returns the domain of the operand `exponent`, or `None` if the device has no such operand.
pub fn exponents(contract: &dyn Contract) -> Option<(i64, i64)> {
    let mut operands = contract.operands().iter();
    let exponent = operands.find(|operand| operand.name == "exponent")?;
    Some(exponent.domain)
}

pub fn walks_lines(contract: &dyn Contract) -> bool {
    contract.length().is_some()
}

impl Feed {
    /// Finds the quantity of a scene for each operand. Messages name the device by `device`.
    ///
    /// # Errors
    ///
    /// Fails if a picture cannot supply an operand, or if the device lacks the colour operands or their outputs. Fails if a
    /// device that computes lines lacks an operand of a line, such as `delta_zeta`.
    pub fn new(device: &str, contract: &dyn Contract) -> Result<Self> {
        Self::with(device, contract, &[])
    }

    /// Finds the quantities like [`Feed::new`], but each operand named in `given` has its value, or its cosine, from there. A
    /// device without colours then computes the specular light's share: its first result.
    ///
    /// # Errors
    ///
    /// Fails for the reasons of [`Feed::new`]. Fails if the device has no operand with a name in `given`, if that operand is a
    /// colour, or if its value is beyond its domain.
    pub fn with(
        device: &str,
        contract: &dyn Contract,
        given: &[(String, GivenOperand)],
    ) -> Result<Self> {
        let surfaces = contract.operands().iter().any(|it| it.name == OF_SURFACES[10].0);
        let names: &[(&str, OperandMeaning)] = match (walks_lines(contract), surfaces) {
            (true, _) => &OF_LINES,
            (false, true) => &OF_SURFACES,
            (false, false) => &OF_POINTS,
        };
        let mut unknown = Vec::new();
        let mut operands = Vec::new();
        for operand in contract.operands() {
            let quantity = match given.iter().find(|(name, _)| *name == operand.name) {
                Some(&(_, value)) => Some(of_user(operand, value)?),
                None => quantity(operand, names),
            };
            match quantity {
                Some(quantity) => operands.push((quantity, operand.format, operand.domain)),
                None if operand.doc.is_empty() => unknown.push(format!("`{}`", operand.name)),
                None => unknown.push(format!("`{}` ({})", operand.name, operand.doc)),
            }
        }
        if !unknown.is_empty() {
            let known: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
            bail!(
                "Glint cannot compute {} of the device `{device}` from a scene; it computes only {}; \
                 `{Program} render --operand NAME=VALUE` sets an operand to a number, or to a cosine of the scene: nh, nl, nv or vh",
                unknown.join(", "),
                known.join(", ")
            );
        }
        for (name, _) in given {
            ensure!(
                contract.operands().iter().any(|operand| operand.name == *name),
                "--operand {name}: the device `{device}` has no such operand"
            );
        }
        let has_colours = contract.operands().iter().any(|operand| operand.colour);
        let is_term = !given.is_empty() && !surfaces && !walks_lines(contract) && !has_colours;
        let mut feed = Self {
            operands,
            channels: [0; 3],
            scales: [0.0; 3],
            longest: None,
            surfaces,
            term: None,
        };
        if is_term {
            let output = contract.outputs().first();
            feed.term = output.map(|output| output.format.to_f64(1));
            return Ok(feed);
        }
        if walks_lines(contract) {
            for (name, quantity) in OF_LINES {
                ensure!(
                    quantity == OperandMeaning::Exponent || feed.find(quantity).is_some(),
                    "the device `{device}` walks a line, but has no operand `{name}`"
                );
            }
            let length = feed.find(OperandMeaning::Length).map(|(_, _, (_, most))| most);
            feed.longest = length.map(|most| usize::try_from(most).unwrap_or(0));
        }
        let control = contract.operands().iter().filter(|operand| !operand.colour);
        let control = control.count();
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            if surfaces {
                let outputs = contract.outputs();
                let output = outputs.iter().position(|it| it.name == format!("{name}_out"));
                let Some(output) = output else {
                    bail!("the device `{device}` has no output `{name}_out`");
                };
                feed.channels[channel] = output;
                feed.scales[channel] = 255.0 / outputs[output].format.max_raw() as f64;
                continue;
            }
            let wanted = match feed.longest {
                None => OperandMeaning::Colour(channel),
                Some(_) => OperandMeaning::Amplitude,
            };
            let mut places = feed.operands.iter();
            let at = places.position(|(quantity, ..)| *quantity == wanted);
            // The outputs are in the order of the colour operands, which follow the control operands.
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

    pub fn operand_count(&self) -> usize {
        self.operands.len()
    }

    pub fn shades(&self) -> bool {
        self.surfaces
    }

    /// Returns whether the first result of the device is the specular light's share.
    pub fn is_term(&self) -> bool {
        self.term.is_some()
    }

    /// Returns whether the device has the operand `cos_dgamma`. In such a device, `cos_gamma` belongs to the angle γ between the
    /// smooth normal and the half vector. dγ is the amount by which the perturbed normal of a rough surface changes this angle.
    /// In any other device, `cos_gamma` belongs to the perturbed normal.
    pub fn takes_deviation(&self) -> bool {
        self.takes(OperandMeaning::CosDgamma)
    }

    /// Returns whether an operand gets the exponent n of the scene, or its logarithm to base 2. A value that the user gives for
    /// the operand does not count.
    pub fn takes_exponent(&self) -> bool {
        self.takes(OperandMeaning::Exponent) || self.takes(OperandMeaning::Shift)
    }

    /// Returns the index of the first operand with a value outside its domain by at least one unit of its last bit. `values` are
    /// not quantised yet. A cosine is never outside, because a negative cosine becomes the smallest one of the domain. The angles
    /// of lines are never outside, because they are taken modulo a full turn.
    pub fn outside(&self, values: &[f64]) -> Option<usize> {
        let mut operands = self.operands.iter().zip(values);
        operands.position(|(&(quantity, format, domain), &value)| match quantity {
            OperandMeaning::CosGamma
            | OperandMeaning::Cosine(_)
            | OperandMeaning::ZetaStart
            | OperandMeaning::DeltaZeta => false,
            _ => {
                (format.to_f64(i128::from(number(value, format, domain))) - value).abs()
                    >= format.to_f64(1)
            }
        })
    }

    /// Returns the largest number of intervals of a line, or `None` if the device computes single points.
    pub fn longest(&self) -> Option<usize> {
        self.longest
    }

    fn takes(&self, quantity: OperandMeaning) -> bool {
        self.find(quantity).is_some()
    }

    fn find(&self, wanted: OperandMeaning) -> Option<(OperandMeaning, Format, (i64, i64))> {
        let mut operands = self.operands.iter();
        operands.find(|operand| operand.0 == wanted).copied()
    }

    /// Returns the operand values for a point as real numbers, before they are quantised, in the order of the device's operands.
    pub fn values<'a>(&'a self, point: &'a Point, exponent: u32) -> impl Iterator<Item = f64> + 'a {
        let split = self.takes_deviation();
        self.operands.iter().map(move |&(quantity, format, (_, high))| match quantity {
            OperandMeaning::CosGamma if split => point.cos_gamma,
            OperandMeaning::CosGamma => point.cos_shaded,
            OperandMeaning::CosDgamma => point.cos_dgamma,
            OperandMeaning::DgammaNegative => f64::from(u8::from(point.dgamma_negative)),
            OperandMeaning::Exponent => f64::from(exponent),
            OperandMeaning::Shift => libm::log2(f64::from(exponent)).round(),
            OperandMeaning::Difference(axis) => point.difference.0[axis],
            // The colour 1 becomes the largest value of the operand.
            OperandMeaning::Colour(channel) => {
                point.colour.0[channel] * format.to_f64(i128::from(high))
            }
            OperandMeaning::Normal(axis) => point.surface.normal.0[axis],
            OperandMeaning::Light(axis) => point.surface.light.0[axis],
            OperandMeaning::Half(axis) => point.surface.half.0[axis],
            OperandMeaning::Ambient(at) => point.surface.ambient.0[at] * format.to_f64(high.into()),
            OperandMeaning::Diffuse(at) => point.surface.diffuse.0[at] * format.to_f64(high.into()),
            OperandMeaning::Specular(at) => point.colour.0[at] * format.to_f64(high.into()),
            OperandMeaning::Given(value) => value,
            OperandMeaning::Cosine(cosine) => cosine.of(&point.cosines),
            // Only devices that compute lines have these operands.
            OperandMeaning::Amplitude
            | OperandMeaning::ZetaStart
            | OperandMeaning::DeltaZeta
            | OperandMeaning::Length => 0.0,
        })
    }

    /// Returns the raw operands of a point, and whether dγ was beyond the device's domain. The device must compute single points.
    pub fn raw<'a>(
        &'a self,
        point: &'a Point,
        exponent: u32,
    ) -> (impl Iterator<Item = i64> + 'a, bool) {
        let raw = self
            .operands
            .iter()
            .zip(self.values(point, exponent))
            .map(|(&(_, format, domain), value)| number(value, format, domain));
        let beyond = self.operands.iter().any(|(quantity, format, (low, _))| {
            *quantity == OperandMeaning::CosDgamma
                && format.quantise(point.cos_dgamma) < i128::from(*low)
        });
        (raw, beyond)
    }

    /// Returns the amplitude operand's value for a white light of full strength, or 0 without such an operand.
    pub fn full(&self) -> f64 {
        let full = self.find(OperandMeaning::Amplitude);
        full.map_or(0.0, |(_, format, (_, most))| format.to_f64(i128::from(most)))
    }

    /// Returns the factor by which the host multiplies a line's angles: √(n/2), or 1 if the device takes the exponent n as an
    /// operand.
    fn stretch(&self, line: &LineParameters) -> f64 {
        if self.takes(OperandMeaning::Exponent) { 1.0 } else { line.stretch() }
    }

    /// Returns the operand values for a line of points as real numbers, before they are quantised, in the order of the
    /// device's operands. Angles are in right angles.
    pub fn line_values<'a>(&'a self, line: &'a LineParameters) -> impl Iterator<Item = f64> + 'a {
        let stretch = self.stretch(line);
        self.operands.iter().map(move |(quantity, ..)| match quantity {
            OperandMeaning::ZetaStart => line.zeta_start * stretch / FRAC_PI_2,
            OperandMeaning::DeltaZeta => line.delta_zeta * stretch / FRAC_PI_2,
            OperandMeaning::Exponent => f64::from(line.exponent),
            OperandMeaning::Length => f64::from(line.length),
            OperandMeaning::Amplitude => line.amplitude,
            OperandMeaning::Given(value) => *value,
            // Only devices that compute single points have the other operands.
            _ => 0.0,
        })
    }

    /// Returns the raw operands of a line. Angles are taken modulo a full turn.
    ///
    /// # Errors
    ///
    /// Fails if the device has no exponent operand and the format of `zeta_start` cannot represent the line's angles. For such a
    /// device, the host multiplies the angles by √(n/2).
    pub fn line(&self, line: &LineParameters) -> Result<Vec<i64>> {
        if let Some((_, format, _)) = self.find(OperandMeaning::ZetaStart)
            && !self.takes(OperandMeaning::Exponent)
        {
            // One right angle of the format's range remains free for the rounding errors that add up along the line.
            let room = exp2(format.int) - 1.0;
            let ends = [line.zeta_start, line.zeta(line.length)];
            let mut ends = ends.map(|zeta| self.stretch(line) * zeta / FRAC_PI_2).into_iter();
            if let Some(right_angles) = ends.find(|right_angles| right_angles.abs() > room) {
                bail!(
                    "an angle of the line, times the square root of n/2, is {right_angles:.1} right angles, \
                     more than the format of the device holds; give a smaller exponent, or set a larger \
                     `angle.integer`"
                );
            }
        }
        let raw = |(&(quantity, format, domain), value)| match quantity {
            OperandMeaning::ZetaStart | OperandMeaning::DeltaZeta => raw_angle(value, format),
            _ => number(value, format, domain),
        };
        Ok(self.operands.iter().zip(self.line_values(line)).map(raw).collect())
    }

    /// Returns the light that a device without colours lets through of `light`, in which 255 is full light. `result` has the
    /// computation's results.
    pub fn share_of(&self, light: Vector, result: &[i64]) -> Vector {
        let unit = self.term.unwrap_or(0.0);
        light * (result[0] as f64 * unit * 255.0)
    }

    /// Returns a colour, in which 255 is full light. `outputs` returns the outputs of the computation that has the colour
    /// channel 0 (red), 1 (green) or 2 (blue). A device for points has all three channels in one computation; a device for
    /// lines has a computation for each.
    #[inline]
    pub fn colour<'a>(&self, outputs: impl Fn(usize) -> &'a [i64]) -> Vector {
        let of = |channel: usize| outputs(channel)[self.channels[channel]] as f64;
        Vector::new(of(0), of(1), of(2)).times(Vector(self.scales))
    }
}

/// Returns the raw value nearest to `value` in the domain. For example, 300 in a domain from 1 to 255 is 255.
fn number(value: f64, format: Format, (low, high): (i64, i64)) -> i64 {
    format.quantise(value).clamp(i128::from(low), i128::from(high)) as i64
}

/// Returns a raw angle. An angle outside the format's range wraps around, which changes it by full turns. For example, 2.5 right
/// angles in a signed format from −2 to 2 are −1.5.
fn raw_angle(right_angles: f64, format: Format) -> i64 {
    let scaled = nearest(right_angles * exp2(format.frac)) as i128;
    format.narrow(scaled, format.frac, Rounding::Truncate, Overflow::Wrap) as i64
}

/// Returns the quantity that the user gives for an operand. Fails if the operand is a colour, or if a value is outside its domain.
fn of_user(operand: &Operand, given: GivenOperand) -> Result<OperandMeaning> {
    let name = &operand.name;
    let [low, high] =
        [operand.domain.0, operand.domain.1].map(|raw| operand.format.to_f64(i128::from(raw)));
    ensure!(
        !operand.colour,
        "--operand {name}: the operand is a colour, and the light determines its value"
    );
    let value = match given {
        GivenOperand::Value(value) => value,
        GivenOperand::Cosine(cosine) => return Ok(OperandMeaning::Cosine(cosine)),
    };
    ensure!(
        (low..=high).contains(&value),
        "--operand {name}={value}: the domain of the operand is {low} to {high}"
    );
    Ok(OperandMeaning::Given(value))
}

/// Returns the quantity of a scene for an operand, or `None` if a scene has none. The renderer supplies one light per
/// computation. If a device takes several lights, the operands of the remaining lights are 0, for example `lx2`.
fn quantity(operand: &Operand, names: &[(&str, OperandMeaning)]) -> Option<OperandMeaning> {
    let of = |wanted: &str| {
        let mut names = names.iter();
        names.find(|(name, quantity)| wanted == *name && operand.colour == quantity.is_colour())
    };
    let first = operand.name.trim_end_matches(|it: char| it.is_ascii_digit());
    match (of(&operand.name), of(first)) {
        (Some((_, quantity)), _) => Some(*quantity),
        (None, Some((_, OperandMeaning::Light(_) | OperandMeaning::Half(_)))) => {
            Some(OperandMeaning::Given(0.0))
        }
        _ => None,
    }
}
