//! Finds the visible surface at each sample of a picture with a z-buffer. Threads render horizontal bands of the picture in
//! parallel.
//!
//! Three planes go through the eye, one through each edge of a triangle. The scalar products of a sample's ray with the normals
//! of these planes give the barycentric coordinates of the sample, so triangles need no clipping. Two triangles that share an
//! edge compute the same product for it with opposite signs, so no gap is visible between them.

use rayon::prelude::*;

use super::camera::Camera;
use super::scene::{Scene, Shape};
use super::vector::Vector;

/// The number of rows of samples in a band.
const BAND: usize = 16;

/// The first surface that the ray through a sample meets.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// The distance from the camera's plane. It is also the factor by which the ray reaches the surface, because the ray's third
    /// component is −1.
    pub depth: f64,
    pub object: u32,
    /// The index of the triangle in the object's mesh; 0 for a ball.
    pub triangle: u32,
    /// The barycentric weights of the triangle's second and third corner.
    pub weights: [f64; 2],
}

const NOTHING: Hit = Hit { depth: f64::INFINITY, object: u32::MAX, triangle: 0, weights: [0.0; 2] };

impl Hit {
    pub fn is_something(&self) -> bool {
        self.object != u32::MAX
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Raster {
    pub columns: usize,
    pub rows: usize,
    half: (f64, f64),
}

impl Raster {
    /// Makes a raster of samples that covers the field of view of `camera`.
    pub fn new(columns: usize, rows: usize, camera: &Camera) -> Self {
        Self { columns, rows, half: camera.half() }
    }

    /// Returns the ray through a sample's middle, in the camera's coordinates.
    #[inline]
    pub fn ray(&self, column: usize, row: usize) -> Vector {
        let x = (2.0 * column as f64 + 1.0) / self.columns as f64 - 1.0;
        let y = 1.0 - (2.0 * row as f64 + 1.0) / self.rows as f64;
        Vector::new(x * self.half.0, y * self.half.1, -1.0)
    }

    /// Returns the first and the end index of the samples with middles that may lie between the slopes `low` and `high`, with one
    /// more sample on each side. A slope is `x/−z` for columns and `−y/−z` for rows. `half` is half the width or height of the
    /// view at distance 1, and `count` the number of samples.
    fn span(&self, low: f64, high: f64, half: f64, count: usize) -> (u32, u32) {
        let last = count as f64;
        let lowest = (low / half + 1.0) / 2.0 * last - 0.5;
        let highest = (high / half + 1.0) / 2.0 * last - 0.5;
        // The limits keep the conversions inside the raster; NaN becomes 0.
        let first = (lowest - 1.0).clamp(0.0, last) as u32;
        let end = (highest + 2.0).clamp(0.0, last) as u32;
        (first, end)
    }
}

/// A scene in the camera's coordinates, with its triangles sorted by the rows that they cover.
pub struct Visibility<'a> {
    scene: &'a Scene,
    raster: Raster,
    corners: Vec<Vec<Vector>>,
    balls: Vec<(u32, Vector, f64)>,
    bands: Vec<Vec<CandidateSurface>>,
    /// The smallest depth at which a surface is visible.
    near: f64,
}

#[derive(Clone, Copy)]
struct CandidateSurface {
    object: u32,
    triangle: u32,
    columns: (u32, u32),
    rows: (u32, u32),
}

impl<'a> Visibility<'a> {
    /// Sorts a scene's triangles, which must lie in a ball of radius `size`. A surface nearer to the camera than a millionth of
    /// `size` is not visible.
    pub fn new(scene: &'a Scene, camera: &Camera, raster: Raster, size: f64) -> Self {
        let mut visibility = Self {
            scene,
            raster,
            corners: Vec::new(),
            balls: Vec::new(),
            bands: vec![Vec::new(); raster.rows.div_ceil(BAND)],
            near: size * 1e-6,
        };
        for (object, thing) in (0..).zip(&scene.objects) {
            let mut corners = Vec::new();
            match &thing.shape {
                Shape::Ball { middle, radius } => {
                    visibility.balls.push((object, camera.place(*middle), *radius));
                }
                Shape::Mesh(mesh) => {
                    let points = mesh.positions.par_iter();
                    corners = points.map(|&point| camera.place(point)).collect();
                }
            }
            visibility.corners.push(corners);
            visibility.sort(object);
        }
        visibility
    }

