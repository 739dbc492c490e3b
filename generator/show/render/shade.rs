//! Computes the host's part of shading: the surface at a point, its ambient and diffuse light, and the device's operands. All
//! arithmetic is f64.

use std::f64::consts::{PI, TAU};

use anyhow::Result;

use super::camera::Camera;
use super::operands::{self, Feed, Point, SceneCosines};
use super::scene::{Light, Object, Scene, Shape};
use super::vector::Vector;
use super::visibility::Hit;
use crate::render::setup::Arc;
use glint_core::cosim::batch::Points;

/// The shares of light that a surface reflects.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// The share of the ambient light, which is white and has the strength of one light.
    pub ambient: f64,
    /// The share of each light that is reflected diffusely, times the cosine of the light's angle.
    pub diffuse: f64,
    /// The specular coefficient k_s: the share of each light that is multiplied by the reflectance f of the device.
    pub specular: f64,
    pub exponent: u32,
}

impl Material {
    pub const fn usual(exponent: u32) -> Self {
        Self { ambient: 0.12, diffuse: 0.75, specular: 0.7, exponent }
    }
}

pub struct Shader<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub material: Material,
    /// The colour where no object is visible, from 0 to 255.
    pub background: Vector,
    pub feed: &'a Feed,
    /// Whether to compute Blinn's function cosⁿγ as well, for a comparison.
    pub compare: bool,
}

/// A row of samples: all light except the light that the device computes, and the points for the device.
pub struct Shaded {
    /// The colour of each sample without the device's light, 0 … 255, and the number of lights for which the device computes a
    /// result.
    pub samples: Vec<(Vector, u32)>,
    pub points: Points,
    /// The indices of the results with red, green and blue, for each sample and each of its lights. `None` if every computation
    /// has one result with all three colours, and the results are in this order.
    pub places: Option<Vec<[usize; 3]>>,
    /// The light that a device without colours reflects in part, for each point; empty for all other devices.
    pub lights: Vec<Vector>,
    /// The light that the device should compute, with Blinn's cosⁿγ in f64 as reflectance, 0 … 255, for each sample and each of
    /// its lights. Empty unless [`Shader::compare`] is set.
    pub exact: Vec<Vector>,
    /// The number of points with a roughness angle dγ (the normal's deviation) outside the device's domain.
    pub beyond: usize,
}

/// A visible point of a surface. `smooth` is the unit normal without the height map, and `perturbed` with it.
struct SurfacePoint {
    colour: Vector,
    smooth: Vector,
    perturbed: Vector,
    /// The interpolated perturbed normal, of any length.
    interpolated: Vector,
    toward_eye: Vector,
}

impl SurfacePoint {
    /// Returns whether a light falls on the surface. The renderer must check this, because the device would also compute a
    /// highlight on the side away from the light.
    fn is_lit(&self, light: &Light) -> bool {
        self.smooth.dot(light.direction) > 0.0
    }

    /// Returns the half vector H between light and eye, of length 1.
    fn half(&self, light: &Light) -> Vector {
        let sum = light.direction + self.toward_eye;
        sum.unit().unwrap_or(self.smooth)
    }
}

