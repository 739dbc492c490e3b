//! The hardware description of the device `threshold`, which computes f = (n/2·(c − 1) + 1)², or 0 if this square is below a
//! level ([symbols](crate#symbols)).
//!
//! The level comes from a table, ROM(n). f is also 0 for c ≤ 0, and where n/2·(c − 1) + 1 is negative. The source is the patent
//! UA 30041, which seed 001 cites. UA 30041 connects its blocks without a control block. This description adds two registers,
//! so that no clock contains more than one multiplier before the outputs. Each kind of block is numbered from 1, as in seed
//! 001.

use glint_base::fixed::{Format, Overflow, Rounding, exp2};
use glint_config::Config;
use glint_keys::threshold::Keys;
use glint_rtl::blocks::colour::ChannelBlocks;
use glint_rtl::dsl::{Designer, Rom, Signal, step};
use glint_rtl::netlist::About;

use super::common::{self, ColourProducts};

const CHANNELS: [ChannelBlocks; 3] = [channel(3), channel(4), channel(5)];

const fn channel(number: u16) -> ChannelBlocks {
    ChannelBlocks {
        inputs: (number, number),
        register: number,
        multiplier: number,
        output: number - 2,
    }
}

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let f = keys.f.format();
    let rounding_f = keys.f.rounding;
    d.about(about(&keys));

    let cos_gamma = common::cosine(d, &keys.operands.cosine).block(1).inputs(1, 1).q();
    let exponent = common::exponent(d, keys.operands.exponent_bits).block(2).inputs(2, 2).q();
    let colours = ColourProducts::new(d, &keys.operands.colours, Some(CHANNELS));

    // The format begins at −1.0, where the parabola has its zero, so that the saturation of the product is the clamp.
    let scaled =
        d.register("scaled", Format::signed(0, f.frac)).doc("n/2*(cos gamma - 1), not below -1.0");
    let intensity = d.register("intensity", f).doc("the reflectance f, the output of the gates");

    let one = d.constant("one", 1.0, Format::unsigned(1, keys.operands.cosine.fraction as i32));
    let adder1 = d.sub("adder1", cos_gamma, one).block(1).doc("cos gamma - 1.0");
    let half_n = exponent.shift_right(1).named("half_exponent").doc("n/2, by wiring");
    let multiplier1 = d.mul("multiplier1", adder1, half_n).block(1);
    let (name, format) = ("multiplier1_rounded", scaled.format());
    scaled.takes(d.narrow(name, multiplier1, format, rounding_f, Overflow::Saturate));
    let one = d.constant("base_one", 1.0, Format::unsigned(1, f.frac));
    let adder2 = d.add("adder2", scaled.q(), one).block(2).doc("base of the square, 0 ... 1.0");
    let multiplier2 = d.mul("multiplier2", adder2, adder2).block(2);
    let square = d.narrow("square", multiplier2, f, rounding_f, Overflow::Saturate);
    intensity.takes(gates(d, &keys, cos_gamma, exponent, square));
    let outputs = colours.results(intensity.q(), keys.f.output_rounding);

    let steps = vec![
        step("operands are written; ROM address <- n", []),
        step("scaled <- n/2 * (cos gamma - 1)", [scaled.load()]),
        step("intensity <- (scaled + 1)^2, or 0 below ROM(n)", [intensity.load()]),
    ];
    d.microprogram(steps.into_iter().chain(outputs));
}

/// Returns the square, or 0 if the square is below ROM(n) or the surface faces away.
fn gates<'d>(
    d: &'d Designer,
    keys: &Keys,
    cos_gamma: Signal<'d>,
    exponent: Signal<'d>,
    square: Signal<'d>,
) -> Signal<'d> {
    let level = level_rom(d, keys, exponent).out();
    let comparator =
        d.less("comparator", square, level).doc("1 if the square is below the level of visibility");
    let visible = d.not("visible", comparator);
    let facing = d.any("facing", cos_gamma).doc("1 if the surface faces the half vector");
    let pass = d.and("pass", facing, visible).doc("1 opens the gates");
    let zero = d.raw_constant("zero", 0, square.format());
    d.choose("gates", pass, [zero, square]).doc("block of keys: the square, or 0")
}

