//! Declares and checks configuration keys that several devices share, so that a key means the same in all of them.

use glint_base::fixed::{Format, Rounding, exp2};
use glint_config::{Key, Problems};

glint_config::keys! {
    /// The keys of the operand `cos_gamma`, the cosine of the angle γ between the surface normal and the half vector.
    pub struct Cosine {
        fraction: u32 = Key::integer("cosine.fraction", 20, 6..=24,
            "Number of fraction bits of the cosine operands, which can be 1.0."),
        signed: bool = Key::flag("cosine.signed", false,
            "Whether the cosine port has a sign bit. A negative cosine gives the result 0."),
    }
}

impl Cosine {
    /// Returns `u1.20` for `cosine.fraction = 20`, or `s1.20` with `cosine.signed`.
    pub fn format(&self) -> Format {
        Format { signed: self.signed, int: 1, frac: self.fraction as i32 }
    }

    /// Returns the raw value of the cosine 1.0, such as 1048576 for 20 fraction bits.
    pub fn one(&self) -> i64 {
        1 << self.fraction
    }

    /// Returns the value of the last bit of a cosine (an ulp), such as 2^−20.
    pub fn ulp(&self) -> f64 {
        exp2(-(self.fraction as i32))
    }

    /// Returns the raw cosine with which the device computes: `raw` limited to 0 … 1.0.
    #[inline]
    pub fn clamped(&self, raw: i64) -> i64 {
        raw.clamp(0, self.one())
    }

    /// Returns the real value of a raw cosine, limited to 0 … 1.0.
    #[inline]
    pub fn value(&self, raw: i64) -> f64 {
        self.clamped(raw) as f64 * self.ulp()
    }
}

glint_config::keys! {
    /// The keys of the colour operands, which the device multiplies by the reflectance f.
    pub struct ColourKeys {
        bits: u32 = colour_bits(),
        multipliers: u32 = Key::choice("colour.multipliers", "3", &["1", "3"],
            "Number of multipliers for f times the colours: one for each colour, or one for all colours. One \
             multiplier saves DSP blocks and takes three more clocks for each point. A pipeline has one for \
             each colour.")
            .only_when("architecture", "sequential").joined_later(),
    }
}

impl ColourKeys {
    /// Returns whether one multiplier computes the products of all colours one after the other. In every pipeline, each colour
    /// has its own.
    pub fn in_turn(&self) -> bool {
        self.multipliers == 1
    }

    /// Returns small keys for tests whose numbers a reader can follow by hand: colours of four bits.
    #[doc(hidden)]
    pub fn small() -> Self {
        Self { bits: 4, multipliers: 3 }
    }
}

glint_config::keys! {
    /// The keys of the operands that most highlight devices have.
    pub struct Operands {
        cosine: Cosine = Cosine::keys(),
        exponent_bits: u32 = exponent_bits(),
        colours: ColourKeys = ColourKeys::keys(),
    }
}

impl Operands {
    /// Returns `u10.0` for `exponent.bits = 10`.
    pub fn exponent_format(&self) -> Format {
        Format::unsigned(self.exponent_bits as i32, 0)
    }

    /// Returns small keys for tests whose numbers a reader can follow by hand: operands of four bits.
    #[doc(hidden)]
    pub fn small() -> Self {
        Self {
            cosine: Cosine { fraction: 4, signed: false },
            exponent_bits: 4,
            colours: ColourKeys::small(),
        }
    }
}

glint_config::keys! {
    /// The keys of the reflectance f, the factor by which a highlight device multiplies colours, and of the products.
    pub struct Intensity {
        fraction: u32 = intensity_fraction(16),
        rounding: Rounding = Key::rounding("intensity.rounding", "truncate",
            "Rounding mode of the register with f."),
        output_rounding: Rounding = output_rounding(),
    }
}

impl Intensity {
    /// Returns `u0.16` for `intensity.fraction = 16`.
    pub fn format(&self) -> Format {
        Format::unsigned(0, self.fraction as i32)
    }

    /// Returns small keys for tests whose numbers a reader can follow by hand: f has four bits.
    #[doc(hidden)]
    pub fn small() -> Self {
        let (rounding, output_rounding) = (Rounding::Truncate, Rounding::Nearest);
        Self { fraction: 4, rounding, output_rounding }
    }
}

glint_config::keys! {
    /// The specular exponents n for which a device's accuracy contract is stated.
    pub struct Domain {
        least: i64 = Key::integer("domain.exponent_min", 1, 0..=4095,
            "The smallest n of the accuracy contract."),
        most: i64 = Key::integer("domain.exponent_max", 1000, 1..=4095,
            "The largest n of the accuracy contract."),
    }
}

impl Domain {
    /// Returns the smallest and the largest exponent, both included.
    pub fn exponents(&self) -> (i64, i64) {
        (self.least, self.most)
    }

    /// Returns small keys for tests whose numbers a reader can follow by hand: all exponents with four bits except 0.
    #[doc(hidden)]
    pub fn small() -> Self {
        Self { least: 1, most: 15 }
    }
}

/// Makes the key `exponent.bits`, the width of the specular exponent n.
pub fn exponent_bits() -> Key {
    Key::integer("exponent.bits", 10, 1..=12, "Width of the specular exponent n.")
}

