//! Defines pictures with 8 bits for each colour channel, and joins, captions, compares and writes them as PNG.

use anyhow::{Context, Result};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use png::{BitDepth, ColorType, Compression, Encoder, Filter};

use super::vector::Vector;

/// The height of a caption's letters.
const LETTERS: RasterHeight = RasterHeight::Size16;

/// The number of empty rows of pixels above a caption, and below it.
const AROUND: usize = 3;

/// The background colour of a caption, as red, green and blue.
const STRIP: [u8; 3] = [24, 26, 30];

/// The colour of a caption's letters.
const LETTER: [u8; 3] = [232, 233, 235];

/// A picture: rows of pixels, from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    pub width: u32,
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    pub fn new(width: u32) -> Self {
        Self { width, pixels: Vec::new() }
    }

    /// Returns the number of rows. The width must not be 0.
    pub fn height(&self) -> u32 {
        (self.pixels.len() / self.width as usize) as u32
    }

    /// Adds a strip of 22 rows below the picture with the caption in its middle. A caption that is too long is cut off.
    pub fn captioned(&self, caption: &str) -> Self {
        let letter = get_raster_width(FontWeight::Regular, LETTERS);
        let width = self.width as usize;
        let mut strip = vec![STRIP; width * (LETTERS.val() + 2 * AROUND)];
        let letters: Vec<char> = caption.chars().take(width / letter).collect();
        let left = (width - letters.len() * letter) / 2;
        for (at, &letter_of_caption) in letters.iter().enumerate() {
            let raster = get_raster(letter_of_caption, FontWeight::Regular, LETTERS);
            for (row, line) in raster.iter().flat_map(|raster| raster.rows().enumerate()) {
                let from = (AROUND + row) * width + left + at * letter;
                for (pixel, &ink) in strip[from..].iter_mut().zip(line) {
                    *pixel = mix(STRIP, LETTER, ink);
                }
            }
        }
        let mut captioned = self.clone();
        captioned.pixels.extend(strip);
        captioned
    }

    /// Joins pictures side by side. All must have the height of the first one. An empty list gives a picture without pixels.
    pub fn beside(pictures: &[&Self]) -> Self {
        let mut all = Self::new(pictures.iter().map(|picture| picture.width).sum());
        for row in 0..pictures.first().map_or(0, |picture| picture.height()) as usize {
            for picture in pictures {
                let width = picture.width as usize;
                all.pixels.extend(&picture.pixels[row * width..(row + 1) * width]);
            }
        }
        all
    }

    /// Returns the picture as a PNG file. The same pixels give the same bytes.
    ///
    /// # Errors
    ///
    /// Fails only through a bug, not through anything that a user gives.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, self.width, self.height());
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Balanced);
        encoder.set_filter(Filter::Adaptive);
        let mut writer = encoder.write_header().context("cannot encode PNG")?;
        writer.write_image_data(self.pixels.as_flattened()).context("cannot encode PNG")?;
        writer.finish().context("cannot encode PNG")?;
        Ok(bytes)
    }
}

/// Rounds each channel to the nearest integer, limited to 0 … 255. For example, 127.5 is 128, and 900 is 255.
#[inline]
pub fn pixel(colour: Vector) -> [u8; 3] {
    colour.0.map(|value| (value + 0.5).clamp(0.0, 255.0) as u8)
}

#[derive(Clone, Debug, PartialEq)]
pub struct PictureDifference {
    /// The largest difference of a colour channel, from 0 to 255.
    pub largest: u8,
    /// The peak signal-to-noise ratio in decibels over the pixels in `shown` ([`PictureDifference::new`]); `None` if the pictures
    /// are equal.
    pub psnr: Option<f64>,
    /// The factor by which [`PictureDifference::picture`] multiplies the differences to make them visible. For example, a
    /// largest difference of 30 has the factor 8.
    pub gain: u8,
    pub picture: Picture,
}

