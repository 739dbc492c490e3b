//! Builds the table of sines of the device `rough`, ROM 18 of the patent UA 60139, which gives √(1 − x²) for a cosine x. The key
//! `sine.scheme` chooses one entry for each bucket of cosines, as in the patent, or straight segments that become shorter toward
//! x = 1.

use super::Formats;
use glint_base::fixed::{Format, exp2};
use glint_keys::rough::{Keys, RomLayout};
use glint_rtl::blocks::segmented::{self, Segment, Segmentation, SegmentedFormats};
use glint_rtl::dsl::{Designer, Signal};

pub(super) fn sine_rom<'d>(
    d: &'d Designer,
    keys: &Keys,
    formats: &Formats,
    cosine: Signal<'d>,
) -> Signal<'d> {
    let fraction = keys.operands.cosine.fraction;
    if keys.scheme == RomLayout::Direct {
        return direct_sine(d, keys, formats, cosine);
    }
    let one = d.constant("one", 1.0, Format::unsigned(1, fraction as i32));
    let complement = d.sub("complement", one, cosine).doc("1.0 - cos");
    let u = complement.shift_left(fraction as i32);
    let cut = Segmentation { operand_bits: fraction, segments: keys.segments.clone() };
    let shape = SegmentedFormats {
        fraction: formats.sine.frac,
        slope_fraction: keys.slope_fraction as i32,
        synchronous: keys.synchronous,
    };
    let sine = |u: f64| {
        let x = 1.0 - u / exp2(fraction as i32);
        (1.0 - x * x).max(0.0).sqrt()
    };
    let entry = |segment: Segment| segmented::chord(segment, shape, sine);
    segmented::interpolate(d, "sine", u, &cut, shape, entry, Some(18))
        .doc("sine of the cosine that addresses the table")
}

/// Builds the table of the patent: an entry has the sine at the middle of its bucket of cosines.
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
        // 1.0 has no bucket of its own, so it reads the last bucket.
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
    rom.out().doc("sine of the cosine that addresses the table")
}