fn level_rom<'d>(d: &'d Designer, keys: &Keys, exponent: Signal<'d>) -> Rom<'d> {
    let words: Vec<i128> = (0..1i64 << keys.operands.exponent_bits)
        .map(|n| level_word(keys, hundredths(keys, n)))
        .collect();
    let comments = (0i64..)
        .take(words.len())
        .map(|n| {
            let level = hundredths(keys, n);
            format!("{}.{:02} units", level / 100, level % 100)
        })
        .collect();
    // The words are as wide as f, so that a memory file with other levels can replace this one.
    let format = keys.f.format();
    d.rom("levels", exponent, format, &words, true)
        .doc("the smallest f that is shown for an exponent n (the address)")
        .comments(comments)
}

/// Returns the level for the exponent n in hundredths of an output unit, by n's octave. n = 20 is in octave 4, from 16 to 31, and
/// n = 0 in octave 0. Octaves beyond the configured levels have the last level.
fn hundredths(keys: &Keys, n: i64) -> u32 {
    let levels = &keys.levels;
    let octave = n.max(1).ilog2() as usize;
    levels[octave.min(levels.len() - 1)]
}

/// Returns the smallest word of f whose product with the largest colour reaches a level in hundredths of an output unit, at most
/// the largest word. The level 100 gives 258 for colours of 8 bits and an f of 16 fraction bits.
fn level_word(keys: &Keys, hundredths: u32) -> i128 {
    let unit = 100 * ((1 << keys.operands.colours.bits) - 1);
    let words = 1i128 << keys.f.fraction;
    // 1.0 itself is no word of f.
    ((i128::from(hundredths) * words + unit - 1) / unit).min(words - 1)
}

fn about(keys: &Keys) -> About {
    About {
        device: "threshold".to_owned(),
        title: "Specular intensity by a parabola's square, above a level of visibility".to_owned(),
        formula: "out = colour * f, f = max(0, n/2 * (cos(gamma) - 1) + 1)^2; 0 where f < ROM(n)"
            .to_owned(),
        source: "UA 30041, the prototype in seed 001".to_owned(),
        notes: vec![
            "The source multiplies by n. An approximation of cos^n needs n/2, which is a shift by wiring.".into(),
            "\"- 1\" and \"+ 1\" are 1.0 here. In the source, adder 1 adds all ones and adder 2 adds a carry. \
             This subtracts and adds 1 ulp, which equals 1.0 only if numbers are modulo 1.0."
                .into(),
            "The source does not state the contents of ROM(n). Here it holds the smallest f that is shown. If \
             the base is negative, the gates stay closed, because its square would rise again."
                .into(),
            comparator_note(keys).into(),
            "Cosines are clamped to 0 ... 1.0 when they are written. The result is 0 for cos gamma <= 0.".into(),
            common::outputs_note(&keys.operands.colours, "register intensity", "has its result"),
        ],
    }
}

/// Returns a sentence for the device's page on whether the comparator changes any output beyond the clamp.
fn comparator_note(keys: &Keys) -> String {
    let largest = (1i128 << keys.operands.colours.bits) - 1;
    let blocked = (0..1i64 << keys.operands.exponent_bits)
        .map(|n| level_word(keys, hundredths(keys, n)) - 1)
        .max()
        .unwrap_or(0)
        .max(0);
    let units = (blocked * largest) as f64 * exp2(-(keys.f.fraction as i32));
    let shown = match keys.f.output_rounding {
        Rounding::Nearest => (units + 0.5).floor(),
        Rounding::Truncate => units.floor(),
    };
    if shown == 0.0 {
        format!(
            "The comparator changes no output: with the largest colour, the largest f that it blocks is \
             {units:.3} units, which would round to 0 without it. Only the clamp is visible."
        )
    } else {
        format!(
            "The comparator is visible: with the largest colour it blocks up to {units:.3} units. So at the \
             rim of the highlight an output drops from {shown} to 0, where the clamp alone would let it fade."
        )
    }
}