impl PictureDifference {
    /// Compares two pictures of the same size. `shown` says for each pixel whether it counts for the mean in the signal-to-noise
    /// ratio. All other pixels should be equal in both pictures.
    pub fn new(a: &Picture, b: &Picture, shown: &[bool]) -> Self {
        let pairs = a.pixels.iter().zip(&b.pixels);
        let differences: Vec<[u8; 3]> =
            pairs.map(|(a, b)| [0, 1, 2].map(|channel| a[channel].abs_diff(b[channel]))).collect();
        let channels = differences.as_flattened();
        let largest = channels.iter().copied().max().unwrap_or(0);
        let squares: u64 = channels.iter().map(|&d| u64::from(d) * u64::from(d)).sum();
        let counted = 3 * shown.iter().filter(|&&shown| shown).count().max(1);
        let mean = squares as f64 / counted as f64;
        // The largest power of two that keeps the largest difference below white.
        let gain = 1 << (255 / largest.max(1)).ilog2();
        Self {
            largest,
            psnr: (squares > 0).then(|| 10.0 * libm::log10(255.0 * 255.0 / mean)),
            gain,
            picture: Picture {
                width: a.width,
                pixels: differences
                    .into_iter()
                    .map(|pixel| pixel.map(|channel| channel * gain))
                    .collect(),
            },
        }
    }
}

/// Mixes two colours: `over` has the share `share`/255. For example, 255 over 0 with a share of 51 is 51.
fn mix(ground: [u8; 3], over: [u8; 3], share: u8) -> [u8; 3] {
    let share = u32::from(share);
    let channel = |at: usize| {
        let sum = u32::from(ground[at]) * (255 - share) + u32::from(over[at]) * share;
        ((sum + 127) / 255) as u8
    };
    [channel(0), channel(1), channel(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: [[u8; 3]; 2]) -> Picture {
        Picture { width: 1, pixels: pixels.to_vec() }
    }

    #[test]
    fn differences_are_measured_over_what_is_shown() {
        let a = picture([[10, 0, 255], [0; 3]]);
        let b = picture([[0, 30, 255], [0; 3]]);
        let difference = PictureDifference::new(&a, &b, &[true, false]);
        assert_eq!((difference.largest, difference.gain), (30, 8));
        assert_eq!(difference.picture.pixels, [[80, 240, 0], [0; 3]]);
        // 10·log₁₀(255²·3/1000).
        assert!((difference.psnr.unwrap() - 22.901_6).abs() < 1e-3);
        assert_eq!(PictureDifference::new(&a, &a, &[true, true]).psnr, None);
    }

    #[test]
    fn pixels_saturate() {
        assert_eq!(pixel(Vector::new(-3.0, 254.5, 900.0)), [0, 255, 255]);
        assert_eq!(pixel(Vector::new(0.49, 127.5, 254.49)), [0, 128, 254]);
    }

    #[test]
    fn a_caption_stands_below() {
        let plain = Picture { width: 40, pixels: vec![[9; 3]; 80] };
        let captioned = plain.captioned("I");
        assert_eq!((captioned.width, captioned.height()), (40, 2 + 22));
        assert_eq!(captioned.pixels[..80], plain.pixels);
        let lit = |picture: &Picture| -> Vec<usize> {
            let strip = picture.pixels[80..].iter().enumerate();
            strip.filter(|(_, pixel)| **pixel != STRIP).map(|(at, _)| at % 40).collect()
        };
        // A letter is drawn in the middle, and a blank leaves the background colour.
        let columns = lit(&captioned);
        assert!(!columns.is_empty() && columns.iter().all(|column| (14..26).contains(column)));
        assert_eq!(lit(&plain.captioned(" ")), Vec::<usize>::new());
        // A caption of 17 letters is cut off, and the strip keeps its size.
        assert_eq!(plain.captioned("IIIIIIIIIIIIIIIII").pixels.len(), captioned.pixels.len());
        assert_eq!(mix([0, 100, 200], [255, 100, 0], 51), [51, 100, 160]);
    }

    #[test]
    fn pictures_stand_beside_each_other() {
        let both = Picture::beside(&[&picture([[1; 3], [2; 3]]), &picture([[3; 3], [4; 3]])]);
        assert_eq!((both.width, both.height()), (2, 2));
        assert_eq!(both.pixels, [[1; 3], [3; 3], [2; 3], [4; 3]]);
    }
}