/// Makes the key `power`, the power m in the formulas of `cosine-power` and `lyon`.
pub fn power() -> Key {
    Key::choice(
        "power",
        "16",
        &["2", "4", "8", "16"],
        "The power m. A larger m is closer to cos^n and needs more squarings.",
    )
}

/// Makes the key `colour.bits`, the width of a colour operand and of an output.
pub fn colour_bits() -> Key {
    Key::integer("colour.bits", 8, 1..=12, "Width of the colour operands and of the outputs.")
}

/// Makes the key `intensity.fraction`, the number of fraction bits of the reflectance f.
pub fn intensity_fraction(default: i64) -> Key {
    Key::integer(
        "intensity.fraction",
        default,
        6..=24,
        "Number of fraction bits of the reflectance f, which multiplies the colours.",
    )
}

/// Makes the key `output.rounding`, the rounding of the colour outputs to integers.
pub fn output_rounding() -> Key {
    Key::rounding(
        "output.rounding",
        "nearest",
        "Rounding mode of the colour outputs, which are integers.",
    )
}

/// Makes the key `angle.fraction`, the number of fraction bits of an angle along a scan line, in right angles.
pub fn angle_fraction(default: i64) -> Key {
    Key::integer(
        "angle.fraction",
        default,
        4..=28,
        "Number of fraction bits of the angles, in right angles. The rounding errors of the angles add up \
         along a line; one more bit halves their sum.",
    )
}

/// Makes the key `table.address`, the number of address bits of a table of cosine powers over a right angle.
pub fn table_address(default: i64) -> Key {
    Key::integer(
        "table.address",
        default,
        4..=14,
        "Number of address bits of each table of cosine powers in ROM 12. A table covers one right angle.",
    )
}

/// Makes the key `length.bits`, the width of the operand that is the length of a scan line.
pub fn length_bits() -> Key {
    Key::integer(
        "length.bits",
        12,
        1..=12,
        "Width of the length of a line. A line has up to 2^bits points.",
    )
}

/// Makes the key `line.stages`, the number of clocks from the angle of a point on a scan line to its output. `choices` are the
/// allowed values.
pub fn line_stages(choices: &'static [&'static str]) -> Key {
    Key::choice(
        "line.stages",
        "2",
        choices,
        "Number of clocks from the angle of a point to its result: the fewest, or one clock for each memory \
         and multiplier, which doubles the frequency.",
    )
    .joined_later()
}

/// Checks that the smallest exponent n does not exceed the largest, and that an operand of `bits` bits can represent it: 8 bits
/// cannot represent n = 1000.
pub fn check_exponents(domain: &Domain, bits: u32, problems: &mut Problems) {
    let (min, max) = domain.exponents();
    if min > max {
        let message =
            format!("the smallest n, {min}, is above domain.exponent_max, which is {max}");
        problems.push(
            "domain.exponent_min",
            message,
            format!("set domain.exponent_min to at most {max}"),
        );
    }
    if max >= 1 << bits {
        let message = format!("the largest n, {max}, does not fit the {bits} bits of the exponent");
        let remedy = format!(
            "set domain.exponent_max to at most {}, or set a larger exponent.bits",
            (1 << bits) - 1
        );
        problems.push("domain.exponent_max", message, remedy);
    }
}

const ROM_LIMIT: i64 = 1 << 20;

/// Checks that a ROM has at most 2^20 bits. `address` is the number of its address bits, and `width` the width of an entry: 15
/// address bits allow entries of up to 32 bits. `key` governs the size, `rom` names the ROM, and `remedy` says how to make it
/// smaller.
pub fn check_rom_size(
    key: &str,
    rom: &str,
    (address, width): (u32, u32),
    remedy: &str,
    problems: &mut Problems,
) {
    let bits = i64::from(width) << address;
    if bits > ROM_LIMIT {
        let message =
            format!("{rom} would have 2^{address} entries of {width} bits, {bits} bits in all");
        problems.push(key, message, format!("{remedy}; the limit is {ROM_LIMIT} bits"));
    }
}

/// Checks the segments of a table over the distance 1 − cos γ, an operand of `bits` bits. Each range of the table is a quarter as
/// long as the preceding one, so range j has `bits` − 2·j operand bits. `segments` has the number of leading bits that select a
/// segment in each range, which must not exceed its operand bits. The check stops at the first problem, an error of `key`.
/// Returns the largest number of bits that remain in a segment up to there: 20 bits and segments of 6 and 5 bits give 14.
pub fn check_segments(segments: &[u32], key: &str, bits: u32, problems: &mut Problems) -> u32 {
    let mut most = 0;
    for (range, &prefix) in (0u32..).zip(segments) {
        let bits = bits.saturating_sub(2 * range);
        if prefix > bits {
            let message = format!(
                "range {range} has {bits} bits of 1 - cos, so it cannot have 2^{prefix} segments"
            );
            let remedy = "set fewer ranges, smaller entries or a larger cosine.fraction".to_owned();
            problems.push(key, message, remedy);
            break;
        }
        most = most.max(bits - prefix);
    }
    most
}
