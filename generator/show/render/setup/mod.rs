//! Computes the operands of a line in f64, for devices that compute a whole line of points after one start. A host does this
//! once for each line, from the vectors at its two ends.
//!
//! The method is from document 000, the source of these devices. Along a line, the normal turns from N₁ to N₂ on a great circle,
//! and the half vector from H₁ to H₂. The method rotates H₂ as N₂ is rotated into N₁, and calls the result H₂′. The normal is
//! then always N₁, and one half vector turns on the circle through H₁ and H₂′.
//!
//! The cosine of the angle δ between them is `A·cos(ζ)`, with an angle ζ that grows evenly along the line: [`Arc`]. So
//! `I·k_s·cosⁿδ = C·cosⁿζ` with `C = I·k_s·Aⁿ`: [`LineParameters`]. [`Feed::line`](super::Feed::line) converts these parameters
//! to raw operands. `templates/setup.c` and `templates/setup.py` compute the same, in the same order.
//!
//! ```
//! use glint_show::render::{Vector, setup::Arc};
//!
//! let v = Vector::new;
//! let arc = Arc::new(v(0.0, 0.0, 1.0), v(0.3, 0.0, 1.0), v(0.1, 0.0, 1.0), v(-0.2, 0.1, 1.0)).unwrap();
//! assert_eq!(arc.line(240.0, 60, 639).length, 639);
//! ```

use std::f64::consts::{PI, TAU};
use std::fmt;

use super::vector::Vector;

/// The largest cosine of two normals that count as opposite: the rotation between them is then half a turn.
const OPPOSITE: f64 = -1.0 + 1e-12;

/// The largest γ, in radians. Beyond it, the half vectors count as opposite.
const LARGEST_GAMMA: f64 = PI - 1e-6;

/// The largest γ, in radians, at which the half vector counts as constant.
const STILL: f64 = 1e-8;

/// The amount by which rounding may make the cosine of the smallest angle to the normal exceed 1.
const ROUNDING: f64 = 1e-6;

#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A vector has the length 0 or is not finite. The text is its name.
    NoDirection(&'static str),
    /// H₁ and H₂′ are opposite, so infinitely many great circles go through both.
    OppositeHalves,
    /// No three directions form these three angles.
    NoSuchAngles,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NoDirection(name) => write!(
                f,
                "{name} has no direction: at least one of its three numbers must differ from 0"
            ),
            Self::OppositeHalves => f.write_str(
                "the half vectors are opposite, so no path between them is the shortest; set up the line in \
                 two parts",
            ),
            Self::NoSuchAngles => f.write_str(
                "no directions have these angles: theta_1, theta_2 and gamma are the sides of a spherical triangle, none \
                 larger than the sum of the others",
            ),
        }
    }
}

impl std::error::Error for Error {}

/// The way of the half vector from H₁ to H₂′, with the fixed normal N₁; the head of this module explains the vectors. Angles are
/// in radians.
///
/// Every field has a value even where a formula of the source document divides by zero. For γ = 0, the angle stays at λ = 0. For
/// cos θ₁ ≤ 0, `arctan P` would be in the wrong half plane; λ is the angle of the point (cos θ₁, P·cos θ₁), from −180° to 180°,
/// and A is never negative. For N₁ = −N₂, the normal turns by half a turn in the plane of N₂ and H₂, so H₂′ = −H₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// θ₁, the angle between the normal N₁ and the half vector H₁ at the line's start.
    pub theta_1: f64,
    /// θ₂, the angle between N₂ and H₂ at the line's end, which is also the angle between N₁ and H₂′.
    pub theta_2: f64,
    /// γ, the angle by which the half vector turns from H₁ to H₂′; less than π.
    pub gamma: f64,
    /// P·cos θ₁ = (cos θ₂ − cos θ₁·cos γ)/sin γ, from which λ follows; 0 for γ = 0.
    pub rise: f64,
    /// λ, the angle by which the half vector must turn from H₁ to the point of its circle that is nearest to N₁. It is `arctan
    /// P` for cos θ₁ > 0.
    pub lambda: f64,
    /// A = cos θ₁/cos λ, the largest cosine between N₁ and any half vector on the circle.
    pub peak: f64,
}

impl Arc {
    /// Makes an arc from the normals and half vectors at the two ends of the line. The vectors may have any length.
    ///
    /// # Errors
    ///
    /// Fails with [`Error::NoDirection`] if a vector has no direction, and with [`Error::OppositeHalves`] if the half vectors are
    /// opposite.
    pub fn new(
        normal_1: Vector,
        half_1: Vector,
        normal_2: Vector,
        half_2: Vector,
    ) -> Result<Self, Error> {
        let normal_1 = direction("normal_1", normal_1)?;
        let half_1 = direction("half_1", half_1)?;
        let normal_2 = direction("normal_2", normal_2)?;
        let half_2 = direction("half_2", half_2)?;
        let turned_half = turned(normal_1, normal_2, half_2);
        // (cos θ₂ − cos θ₁·cos γ)/sin γ is the cosine between N₁ and the direction in which the half vector turns. Computed as
        // a scalar product, it needs no difference of cosines, which would be inexact for a small γ.
        let aside = half_1.cross(turned_half).cross(half_1).unit();
        Self::new_of(
            [angle(normal_1, half_1), angle(normal_1, turned_half)],
            angle(half_1, turned_half),
            normal_1.dot(half_1),
            aside.map_or(0.0, |aside| normal_1.dot(aside)),
        )
    }

