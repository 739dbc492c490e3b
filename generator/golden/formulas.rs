//! The exact formulas of the devices, computed in f64 without rounding to fixed point ([symbols](crate#symbols)).
//!
//! A surface that faces away (c ≤ 0) has f = 0, except in [`lyon`], [`cosine_squared`] and [`stretched_cosine`], which do not
//! know γ. Angles are in radians. Transcendental functions come from `libm`, so every machine computes the same values.

use std::f64::consts::FRAC_PI_2;

/// Returns Blinn's function `cⁿ` (device `blinn`), or 0 if `c ≤ 0`, also for n = 0. For example, c = 0.5 and n = 2 give 0.25.
pub fn blinn(c: f64, n: f64) -> f64 {
    if c <= 0.0 { 0.0 } else { libm::pow(c, n) }
}

/// Returns cos(γ + dγ), or cos(γ − dγ) if `dgamma_negative`. `c` is cos γ and `cd` is cos dγ; both angles must be in 0 … 90°. The
/// device `rough` tilts γ by dγ, the deviation of the normal on a rough surface. For example, γ = 60° and dγ = 30° give 0, or cos
/// 30°.
#[inline]
pub fn turned_cosine(c: f64, cd: f64, dgamma_negative: bool) -> f64 {
    let sines = ((1.0 - c * c) * (1.0 - cd * cd)).max(0.0).sqrt();
    if dgamma_negative {
        // In real numbers a cosine never exceeds 1; in f64 the sum may, by an ulp.
        (c * cd + sines).min(1.0)
    } else {
        c * cd - sines
    }
}

/// Returns `n/2·(cos(γ ± dγ) − 1) + 1`. The formula of `rough` clamps this base at 0 and squares it.
#[inline]
fn rough_base(c: f64, cd: f64, dgamma_negative: bool, n: f64) -> f64 {
    n / 2.0 * (turned_cosine(c, cd, dgamma_negative) - 1.0) + 1.0
}

/// Returns the formula of the device `rough` (seed 001): `(n/2·(cos(γ ± dγ) − 1) + 1)²`, or 0 if the base is negative or `c ≤ 0`.
/// `c`, `cd` and `dgamma_negative` are as for [`turned_cosine`].
#[inline]
pub fn rough(c: f64, cd: f64, dgamma_negative: bool, n: f64) -> f64 {
    if c <= 0.0 {
        return 0.0;
    }
    let base = rough_base(c, cd, dgamma_negative, n).max(0.0);
    base * base
}

/// Returns the formula of the device `rough` without its clamp of the base: for a negative base, the parabola rises again. The
/// result is limited to 1; it is 0 if `c ≤ 0`.
#[inline]
pub fn rough_unclamped(c: f64, cd: f64, dgamma_negative: bool, n: f64) -> f64 {
    if c <= 0.0 {
        return 0.0;
    }
    let base = rough_base(c, cd, dgamma_negative, n);
    (base * base).min(1.0)
}

/// Returns the parabola `(n/2·(c − 1) + 1)²`, or 0 if the base is negative or `c ≤ 0`.
#[inline]
pub fn parabola(c: f64, n: f64) -> f64 {
    rough(c, 1.0, false, n)
}

/// Returns `square` if it is at least `level`, otherwise 0. UA 30041 (device `threshold`) calls `level` the level of visibility.
#[inline]
pub fn threshold(square: f64, level: f64) -> f64 {
    if square < level { 0.0 } else { square }
}

/// Returns the formula of the device `lyon` (US 5 739 820, cited in seed 000): `(1 − β·D²)^m`, or 0 if β·D² is 1 or more.
///
/// `distance` is D² = |N − H|², the squared distance of the normal N and the half vector H. `m` is a power of two. If N and H are
/// unit vectors and β = n/(2·m), the formula equals [`cosine_power`], except on surfaces that face away.
#[inline]
pub fn lyon(distance: f64, beta: f64, m: u32) -> f64 {
    let base = (1.0 - beta * distance).max(0.0);
    (0..m.ilog2()).fold(base, |power, _| power * power)
}

