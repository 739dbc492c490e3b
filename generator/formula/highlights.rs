//! Lists the highlights that a formula may call, by the names of the devices that compute them. `u` is the cosine of the angle γ,
//! and `v` is the exponent. On a surface that faces away, where u ≤ 0, each highlight is 0.

/// The highlights of the cosine and the exponent.
pub(super) const HIGHLIGHTS: [(&str, &str); 3] = [
    // Blinn 1977.
    ("blinn", "if(u > 0, u ^ v, 0)"),
    // UA 30041, cited in seed 001.
    ("parabola", "if(u > 0, max(v / 2 * (u - 1) + 1, 0)^2, 0)"),
    // Schlick 1994.
    ("schlick", "if(u > 0, u / (v - v * u + u), 0)"),
];

/// The highlight W(n, γ) of seed 002 with a third number w, the power: a constant 2, 4, 8 or 16.
pub(super) const HIGHLIGHTS_WITH_POWER: [(&str, &str); 1] =
    [("cosine_power", "if(u > 0, max(v / w * (u - 1) + 1, 0)^w, 0)")];
