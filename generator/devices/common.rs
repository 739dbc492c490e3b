//! Keys that several devices share, so that one name means one thing everywhere.

use crate::base::fixed::Format;
use crate::config::{Config, Key, Problems};
use crate::hdl::blocks::colour::Colours;
use crate::hdl::blocks::line::{LineBlocks, OperandBlocks};
use crate::hdl::dsl::{Designer, Note, Operand, Signal, Step, Topic, end, step, valid};

use super::rounding;

/// The names of the roundings.
pub const ROUNDINGS: [&str; 2] = ["truncate", "nearest"];

/// `cosine.fraction`.
pub fn cosine_fraction() -> Key {
    Key::integer(
        "cosine.fraction",
        20,
        6..=24,
        "Fraction bits of the cosine operands; 1.0 is representable.",
    )
}

/// The operand `cos_gamma`, limited to 0 … 1.0, in the format of the keys `cosine`.
#[track_caller]
pub fn cosine<'d>(d: &'d Designer, config: &Config) -> Operand<'d> {
    let frac = config.integer("cosine.fraction") as i32;
    let format = Format { signed: config.flag("cosine.signed"), int: 1, frac };
    d.operand_clamped("cos_gamma", format, 0.0, 1.0)
        .doc("cosine of the angle between normal and half vector")
}

/// `cosine.signed`.
pub fn cosine_signed() -> Key {
    Key::flag("cosine.signed", false, "The cosine port has a sign bit; a negative cosine gives 0.")
}

/// `exponent.bits`.
pub fn exponent_bits() -> Key {
    Key::integer("exponent.bits", 10, 1..=12, "Bits of the specular exponent n.")
}

/// The operand `exponent`, of `exponent.bits` bits.
#[track_caller]
pub fn exponent<'d>(d: &'d Designer, config: &Config) -> Operand<'d> {
    let format = Format::unsigned(config.integer("exponent.bits") as i32, 0);
    d.operand("exponent", format).doc("specular exponent n")
}

/// `power`.
pub fn power() -> Key {
    Key::choice(
        "power",
        "16",
        &["2", "4", "8", "16"],
        "The power m: the larger, the closer to cos^n, and the more squarings.",
    )
}

/// log2 of `power`: how many squarings make it.
pub fn squarings(config: &Config) -> u32 {
    config.integer("power").ilog2()
}

/// `colour.bits`.
pub fn colour_bits() -> Key {
    Key::integer("colour.bits", 8, 1..=12, "Bits of a colour operand, and of an output.")
}

/// `colour.multipliers`.
pub fn colour_multipliers() -> Key {
    Key::choice(
        "colour.multipliers",
        "3",
        &["1", "3"],
        "Multipliers for f times the colours: one for each, or one for all, which takes three clocks a point more and saves DSP blocks. A pipeline has one for each.",
    )
    .only_when("architecture", "sequential")
    .joined_later()
}

/// The outputs of colours by as many multipliers as `colour.multipliers` says, and the microinstructions that make
/// them, which stand before the one with the result.
#[track_caller]
pub fn colour_products<'d>(config: &Config, colours: &Colours<'d>, f: Signal<'d>) -> Vec<Step> {
    let rounding = rounding(config, "output.rounding");
    if shares_multiplier(config) {
        return colours.outputs_in_turn(f, rounding);
    }
    colours.outputs(f, rounding);
    Vec::new()
}

/// The same with the microinstruction that has the result, which ends the microprogram.
#[track_caller]
pub fn colour_outputs<'d>(config: &Config, colours: &Colours<'d>, f: Signal<'d>) -> Vec<Step> {
    let mut steps = colour_products(config, colours, f);
    steps.push(step("result", [valid(), end()]));
    steps
}

/// Whether one multiplier makes the products with all colours.
fn shares_multiplier(config: &Config) -> bool {
    config.choice("colour.multipliers") == "1"
}

/// What a device says of writes while it is busy and of how long its outputs hold, where each colour has a
/// multiplier of its own behind the register that `follow` names, until `until`.
pub fn outputs_note(config: &Config, follow: &str, until: &str) -> Note {
    if shares_multiplier(config) {
        return Topic::Writes.note(
            "Writes while busy are ignored. One multiplier multiplies f by the colours, one after the other, and the \
             outputs are registers: they hold from valid until the next computation reaches the products.",
        );
    }
    Topic::Writes.note(format!(
        "Writes while busy are ignored. The outputs follow {follow} and the colour registers: they hold from valid \
         until a colour is written or the next computation {until}."
    ))
}

/// The keys of the operands of a device that has cos γ, n and colours.
pub fn operands() -> Vec<Key> {
    vec![cosine_fraction(), cosine_signed(), exponent_bits(), colour_bits(), colour_multipliers()]
}

