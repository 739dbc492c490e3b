//! The keys of `rough`, and which of their combinations make a device.

use crate::config::{Config, Key, Problems, Schema};
use crate::devices::common;

/// The keys of the device.
pub fn schema() -> Schema {
    let exact = ("arithmetic", "exact");
    let segmented = ("sine.scheme", "segmented");
    let own = vec![
        Key::choice("arithmetic", "exact", &["exact", "patent"], "exact: numbers with an integer position. patent: numbers modulo 1.0, as in UA 60139."),
        Key::flag("clamp", true, "Clamp a negative n/2*(cos - 1) + 1 to 0; without it a ring appears around the highlight.").only_when(exact.0, exact.1),
        common::cosine_fraction(),
        common::cosine_signed().only_when(exact.0, exact.1),
        common::exponent_bits(),
        common::colour_bits(),
        common::colour_multipliers(),
        Key::integer("product.fraction", 22, 8..=28, "Fraction bits of registers 11 and 12, the products of cosines and of sines.").only_when(exact.0, exact.1),
        Key::choice("product.rounding", "truncate", &common::ROUNDINGS, "Rounding into registers 11 and 12.").only_when(exact.0, exact.1),
        common::intensity_fraction(16).only_when(exact.0, exact.1),
        common::intensity_rounding().only_when(exact.0, exact.1),
        common::output_rounding(),
        Key::choice("sine.scheme", "segmented", &["segmented", "direct"], "ROM 18: segments that shrink toward cos = 1, with interpolation; or one entry a bucket, as in the patent."),
        Key::integer("sine.fraction", 22, 8..=28, "Fraction bits of the sine.").only_when(exact.0, exact.1),
        Key::flag("sine.synchronous", true, "ROM 18 reads on the clock edge (block RAM) instead of at once (logic)."),
        Key::integer("sine.address", 12, 4..=16, "Address bits of the direct table.").only_when("sine.scheme", "direct"),
        Key::integers("sine.segments", &[6, 8, 7, 6, 5, 4, 3, 3, 2], 2..=10, 1..=11, "log2 of the segments for each factor of four of 1 - cos, from the top.").only_when(segmented.0, segmented.1),
        Key::integer("sine.slope_fraction", 18, 8..=28, "Fraction bits of the rise over a segment.").only_when(segmented.0, segmented.1),
    ];
    let deviation = Key::number(
        "domain.deviation",
        30.0,
        0.0..=90.0,
        "The largest angle between the normal and the perturbed normal, in degrees.",
    );
    Schema { device: "rough", keys: [own, common::domain(), vec![deviation]].concat(), check }
}

fn check(config: &Config, problems: &mut Problems) {
    common::check_exponents(config, problems);
    let cosine = config.integer("cosine.fraction");
    // No range of a key makes a net wider than 64 bits: the widest is n/2 * adder 15 with the point of the
    // square, 13 + 48 bits.
    if config.choice("arithmetic") == "patent" && config.integer("exponent.bits") < 2 {
        problems.push(
            "exponent.bits",
            "the patent's wiring of n/2 drops the only bit of n".to_owned(),
            "at least 2 with arithmetic = \"patent\"".to_owned(),
        );
    }
    let (fraction, product) = if config.choice("arithmetic") == "exact" {
        (config.integer("sine.fraction"), config.integer("product.fraction"))
    } else {
        (cosine, cosine)
    };
    if product > 2 * fraction.min(cosine) {
        problems.push(
            "product.fraction",
            format!("{product} fraction bits are more than the products have"),
            format!("at most {}", 2 * fraction.min(cosine)),
        );
    }
    if config.choice("sine.scheme") == "direct" {
        if config.integer("sine.address") > cosine {
            problems.push(
                "sine.address",
                "more address bits than the cosine has fraction bits".to_owned(),
                format!("at most {cosine}, or a larger cosine.fraction"),
            );
        }
        let remedy = "fewer address bits, or sine.scheme = \"segmented\"";
        let address = config.integer("sine.address");
        common::check_rom_size("sine.address", "ROM 18", (address, fraction), remedy, problems);
        return;
    }
    let most = common::check_segments(config, "sine.segments", cosine, problems);
    let rest = cosine - 2 * config.integers("sine.segments").len() as i64;
    if !(0..=12).contains(&rest) {
        problems.push(
            "sine.segments",
            format!("2^{rest} exact entries would remain below the last range"),
            "as many ranges as leave 0 to 12 bits of cosine.fraction, two bits a range".to_owned(),
        );
    }
    let slope = config.integer("sine.slope_fraction");
    if slope > fraction || most + slope < fraction {
        problems.push(
            "sine.slope_fraction",
            format!("{slope} fraction bits of the slope do not go with {fraction} of the sine"),
            format!("{} to {fraction}", (fraction - most).max(8)),
        );
    }
}
