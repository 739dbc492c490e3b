//! What a host computes before it starts a line of `quad-cosine` or `cosine-squared` (seed 000), in f64, and
//! the raw operands that it then writes.
//!
//! Along a line the half vector goes from H₁ to H₂ on a great circle while the normal goes from N₁ to N₂. The
//! seed turns the second end so that the normals coincide: H₂′ is H₂ turned as N₂ is turned into N₁. What is
//! left is one half vector on the circle through H₁ and H₂′, and the cosine of its angle to N₁ is
//! `A·cos(ζ)`, with ζ growing evenly: [`Arc`]. So `I·k_s·cosⁿδ = C·cosⁿζ` with `C = I·k_s·Aⁿ`: [`Line`].
//!
//! ```
//! use glint::config::Config;
//! use glint::render::setup::Arc;
//!
//! let config = Config::defaults(&glint::devices::quad_cosine::schema(), "line");
//! let arc = Arc::new([0.0, 0.0, 1.0], [0.3, 0.0, 1.0], [0.1, 0.0, 1.0], [-0.2, 0.1, 1.0]).unwrap();
//! let operands = arc.line(240.0, 60, 639).quad_cosine(&config).unwrap();
//! assert_eq!((operands.length, operands.exponent), (639, Some(60)));
//! ```

mod operands;
mod vector;

use std::f64::consts::{PI, TAU};
use std::fmt;

pub use operands::{Operands, raw_angle};
pub use vector::Vector;
use vector::{angle, cross, dot, scaled, sum, unit};

/// A cosine below which two directions count as opposite: a rotation of half a turn.
const OPPOSITE: f64 = -1.0 + 1e-12;

/// Why a line cannot be set up.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A vector has no direction: its length is 0 or not finite. Which one.
    NoDirection(&'static str),
    /// H₁ and H₂′ are opposite: no great circle through them is distinguished.
    OppositeHalves,
    /// An operand does not fit the configuration: its name, its value, and the key to change.
    Beyond {
        /// The operand.
        operand: &'static str,
        /// Its value.
        value: f64,
        /// The configuration key.
        key: &'static str,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NoDirection(name) => write!(f, "{name} has no direction"),
            Self::OppositeHalves => f.write_str("the half vectors are opposite"),
            Self::Beyond { operand, value, key } => {
                write!(f, "{operand} is {value}, which {key} has no room for")
            }
        }
    }
}

impl std::error::Error for Error {}

/// The half vector's way from H₁ to H₂′ as seen from N₁. Angles are in radians.
///
/// Everything is defined where the seed divides by zero: for γ = 0 the angle stands still at λ = 0;
/// for cos θ₁ ≤ 0, where `arctan P` would be in the wrong half plane, λ is the angle of the point (cos θ₁, P·cos θ₁),
/// from −180° to 180°, and A is never negative; for N₁ = −N₂ the turn is half of one in the plane of N₂ and H₂,
/// so that H₂′ = −H₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// θ₁ = ∠(N₁, H₁).
    pub theta_1: f64,
    /// θ₂ = ∠(N₁, H₂′) = ∠(N₂, H₂).
    pub theta_2: f64,
    /// γ = ∠(H₁, H₂′), less than π.
    pub gamma: f64,
    /// H₂′, a unit vector.
    pub turned_half: Vector,
    /// P·cos θ₁ = (cos θ₂ − cos θ₁·cos γ)/sin γ; 0 for γ = 0.
    pub rise: f64,
    /// λ: how far from H₁ on the circle the point nearest to N₁ lies; `arctan P` for cos θ₁ > 0.
    pub lambda: f64,
    /// A = cos θ₁/cos λ: the cosine of the angle from that point to N₁.
    pub peak: f64,
}