impl Shader<'_> {
    /// Shades a row of samples. `hits` are the surfaces at the samples, and `ray` returns the ray through the sample in a column.
    ///
    /// # Errors
    /// Fails if a line's operands cannot be computed, or if the device cannot represent them.
    pub fn shade(&self, hits: &[Hit], ray: impl Fn(usize) -> Vector) -> Result<Shaded> {
        let mut shaded = Shaded {
            samples: Vec::with_capacity(hits.len()),
            points: Points::new(self.feed.operand_count()),
            places: self.feed.longest().map(|_| Vec::new()),
            lights: Vec::new(),
            exact: Vec::new(),
            beyond: 0,
        };
        let mut column = 0;
        for run in hits.chunk_by(|a, b| (a.object, a.triangle) == (b.object, b.triangle)) {
            if !run[0].is_something() {
                let samples = shaded.samples.len() + run.len();
                shaded.samples.resize(samples, (self.background, 0));
                column += run.len();
                continue;
            }
            let most = match self.feed.longest() {
                // A line has one point more than it has intervals.
                Some(longest) => longest + 1,
                None => run.len(),
            };
            for part in run.chunks(most) {
                let mut surfaces: Vec<SurfacePoint> = Vec::with_capacity(part.len());
                for hit in part {
                    surfaces.push(self.surface(hit, ray(column)));
                    column += 1;
                }
                self.surfaces(&surfaces, &mut shaded)?;
            }
        }
        Ok(shaded)
    }

    /// Shades neighbouring samples of a row on one triangle or ball, and appends them to `shaded`.
    fn surfaces(&self, surfaces: &[SurfacePoint], shaded: &mut Shaded) -> Result<()> {
        let lines = match self.feed.longest() {
            None => Vec::new(),
            Some(_) => self.lines(surfaces, &mut shaded.points)?,
        };
        for (at, surface) in surfaces.iter().enumerate() {
            let material = &self.material;
            let white = Vector::new(1.0, 1.0, 1.0);
            let (mut ambient, mut light_sum) = (white * material.ambient, Vector::default());
            if !self.feed.shades() {
                std::mem::swap(&mut ambient, &mut light_sum);
            }
            let mut computed = 0;
            for (number, light) in self.scene.lights.iter().enumerate() {
                let facing = surface.perturbed.dot(light.direction).max(0.0);
                let scattered = light.colour * material.diffuse;
                if !self.feed.shades() {
                    light_sum = light_sum + scattered * facing;
                }
                if !surface.is_lit(light) {
                    continue;
                }
                let mut specular = light.colour * material.specular;
                if self.feed.is_term() {
                    // The term is a reflectance, and the light on the surface falls with its angle.
                    specular = specular * facing;
                }
                let half = surface.half(light);
                let mut point = point(surface.smooth, surface.perturbed, half, specular);
                if self.feed.shades() {
                    point.surface = operands::Surface {
                        normal: surface.interpolated,
                        light: light.direction,
                        half,
                        // The first light that falls on the surface carries the ambient light; `take` leaves 0 for the others.
                        ambient: surface.colour.times(std::mem::take(&mut ambient)),
                        diffuse: surface.colour.times(scattered),
                    };
                }
                if self.feed.is_term() {
                    let normal = surface.perturbed;
                    point.cosines = SceneCosines {
                        normal_half: point.cos_shaded,
                        normal_light: normal.dot(light.direction),
                        normal_viewer: normal.dot(surface.toward_eye),
                        viewer_half: surface.toward_eye.dot(half),
                    };
                    shaded.lights.push(specular);
                }
                match &mut shaded.places {
                    None => {
                        let (raw, beyond) = self.feed.raw(&point, material.exponent);
                        shaded.points.push(raw, 1);
                        shaded.beyond += usize::from(beyond);
                    }
                    Some(places) => places.push(lines[number].map(|first| first + at)),
                }
                computed += 1;
                if self.compare {
                    let f = glint_golden::formulas::blinn(
                        point.cos_shaded,
                        f64::from(material.exponent),
                    );
                    let it = &point.surface;
                    let rest = it.ambient + it.diffuse * facing;
                    shaded.exact.push(rest * 255.0 + point.colour * (f * 255.0));
                }
            }
            let base = surface.colour.times(light_sum + ambient) * 255.0;
            shaded.samples.push((base, computed));
        }
        Ok(())
    }

    /// Adds the lines along neighbouring samples to `points`: for each light one line in red, green and blue. Returns the indices
    /// of the first results of these three lines for each light. A light that falls on none of the samples has no lines. [`Arc`]
    /// computes the operands from the normals and half vectors at the two ends.
    fn lines(&self, surfaces: &[SurfacePoint], points: &mut Points) -> Result<Vec<[usize; 3]>> {
        let (Some(first), Some(last)) = (surfaces.first(), surfaces.last()) else {
            return Ok(Vec::new());
        };
        let count = surfaces.len();
        let mut firsts = Vec::with_capacity(self.scene.lights.len());
        for light in &self.scene.lights {
            let mut numbers = [0; 3];
            if surfaces.iter().any(|surface| surface.is_lit(light)) {
                let (half_1, half_2) = (first.half(light), last.half(light));
                let arc = Arc::new(first.smooth, half_1, last.smooth, half_2)?;
                let strengths = light.colour * self.material.specular;
                for (number, strength) in numbers.iter_mut().zip(strengths.0) {
                    *number = points.result_count();
                    let light = self.feed.full() * strength;
                    let line = arc.line(light, self.material.exponent, count as u32 - 1);
                    points.push(self.feed.line(&line)?, count);
                }
            }
            firsts.push(numbers);
        }
        Ok(firsts)
    }

    fn surface(&self, hit: &Hit, ray: Vector) -> SurfacePoint {
        let object = &self.scene.objects[hit.object as usize];
        let along = self.camera.outward(ray);
        let place = self.camera.eye() + along * hit.depth;
        let toward_eye = (-along).unit().unwrap_or_default();
        let [smooth, perturbed, interpolated] = self.normals(object, hit, place, toward_eye);
        SurfacePoint { colour: object.colour, smooth, perturbed, interpolated, toward_eye }
    }

    /// Returns three normals on the side of the eye: the unit normals of the smooth and of the perturbed surface, and the
    /// interpolated perturbed normal, of any length.
    fn normals(
        &self,
        object: &Object,
        hit: &Hit,
        place: Vector,
        toward_eye: Vector,
    ) -> [Vector; 3] {
        // The flat side of the triangle decides which direction is toward the eye. The interpolated normal may lean away from the
        // eye although the triangle is visible.
        let (normal, mixed, side) = match &object.shape {
            Shape::Ball { middle, .. } => {
                let normal = (place - *middle).unit().unwrap_or(toward_eye);
                (normal, normal, normal)
            }
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.triangles[hit.triangle as usize]
                    .map(|corner| mesh.normals[corner.normal as usize]);
                let [second, third] = hit.weights;
                let mixed = a * (1.0 - second - third) + b * second + c * third;
                let [p, q, r] = mesh.corners(hit.triangle as usize);
                let side = (q - p).cross(r - p).unit().unwrap_or(toward_eye);
                (mixed.unit().unwrap_or(side), mixed, side)
            }
        };
        let side = if side.dot(toward_eye) < 0.0 { -side } else { side };
        let sign = if normal.dot(side) < 0.0 { -1.0 } else { 1.0 };
        let (perturbed, mixed) = match &self.scene.relief {
            None => (normal, mixed),
            Some(relief) => {
                let (texture, gradients) = texture(object, hit, normal);
                let [along_u, along_v] = relief.rise(texture[0], texture[1]);
                let slope = gradients[0] * along_u + gradients[1] * along_v;
                let perturbed = (normal - slope).unit().unwrap_or(normal);
                (perturbed, perturbed)
            }
        };
        [normal, perturbed, mixed].map(|it| it * sign)
    }
}

