//! Defines the perspective camera of a rendered picture: its position and direction, and where a point of the scene appears.

use anyhow::{Context, Result, ensure};

use super::vector::Vector;

/// A perspective camera. In its own coordinates, x points to the right, y upward, and the camera looks along −z.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    eye: Vector,
    right: Vector,
    up: Vector,
    back: Vector,
    half: (f64, f64),
}

/// The user's settings of the camera. Settings that are left out follow from the scene's size.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The position in the scene. The default is the nearest position, in front of the scene and a little above, from which
    /// all objects are visible.
    pub eye: Option<Vector>,
    /// The point at which the camera looks; by default the scene's middle.
    pub target: Option<Vector>,
    /// The vertical field of view in degrees.
    pub field: f64,
}

/// The default direction from the target to the camera: from the front and a little above.
const DIRECTION: Vector = Vector::new(0.0, 0.28, 1.0);

/// The share of the picture's width or height that the objects fill by default.
const FILLED: f64 = 0.92;

impl Camera {
    /// Makes the camera. `aspect` is the picture's width divided by its height. The camera shows all of `things`, balls with
    /// their middle and radius, unless `view` says otherwise. `middle` is the middle of all balls.
    ///
    /// # Errors
    ///
    /// Fails if the camera's position is the point at which it looks, or if the position is not finite.
    pub fn new(
        view: &View,
        aspect: f64,
        middle: Vector,
        things: impl Iterator<Item = (Vector, f64)>,
    ) -> Result<Self> {
        let tangent = libm::tan((view.field / 2.0).to_radians());
        let target = view.target.unwrap_or(middle);
        let from = view.eye.map_or(DIRECTION, |eye| eye - target);
        let back = from.unit();
        let back = back.context(
            "the camera is at the point that it looks at: give --camera and --target different points",
        )?;
        // If the camera looks straight up or down, the upper edge of the picture is toward −z.
        let upward = if back.0[0] == 0.0 && back.0[2] == 0.0 {
            Vector::new(0.0, 0.0, -1.0)
        } else {
            Vector::new(0.0, 1.0, 0.0)
        };
        let right = upward.cross(back).unit();
        let right = right.context("the camera has no upward direction")?;
        let mut camera = Self {
            eye: view.eye.unwrap_or(target),
            right,
            up: back.cross(right),
            back,
            half: (tangent * aspect, tangent),
        };
        if view.eye.is_none() {
            camera.eye = target + back * camera.distance(things);
        }
        ensure!(camera.eye.finite(), "the camera is infinitely far away");
        Ok(camera)
    }

    /// Returns the smallest distance from the target at which the camera sees all of `things`. The eye must still be at the
    /// target.
    fn distance(&self, things: impl Iterator<Item = (Vector, f64)>) -> f64 {
        let slopes = [self.half.0 * FILLED, self.half.1 * FILLED];
        let needed = things.flat_map(|(middle, radius)| {
            let [x, y, z] = self.place(middle).0;
            // The plane through the eye and an edge of the picture touches the ball.
            let touching = |aside: f64, slope: f64| {
                z + (aside.abs() + radius * (1.0 + slope * slope).sqrt()) / slope
            };
            [touching(x, slopes[0]), touching(y, slopes[1])]
        });
        needed.fold(0.0, f64::max)
    }

    pub fn eye(&self) -> Vector {
        self.eye
    }

    /// Converts a point of the scene to the camera's coordinates. For example, a point 5 units in front of the camera is (0,
    /// 0, −5).
    #[inline]
    pub fn place(&self, point: Vector) -> Vector {
        let from = point - self.eye;
        Vector::new(from.dot(self.right), from.dot(self.up), from.dot(self.back))
    }

    /// Converts a direction from the camera's coordinates to the scene's coordinates.
    #[inline]
    pub fn outward(&self, direction: Vector) -> Vector {
        let [x, y, z] = direction.0;
        self.right * x + self.up * y + self.back * z
    }

    /// Returns half the width and half the height of the visible area at distance 1.
    pub fn half(&self) -> (f64, f64) {
        self.half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View { eye: None, target: None, field: 90.0 };

    #[test]
    fn coordinates_of_the_camera() {
        let view =
            View { eye: Some(Vector::new(5.0, 0.0, 0.0)), target: Some(Vector::default()), ..VIEW };
        let none = || std::iter::empty();
        let camera = Camera::new(&view, 2.0, Vector::default(), none()).unwrap();
        // For a camera on the +x axis, +z is to the left.
        assert_eq!(camera.place(Vector::new(0.0, 2.0, 1.0)), Vector::new(-1.0, 2.0, -5.0));
        assert_eq!(camera.outward(Vector::new(-1.0, 2.0, -5.0)), Vector::new(-5.0, 2.0, 1.0));
        assert!((camera.half().1 - 1.0).abs() < 1e-15);
        let inside = View { eye: Some(Vector::default()), ..view };
        assert!(Camera::new(&inside, 1.0, Vector::default(), none()).is_err());
    }

    #[test]
    fn everything_is_seen() {
        let things = [(Vector::new(3.0, 0.0, 1.0), 0.0), (Vector::new(-1.0, 2.0, -4.0), 1.5)];
        for aspect in [0.25, 1.0, 3.0] {
            let camera = Camera::new(&VIEW, aspect, Vector::default(), things.into_iter()).unwrap();
            let mut fullest: f64 = 0.0;
            for (middle, radius) in things {
                let [x, y, z] = camera.place(middle).0;
                for (aside, half) in [(x, camera.half().0), (y, camera.half().1)] {
                    // The line's angle from the eye that touches the ball, in the plane of this axis.
                    let angle =
                        libm::atan(aside.abs() / -z) + libm::asin(radius / libm::hypot(aside, z));
                    fullest = fullest.max(libm::tan(angle) / half);
                }
            }
            assert!((fullest - FILLED).abs() < 1e-9, "{aspect}: {fullest}");
        }
    }
}
