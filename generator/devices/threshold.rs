//! `threshold` — UA 30041 (the prototype in seed 001): `(n/2·(cos γ − 1) + 1)²`, gated by a comparator
//! against ROM(n).
//!
//! The patent's blocks follow one another without a control block; two registers that it does not have cut the chain
//! so that no clock holds more than one multiplier before the outputs. Numbers count each kind of block, as the seed's
//! text does: register 1, adder 1, multiplier 1.

use crate::base::fixed::{Format, Overflow, Rounding, exp2};
use crate::config::{Config, Key, Problems, Schema};
use crate::hdl::blocks::colour::{ChannelBlocks, Colours};
use crate::hdl::dsl::{Designer, Rom, Signal, step};
use crate::hdl::netlist::About;

use super::{common, rounding};

/// The keys of the device.
pub fn schema() -> Schema {
    let own = vec![Key::integers(
        "visibility.levels",
        &[50],
        0..=10_000,
        1..=12,
        "The levels in ROM(n), in hundredths of an output unit: one for each octave of n (up to 1, 2 to 3, 4 to 7, ...), of which the last holds for all above. A smaller f is shown as 0.",
    )];
    Schema {
        device: "threshold",
        keys: [common::operands(), common::reflectance(), own, common::domain()].concat(),
        check,
    }
}

fn check(config: &Config, problems: &mut Problems) {
    common::check_exponents(config, problems);
    let most = 100 * ((1 << config.integer("colour.bits")) - 1);
    if let Some(level) = config.integers("visibility.levels").iter().find(|&&level| level >= most) {
        problems.push(
            "visibility.levels",
            format!(
                "{level} hundredths are as much as the largest output: nothing would be visible"
            ),
            format!("at most {}, or a larger colour.bits", most - 1),
        );
    }
}

/// The seed's numbers of the colour channels.
const CHANNELS: [ChannelBlocks; 3] = [channel(3), channel(4), channel(5)];

const fn channel(number: u16) -> ChannelBlocks {
    ChannelBlocks {
        inputs: (number, number),
        register: number,
        multiplier: number,
        output: number - 2,
    }
}

/// The device.
pub fn describe(d: &Designer, config: &Config) {
    let integer = |key: &str| config.integer(key) as i32;
    let f = Format::unsigned(0, integer("intensity.fraction"));
    let rounding_f = rounding(config, "intensity.rounding");
    d.about(about(config));

    let cos_gamma = common::cosine(d, config).block(1).inputs(1, 1).q();
    let exponent = common::exponent(d, config).block(2).inputs(2, 2).q();
    let colours = Colours::new(d, integer("colour.bits"), Some(CHANNELS));

    // From -1.0, where the parabola has its zero: the saturation of the product is the clamp.
    let scaled =
        d.register("scaled", Format::signed(0, f.frac)).doc("n/2*(cos gamma - 1), not below -1.0");
    let intensity = d.register("intensity", f).doc("the reflectance f: what the gates passed");

    let one = d.constant("one", 1.0, Format::unsigned(1, integer("cosine.fraction")));
    let adder1 = d.sub("adder1", cos_gamma, one).block(1).doc("cos gamma - 1.0");
    let half_n = exponent.shift_right(1).named("half_exponent").doc("n/2, by wiring");
    let multiplier1 = d.mul("multiplier1", adder1, half_n).block(1);
    scaled.takes(d.narrow(
        "multiplier1_rounded",
        multiplier1,
        scaled.format(),
        rounding_f,
        Overflow::Saturate,
    ));
    let one = d.constant("base_one", 1.0, Format::unsigned(1, f.frac));
    let adder2 = d.add("adder2", scaled.q(), one).block(2).doc("base of the square, 0 ... 1.0");
    let multiplier2 = d.mul("multiplier2", adder2, adder2).block(2);
    let square = d.narrow("square", multiplier2, f, rounding_f, Overflow::Saturate);
    intensity.takes(gates(d, config, cos_gamma, exponent, square));
    let outputs = common::colour_outputs(config, &colours, intensity.q());

    let steps = vec![
        step("operands; ROM(n) addressed", []),
        step("scaled <- n/2 * (cos gamma - 1)", [scaled.load()]),
        step("intensity <- (scaled + 1)^2, or 0 below ROM(n)", [intensity.load()]),
    ];
    d.microprogram(steps.into_iter().chain(outputs));
}