    /// Makes an arc from three angles, each from 0 to π: θ₁ and θ₂ between normal and half vector at the two ends of the line,
    /// and γ, by which the half vector turns.
    ///
    /// # Errors
    /// Fails with [`Error::OppositeHalves`] if γ is π, and with [`Error::NoSuchAngles`] if no directions form these angles.
    pub fn of_angles(theta_1: f64, theta_2: f64, gamma: f64) -> Result<Self, Error> {
        let (cosine_1, cosine_2) = (libm::cos(theta_1), libm::cos(theta_2));
        let rise = (cosine_2 - cosine_1 * libm::cos(gamma)) / libm::sin(gamma);
        let arc = Self::new_of([theta_1, theta_2], gamma, cosine_1, rise)?;
        let still = gamma <= STILL && (theta_1 - theta_2).abs() > ROUNDING;
        if arc.peak > 1.0 + ROUNDING || still { Err(Error::NoSuchAngles) } else { Ok(arc) }
    }

    /// Makes the arc, without `rise` if γ is so small that the half vector counts as constant.
    fn new_of(
        [theta_1, theta_2]: [f64; 2],
        gamma: f64,
        cosine_1: f64,
        rise: f64,
    ) -> Result<Self, Error> {
        if gamma > LARGEST_GAMMA {
            return Err(Error::OppositeHalves);
        }
        // At the angle x from H₁, cos δ = cos θ₁·cos x + rise·sin x, which is A·cos(x − λ).
        let (rise, peak, lambda) = match gamma > STILL {
            true => (rise, libm::hypot(cosine_1, rise), libm::atan2(rise, cosine_1)),
            false => (0.0, cosine_1.max(0.0), 0.0),
        };
        Ok(Self { theta_1, theta_2, gamma, rise, lambda, peak })
    }

    /// Returns cos δ = A·cos ζ, the cosine between normal and half vector, at the part `t` of the line, 0 … 1. It is negative if
    /// the surface faces away; for γ = 0 it is then 0.
    pub fn cosine(&self, t: f64) -> f64 {
        self.peak * libm::cos(t * self.gamma - self.lambda)
    }

    /// Returns P = (cos θ₂ − cos θ₁·cos γ)/(cos θ₁·sin γ), whose arctangent is λ. P is infinite or not a number for cos θ₁ =
    /// 0.
    pub fn p(&self) -> f64 {
        self.rise / libm::cos(self.theta_1)
    }

    /// Returns the angle ζ at the line's start: −λ, or a full turn less if this brings the lit part of the line near ζ = 0.
    pub fn zeta_start(&self) -> f64 {
        if self.gamma - self.lambda > 1.5 * PI { -self.lambda - TAU } else { -self.lambda }
    }

    /// Returns the line of `length` intervals with the light `intensity` (I·k_s, in output units) and the exponent n. It has
    /// one point more than intervals.
    pub fn line(&self, intensity: f64, exponent: u32, length: u32) -> LineParameters {
        LineParameters {
            amplitude: intensity * libm::pow(self.peak.min(1.0), f64::from(exponent)),
            exponent,
            length,
            delta_zeta: match length {
                0 => 0.0,
                intervals => self.gamma / f64::from(intervals),
            },
            zeta_start: self.zeta_start(),
        }
    }
}

/// Scales a vector to length 1. `name` is its name in an error.
///
/// # Errors
/// Fails with [`Error::NoDirection`] if the length is 0 or not finite.
pub fn direction(name: &'static str, vector: Vector) -> Result<Vector, Error> {
    vector.unit().ok_or(Error::NoDirection(name))
}

/// Returns the half vector (L + V)/|L + V| of the directions toward the light and the viewer. `names` are the names of light,
/// view and half vector in an error.
///
/// # Errors
/// Fails with [`Error::NoDirection`] if `light` or `view` has no direction, or if they are opposite.
pub fn half(names: [&'static str; 3], light: Vector, view: Vector) -> Result<Vector, Error> {
    let [of_light, of_view, of_both] = names;
    direction(of_both, direction(of_light, light)? + direction(of_view, view)?)
}

/// Returns H₂′: `half_2` rotated by the rotation that turns N₂ into N₁ about their common perpendicular. All vectors must have
/// length 1.
fn turned(normal_1: Vector, normal_2: Vector, half_2: Vector) -> Vector {
    let cosine = normal_1.dot(normal_2);
    if cosine <= OPPOSITE {
        return -half_2;
    }
    let v = normal_1.cross(normal_2);
    let once = v.cross(half_2);
    half_2 - once + v.cross(once) * (1.0 / (1.0 + cosine))
}

/// Returns the angle between two unit vectors, in radians. Unlike the arc cosine, it is exact for small angles.
fn angle(a: Vector, b: Vector) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}

/// The parameters of a line before they are quantised. Angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineParameters {
    /// C = I·k_s·Aⁿ, the amplitude operand in output units: the light times the specular coefficient times the peak.
    pub amplitude: f64,
    /// n, the highlight's exponent.
    pub exponent: u32,
    /// l = X_end − X_start, the number of intervals between the line's points.
    pub length: u32,
    /// Δζ = γ/l, the angle from a point to the next; 0 for l = 0.
    pub delta_zeta: f64,
    /// ζ(X_start), the first point's angle.
    pub zeta_start: f64,
}

impl LineParameters {
    /// Returns the angle ζ of point number `index`, counted from 0.
    pub fn zeta(&self, index: u32) -> f64 {
        self.zeta_start + f64::from(index) * self.delta_zeta
    }

    /// Returns a = √(n/2), by which the host multiplies angles for a device that has no exponent as an operand.
    pub fn stretch(&self) -> f64 {
        (f64::from(self.exponent) / 2.0).sqrt()
    }
}

#[cfg(test)]
mod tests;
