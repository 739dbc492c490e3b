//! Reads a mesh's geometry from a file in Wavefront's OBJ format.
//!
//! The reader takes vertices, normals, texture coordinates and faces, and ignores everything else, such as groups, materials and
//! curves.

use anyhow::{Context, Result, anyhow, bail, ensure};

use super::mesh::{Mesh, RawCorner};
use super::vector::Vector;

/// Parses a file. At corners without normals, edges of more than `crease` degrees are drawn as sharp.
///
/// # Errors
///
/// Fails with the line number if a coordinate is missing or not a finite number. Fails with the line number if a face has less
/// than three corners, or if a corner does not exist. Fails without a line number if [`Mesh::new`] fails.
pub fn parse(text: &str, crease: f64) -> Result<Mesh> {
    let mut read = ObjReader::default();
    for (number, line) in text.lines().enumerate() {
        read.line(line).with_context(|| format!("line {}", number + 1))?;
    }
    Mesh::new(read.positions, read.normals, read.textures, read.triangles, crease)
}

#[derive(Default)]
struct ObjReader {
    positions: Vec<Vector>,
    normals: Vec<Vector>,
    textures: Vec<[f64; 2]>,
    triangles: Vec<[RawCorner; 3]>,
}

impl ObjReader {
    fn line(&mut self, line: &str) -> Result<()> {
        let line = line.split('#').next().unwrap_or(line);
        let mut words = line.split_whitespace();
        match words.next() {
            // A weight or a colour may follow the three coordinates; the reader ignores it.
            Some("v") => self.positions.push(Vector(numbers("vertex", words)?)),
            Some("vn") => self.normals.push(Vector(numbers("normal", words)?)),
            Some("vt") => {
                // A texture of a curve has one coordinate, and a texture of a volume three. The reader takes u and v; a missing
                // v is 0.
                let [u] = numbers("texture coordinate", words.clone())?;
                let v = match words.nth(1) {
                    Some(word) => number(word)?,
                    None => 0.0,
                };
                self.textures.push([u, v]);
            }
            Some("f") => self.face(words)?,
            _ => {}
        }
        Ok(())
    }

    /// Adds a face of n corners as a fan of n − 2 triangles. For example, the face 1 2 3 4 becomes the triangles 1 2 3 and 1 3 4.
    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<()> {
        let corners: Vec<RawCorner> = words
            .map(|word| {
                self.corner(word).with_context(|| format!("`{word}` is not a corner of a face"))
            })
            .collect::<Result<_>>()?;
        ensure!(
            corners.len() >= 3,
            "a face has {} corners, but needs at least three",
            corners.len()
        );
        let fan = corners[1..].windows(2);
        self.triangles.extend(fan.map(|pair| [corners[0], pair[0], pair[1]]));
        Ok(())
    }

    /// Reads a corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`. For example, `3//1` has vertex 3 and normal 1.
    fn corner(&self, word: &str) -> Result<RawCorner> {
        let mut parts = word.split('/');
        let position = parts.next().unwrap_or_default();
        let mut optional = |what, count| match parts.next() {
            None | Some("") => Ok(None),
            Some(part) => index(part, what, count).map(Some),
        };
        let texture = optional("texture coordinate", self.textures.len())?;
        let normal = optional("normal", self.normals.len())?;
        ensure!(parts.next().is_none(), "the corner has more than two `/`");
        Ok(RawCorner {
            position: index(position, "vertex", self.positions.len())?,
            normal,
            texture,
        })
    }
}

fn numbers<'a, const N: usize>(
    what: &str,
    mut words: impl Iterator<Item = &'a str>,
) -> Result<[f64; N]> {
    let mut values = [0.0; N];
    for value in &mut values {
        let word = words.next();
        let word = word.ok_or_else(|| anyhow!("a {what} needs {N} numbers"))?;
        *value = number(word).with_context(|| format!("not a {what}"))?;
    }
    Ok(values)
}

