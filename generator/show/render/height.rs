//! Reads a height map from a PNG file, and computes its slopes, which tilt the normals of a surface (bump mapping).

use anyhow::{Context, Result, bail, ensure};
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

/// The largest width or height of a map, in pixels.
const LARGEST_SIDE: u32 = 8192;

/// The largest number of bytes that the decoder may use.
const MEMORY: usize = 512 << 20;

/// A height map, which is repeated in all directions, like tiles.
#[derive(Clone, Debug)]
pub struct Relief {
    width: usize,
    height: usize,
    /// The rise per pixel to the right and upward, for each pixel; from black to white the surface rises by 1.
    slopes: Vec<[f32; 2]>,
    /// The height of white above black, in the scene's unit.
    depth: f64,
    /// The number of copies of the map for each unit of the texture coordinates.
    repeat: f64,
}

impl Relief {
    /// Reads the contents of a PNG file. `depth` is the height of white above black, in the scene's unit. `repeat` is the number
    /// of copies of the map for each unit of the texture coordinates.
    ///
    /// # Errors
    ///
    /// Fails if the file is not a complete PNG, has colours or transparency, has more than 8192 pixels along a side, or needs too
    /// much memory.
    pub fn decode(png: &[u8], depth: f64, repeat: f64) -> Result<Self> {
        let limits = Limits { bytes: MEMORY };
        let mut decoder = Decoder::new_with_limits(std::io::Cursor::new(png), limits);
        decoder.set_transformations(Transformations::EXPAND);
        let mut reader = decoder.read_info().context("the file is not a PNG file")?;
        let (width, height) = (reader.info().width, reader.info().height);
        ensure!(
            width <= LARGEST_SIDE && height <= LARGEST_SIDE,
            "the picture has {width}x{height} pixels; at most {LARGEST_SIDE}x{LARGEST_SIDE} are possible"
        );
        let (colour, bits) = reader.output_color_type();
        let kind = match colour {
            ColorType::Grayscale => "",
            ColorType::GrayscaleAlpha => "grey with transparency",
            ColorType::Rgb | ColorType::Rgba => "in colour",
            ColorType::Indexed => "in colour, from a palette",
        };
        if !kind.is_empty() {
            bail!("the picture is {kind}; a height map must be grey, with 1 to 16 bits");
        }
        let size =
            reader.output_buffer_size().context("the picture is too large for this machine")?;
        let mut bytes = vec![0; size];
        reader.next_frame(&mut bytes).context("the PNG file is not complete")?;
        let heights: Vec<f32> = match bits {
            BitDepth::Sixteen => bytes
                .chunks_exact(2)
                .map(|pair| f32::from(u16::from_be_bytes([pair[0], pair[1]])) / 65535.0)
                .collect(),
            _ => bytes.iter().map(|&byte| f32::from(byte) / 255.0).collect(),
        };
        let (width, height) = (width as usize, height as usize);
        ensure!(heights.len() == width * height, "the PNG file is not complete");
        Ok(Self { slopes: slopes(&heights, width, height), width, height, depth, repeat })
    }

    /// Returns the surface's rise at the texture coordinates `u` and `v`, in units of the scene, per unit of u and of v. The rise
    /// is interpolated between the middles of pixels, so no edges are visible.
    pub fn rise(&self, u: f64, v: f64) -> [f64; 2] {
        let (width, height) = (self.width as f64, self.height as f64);
        // The first row is the upper edge, v = 1.
        let x = (u * self.repeat).rem_euclid(1.0) * width - 0.5;
        let y = (-v * self.repeat).rem_euclid(1.0) * height - 0.5;
        let (left, above) = (x.floor(), y.floor());
        let (right_share, below_share) = (x - left, y - above);
        let (column, row) = (left as i64, above as i64);
        let above_left = self.slope(column, row);
        let above_right = self.slope(column + 1, row);
        let below_left = self.slope(column, row + 1);
        let below_right = self.slope(column + 1, row + 1);
        let mut rise = [0.0; 2];
        for (axis, scale) in [width, height].into_iter().enumerate() {
            let above = between(above_left[axis], above_right[axis], right_share);
            let below = between(below_left[axis], below_right[axis], right_share);
            let slope = above + (below - above) * below_share;
            rise[axis] = slope * scale * self.repeat * self.depth;
        }
        rise
    }

    fn slope(&self, column: i64, row: i64) -> [f32; 2] {
        let column = column.rem_euclid(self.width as i64) as usize;
        let row = row.rem_euclid(self.height as i64) as usize;
        self.slopes[row * self.width + column]
    }
}

fn between(from: f32, to: f32, share: f64) -> f64 {
    let (from, to) = (f64::from(from), f64::from(to));
    from + (to - from) * share
}

/// Returns the rise per pixel to the right and upward: half the difference between the neighbours.
fn slopes(heights: &[f32], width: usize, height: usize) -> Vec<[f32; 2]> {
    let height_at = |column: usize, row: usize| heights[row % height * width + column % width];
    let mut slopes = Vec::with_capacity(heights.len());
    for row in 0..height {
        for column in 0..width {
            let right = height_at(column + 1, row) - height_at(column + width - 1, row);
            let up = height_at(column, row + height - 1) - height_at(column, row + 1);
            slopes.push([right / 2.0, up / 2.0]);
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_wrap_and_point_upward() {
        // 3 × 2 pixels.
        let slopes = slopes(&[0.0, 0.5, 1.0, 0.0, 0.0, 0.25], 3, 2);
        assert_eq!(slopes[0], [-0.25, 0.0]);
        assert_eq!(slopes[1], [0.5, 0.0]);
        let tall = super::slopes(&[1.0, 0.5, 0.0], 1, 3);
        assert_eq!(tall[1], [0.0, 0.5]);
    }

    #[test]
    fn the_rise_is_per_unit_of_texture() {
        let relief = Relief {
            width: 2,
            height: 1,
            slopes: vec![[0.25, 0.0], [0.5, 0.0]],
            depth: 0.5,
            repeat: 3.0,
        };
        // The middles of the first copy's pixels are at 1/12 and 3/12.
        let rise = |u| relief.rise(u, 0.7)[0];
        assert!((rise(1.0 / 12.0) - 0.25 * 2.0 * 3.0 * 0.5).abs() < 1e-12);
        assert!((rise(3.0 / 12.0 - 1.0) - 0.5 * 2.0 * 3.0 * 0.5).abs() < 1e-12);
        assert!((rise(2.0 / 12.0) - 0.375 * 3.0).abs() < 1e-12);
    }
}
