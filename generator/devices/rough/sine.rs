//! ROM 18 of `rough`: the sine of a cosine, in one of two schemes.

use super::Formats;
use crate::base::fixed::Format;
use crate::hdl::blocks::segmented::{self, Entry, Segment, Segmentation, SegmentedFormats};
use crate::hdl::dsl::{Designer, Signal};
use crate::keys::rough::{Keys, Scheme};

/// ROM 18: sin = √(1 − cos²).
pub(super) fn sine_rom<'d>(
    d: &'d Designer,
    keys: &Keys,
    formats: &Formats,
    cosine: Signal<'d>,
) -> Signal<'d> {
    let fraction = keys.operands.cosine.fraction;
    if keys.scheme == Scheme::Direct {
        return direct_sine(d, keys, formats, cosine);
    }
    let one = d.constant("one", 1.0, Format::unsigned(1, fraction as i32));
    let complement = d.sub("complement", one, cosine).doc("1.0 - cos");
    let u = complement.shift_left(fraction as i32);
    let cut = Segmentation {
        operand_bits: fraction,
        segments: keys.segments.clone(),
        tail: None,
        packed: false,
    };
    let shape = SegmentedFormats {
        fraction: formats.sine.frac,
        slope_fraction: keys.slope_fraction as i32,
        synchronous: keys.synchronous,
    };
    let entry = |segment: Segment| sine_entry(segment, fraction, shape);
    segmented::interpolate(d, "sine", u, &cut, shape, entry, Some(18))
        .doc("sine of the addressed cosine")
}

/// The patent's own: one entry for each bucket of the cosine, the sine at its middle.
fn direct_sine<'d>(
    d: &'d Designer,
    keys: &Keys,
    formats: &Formats,
    cosine: Signal<'d>,
) -> Signal<'d> {
    let fraction = keys.operands.cosine.fraction;
    let bits = keys.address;
    let mut address = cosine.bits(fraction - bits, Format::unsigned(bits as i32, 0));
    if !formats.patent {
        // 1.0 has no bucket of its own: it reads the last one.
        let last = d.raw_constant("last_bucket", (1 << bits) - 1, address.format());
        address = d.choose("sine_address", cosine.bit(fraction), [address, last]);
    }
    let words: Vec<i128> = (0..1u32 << bits)
        .map(|bucket| {
            let x = (f64::from(bucket) + 0.5) / f64::from(1u32 << bits);
            formats.sine.quantise((1.0 - x * x).sqrt())
        })
        .collect();
    let rom = d
        .rom("sine", address, formats.sine, &words, keys.synchronous)
        .block(18)
        .doc(&format!("sine ({}) at the middle of a bucket of the cosine", formats.sine));
    rom.out().doc("sine of the addressed cosine")
}

/// The straight line through a segment of s(u) = √(1 − (1 − u)²) with the least error: the slope of
/// the chord, and the base that puts the error of the segment's points symmetrically about 0.
fn sine_entry(segment: Segment, fraction: u32, shape: SegmentedFormats) -> Entry {
    let one = f64::from(1u32 << fraction);
    let sine = |u: f64| {
        let x = (one - u) / one;
        (1.0 - x * x).max(0.0).sqrt()
    };
    let value = Format::unsigned(0, shape.fraction);
    let (from, length) = (segment.from as f64, segment.length as f64);
    if segment.length == 1 {
        return Entry { base: value.quantise(sine(from)), slope: 0 };
    }
    let scale = f64::from(1u32 << shape.slope_fraction);
    let slope = ((sine(from + length) - sine(from)) * scale + 0.5).floor();
    let residual = |at: f64| sine(from + at) - slope / scale * at / length;
    // Concave: the least residual is at an end, the greatest where the line is parallel.
    let last = length - 1.0;
    let least = residual(0.0).min(residual(last));
    let (mut low, mut high) = (0.0, last);
    while high - low > 2.0 {
        let (a, b) = ((low + (high - low) / 3.0).floor(), (high - (high - low) / 3.0).ceil());
        if residual(a) < residual(b) {
            low = a;
        } else {
            high = b;
        }
    }
    let middle = ((low + high) / 2.0).floor();
    let most = [low, middle, high].into_iter().map(residual).fold(f64::MIN, f64::max);
    Entry { base: value.quantise((least + most) / 2.0), slope: slope as i128 }
}
