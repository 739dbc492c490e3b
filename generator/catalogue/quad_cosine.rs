//! The hardware description of the device `quad-cosine`, which computes f = cosᵏ(√(n/k)·δ) for the points of a scan line.
//!
//! δ is the angle at a point of the line, and n the specular exponent. Decoder 10 chooses k from n: 1 for n = 1, 2 for n = 2, 4
//! for n = 3 to 6, and 16 for all other n. f is 0 if δ does not lie from −90° (included) to 90°, or if √(n/k)·|δ| is 90° or
//! more. The source is [seed 000](crate#symbols), whose figure numbers the blocks and outputs. The patent's control unit, block
//! 14, consists of triggers (flip-flops); Glint replaces them by a microprogram with the same order of events.
//!
//! Output 37 (`write_angle`) writes the angle of a point into register 8. The output `valid` is a copy of output 37, delayed
//! until the result of the point is ready. With the default key `line.stages` = 2 the delay is two clocks: one for register 8,
//! and one for ROM 12, which is synchronous like ROM 9. With `line.stages` = 7 five more registers lie between register 8 and
//! the output. Registers behind the outputs (`output.registered`) add another clock.

use glint_base::fixed::Format;
use glint_config::Config;
use glint_keys::quad_cosine::Keys;
use glint_rtl::blocks::angle;
use glint_rtl::blocks::colour::{ChannelBlocks, Colours};
use glint_rtl::blocks::line::Line;
use glint_rtl::dsl::{Designer, Signal};
use glint_rtl::netlist::{About, Topic};

use super::common;

/// The powers k, in the order of ROM 12's tables and of the decoder's outputs 30 to 33.
const POWERS: [u32; 4] = [1, 2, 4, 16];

/// The numbers of the amplitude's blocks in the patent's figure.
pub(super) const AMPLITUDE: ChannelBlocks =
    ChannelBlocks { inputs: (15, 16), register: 1, multiplier: 13, output: 27 };

pub fn describe<'d>(d: &'d Designer, config: &Config) {
    let keys = Keys::of(config);
    let table = keys.table_address as i32;
    let f = keys.f_format();
    // The registers after the magnitude and the root, after multiplier 11, after the address and the word of ROM 12, and after
    // multiplier 13.
    let staged = keys.stages == 7;
    let held =
        |name: &str, source: Signal<'d>| if staged { d.pipeline(name, source) } else { source };
    d.about(about(keys.stages));

    let colours = Colours::amplitude(d, keys.colour_bits as i32, Some(AMPLITUDE));
    let line =
        Line::new(d, keys.angle_format(), keys.length_bits as i32, Some(common::LINE_BLOCKS));
    let exponent = common::exponent(d, keys.exponent_bits).block(4).inputs(21, 22).q();

    let root = d
        .rom("root", exponent, root_format(&keys), &roots(&keys), true)
        .block(9)
        .doc("sqrt(n/k), where decoder 10 selects k for n; the address is n")
        .comments(
            (0..1i64 << keys.exponent_bits)
                .map(|n| format!("sqrt({n}/{})", POWERS[power_of(n)]))
                .collect(),
        );
    let folded = angle::fold(d, line.angle(), keys.angle_multiplied as i32);
    let magnitude = held("angle_magnitude_held", folded.magnitude);
    let within = held("angle_within_held", folded.within);
    let scaled = d
        .mul("scaled_angle", magnitude, held("root_held", root.out()))
        .block(11)
        .doc("sqrt(n/k) * |angle|, in right angles");
    let (scaled, within) = (held("scaled_angle_held", scaled), held("scaled_within_held", within));
    let step = angle::address(d, "table_step", scaled, within, table);
    let address = d
        .concat("table_address", decoder(d, exponent), step)
        .doc("the number of the table, and the address in it");
    let address = held("table_address_held", address);
    let words: Vec<i128> =
        POWERS.iter().flat_map(|&power| angle::cosine_power_table(power, table, f.frac)).collect();
    let comments = POWERS.iter().flat_map(|&power| angle::step_comments(power, table)).collect();
    let cosine = d
        .rom("cosine", address, f, &words, true)
        .block(12)
        .doc(&format!(
            "four tables, cos^k for k = 1, 2, 4, 16, each at 2^{table} angles of a right angle"
        ))
        .comments(comments);
    let rounding = keys.output_rounding;
    if staged {
        colours.outputs_staged(d.pipeline("cosine_held", cosine.out()), rounding);
    } else {
        colours.outputs(cosine.out(), rounding);
    }
    // The clocks of register 8 and ROM 12, and of the registers between them.
    line.microprogram(keys.stages);
}

