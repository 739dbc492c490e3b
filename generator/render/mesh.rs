//! Triangle meshes.

use std::collections::HashMap;

use anyhow::{Result, bail, ensure};

use super::vector::Vector;

/// The most triangles, which keeps their numbers in 32 bits and their memory in gigabytes.
pub const MOST_TRIANGLES: usize = 20_000_000;

/// The largest coordinate: areas and their squares are still numbers.
const FARTHEST: f64 = 1e30;

/// Triangles with a normal and perhaps texture coordinates at each corner.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Points.
    pub positions: Vec<Vector>,
    /// Directions of length 1.
    pub normals: Vec<Vector>,
    /// Texture coordinates.
    pub textures: Vec<[f64; 2]>,
    /// Corners, as indices into these.
    pub triangles: Vec<[Corner; 3]>,
    /// Triangles without area that were left out.
    pub degenerate: usize,
}

/// A corner of a triangle: indices into the lists of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Of a position.
    pub position: u32,
    /// Of a normal.
    pub normal: u32,
    /// Of texture coordinates.
    pub texture: Option<u32>,
}

/// A corner as it is given: without a normal, one is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawCorner {
    /// Of a position.
    pub position: u32,
    /// Of a normal.
    pub normal: Option<u32>,
    /// Of texture coordinates.
    pub texture: Option<u32>,
}

impl Mesh {
    /// A mesh of what is given. Triangles without area are left out and counted; corners without a normal,
    /// or with one of length 0, get the mean of the normals of all triangles that meet in their position,
    /// weighted by area.
    ///
    /// # Errors
    /// No triangle with an area, or too many; numbers that are not finite, or coordinates beyond 10³⁰.
    pub fn new(
        positions: Vec<Vector>,
        mut normals: Vec<Vector>,
        textures: Vec<[f64; 2]>,
        triangles: Vec<[RawCorner; 3]>,
    ) -> Result<Self> {
        finite("vertex", &positions)?;
        finite("normal", &normals)?;
        let far = |position: &Vector| position.0.iter().any(|x| x.abs() > FARTHEST);
        if let Some(at) = positions.iter().position(far) {
            bail!("vertex {} is farther away than {FARTHEST:e}", at + 1);
        }
        if let Some(at) = textures.iter().position(|at| !at.iter().all(|x| x.is_finite())) {
            bail!("texture coordinate {} is not finite", at + 1);
        }
        ensure!(
            triangles.len() <= MOST_TRIANGLES,
            "there are {} triangles; at most {MOST_TRIANGLES} are possible",
            triangles.len()
        );
        let all = triangles.len();
        let area = |corners: &[RawCorner; 3]| {
            let [a, b, c] = corners.map(|corner| positions[corner.position as usize]);
            (b - a).cross(c - a)
        };
        let triangles: Vec<[RawCorner; 3]> =
            triangles.into_iter().filter(|corners| area(corners).unit().is_some()).collect();
        ensure!(all > 0, "there is no triangle");
        ensure!(!triangles.is_empty(), "all {all} triangles are without area");
        let given: Vec<Option<Vector>> = normals.iter().map(|normal| normal.unit()).collect();
        let smooth = smooth_normals(&positions, &triangles, area);
        let first_smooth = normals.len() as u32;
        for (normal, given) in normals.iter_mut().zip(&given) {
            *normal = given.unwrap_or_default();
        }
        normals.extend(smooth);
        let corner = |corner: RawCorner| {
            let usable = corner.normal.filter(|&at| given[at as usize].is_some());
            Corner {
                position: corner.position,
                normal: usable.unwrap_or(first_smooth + corner.position),
                texture: corner.texture,
            }
        };
        Ok(Self {
            degenerate: all - triangles.len(),
            triangles: triangles.iter().map(|corners| corners.map(corner)).collect(),
            positions,
            normals,
            textures,
        })
    }

    /// The position of each corner of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vector; 3] {
        self.triangles[triangle].map(|corner| self.positions[corner.position as usize])
    }

    /// Whether every corner has texture coordinates.
    pub fn is_textured(&self) -> bool {
        let mut corners = self.triangles.iter().flatten();
        corners.all(|corner| corner.texture.is_some())
    }

    /// The positions of all corners of all triangles.
    pub fn corner_positions(&self) -> impl Iterator<Item = Vector> {
        let corners = self.triangles.iter().flatten();
        corners.map(|corner| self.positions[corner.position as usize])
    }
}

fn finite(what: &str, vectors: &[Vector]) -> Result<()> {
    match vectors.iter().position(|vector| !vector.finite()) {
        Some(at) => bail!("{what} {} is not finite", at + 1),
        None => Ok(()),
    }
}

/// For each position the mean normal of the triangles that meet there, weighted by area. Positions with
/// the same coordinates are one.
fn smooth_normals(
    positions: &[Vector],
    triangles: &[[RawCorner; 3]],
    area: impl Fn(&[RawCorner; 3]) -> Vector,
) -> Vec<Vector> {
    let mut first = HashMap::with_capacity(positions.len());
    let same: Vec<u32> = positions
        .iter()
        .enumerate()
        .map(|(at, position)| {
            // −0.0 is 0.0.
            let key = position.0.map(|component| (component + 0.0).to_bits());
            *first.entry(key).or_insert(at as u32)
        })
        .collect();
    let mut sums = vec![Vector::default(); positions.len()];
    for corners in triangles {
        let area = area(corners);
        for corner in corners {
            let sum = &mut sums[same[corner.position as usize] as usize];
            *sum = *sum + area;
        }
    }
    // Where areas cancel, as on both sides of a sheet, any direction is as good as another.
    let anywhere = Vector::new(0.0, 0.0, 1.0);
    same.iter().map(|&at| sums[at as usize].unit().unwrap_or(anywhere)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(positions: [u32; 3]) -> [RawCorner; 3] {
        positions.map(|position| RawCorner { position, normal: None, texture: None })
    }

    #[test]
    fn normals_are_smooth_over_equal_positions() {
        // Two unit squares that meet in the line x = 0, z = 0, at right angles; the shared corners are
        // given twice.
        let v = Vector::new;
        let positions = vec![
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(-0.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.0, 0.0, -1.0),
        ];
        let triangles = vec![corners([0, 1, 2]), corners([3, 4, 5]), corners([0, 1, 1])];
        let mesh = Mesh::new(positions, Vec::new(), Vec::new(), triangles).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.degenerate), (2, 1));
        let normal = mesh.normals[mesh.triangles[0][0].normal as usize];
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // +z and −x.
        assert!((normal - v(-half, 0.0, half)).length() < 1e-15, "{normal:?}");
        assert_eq!(normal, mesh.normals[mesh.triangles[1][0].normal as usize]);
        assert_eq!(mesh.normals[mesh.triangles[0][1].normal as usize], v(0.0, 0.0, 1.0));
    }
}