/// The square, or 0 where it is below ROM(n) or the surface faces away.
fn gates<'d>(
    d: &'d Designer,
    config: &Config,
    cos_gamma: Signal<'d>,
    exponent: Signal<'d>,
    square: Signal<'d>,
) -> Signal<'d> {
    let level = level_rom(d, config, exponent).out();
    let comparator =
        d.less("comparator", square, level).doc("the square is below the level of visibility");
    let visible = d.not("visible", comparator);
    let facing = d.any("facing", cos_gamma).doc("the surface faces the half vector");
    let pass = d.and("pass", facing, visible).doc("opens the gates");
    let zero = d.raw_constant("zero", 0, square.format());
    d.choose("gates", pass, [zero, square]).doc("block of keys: the square or 0")
}

fn level_rom<'d>(d: &'d Designer, config: &Config, exponent: Signal<'d>) -> Rom<'d> {
    let words: Vec<i128> = (0..1i64 << config.integer("exponent.bits"))
        .map(|n| level_word(config, hundredths(config, n)))
        .collect();
    let comments = (0i64..)
        .take(words.len())
        .map(|n| {
            let level = hundredths(config, n);
            format!("{}.{:02} units", level / 100, level % 100)
        })
        .collect();
    // As wide as f, so that the memory file can be exchanged for one of other levels.
    let format = Format::unsigned(0, config.integer("intensity.fraction") as i32);
    d.rom("levels", exponent, format, &words, true)
        .doc("the smallest f that is shown for an exponent n (the address)")
        .comments(comments)
}

/// The level for n: that of its octave.
fn hundredths(config: &Config, n: i64) -> i64 {
    let levels = config.integers("visibility.levels");
    let octave = n.max(1).ilog2() as usize;
    levels[octave.min(levels.len() - 1)]
}

/// The smallest word of f, but the largest word at most, whose product with the largest colour reaches a level.
fn level_word(config: &Config, hundredths: i64) -> i128 {
    let unit = 100 * ((1 << config.integer("colour.bits")) - 1);
    let words = 1i128 << config.integer("intensity.fraction");
    // 1.0 itself is no word.
    ((i128::from(hundredths) * words + unit - 1) / unit).min(words - 1)
}

fn about(config: &Config) -> About {
    About {
        device: "threshold".to_owned(),
        title: "Specular intensity by a parabola's square, above a level of visibility".to_owned(),
        formula: "out = colour * f, f = max(0, n/2 * (cos(gamma) - 1) + 1)^2; 0 where f < ROM(n)"
            .to_owned(),
        source: "UA 30041, the prototype in seed 001".to_owned(),
        notes: vec![
            "The seed multiplies by n; for cos^n to be approximated it must be n/2, which is wiring.".into(),
            "\"- 1\" and \"+ 1\" are 1.0 here. The seed's adder 1 adds all ones and its adder 2 a carry: an ulp \
             down and up, which stands for 1.0 only where numbers are modulo 1.0."
                .into(),
            "The seed does not say what ROM(n) holds: here it holds the smallest f that is shown. Nothing passes where \
             the base is negative, whose square would rise again."
                .into(),
            comparator_note(config).into(),
            "Cosines are limited to 0 ... 1.0 as they are written; cos gamma <= 0 gives 0.".into(),
            common::outputs_note(config, "register intensity", "has its result"),
        ],
    }
}

/// Whether the comparator ever matters beyond the clamp.
fn comparator_note(config: &Config) -> String {
    let frac = config.integer("intensity.fraction");
    let largest = (1i128 << config.integer("colour.bits")) - 1;
    let blocked = (0..1i64 << config.integer("exponent.bits"))
        .map(|n| level_word(config, hundredths(config, n)) - 1)
        .max()
        .unwrap_or(0)
        .max(0);
    let units = (blocked * largest) as f64 * exp2(-(frac as i32));
    let shown = match rounding(config, "output.rounding") {
        Rounding::Nearest => (units + 0.5).floor(),
        Rounding::Truncate => units.floor(),
    };
    if shown == 0.0 {
        format!(
            "The comparator changes no output: the largest f that it blocks is {units:.3} of a unit at the largest \
             colour, which rounds to 0 anyhow. All that is seen is the work of the clamp."
        )
    } else {
        format!(
            "The comparator is seen: it blocks up to {units:.3} units at the largest colour, so that an output goes \
             from {shown} to 0 at the rim of the highlight, where the clamp alone would let it fade."
        )
    }
}
