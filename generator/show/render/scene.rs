//! Defines a picture's scene: objects with shapes and colours, lights, and a height map.

use super::height::Relief;
use super::mesh::Mesh;
use super::shapes;
use super::vector::Vector;
use anyhow::Result;

#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The objects, at least one.
    pub objects: Vec<Object>,
    /// The lights. They are so far away that their directions are the same everywhere.
    pub lights: Vec<Light>,
    /// The height map that tilts the normals of all objects.
    pub relief: Option<Relief>,
}

#[derive(Clone, Debug)]
pub struct Object {
    pub shape: Shape,
    /// The colour of the reflected ambient and diffuse light, 0 … 1 in each channel.
    pub colour: Vector,
}

#[derive(Clone, Debug)]
pub enum Shape {
    /// A ball, which is drawn exactly and not as triangles.
    Ball {
        /// The middle, in coordinates of the scene.
        middle: Vector,
        radius: f64,
    },
    /// Triangles with interpolated normals.
    Mesh(Mesh),
}

/// A light so far away that its direction is the same everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// A vector of length 1 toward the light.
    pub direction: Vector,
    /// The colour, 0 … 1 in each channel.
    pub colour: Vector,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    Sphere,
    Torus,
    Vase,
    Group,
}

/// The default colour of an object: red, green and blue from 0 to 1, as for [`BACKGROUND`].
pub const COLOUR: Vector = Vector::new(0.08, 0.35, 0.54);

pub const BACKGROUND: Vector = Vector::new(0.05, 0.06, 0.08);

impl Light {
    /// Returns the default lights: a white light from the upper left, and a weaker light from behind on the right.
    pub fn usual() -> Vec<Self> {
        let white = Self {
            direction: Vector::new(-0.6, 0.8, 0.9).unit().unwrap_or_default(),
            colour: Vector::new(1.0, 1.0, 1.0),
        };
        let weaker = Self {
            direction: Vector::new(1.0, 0.35, -0.3).unit().unwrap_or_default(),
            colour: Vector::new(0.55, 0.47, 0.38),
        };
        vec![white, weaker]
    }
}

impl Scene {
    /// Returns the objects of a built-in scene, in `colour` or in colours of their own. With `coarse`, they consist of large
    /// triangles, for devices that interpolate along lines in a triangle.
    ///
    /// # Errors
    ///
    /// Fails only through a bug, not through anything that a user gives.
    pub fn built_in(which: BuiltIn, colour: Option<Vector>, coarse: bool) -> Result<Vec<Object>> {
        let origin = Vector::default();
        let shapes_and_colours = match which {
            BuiltIn::Sphere => vec![(ball(origin, 1.0, coarse)?, COLOUR)],
            BuiltIn::Torus => vec![(place(ring(coarse)?, 1.0, 0.9, origin), COLOUR)],
            BuiltIn::Vase => vec![(Shape::Mesh(vase(coarse)?), COLOUR)],
            BuiltIn::Group => {
                let to_the_left = Vector::new(-1.12, 0.2, -0.45);
                let to_the_right = Vector::new(1.22, 0.12, -0.35);
                let in_front = Vector::new(0.0, -0.2, 0.4);
                vec![
                    (place(vase(coarse)?, 1.0, 0.0, to_the_left), Vector::new(0.60, 0.08, 0.07)),
                    (ball(in_front, 0.74, coarse)?, COLOUR),
                    (place(ring(coarse)?, 0.85, 1.05, to_the_right), Vector::new(0.62, 0.38, 0.06)),
                ]
            }
        };
        let mut objects = Vec::new();
        for (shape, usual_colour) in shapes_and_colours {
            objects.push(Object { shape, colour: colour.unwrap_or(usual_colour) });
        }
        Ok(objects)
    }

    /// Returns the middle and half the diagonal of the box around all objects. For example, a ball of radius 1 around the origin
    /// gives the origin and √3.
    pub fn extent(&self) -> (Vector, f64) {
        let mut low = Vector([f64::INFINITY; 3]);
        let mut high = Vector([f64::NEG_INFINITY; 3]);
        for (middle, radius) in self.balls() {
            for axis in 0..3 {
                low.0[axis] = low.0[axis].min(middle.0[axis] - radius);
                high.0[axis] = high.0[axis].max(middle.0[axis] + radius);
            }
        }
        // Halves first: the sum of two large numbers may be none.
        ((low * 0.5 + high * 0.5), (high * 0.5 - low * 0.5).length())
    }

    /// Returns balls that together contain all objects. A corner of a mesh is a ball of radius 0.
    pub fn balls(&self) -> impl Iterator<Item = (Vector, f64)> {
        self.objects.iter().flat_map(|object| {
            let (ball, mesh) = match &object.shape {
                Shape::Ball { middle, radius } => (Some((*middle, *radius)), None),
                Shape::Mesh(mesh) => (None, Some(mesh)),
            };
            let corners = mesh.into_iter().flat_map(Mesh::corner_positions);
            ball.into_iter().chain(corners.map(|corner| (corner, 0.0)))
        })
    }
}

fn ball(middle: Vector, radius: f64, coarse: bool) -> Result<Shape> {
    if coarse {
        Ok(Shape::Mesh(shapes::ball(middle, radius, [64, 32])?))
    } else {
        Ok(Shape::Ball { middle, radius })
    }
}

fn ring(coarse: bool) -> Result<Mesh> {
    shapes::torus(0.72, 0.28, if coarse { [48, 20] } else { [384, 160] })
}

fn vase(coarse: bool) -> Result<Mesh> {
    shapes::vase(if coarse { [48, 60] } else { [384, 480] })
}

fn place(mut mesh: Mesh, size: f64, tilt: f64, to: Vector) -> Shape {
    let (sin, cos) = (libm::sin(tilt), libm::cos(tilt));
    for position in &mut mesh.positions {
        *position = tilted(*position, sin, cos) * size + to;
    }
    for normal in &mut mesh.normals {
        *normal = tilted(*normal, sin, cos);
    }
    Shape::Mesh(mesh)
}

/// Turns a vector about the x axis by the angle with the sine `sin` and the cosine `cos`.
fn tilted(vector: Vector, sin: f64, cos: f64) -> Vector {
    let [x, y, z] = vector.0;
    Vector::new(x, y * cos - z * sin, y * sin + z * cos)
}
