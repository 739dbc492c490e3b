//! Defines triangle meshes with normals and texture coordinates, and computes normals that are missing. A computed normal is the
//! mean over the triangles around a corner that no sharp edge separates from the corner's triangle.

use std::collections::HashMap;

use anyhow::{Result, bail, ensure};

use super::vector::Vector;

/// The largest number of triangles. It keeps indices in 32 bits and memory in gigabytes.
pub const MOST_TRIANGLES: usize = 20_000_000;

/// The default angle, in degrees, beyond which an edge of a mesh without normals is drawn as sharp.
pub const CREASE: f64 = 40.0;

/// The angle, in degrees, at which no edge is drawn as sharp.
pub const SMOOTH: f64 = 180.0;

/// The largest absolute value of a coordinate, with which the areas of triangles and their squares are finite.
const FARTHEST: f64 = 1e30;

/// A mesh of triangles. Every corner has a normal, and may have texture coordinates.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The corners' positions, in coordinates of the scene.
    pub positions: Vec<Vector>,
    /// The normals, of length 1.
    pub normals: Vec<Vector>,
    pub textures: Vec<[f64; 2]>,
    /// The triangles. Their corners are indices into the lists above.
    pub triangles: Vec<[Corner; 3]>,
    /// The number of triangles without area that were left out.
    pub degenerate: usize,
}

/// A corner of a triangle: indices into the lists of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    pub position: u32,
    pub normal: u32,
    pub texture: Option<u32>,
}

/// A corner in a file, perhaps without a normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawCorner {
    pub position: u32,
    pub normal: Option<u32>,
    pub texture: Option<u32>,
}

impl Mesh {
    /// Makes a mesh, without triangles that have no area. Panics if an index of a corner does not exist.
    ///
    /// A corner without a normal, or with a normal of length 0, gets the mean normal of the triangles that meet at its
    /// position. Their areas weight the mean. The mean includes only triangles that are connected to the corner's own triangle
    /// there by edges of at most `crease` degrees. For example, a cube without normals keeps its edges of 90 degrees at a
    /// `crease` of 40, and looks round at 90.
    ///
    /// # Errors
    /// Fails if no triangle has an area, or if there are more than 20 million triangles. Fails if a number is not finite, or if
    /// a coordinate is beyond ±10³⁰.
    pub fn new(
        positions: Vec<Vector>,
        mut normals: Vec<Vector>,
        textures: Vec<[f64; 2]>,
        triangles: Vec<[RawCorner; 3]>,
        crease: f64,
    ) -> Result<Self> {
        finite("vertex", &positions)?;
        finite("normal", &normals)?;
        for (at, position) in positions.iter().enumerate() {
            let is_far = position.0.iter().any(|x| x.abs() > FARTHEST);
            ensure!(!is_far, "vertex {} is farther away than {FARTHEST:e}", at + 1);
        }
        for (at, [u, v]) in textures.iter().enumerate() {
            let is_finite = u.is_finite() && v.is_finite();
            ensure!(is_finite, "texture coordinate {} is not finite", at + 1);
        }
        ensure!(
            triangles.len() <= MOST_TRIANGLES,
            "there are {} triangles; at most {MOST_TRIANGLES} are possible",
            triangles.len()
        );
        let all = triangles.len();
        let mut kept = triangles;
        kept.retain(|corners| area_vector(&positions, corners).unit().is_some());
        ensure!(all > 0, "the mesh has no triangle");
        ensure!(!kept.is_empty(), "all {all} triangles have no area");
        // A normal of length 0 gives `None`.
        let given: Vec<Option<Vector>> = normals.iter().map(|normal| normal.unit()).collect();
        let is_complete =
            kept.iter().flatten().all(|corner| usable_normal(corner, &given).is_some());
        let computed = if is_complete {
            Vec::new()
        } else {
            let areas: Vec<Vector> =
                kept.iter().map(|corners| area_vector(&positions, corners)).collect();
            creased_normals(&positions, &kept, &areas, crease, &mut normals)
        };
        for (normal, given) in normals.iter_mut().zip(&given) {
            *normal = given.unwrap_or_default();
        }
        let mut triangles = Vec::with_capacity(kept.len());
        for (triangle, corners) in kept.iter().enumerate() {
            triangles.push([0, 1, 2].map(|at| Corner {
                position: corners[at].position,
                normal: match usable_normal(&corners[at], &given) {
                    Some(normal) => normal,
                    None => computed[3 * triangle + at],
                },
                texture: corners[at].texture,
            }));
        }
        Ok(Self { degenerate: all - kept.len(), triangles, positions, normals, textures })
    }

    #[inline]
    pub fn corners(&self, triangle: usize) -> [Vector; 3] {
        self.triangles[triangle].map(|corner| self.positions[corner.position as usize])
    }

    pub fn is_textured(&self) -> bool {
        let mut corners = self.triangles.iter().flatten();
        corners.all(|corner| corner.texture.is_some())
    }

    pub fn corner_positions(&self) -> impl Iterator<Item = Vector> {
        let corners = self.triangles.iter().flatten();
        corners.map(|corner| self.positions[corner.position as usize])
    }
}

/// Returns a normal of the triangle; its length is twice the area.
fn area_vector(positions: &[Vector], corners: &[RawCorner; 3]) -> Vector {
    let [a, b, c] = corners.map(|corner| positions[corner.position as usize]);
    (b - a).cross(c - a)
}

