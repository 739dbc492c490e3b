//! The little of vectors that the set-up needs.

/// A vector of three coordinates.
pub type Vector = [f64; 3];

/// a · b.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + b.
pub fn sum(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a · by.
pub fn scaled(a: Vector, by: f64) -> Vector {
    a.map(|coordinate| coordinate * by)
}

/// The direction of a, when it has one.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = libm::hypot(libm::hypot(a[0], a[1]), a[2]);
    (length > 0.0 && length.is_finite()).then(|| a.map(|coordinate| coordinate / length))
}

/// The angle between unit vectors; exact for small angles too, where the arc cosine is not.
pub fn angle(a: Vector, b: Vector) -> f64 {
    let normal = cross(a, b);
    libm::atan2(dot(normal, normal).sqrt(), dot(a, b))
}