    fn sort(&mut self, object: u32) {
        let Shape::Mesh(mesh) = &self.scene.objects[object as usize].shape else {
            return;
        };
        let candidates: Vec<Option<CandidateSurface>> = (0..mesh.triangles.len() as u32)
            .into_par_iter()
            .map(|triangle| self.candidate(object, triangle))
            .collect();
        for candidate in candidates.into_iter().flatten() {
            let (first, end) = candidate.rows;
            for band in first as usize / BAND..(end as usize).div_ceil(BAND) {
                self.bands[band].push(candidate);
            }
        }
    }

    fn corners(&self, object: u32, triangle: u32) -> [Vector; 3] {
        match &self.scene.objects[object as usize].shape {
            Shape::Ball { .. } => [Vector::default(); 3],
            Shape::Mesh(mesh) => mesh.triangles[triangle as usize]
                .map(|corner| self.corners[object as usize][corner.position as usize]),
        }
    }

    /// Returns the rows and columns in which a triangle may be visible, or `None` if it lies behind the eye or beside the
    /// picture.
    fn candidate(&self, object: u32, triangle: u32) -> Option<CandidateSurface> {
        let corners = self.corners(object, triangle);
        let distances = corners.map(|corner| -corner.0[2]);
        if distances.iter().all(|&distance| distance <= self.near) {
            return None;
        }
        let Raster { columns: width, rows: height, half } = self.raster;
        let (columns, rows) = if distances.iter().all(|&distance| distance > self.near) {
            let mut low = [f64::INFINITY; 2];
            let mut high = [f64::NEG_INFINITY; 2];
            for corner in corners {
                let [x, y, z] = corner.0;
                for (axis, slope) in [x / -z, y / z].into_iter().enumerate() {
                    low[axis] = low[axis].min(slope);
                    high[axis] = high[axis].max(slope);
                }
            }
            (
                self.raster.span(low[0], high[0], half.0, width),
                self.raster.span(low[1], high[1], half.1, height),
            )
        } else {
            // The triangle reaches behind the eye, so it may be visible anywhere.
            ((0, width as u32), (0, height as u32))
        };
        if columns.0 >= columns.1 || rows.0 >= rows.1 {
            return None;
        }
        Some(CandidateSurface { object, triangle, columns, rows })
    }

    /// Returns the nearest surface at each sample of the rows from `first` to before `end`, row by row.
    pub fn rows(&self, first: usize, end: usize) -> Vec<Hit> {
        let width = self.raster.columns;
        let mut hits = vec![NOTHING; width * (end - first)];
        // The bands divide the whole picture, so the first and the last band may be only partly among these rows.
        let mut parts = Vec::new();
        let (mut rest, mut row) = (hits.as_mut_slice(), first);
        while row < end {
            let until = ((row / BAND + 1) * BAND).min(end);
            let (part, after) = rest.split_at_mut((until - row) * width);
            parts.push((row, part));
            (rest, row) = (after, until);
        }
        parts.into_par_iter().for_each(|(row, part)| self.band(row, part));
        hits
    }