/// Returns the index of a corner's normal in the file, or `None` without a normal or if its length is 0.
fn usable_normal(corner: &RawCorner, given: &[Option<Vector>]) -> Option<u32> {
    corner.normal.filter(|&normal| given[normal as usize].is_some())
}

fn finite(what: &str, vectors: &[Vector]) -> Result<()> {
    match vectors.iter().position(|vector| !vector.finite()) {
        Some(at) => bail!("{what} {} is not finite", at + 1),
        None => Ok(()),
    }
}

/// Returns for each position the index of the first equal position. For example, the positions a, b, a, b give 0, 1, 0, 1.
fn first_of_same(positions: &[Vector]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let mut same = Vec::with_capacity(positions.len());
    for (at, position) in positions.iter().enumerate() {
        // Adding 0.0 turns −0.0 into 0.0, so both have the same bits.
        let key = position.0.map(|component| (component + 0.0).to_bits());
        same.push(*first.entry(key).or_insert(at as u32));
    }
    same
}

/// Computes the mean normals of [`Mesh::new`], and appends them to `normals`. Returns the index of the normal of every corner,
/// three for each triangle.
fn creased_normals(
    positions: &[Vector],
    triangles: &[[RawCorner; 3]],
    areas: &[Vector],
    crease: f64,
    normals: &mut Vec<Vector>,
) -> Vec<u32> {
    let same = first_of_same(positions);
    let point = |corner: usize| same[triangles[corner / 3][corner % 3].position as usize];
    // The indices of all corners, sorted by position. The corners at one position are in the order of their triangles.
    let mut corners: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    corners.sort_by_key(|&corner| point(corner as usize));
    let flat = libm::cos(crease.to_radians());
    let is_smooth = |a: u32, b: u32| {
        let a_normal = areas[a as usize / 3].unit().unwrap_or_default();
        let b_normal = areas[b as usize / 3].unit().unwrap_or_default();
        // The margin makes an edge of exactly `crease` degrees smooth even if rounding makes its angle slightly larger.
        a_normal.dot(b_normal) >= flat - 1e-12
    };
    let mut found = vec![0; corners.len()];
    let (mut edges, mut group) = (Vec::new(), Vec::new());
    for around in corners.chunk_by(|&a, &b| point(a as usize) == point(b as usize)) {
        // Each triangle has two edges at this position, which lead to its two other corners.
        edges.clear();
        for (at, &corner) in around.iter().enumerate() {
            let (triangle, own) = (corner as usize / 3 * 3, corner as usize % 3);
            for step in [1, 2] {
                edges.push((point(triangle + (own + step) % 3), at));
            }
        }
        edges.sort_unstable();
        group.clear();
        group.extend(0..around.len());
        for pair in edges.windows(2) {
            let [(to, a), (other, b)] = [pair[0], pair[1]];
            if to == other && is_smooth(around[a], around[b]) {
                let (a, b) = (root(&mut group, a), root(&mut group, b));
                group[a.max(b)] = a.min(b);
            }
        }
        let mut sums: Vec<(usize, Vector)> = Vec::new();
        let mut place = vec![0; around.len()];
        for (at, &corner) in around.iter().enumerate() {
            let area = areas[corner as usize / 3];
            let of = root(&mut group, at);
            if of == at {
                place[at] = sums.len();
                sums.push((corner as usize / 3, area));
            } else {
                place[at] = place[of];
                sums[place[of]].1 = sums[place[of]].1 + area;
            }
            found[corner as usize] = (normals.len() + place[at]) as u32;
        }
        for (triangle, sum) in &sums {
            // If the areas of opposite triangles cancel, the group takes the direction of its first triangle.
            let direction = sum.unit().or_else(|| areas[*triangle].unit());
            normals.push(direction.unwrap_or_default());
        }
    }
    found
}

/// Returns the smallest member of the group that contains `at`, as its representative (union-find), and shortens the path to
/// it.
fn root(group: &mut [usize], at: usize) -> usize {
    let mut root = at;
    while group[root] != root {
        group[root] = group[group[root]];
        root = group[root];
    }
    root
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
        let make = |crease| {
            let (positions, triangles) = (positions.clone(), triangles.clone());
            Mesh::new(positions, Vec::new(), Vec::new(), triangles, crease).unwrap()
        };
        let mesh = make(90.0);
        assert_eq!((mesh.triangles.len(), mesh.degenerate), (2, 1));
        let normal = mesh.normals[mesh.triangles[0][0].normal as usize];
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // +z and −x.
        assert!((normal - v(-half, 0.0, half)).length() < 1e-15, "{normal:?}");
        assert_eq!(normal, mesh.normals[mesh.triangles[1][0].normal as usize]);
        assert_eq!(mesh.normals[mesh.triangles[0][1].normal as usize], v(0.0, 0.0, 1.0));
        // The edge of 90 degrees stays sharp where only flatter ones are smooth.
        let sharp = make(89.0);
        for at in 0..3 {
            let normal =
                |triangle: usize| sharp.normals[sharp.triangles[triangle][at].normal as usize];
            assert_eq!((normal(0), normal(1)), (v(0.0, 0.0, 1.0), v(-1.0, 0.0, 0.0)));
        }
    }
}
