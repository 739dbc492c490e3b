//! Defines vectors of three f64 components, and their arithmetic.
//!
//! The module uses only addition, subtraction, multiplication, division and square roots, so every machine computes the same
//! bits.

use std::ops::{Add, Mul, Neg, Sub};

/// A point, a direction, or a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector(pub [f64; 3]);

impl Vector {
    #[inline]
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self([x, y, z])
    }

    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        ax * bx + ay * by + az * bz
    }

    /// Returns the cross product. Swapping the operands negates it exactly, even after rounding.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Self::new(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)
    }

    #[inline]
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Returns the vector of length 1 with the same direction, or `None` if the length is 0 or a component is not finite.
    #[inline]
    pub fn unit(self) -> Option<Self> {
        let [x, y, z] = self.0.map(f64::abs);
        let largest = x.max(y).max(z);
        // The scaled vector has the largest component 1, so its squares neither overflow nor vanish.
        let scaled = self * (1.0 / largest);
        let length = scaled.length();
        (self.finite() && length.is_finite() && length > 0.0).then(|| scaled * (1.0 / length))
    }

    /// Multiplies two vectors component by component.
    #[inline]
    pub fn times(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Self::new(ax * bx, ay * by, az * bz)
    }

    #[inline]
    pub fn finite(self) -> bool {
        self.0.iter().all(|component| component.is_finite())
    }
}

impl Add for Vector {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Self::new(ax + bx, ay + by, az + bz)
    }
}

impl Sub for Vector {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (self.0, other.0);
        Self::new(ax - bx, ay - by, az - bz)
    }
}

impl Mul<f64> for Vector {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|component| component * factor))
    }
}

impl Neg for Vector {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|component| -component))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products() {
        let (x, y) = (Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, 1.0, 0.0));
        assert_eq!(x.cross(y), Vector::new(0.0, 0.0, 1.0));
        assert_eq!(x.cross(y), -y.cross(x));
        assert_eq!(Vector::new(1.0, 2.0, 3.0).dot(Vector::new(4.0, 5.0, 6.0)), 32.0);
    }

    #[test]
    fn units_of_extreme_vectors() {
        let unit = Vector::new(0.0, 3e-200, -4e-200).unit();
        let [x, y, z] = unit.expect("a direction").0;
        assert!(x == 0.0 && (y - 0.6).abs() < 1e-15 && (z + 0.8).abs() < 1e-15);
        assert!(Vector::new(1e300, 1e300, 0.0).unit().is_some());
        assert_eq!(Vector::default().unit(), None);
        assert_eq!(Vector::new(f64::NAN, 1.0, 0.0).unit(), None);
        assert_eq!(Vector::new(f64::INFINITY, 1.0, 0.0).unit(), None);
    }
}