fn number(word: &str) -> Result<f64> {
    let value: f64 = word.parse().map_err(|_| anyhow!("`{word}` is not a number"))?;
    ensure!(value.is_finite(), "`{word}` is not a finite number");
    Ok(value)
}

/// Returns an entry's index from its number `part` in the file, which has had `count` entries so far. Positive numbers count from
/// 1, and negative numbers count backward from the last entry. For example, with 4 entries `1` is index 0, and `-1` is index 3.
///
/// # Errors
///
/// Fails if `part` is not an integer, is 0, or denotes no entry so far. The message calls the entry `what`, for example `vertex`.
fn index(part: &str, what: &str, count: usize) -> Result<u32> {
    let given: i64 = part.parse().map_err(|_| anyhow!("`{part}` is not an integer"))?;
    let index = match given {
        0 => bail!("there is no {what} 0: the numbers begin at 1"),
        1.. => given - 1,
        _ => count as i64 + given,
    };
    match u32::try_from(index) {
        Ok(index) if (index as usize) < count => Ok(index),
        _ => bail!("there is no {what} {given}: {count} were declared before this line"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::mesh::CREASE;

    const SQUARE: &str =
        "v 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0 # last\nvn 0 0 2\nvt 0 0\nvt 1\n";

    fn message(text: &str) -> String {
        format!("{:#}", parse(text, CREASE).unwrap_err())
    }

    #[test]
    fn faces_of_all_kinds() {
        let mesh = parse(
            &format!("{SQUARE}o one\nusemtl none\nf 1 2/1 3//1 -1/2/1\r\nl 1 2 3 4\n"),
            CREASE,
        )
        .unwrap();
        assert_eq!(mesh.triangles.len(), 2);
        let [a, b, c] = mesh.triangles[0];
        assert_eq!([a.position, b.position, c.position], [0, 1, 2]);
        assert_eq!([a.texture, b.texture, c.texture], [None, Some(0), None]);
        assert_eq!(c.normal, 0);
        assert_eq!(mesh.normals[0], Vector::new(0.0, 0.0, 1.0));
        assert_eq!(mesh.normals[a.normal as usize], Vector::new(0.0, 0.0, 1.0));
        let [_, _, d] = mesh.triangles[1];
        assert_eq!((d.position, d.texture, d.normal), (3, Some(1), 0));
        assert!(!mesh.is_textured());
    }

    #[test]
    fn mistakes_have_their_line() {
        for (text, expected) in [
            ("v 0 0\n", "line 1: a vertex needs 3 numbers"),
            ("\nv 0 0 x\n", "line 2: not a vertex: `x` is not a number"),
            ("v 0 0 nan\n", "line 1: not a vertex: `nan` is not a finite number"),
            ("vn 0 inf 0\n", "line 1: not a normal: `inf` is not a finite number"),
        ] {
            assert_eq!(message(text), expected);
        }
        for (face, expected) in [
            ("f 1 2", "a face has 2 corners, but needs at least three"),
            (
                "f 1 2 5",
                "`5` is not a corner of a face: there is no vertex 5: 4 were declared before this line",
            ),
            ("f 1 2 -5", "there is no vertex -5"),
            ("f 0 1 2", "there is no vertex 0: the numbers begin at 1"),
            ("f 1 2 3//2", "there is no normal 2: 1 were declared before this line"),
            ("f 1 2 3/1/1/1", "the corner has more than two `/`"),
            ("f 1 2 three", "`three` is not an integer"),
            ("f 1 2 99999999999999999999", "is not an integer"),
        ] {
            let found = message(&format!("{SQUARE}{face}\n"));
            assert!(found.starts_with("line 8: "), "{found}");
            assert!(found.contains(expected), "{found}");
        }
        assert_eq!(message(""), "the mesh has no triangle");
        assert_eq!(message(&format!("{SQUARE}f 1 1 2\n")), "all 1 triangles have no area");
    }
}
