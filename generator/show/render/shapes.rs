//! Generates the triangle meshes of simple shapes: torus, ball and vase.

use std::f64::consts::{PI, TAU};

use anyhow::Result;

use super::mesh::{Mesh, RawCorner, SMOOTH};
use super::vector::Vector;

/// Makes a torus around the y axis. `major` is the distance from its middle to the tube's middle, and `minor` the tube's radius.
/// `steps` are the numbers of steps around the axis and around the tube.
///
/// # Errors
/// Fails if [`Mesh::new`] fails.
pub fn torus(major: f64, minor: f64, steps: [u32; 2]) -> Result<Mesh> {
    grid(steps, [true, true], |u, v| {
        let (around, across) = (u * TAU, v * TAU);
        let from_axis = major + minor * libm::cos(across);
        Vector::new(
            from_axis * libm::sin(around),
            minor * libm::sin(across),
            from_axis * libm::cos(around),
        )
    })
}

/// Makes a ball. `steps` are the numbers of steps around the y axis and from pole to pole.
///
/// # Errors
///
/// Fails if [`Mesh::new`] fails.
pub fn ball(middle: Vector, radius: f64, steps: [u32; 2]) -> Result<Mesh> {
    grid(steps, [true, false], |u, v| {
        let (around, down) = (u * TAU, v * PI);
        // The sine of π is not exactly 0 in f64, but the distance from the axis must be 0 at both poles.
        let from_axis = if v == 0.0 || v == 1.0 { 0.0 } else { radius * libm::sin(down) };
        let offset = Vector::new(
            from_axis * libm::sin(around),
            radius * libm::cos(down),
            from_axis * libm::cos(around),
        );
        middle + offset
    })
}

/// Makes a vase around the y axis with belly, neck and lip, open at the top, from y = −1 to y = 1. `steps` are the numbers of
/// steps around the axis and along the wall.
///
/// # Errors
/// Fails if [`Mesh::new`] fails.
pub fn vase(steps: [u32; 2]) -> Result<Mesh> {
    grid(steps, [true, false], |u, v| {
        // The first 0.6 of v go up the outside from the foot to the lip, and the rest goes down the inside.
        let wall = 0.035;
        let (height, inward) = match v {
            ..0.6 => (v / 0.6, 0.0),
            _ => ((1.0 - v) / 0.4, wall),
        };
        let height = if inward > 0.0 { height * (1.0 - wall) + wall } else { height };
        let radius = (vase_radius(height) - inward).max(0.0);
        let around = u * TAU;
        Vector::new(radius * libm::sin(around), 2.0 * height - 1.0, radius * libm::cos(around))
    })
}

/// Returns the outer radius of the vase at `height`, from 0 (the foot) to 1 (the lip).
fn vase_radius(height: f64) -> f64 {
    // The radius is 0 at the foot, so the vase has a closed bottom; the lip widens at the top.
    let foot = (height * 14.0).min(1.0);
    let foot = foot * (2.0 - foot);
    let belly = 0.36 + 0.27 * libm::sin(height * 5.1 - 0.35);
    let lip = 0.22 * libm::pow(height, 14.0);
    (foot * belly + lip).max(0.0)
}

/// Makes a mesh with the corners `at(u, v)` at evenly spaced u and v from 0 to 1. `steps` are the numbers of steps along u and v.
/// If `closed` is set for a direction, `at` must repeat in it, and the last corners are the first ones.
fn grid(steps: [u32; 2], closed: [bool; 2], at: impl Fn(f64, f64) -> Vector) -> Result<Mesh> {
    let [columns, rows] = steps;
    let mut positions = Vec::new();
    let mut textures = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            // In a closed direction, the last corner is computed at 0 and not at 1, so both ends have the same bits.
            let fraction = |at: u32, steps: u32, closed: bool| {
                f64::from(if closed { at % steps } else { at }) / f64::from(steps)
            };
            positions
                .push(at(fraction(column, columns, closed[0]), fraction(row, rows, closed[1])));
            textures
                .push([f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows)]);
        }
    }
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let corner = |right: u32, above: u32| {
                let at = (row + above) * (columns + 1) + column + right;
                RawCorner { position: at, normal: None, texture: Some(at) }
            };
            let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            // If a row is a single point, such as a pole, a cell of the grid is one triangle instead of two.
            let differ = |corners: &[RawCorner; 3]| {
                let [p, q, r] = corners.map(|corner| positions[corner.position as usize]);
                p != q && q != r && r != p
            };
            triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(differ));
        }
    }
    Mesh::new(positions, Vec::new(), textures, triangles, SMOOTH)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torus_has_the_normals_of_a_torus() {
        let mesh = torus(1.0, 0.25, [96, 48]).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.degenerate), (2 * 96 * 48, 0));
        for corner in mesh.triangles.iter().flatten() {
            let point = mesh.positions[corner.position as usize];
            let [x, _, z] = point.0;
            let ring = Vector::new(x, 0.0, z).unit().unwrap();
            let exact = (point - ring).unit().unwrap();
            let normal = mesh.normals[corner.normal as usize];
            assert!((normal - exact).length() < 0.01, "{point:?}: {normal:?}");
        }
    }
}