/// The keys of f and of the outputs.
pub fn reflectance() -> Vec<Key> {
    vec![intensity_fraction(16), intensity_rounding(), output_rounding()]
}

/// `intensity.fraction`.
pub fn intensity_fraction(default: i64) -> Key {
    Key::integer(
        "intensity.fraction",
        default,
        6..=24,
        "Fraction bits of the reflectance f, which multiplies the colours.",
    )
}

/// `intensity.rounding`.
pub fn intensity_rounding() -> Key {
    Key::choice(
        "intensity.rounding",
        "truncate",
        &ROUNDINGS,
        "Rounding into the register that holds f.",
    )
}

/// `output.rounding`.
pub fn output_rounding() -> Key {
    Key::choice(
        "output.rounding",
        "nearest",
        &ROUNDINGS,
        "Rounding of the colour outputs to integers.",
    )
}

/// `angle.fraction`.
pub fn angle_fraction(default: i64) -> Key {
    Key::integer(
        "angle.fraction",
        default,
        4..=28,
        "Fraction bits of the angles, in right angles. A line adds up their rounding: one bit more halves its drift.",
    )
}

/// `line.stages`.
pub fn line_stages(choices: &'static [&'static str]) -> Key {
    Key::choice(
        "line.stages",
        "2",
        choices,
        "Clocks from a point's angle to its result: the fewest, or one for each memory and multiplier, at twice the frequency.",
    )
    .joined_later()
}

/// `table.address`.
pub fn table_address(default: i64) -> Key {
    Key::integer(
        "table.address",
        default,
        4..=14,
        "Address bits of a table of the cosine's power in ROM 12, over a right angle.",
    )
}

/// `length.bits`.
pub fn length_bits() -> Key {
    Key::integer(
        "length.bits",
        12,
        1..=12,
        "Bits of the line's length l; a line has up to 2^bits points.",
    )
}

/// `domain.exponent_min` and `domain.exponent_max`.
pub fn domain() -> Vec<Key> {
    let doc = "The smallest n for which the accuracy contract is stated.";
    let least = Key::integer("domain.exponent_min", 1, 0..=4095, doc);
    let doc = "The largest n for which the accuracy contract is stated.";
    vec![least, Key::integer("domain.exponent_max", 1000, 1..=4095, doc)]
}

/// The domain of n is not empty and fits the operand.
pub fn check_exponents(config: &Config, problems: &mut Problems) {
    let (min, max) = (config.integer("domain.exponent_min"), config.integer("domain.exponent_max"));
    let bits = config.integer("exponent.bits");
    if min > max {
        problems.push(
            "domain.exponent_min",
            format!("{min} is above domain.exponent_max, {max}"),
            format!("at most {max}"),
        );
    }
    if max >= 1 << bits {
        problems.push(
            "domain.exponent_max",
            format!("{max} does not fit the {bits} bits of the exponent"),
            format!("at most {}, or a larger exponent.bits", (1 << bits) - 1),
        );
    }
}

/// The most bits of a ROM: a megabit.
const ROM_LIMIT: i64 = 1 << 20;

/// The ROM with as many address bits and bits in a word as `size` says is not too large. `key` governs it.
pub fn check_rom_size(
    key: &str,
    rom: &str,
    (address, width): (i64, i64),
    remedy: &str,
    problems: &mut Problems,
) {
    let bits = width << address;
    if bits > ROM_LIMIT {
        problems.push(
            key,
            format!("{rom} would have 2^{address} entries of {width} bits, {bits} bits in all"),
            format!("{remedy}, for at most {ROM_LIMIT} bits"),
        );
    }
}

/// Every range of `key`, each a quarter of the one before it, has as many of the `bits` bits of 1 − cos as it is cut by. The
/// most bits that a segment is left with, up to a range that has too few.
pub fn check_segments(config: &Config, key: &str, bits: i64, problems: &mut Problems) -> i64 {
    let mut most = 0;
    for (range, &prefix) in (0i64..).zip(config.integers(key)) {
        let bits = (bits - 2 * range).max(0);
        if prefix > bits {
            problems.push(
                key,
                format!("range {range} has {bits} bits of 1 - cos, which cannot be cut into 2^{prefix} segments"),
                "fewer ranges or smaller entries, or a larger cosine.fraction".to_owned(),
            );
            break;
        }
        most = most.max(bits - prefix);
    }
    most
}

/// Seed 000's numbers of the accumulator that walks a line.
pub const LINE_BLOCKS: LineBlocks = LineBlocks {
    delta: OperandBlocks { inputs: (17, 18), register: 2 },
    start: OperandBlocks { inputs: (19, 20), register: 3 },
    length_inputs: (23, 24),
    counter: 5,
    adder: 6,
    mux: 7,
    register: 8,
    count: 34,
    select: 36,
    write: 37,
};