/// Returns the formula of the device `quadratic` (UA 20998, cited in seed 001): `c + a·(c² − c)`, or 0 if that is negative or
/// `c ≤ 0`.
///
/// The coefficient a = a(n) depends on the exponent n and comes from a table; it is never negative. For example, c = 0.5 and a =
/// 1 give 0.25.
#[inline]
pub fn quadratic(c: f64, a: f64) -> f64 {
    if c <= 0.0 {
        return 0.0;
    }
    (c * (1.0 - a * (1.0 - c))).max(0.0)
}

/// Returns the formula of the device `cosine-power`, the function W of the paper (seed 002): `(n/m·(c − 1) + 1)^m`, or 0 if the
/// base is negative or `c ≤ 0`.
#[inline]
pub fn cosine_power(c: f64, n: f64, m: u32) -> f64 {
    if c <= 0.0 {
        return 0.0;
    }
    let base = (n / f64::from(m) * (c - 1.0) + 1.0).max(0.0);
    (0..m.ilog2()).fold(base, |power, _| power * power)
}

/// Returns the power k of the device `quad-cosine` (seed 000) for the exponent `n`: 1 for n = 1, 2 for n = 2, 4 for n = 3 to 6,
/// and 16 for every other n, including 0.
#[inline]
pub fn quad_power(n: i64) -> u32 {
    match n {
        1 => 1,
        2 => 2,
        3..=6 => 4,
        _ => 16,
    }
}

/// Returns `cosᵏ(angle)`, or 0 if the magnitude of `angle` is a right angle or more. `k` is a power of two.
#[inline]
fn lobe(angle: f64, k: u32) -> f64 {
    let magnitude = angle.abs();
    if magnitude >= FRAC_PI_2 {
        return 0.0;
    }
    (0..k.ilog2()).fold(libm::cos(magnitude), |power, _| power * power)
}

/// Returns the formula of the device `quad-cosine` (seed 000): `cosᵏ(√(n/k)·δ)`. `delta` is δ, and k is [`quad_power`] of `n`.
/// The result is 0 if `√(n/k)·δ` or δ is beyond a right angle, since the surface then faces away.
#[inline]
pub fn quad_cosine(delta: f64, n: i64) -> f64 {
    if delta.abs() > FRAC_PI_2 {
        return 0.0;
    }
    let k = quad_power(n);
    lobe((n as f64 / f64::from(k)).sqrt() * delta, k)
}

/// Returns the formula of the device `cosine-squared` (a prototype that seed 000 cites): `cos²(a·δ)`, or 0 if a·δ is a right
/// angle or more. `stretched` is the product a·δ, with a = √(n/2).
#[inline]
pub fn cosine_squared(stretched: f64) -> f64 {
    lobe(stretched, 2)
}

/// Returns the formula of the device `gauss` (seed 002): `exp(−n·γ²/2)` with the angle γ = arccos c, or 0 if `c ≤ 0`.
#[inline]
pub fn gauss(c: f64, n: f64) -> f64 {
    if c <= 0.0 {
        return 0.0;
    }
    let gamma = libm::acos(c.min(1.0));
    libm::exp(-n * gamma * gamma / 2.0)
}

/// Returns the formula of the device `schlick` (seed 002): `c / (n − n·c + c)`, or 0 if `c ≤ 0`, also for n = 0. For example, c =
/// 0.5 and n = 1 give 0.5.
#[inline]
pub fn schlick(c: f64, n: f64) -> f64 {
    // Near c = 1, n − n·c loses digits to cancellation, and n·(1 − c) does not.
    if c <= 0.0 { 0.0 } else { c / (n * (1.0 - c) + c) }
}