    /// Finds the hits of a part of a band. `first` is the number of the first row of `hits`.
    fn band(&self, first: usize, hits: &mut [Hit]) {
        let width = self.raster.columns;
        let end = first + hits.len() / width;
        for candidate in &self.bands[first / BAND] {
            let corners = self.corners(candidate.object, candidate.triangle);
            let Some(planes) = Planes::new(corners) else {
                continue;
            };
            let (top, bottom) = candidate.rows;
            for row in first.max(top as usize)..end.min(bottom as usize) {
                let line = &mut hits[(row - first) * width..][..width];
                let (left, right) = (candidate.columns.0 as usize, candidate.columns.1 as usize);
                for (column, hit) in (left..right).zip(&mut line[left..right]) {
                    let ray = self.raster.ray(column, row);
                    if let Some((depth, weights)) = planes.meet(ray)
                        && depth > self.near
                        && depth < hit.depth
                    {
                        *hit = Hit {
                            depth,
                            object: candidate.object,
                            triangle: candidate.triangle,
                            weights,
                        };
                    }
                }
            }
        }
        for &(object, middle, radius) in &self.balls {
            for (at, hit) in hits.iter_mut().enumerate() {
                let ray = self.raster.ray(at % width, first + at / width);
                if let Some(depth) = meet_ball(ray, middle, radius)
                    && depth > self.near
                    && depth < hit.depth
                {
                    *hit = Hit { depth, object, ..NOTHING };
                }
            }
        }
    }
}

/// The three planes through the eye and an edge of a triangle.
struct Planes {
    normals: [Vector; 3],
    /// The triple product of the corners: six times the signed volume of the tetrahedron of eye and triangle.
    volume: f64,
}

impl Planes {
    /// Makes the planes. The corners are in the camera's coordinates. Returns `None` if the eye lies in the triangle's plane.
    fn new([a, b, c]: [Vector; 3]) -> Option<Self> {
        let normals = [b.cross(c), c.cross(a), a.cross(b)];
        let volume = a.dot(normals[0]);
        (volume != 0.0).then_some(Self { normals, volume })
    }

    /// Returns the depth at which a ray meets the triangle, with the barycentric weights of the second and the third corner.
    /// Returns `None` if the ray passes beside the triangle. The depth is negative if the triangle is behind the eye.
    #[inline]
    fn meet(&self, ray: Vector) -> Option<(f64, [f64; 2])> {
        let [a, b, c] = self.normals.map(|normal| ray.dot(normal));
        let inside = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
        if !inside {
            return None;
        }
        let sum = a + b + c;
        let depth = self.volume / sum;
        if depth.is_finite() { Some((depth, [b / sum, c / sum])) } else { None }
    }
}

/// Returns the depth at which a ray enters a ball, as a multiple of the ray, or `None` if the ray passes beside the ball. For
/// example, the ray (0, 0, −1) enters a ball of radius 2 around (0, 0, −5) at 3. The depth is negative if the ray enters the ball
/// behind the eye.
#[inline]
fn meet_ball(ray: Vector, middle: Vector, radius: f64) -> Option<f64> {
    let square = ray.dot(ray);
    let along = ray.dot(middle);
    let discriminant = along * along - square * (middle.dot(middle) - radius * radius);
    (discriminant >= 0.0).then(|| (along - discriminant.sqrt()) / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_is_met_with_its_weights() {
        let corners = [[0.0, 0.0, -2.0], [4.0, 0.0, -4.0], [0.0, 1.0, -1.0]].map(Vector);
        let planes = Planes::new(corners).unwrap();
        // The weights 1/4, 1/2 and 1/4 give the point (2, 1/4, −11/4). Its ray has z = −1.
        let point = Vector::new(2.0, 0.25, -2.75);
        let (depth, [b, c]) = planes.meet(point * (1.0 / 2.75)).unwrap();
        assert!(
            (depth - 2.75).abs() < 1e-14 && (b - 0.5).abs() < 1e-14 && (c - 0.25).abs() < 1e-14
        );
        assert!(planes.meet(Vector::new(-0.1, 0.1, -1.0)).is_none());
        // Behind the eye the depth is negative.
        assert!(planes.meet(point * -1.0).unwrap().0 < 0.0);
    }

    #[test]
    fn a_ball_is_met_in_front() {
        let depth = meet_ball(Vector::new(0.0, 0.0, -1.0), Vector::new(0.0, 0.0, -5.0), 2.0);
        assert_eq!(depth, Some(3.0));
        let beside = meet_ball(Vector::new(1.0, 0.0, -1.0), Vector::new(0.0, 0.0, -5.0), 2.0);
        assert_eq!(beside, None);
    }
}