impl Arc {
    /// From the normals and half vectors at the ends of the line, of any length.
    ///
    /// # Errors
    /// [`Error::NoDirection`] and [`Error::OppositeHalves`].
    pub fn new(
        normal_1: Vector,
        half_1: Vector,
        normal_2: Vector,
        half_2: Vector,
    ) -> Result<Self, Error> {
        let normal_1 = unit(normal_1).ok_or(Error::NoDirection("the first normal"))?;
        let half_1 = unit(half_1).ok_or(Error::NoDirection("the first half vector"))?;
        let normal_2 = unit(normal_2).ok_or(Error::NoDirection("the second normal"))?;
        let half_2 = unit(half_2).ok_or(Error::NoDirection("the second half vector"))?;
        let turned_half = turned(normal_1, normal_2, half_2);
        if dot(half_1, turned_half) <= OPPOSITE {
            return Err(Error::OppositeHalves);
        }
        let gamma = angle(half_1, turned_half);
        let (cosine_1, cosine_2) = (dot(normal_1, half_1), dot(normal_1, turned_half));
        let sine = libm::sin(gamma);
        let rise = if sine == 0.0 { 0.0 } else { (cosine_2 - cosine_1 * libm::cos(gamma)) / sine };
        // cos δ = cos θ₁·cos x + rise·sin x at x from H₁, that is A·cos(x − λ).
        let (peak, lambda) = if sine == 0.0 {
            (cosine_1.max(0.0), 0.0)
        } else {
            (libm::hypot(cosine_1, rise), libm::atan2(rise, cosine_1))
        };
        Ok(Self {
            theta_1: angle(normal_1, half_1),
            theta_2: angle(normal_1, turned_half),
            gamma,
            turned_half,
            rise,
            lambda,
            peak,
        })
    }

    /// cos δ at the part `t` of the way, 0 … 1: A·cos ζ. Negative where the surface faces away, but for γ = 0, where
    /// it is 0 then.
    pub fn cosine(&self, t: f64) -> f64 {
        self.peak * libm::cos(t * self.gamma - self.lambda)
    }

    /// P = (cos θ₂ − cos θ₁·cos γ)/(cos θ₁·sin γ), infinite or not a number for cos θ₁ = 0.
    pub fn p(&self) -> f64 {
        self.rise / libm::cos(self.theta_1)
    }

    /// ζ at H₁: −λ, or a turn less where that brings the part of the way that has light near ζ = 0.
    /// The whole way lies within three right angles of 0 then.
    pub fn zeta_start(&self) -> f64 {
        if self.gamma - self.lambda > 1.5 * PI { -self.lambda - TAU } else { -self.lambda }
    }

    /// The line of `length` intervals with the light `intensity` (I·k_s, in output units) and the exponent n.
    pub fn line(&self, intensity: f64, exponent: u32, length: u32) -> Line {
        Line {
            amplitude: intensity * libm::pow(self.peak, f64::from(exponent)),
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

/// H₂′: H₂ turned as N₂ is turned into N₁ about the normal of both; all unit vectors.
fn turned(normal_1: Vector, normal_2: Vector, half_2: Vector) -> Vector {
    let cosine = dot(normal_1, normal_2);
    if cosine <= OPPOSITE {
        return scaled(half_2, -1.0);
    }
    let v = cross(normal_1, normal_2);
    let once = cross(v, half_2);
    let twice = scaled(cross(v, once), 1.0 / (1.0 + cosine));
    sum(sum(half_2, scaled(once, -1.0)), twice)
}

/// A line before it is quantised. Angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// C = I·k_s·Aⁿ, in output units.
    pub amplitude: f64,
    /// n.
    pub exponent: u32,
    /// l = X_end − X_start.
    pub length: u32,
    /// Δζ = γ/l; 0 for l = 0.
    pub delta_zeta: f64,
    /// ζ(X_start).
    pub zeta_start: f64,
}

impl Line {
    /// ζ of point number `index`.
    pub fn zeta(&self, index: u32) -> f64 {
        self.zeta_start + f64::from(index) * self.delta_zeta
    }
}

#[cfg(test)]
mod tests;