/// Returns the approximation of seed 000 for any power k: `cosᵏ(√(n/k)·δ)`, or 0 if `√(n/k)·δ` is a right angle or more.
#[inline]
pub fn stretched_cosine(delta: f64, n: f64, k: u32) -> f64 {
    let angle = (n / f64::from(k)).sqrt() * delta.abs();
    if angle >= FRAC_PI_2 {
        return 0.0;
    }
    libm::pow(libm::cos(angle), f64::from(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIN_COS_30: (f64, f64) = (0.5, 0.866_025_403_784_438_6);

    #[test]
    fn turned_cosine_adds_and_subtracts_angles() {
        let (sin, cos) = SIN_COS_30;
        // cos(60° + 30°) = 0, cos(60° − 30°) = cos 30°.
        assert!(turned_cosine(sin, cos, false).abs() < 1e-15);
        assert!((turned_cosine(sin, cos, true) - cos).abs() < 1e-15);
    }

    #[test]
    fn peaks_and_zeros() {
        assert_eq!(blinn(1.0, 1000.0), 1.0);
        assert_eq!(blinn(-0.1, 2.0), 0.0);
        assert_eq!(blinn(0.5, 3.0), 0.125);
        assert_eq!(gauss(1.0, 1000.0), 1.0);
        assert_eq!(gauss(-0.1, 2.0), 0.0);
        // γ = 60°: exp(−π²/18).
        assert!((gauss(0.5, 1.0) - 0.577_924_896_492_729_3).abs() < 1e-12);
        // n = 2, dγ = 0: the base is c itself.
        assert_eq!(rough(0.25, 1.0, false, 2.0), 0.0625);
        // n = 8, c = 1/2: the base is 4·(−1/2) + 1 = −1.
        assert_eq!(rough(0.5, 1.0, true, 8.0), 0.0);
        assert_eq!(rough_unclamped(0.5, 1.0, true, 8.0), 1.0);
        assert_eq!(rough_unclamped(0.0, 1.0, true, 8.0), 0.0);
        // The zero of W is at c = (n − m)/n.
        assert_eq!(cosine_power(0.75, 16.0, 4), 0.0);
        // n = 4, m = 4: the base is c.
        assert_eq!(cosine_power(0.5, 4.0, 4), 0.0625);
        assert_eq!(cosine_power(0.5, 1.0, 2), 0.5625);
        // 1/2 over 3·1/2 + 1/2; n = 1 is c itself, n = 0 is 1.
        assert_eq!(schlick(0.5, 3.0), 0.25);
        assert_eq!(schlick(0.3, 1.0), 0.3);
        assert_eq!([0.0, 0.1, 1.0].map(|c| schlick(c, 0.0)), [0.0, 1.0, 1.0]);
        assert_eq!(schlick(1.0, 1000.0), 1.0);
        assert_eq!(schlick(-0.5, 3.0), 0.0);
    }

    #[test]
    fn stretched_cosines() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        // cos(60°), cos²(−60°), cos⁴(√(4/4)·60°), cos¹⁶(√(64/16)·30°).
        let third = std::f64::consts::FRAC_PI_3;
        assert!(close(quad_cosine(third, 1), 0.5));
        assert!(close(quad_cosine(-third, 2), 0.25));
        assert!(close(quad_cosine(third, 4), 0.0625));
        assert!(close(quad_cosine(third / 2.0, 64), 0.5f64.powi(16)));
        // √(64/16)·45° is a right angle; n = 0 gives 1 as far as the surface faces.
        assert_eq!(quad_cosine(0.786, 64), 0.0);
        assert_eq!(quad_cosine(1.57, 0), 1.0);
        assert_eq!(quad_cosine(-1.58, 0), 0.0);
        // √(3/4) < 1: the stretched angle is small when δ is a right angle.
        assert!(quad_cosine(1.57, 3) > 0.001);
        assert_eq!(quad_cosine(1.58, 3), 0.0);
        assert!(close(cosine_squared(-third), 0.25));
        assert_eq!(cosine_squared(1.6), 0.0);
    }

    #[test]
    fn stretched_powers() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        let third = std::f64::consts::FRAC_PI_3;
        // n = k stretches nothing; √(64/16)·30° = 60°; √(64/16)·45° is a right angle.
        assert!(close(stretched_cosine(-third, 3.0, 3), 0.125));
        assert!(close(stretched_cosine(third / 2.0, 64.0, 16), libm::pow(0.5, 16.0)));
        assert_eq!(stretched_cosine(0.786, 64.0, 16), 0.0);
        assert_eq!([1, 2, 3, 6, 7, 1000].map(quad_power), [1, 2, 4, 4, 16, 16]);
    }
}
