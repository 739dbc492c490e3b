//! A perspective camera.

use anyhow::{Context, Result, ensure};

use super::vector::Vector;

/// Where a picture is seen from. Its own coordinates have x to the right, y upward, and look along −z.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    eye: Vector,
    right: Vector,
    up: Vector,
    back: Vector,
    /// Half the width and half the height of what is seen at distance 1.
    half: (f64, f64),
}

/// What the user says of the camera; the rest follows from what there is to be seen.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Where it stands.
    pub eye: Option<Vector>,
    /// What it looks at: the middle of everything by default.
    pub target: Option<Vector>,
    /// The angle between the upper and the lower edge, in degrees.
    pub field: f64,
}

/// From where things are seen by default: from the front, a little above.
const DIRECTION: Vector = Vector::new(0.0, 0.28, 1.0);

/// How much of the narrower side of the picture things fill, by default.
const FILLED: f64 = 0.9;

impl Camera {
    /// A camera for a picture of the given aspect, width through height, that shows the ball of the given
    /// middle and radius unless `view` says otherwise.
    ///
    /// # Errors
    /// An eye at its target.
    pub fn new(view: &View, aspect: f64, middle: Vector, radius: f64) -> Result<Self> {
        let half_field = (view.field / 2.0).to_radians();
        let tangent = libm::tan(half_field);
        let target = view.target.unwrap_or(middle);
        let narrow = libm::atan(tangent * aspect.min(1.0) * FILLED);
        let eye = match (view.eye, DIRECTION.unit()) {
            (Some(eye), _) => eye,
            (None, direction) => {
                target + direction.unwrap_or_default() * (radius / libm::sin(narrow))
            }
        };
        let back = (eye - target).unit();
        let back = back.context("the camera stands where it looks at: --camera and --target")?;
        // Looking straight up or down, the upper edge is to the back.
        let upward = match back.0[0] == 0.0 && back.0[2] == 0.0 {
            true => Vector::new(0.0, 0.0, -1.0),
            false => Vector::new(0.0, 1.0, 0.0),
        };
        let right = upward.cross(back).unit();
        let right = right.context("the camera has no upward direction")?;
        ensure!(eye.finite(), "the camera is infinitely far away");
        Ok(Self {
            eye,
            right,
            up: back.cross(right),
            back,
            half: (tangent * aspect, tangent),
        })
    }

    /// Where it stands.
    pub fn eye(&self) -> Vector {
        self.eye
    }

    /// A point in the camera's coordinates.
    #[inline]
    pub fn place(&self, point: Vector) -> Vector {
        let from = point - self.eye;
        Vector::new(from.dot(self.right), from.dot(self.up), from.dot(self.back))
    }

    /// A direction of the camera's coordinates, outside.
    #[inline]
    pub fn outward(&self, direction: Vector) -> Vector {
        let [x, y, z] = direction.0;
        self.right * x + self.up * y + self.back * z
    }

    /// Half the width and half the height of what is seen at distance 1.
    pub fn half(&self) -> (f64, f64) {
        self.half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_the_camera() {
        let view = View {
            eye: Some(Vector::new(5.0, 0.0, 0.0)),
            target: Some(Vector::default()),
            field: 90.0,
        };
        let camera = Camera::new(&view, 2.0, Vector::default(), 1.0).unwrap();
        // From +x, +z is to the left.
        assert_eq!(
            camera.place(Vector::new(0.0, 2.0, 1.0)),
            Vector::new(-1.0, 2.0, -5.0)
        );
        assert_eq!(
            camera.outward(Vector::new(-1.0, 2.0, -5.0)),
            Vector::new(-5.0, 2.0, 1.0)
        );
        assert!((camera.half().1 - 1.0).abs() < 1e-15);
        let inside = View {
            eye: Some(Vector::default()),
            ..view
        };
        assert!(Camera::new(&inside, 1.0, Vector::default(), 1.0).is_err());
    }
}