/// Returns a point's quantities from which operands are made. `smooth` and `perturbed` are unit normals, and `half` is the half
/// vector H.
///
/// As in the patent that `rough` implements, roughness changes the angle γ between normal and half vector by dγ. N′ is the
/// perturbed normal, and γ′ is its angle with H. Then dγ = γ′ − γ and cos dγ = cos γ·cos γ′ + sin γ·sin γ′. dγ is negative if
/// N′ is nearer to H.
pub fn point(smooth: Vector, perturbed: Vector, half: Vector, colour: Vector) -> Point {
    let cosine = |normal: Vector| normal.dot(half).clamp(-1.0, 1.0);
    let (cos_gamma, cos_shaded) = (cosine(smooth), cosine(perturbed));
    let sine = |cosine: f64| (1.0 - cosine * cosine).sqrt();
    let cos_dgamma = if smooth == perturbed {
        1.0
    } else {
        (cos_gamma * cos_shaded + sine(cos_gamma) * sine(cos_shaded)).min(1.0)
    };
    Point {
        cos_gamma,
        cos_dgamma,
        dgamma_negative: cos_shaded > cos_gamma,
        difference: perturbed - half,
        cos_shaded,
        colour,
        ..Point::default()
    }
}

/// Returns the texture coordinates (u, v) of a hit and their gradients: the vectors along the surface in which u and v grow,
/// in texture units per unit of the scene.
fn texture(object: &Object, hit: &Hit, normal: Vector) -> ([f64; 2], [Vector; 2]) {
    match &object.shape {
        Shape::Ball { radius, .. } => {
            let [x, y, z] = normal.0;
            // u is the longitude, which runs from −1 to 1 once around; v is the latitude, from 0 to 1 between the poles. Both
            // have the same scale at the equator. Near the poles the meridians come together, so `sine` is limited to keep the
            // height map from doing so.
            let sine = (1.0 - y * y).max(0.02).sqrt();
            let u = libm::atan2(x, z) / PI;
            let v = 1.0 - libm::acos(y.clamp(-1.0, 1.0)) / PI;
            let east = Vector::new(z, 0.0, -x) * (1.0 / sine);
            let north = (Vector::new(0.0, 1.0, 0.0) - normal * y) * (1.0 / sine);
            ([u, v], [east * (2.0 / (TAU * radius * sine)), north * (1.0 / (PI * radius))])
        }
        Shape::Mesh(mesh) => {
            let corners = mesh.triangles[hit.triangle as usize];
            let [a, b, c] = corners.map(|corner| {
                let at = corner.texture.map(|at| mesh.textures[at as usize]);
                at.unwrap_or_default()
            });
            let [second, third] = hit.weights;
            let [p, q, r] = mesh.corners(hit.triangle as usize);
            let (first_edge, second_edge) = (q - p, r - p);
            let area = first_edge.cross(second_edge);
            let scale = 1.0 / area.dot(area);
            // Vectors in the triangle's plane: each is perpendicular to one of the two edges.
            let across = [second_edge.cross(area), area.cross(first_edge)];
            let along = |axis: usize| {
                let (to_b, to_c) = (b[axis] - a[axis], c[axis] - a[axis]);
                let at = a[axis] + to_b * second + to_c * third;
                let gradient = (across[0] * to_b + across[1] * to_c) * scale;
                let finite = if gradient.finite() { gradient } else { Vector::default() };
                (at, finite)
            };
            let (u, v) = (along(0), along(1));
            ([u.0, v.0], [u.1, v.1])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::mesh::{Mesh, RawCorner};
    use glint_golden::formulas::turned_cosine;

    #[test]
    fn the_deviation_turns_the_smooth_angle_into_the_perturbed_one() {
        let unit = |x, y, z| Vector::new(x, y, z).unit().unwrap();
        let half = unit(0.1, 0.2, 1.0);
        for (smooth, perturbed) in [
            (unit(0.5, 0.1, 1.0), unit(0.3, 0.1, 1.0)),
            (unit(0.3, 0.1, 1.0), unit(0.5, 0.4, 1.0)),
            (unit(0.3, 0.1, 1.0), unit(0.3, 0.1, 1.0)),
        ] {
            let it = point(smooth, perturbed, half, Vector::default());
            let turned = turned_cosine(it.cos_gamma, it.cos_dgamma, it.dgamma_negative);
            assert!((turned - perturbed.dot(half)).abs() < 1e-12);
            assert!((it.cos_shaded - perturbed.dot(half)).abs() < 1e-15);
        }
    }

    #[test]
    fn texture_gradients_of_a_triangle() {
        // The triangle lies in the plane z = 0, where u = x/2 and v = x/4 + y/3.
        let v = Vector::new;
        let corners =
            [0, 1, 2].map(|at| RawCorner { position: at, normal: None, texture: Some(at) });
        let mesh = Mesh::new(
            vec![v(0.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 3.0, 0.0)],
            Vec::new(),
            vec![[0.0, 0.0], [1.0, 0.5], [0.0, 1.0]],
            vec![corners],
            crate::render::mesh::CREASE,
        )
        .unwrap();
        let object = Object { shape: Shape::Mesh(mesh), colour: Vector::default() };
        let hit = Hit { depth: 1.0, object: 0, triangle: 0, weights: [0.5, 0.25] };
        let (at, [along_u, along_v]) = texture(&object, &hit, v(0.0, 0.0, 1.0));
        assert_eq!(at, [0.5, 0.5]);
        assert!((along_u - v(0.5, 0.0, 0.0)).length() < 1e-15, "{along_u:?}");
        assert!((along_v - v(0.25, 1.0 / 3.0, 0.0)).length() < 1e-15, "{along_v:?}");
    }
}