/// Builds decoder 10, and returns which of its outputs 30 to 33 is 1, counted from 0.
fn decoder<'d>(d: &'d Designer, exponent: Signal<'d>) -> Signal<'d> {
    let constant = |name: &str, raw: i128| d.raw_constant(name, raw, exponent.format());
    let first = constant("first_exponent", 1);
    let second = constant("second_exponent", 2);
    let high = constant("high_exponents", 7);
    let power_1 = d.equal("power_1", exponent, first).doc("output 30 of decoder 10: n = 1");
    let power_2 = d.equal("power_2", exponent, second).doc("output 31 of decoder 10: n = 2");
    let above_2 = d.less("above_2", second, exponent);
    let below_7 = d.less("below_7", exponent, high);
    let power_4 = d.and("power_4", above_2, below_7).doc("output 32 of decoder 10: n = 3 to 6");
    let small = d.or("power_1_or_2", power_1, power_2);
    let small = d.or("power_below_16", small, power_4);
    let power_16 = d.not("power_16", small).doc("output 33 of decoder 10: n = 0, and n from 7 on");
    let high = d.or("power_4_or_16", power_4, power_16);
    let low = d.or("power_2_or_16", power_2, power_16);
    d.concat("power_code", high, low).block(10).doc("the number of the decoder output that is 1")
}

/// Returns the index in `POWERS` for the exponent n: 2 for n = 5, whose power is 4.
fn power_of(n: i64) -> usize {
    match n {
        1 => 0,
        2 => 1,
        3..=6 => 2,
        _ => 3,
    }
}

fn roots(keys: &Keys) -> Vec<i128> {
    let format = Format::unsigned(8, keys.root_fraction as i32);
    (0..1i64 << keys.exponent_bits)
        .map(|n| format.quantise((n as f64 / f64::from(POWERS[power_of(n)])).sqrt()))
        .collect()
}

fn root_format(keys: &Keys) -> Format {
    let largest = roots(keys).into_iter().max().unwrap_or(0);
    Format::holding(0, largest, keys.root_fraction as i32)
}

fn about(stages: u32) -> About {
    About {
        device: "quad-cosine".to_owned(),
        title: "Specular intensity along a scan line by powers of a stretched cosine".to_owned(),
        formula: "out = amplitude * cos^k(sqrt(n/k) * angle), k = 1, 2, 4, 16 by n; angle = zeta_start + i * delta_zeta"
            .to_owned(),
        source: "Seed 000, the claimed device: quadruple cosine".to_owned(),
        notes: vec![
            "The unit of angles is the right angle: 1.0 is 90 degrees. The register holds one turn and wraps \
             around as angles do, so no line can overflow it. The intensity is 0 if the angle is below -90 \
             degrees, or 90 degrees or more, or if the size of the stretched angle is 90 degrees or more."
                .into(),
            Topic::Latency.note(format!(
                "A start computes length + 1 points, one per clock. valid is high for each point. Output 37 \
                 (write_angle) writes the angle of a point. In the patent valid is the same net; here valid \
                 follows by {}. busy is high until the last point, and done is high together with the last \
                 point.",
                match stages {
                    2 => "two clocks, for register 8 and for the synchronous ROM 12".to_owned(),
                    stages => format!("{stages} clocks, because of the registers between"),
                }
            )),
            "Decoder 10 selects k = 1 for n = 1, 2 for n = 2, 4 for n = 3 to 6, and 16 for all other n. This \
             includes n = 0, whose root is 0: its intensity is the amplitude wherever the surface faces the \
             half vector. In the patent, the decoder outputs 30 to 33 drive four address bits of ROM 12. Here \
             the number of the output drives two address bits, so the ROM is a quarter as large. The patent \
             has nine bits for n, which cannot hold 1000; here n has ten bits."
                .into(),
            "In the patent, a strobe writes counter 5, and a line uses the count up. Here the operand length \
             keeps its value and loads the counter at the first point, so a start alone repeats the line. A \
             length of 0 gives one point: the microprogram skips the addition, as the borrow from an empty \
             counter does in the patent."
                .into(),
            "By default an angle has 26 fraction bits. Over the longest line, with 4095 intervals, the host's \
             roundings of delta_zeta and zeta_start add up to at most 2^11 ulps. The slope of the formula is \
             at most 30.6 per right angle (n = 1000). So with an amplitude of 255 the result drifts by at most \
             255 * 30.6 * 2^(11 - 26) = 0.24 units. With the contract's 0.93 units and half a unit for the \
             rounding of the amplitude, the error against the host's unrounded numbers is at most 1.67 units. \
             The accumulator adds exactly; only multiplier 11 drops bits."
                .into(),
            "Only multiplier 11 applies the root sqrt(n/k). The formulas (13) and (16) of the source apply it \
             to the operands a second time. Output 28 is busy, which trigger 39 drives high from start to the \
             end."
                .into(),
            "Writes while busy are ignored. The output depends on the operand registers of amplitude and \
             exponent: it keeps its value from valid until one of them is written or the next computation \
             starts."
                .into(),
        ],
    }
}
