//! The hardware description of the device `rough`, which computes f = (n/2·(cos(γ ± dγ) − 1) + 1)², the highlight of a rough
//! surface ([symbols](crate#symbols)).
//!
//! dγ is the deviation of the normal on a rough surface. The source is [seed 001](crate#symbols), whose figure has the block
//! numbers. Multiplier 10 computes four products in turn, and the select lines V1 and V2 choose its operands. The
//! microprogram equals table 1 of the patent, word by word. Only with one multiplier for all colours, or with output registers,
//! it has additional microinstructions. With the default key `arithmetic` = `"exact"`, f is 0 for cos γ ≤ 0. With the default
//! key `clamp` = true, f is also 0 where n/2·(cos(γ ± dγ) − 1) + 1 is negative.

mod sine;

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_config::{Config, Shared};
use glint_keys::rough::Keys;
use glint_rtl::blocks::colour::ChannelBlocks;
use glint_rtl::dsl::{Designer, Register, Signal, end, hold, step, valid};
use glint_rtl::netlist::{About, Note, Topic};

use super::common::{self, ColourProducts};
use sine::sine_rom;

const CHANNELS: [ChannelBlocks; 3] = [
    ChannelBlocks { inputs: (32, 33), register: 5, multiplier: 20, output: 40 },
    ChannelBlocks { inputs: (34, 35), register: 6, multiplier: 21, output: 41 },
    ChannelBlocks { inputs: (36, 37), register: 7, multiplier: 22, output: 42 },
];

/// The formats and roundings. With `patent`, all numbers are fractions modulo 1.0.
struct Formats {
    cosine: Format,
    sine: Format,
    cos_cos: Format,
    sin_sin: Format,
    result: Format,
    /// The low bits of register 13.
    f: Format,
    product_rounding: Rounding,
    result_rounding: Rounding,
    patent: bool,
}

impl Formats {
    fn of(keys: &Keys) -> Self {
        if keys.patent() {
            let word = Format::unsigned(0, keys.operands.cosine.fraction as i32);
            return Self {
                cosine: word,
                sine: word,
                cos_cos: word,
                sin_sin: word,
                result: word,
                f: word,
                product_rounding: Rounding::Truncate,
                result_rounding: Rounding::Truncate,
                patent: true,
            };
        }
        let product = keys.product_fraction as i32;
        Self {
            cosine: keys.operands.cosine.format(),
            sine: Format::unsigned(0, keys.sine_fraction as i32),
            cos_cos: Format::unsigned(1, product),
            sin_sin: Format::unsigned(0, product),
            // The format begins at −1.0, where the parabola has its zero and the clamp acts. Without the clamp it begins at
            // −2.0, the smallest value that can occur.
            result: Format::signed(i32::from(!keys.clamp), keys.f.fraction as i32),
            f: keys.f.format(),
            product_rounding: keys.product_rounding,
            result_rounding: keys.f.rounding,
            patent: false,
        }
    }
}

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let formats = Formats::of(&keys);
    d.about(about(&keys, config));

    let (cos_gamma, cos_dgamma) = operands(d, &formats);
    let r3 = common::exponent(d, keys.operands.exponent_bits).block(3).inputs(59, 60);
    let r4 = d
        .operand("dgamma_negative", Format::BIT)
        .block(4)
        .inputs(61, 62)
        .doc("sign of dgamma: 0 for cos(gamma + dgamma), 1 for cos(gamma - dgamma)");
    let colours = ColourProducts::new(d, &keys.operands.colours, Some(CHANNELS));

    // The order is the order in the patent's table: V1 V2, then V3, then the load lines V4 to V7.
    let operand_select =
        d.select("operand_select", &["cosines", "sines", "half_n", "square"]).lines(&[45, 46]);
    let sine_of = d
        .mux("mux17", [cos_gamma, cos_dgamma])
        .block(17)
        .line(47)
        .doc("the cosine that addresses the sine table");
    let r19 = d.register("reg19_sin_gamma", formats.sine).block(19).line(48).doc("sin gamma");
    let r11 = d
        .register("reg11_cos_cos", formats.cos_cos)
        .block(11)
        .line(49)
        .doc("cos gamma * cos dgamma");
    let r12 = d
        .register("reg12_sin_sin", formats.sin_sin)
        .block(12)
        .line(50)
        .doc("sin gamma * sin dgamma");
    let r13 = d
        .register("reg13_result", formats.result)
        .block(13)
        .line(51)
        .doc("n/2*(cos(gamma +- dgamma) - 1), later f");

    // A synchronous ROM is addressed with dγ while register 19 still loads the sine of γ, one microinstruction before line 47
    // selects dγ. The sine of dγ is then available when mux 8 selects it.
    let addressed = if keys.synchronous {
        d.choose("sine_of", r19.loading(), [sine_of.out(), cos_dgamma])
            .doc("mux 17, one microinstruction earlier")
    } else {
        sine_of.out()
    };
    let sine = sine_rom(d, &keys, &formats, addressed);
    r19.takes(sine);
    let (adder15, half_n, adder16) = if formats.patent {
        patent_sums(d, r4.q(), r3.q(), [r11, r12, r13])
    } else {
        exact_sums(d, r4.q(), r3.q(), [r11, r12, r13])
    };

    let half_n = half_n.named("half_exponent").doc("n/2, by wiring");
    // Words 0, 2, 4 and 6 of the control ROM select the operands, and words 1, 3, 5 and 7 load the products. Registers store
    // the operands, so that the multiplier and an adder before it never share a clock.
    let mux8 = d
        .bus("mux8", operand_select, [cos_gamma, sine, adder15, adder16])
        .block(8)
        .doc("first operand of multiplier 10")
        .held();
    let mux9 = d
        .bus("mux9", operand_select, [cos_dgamma, r19.q(), half_n, adder16])
        .block(9)
        .doc("second operand of multiplier 10")
        .held();
    let product = d.shared_mul("multiplier10", &mux8, &mux9).block(10).doc_on(
        Topic::Microprogram,
        "the shared product; its number of fraction bits depends on the operands",
    );
    let overflow = if formats.patent { Overflow::Wrap } else { Overflow::Saturate };
    let (rounding_products, rounding_result) = (formats.product_rounding, formats.result_rounding);
    let cos_cos = product.of(cos_gamma, cos_dgamma);
    r11.takes(d.narrow("cos_cos", cos_cos, r11.format(), rounding_products, overflow));
    let sin_sin = product.of(sine, r19.q());
    r12.takes(d.narrow("sin_sin", sin_sin, r12.format(), rounding_products, overflow));
    let line = product.of(adder15, half_n);
    let square = product.of(adder16, adder16);
    let squares = operand_select
        .out()
        .bit(0)
        .named("squares")
        .doc("V2: which of the two products register 13 loads");
    let frac = line.format().frac.max(square.format().frac);
    let either = [line.with_fraction(frac), square.with_fraction(frac)];
    let either = d
        .choose("line_or_square", squares, either)
        .doc("n/2 * adder 15, or the square of adder 16");
    let result = d.narrow("result", either, r13.format(), rounding_result, overflow);
    r13.takes(if formats.patent { result } else { facing_only(d, cos_gamma, result) });

    let doc = "the reflectance, once register 13 holds the square";
    let f = if r13.format().int == 0 {
        r13.q().bits(0, formats.f).named("f").doc(doc)
    } else {
        // Without the clamp the square can be 1.0 or more. f then saturates.
        d.narrow("f", r13.q(), formats.f, Rounding::Truncate, Overflow::Saturate).doc(doc)
    };
    let outputs = colours.outputs(f, keys.f.output_rounding);

    d.sequencer_lines(43, 44);
    let mut steps = vec![
        step("operands <- cos gamma, cos dgamma; ROM address <- cos gamma", []),
        step("19 <- sin gamma; 11 <- cos gamma * cos dgamma", [hold(), r19.load(), r11.load()]),
        step(
            "operands <- sin dgamma, sin gamma",
            [mux8.pick(sine), mux9.pick(r19.q()), sine_of.pick(cos_dgamma)],
        ),
        step("12 <- sin gamma * sin dgamma", [hold(), r12.load()]),
        step(
            "operands <- adder 15, n/2",
            [mux8.pick(adder15), mux9.pick(half_n), sine_of.pick(cos_dgamma)],
        ),
        step("13 <- n/2 * (cos(gamma +- dgamma) - 1)", [hold(), r13.load()]),
        step(
            "operands <- adder 16, adder 16",
            [mux8.pick(adder16), mux9.pick(adder16), sine_of.pick(cos_dgamma)],
        ),
        step("13 <- (... + 1)^2", [hold(), r13.load()]),
    ];
    steps.extend(outputs);
    steps.extend([
        step(
            "valid: intensities on the outputs",
            [mux8.pick(adder15), mux9.pick(half_n), sine_of.pick(cos_dgamma), valid()],
        ),
        step("end: clears the triggers and counter 29", [end()]),
    ]);
    d.microprogram(steps);
}

/// Builds the operand registers of cos γ and cos dγ, which are blocks 1 and 2 in the figure of the patent. With exact
/// arithmetic, the registers limit the values that the user writes to 0 … 1.0. A negative cos γ becomes 0, and [`facing_only`]
/// then makes f = 0.
fn operands<'d>(d: &'d Designer, formats: &Formats) -> (Signal<'d>, Signal<'d>) {
    let operand = |name: &str, format: Format| {
        if formats.patent {
            d.operand(name, format)
        } else {
            d.operand_clamped(name, format, 0.0, 1.0)
        }
    };
    let unsigned = Format { signed: false, ..formats.cosine };
    let r1 = operand("cos_gamma", formats.cosine)
        .block(1)
        .inputs(55, 56)
        .doc("cosine of the angle between normal and half vector");
    let r2 = operand("cos_dgamma", unsigned)
        .block(2)
        .inputs(57, 58)
        .doc("cosine of the angle by which the normal is perturbed");
    (r1.q(), r2.q())
}

/// Builds adder 15, n/2 and adder 16 with integer bits. Adder 15 computes register 11 ∓ register 12 − 1.0. For the minus sign,
/// mux 14 passes the inverse of 1.0 + register 12, and the carry-in adds the missing unit in the last place. For the plus sign,
/// mux 14 passes register 12 − 1.0 from adder 31.
fn exact_sums<'d>(
    d: &'d Designer,
    negative: Signal<'d>,
    exponent: Signal<'d>,
    [r11, r12, r13]: [Register<'d>; 3],
) -> (Signal<'d>, Signal<'d>, Signal<'d>) {
    let one = d.constant("one", 1.0, Format::unsigned(1, r12.format().frac));
    let adder31 = d.sub("adder31", r12.q(), one).block(31).doc("register 12 - 1.0");
    let raised = d.add("raised12", r12.q(), one).doc("register 12 + 1.0, by wiring");
    let inverse = d.not("inverse12", raised.as_signed()).doc("-(register 12) - 1.0 - 1 ulp");
    let mux14 = d
        .choose("mux14", negative, [inverse, adder31])
        .block(14)
        .doc("the number that adder 15 adds to register 11");
    let positive = d.not("subtracts", negative).doc("carry-in of adder 15");
    let adder15 = d
        .add_carry("adder15", r11.q(), mux14, positive)
        .block(15)
        .doc("cos(gamma +- dgamma) - 1.0");
    let one = d.constant("one", 1.0, Format::unsigned(1, r13.format().frac));
    let adder16 = d.add("adder16", r13.q(), one).block(16).doc("register 13 + 1.0");
    (adder15, exponent.shift_right(1), adder16)
}

/// Builds adder 15, n/2 and adder 16 as in the patent. All numbers are fractions modulo 1.0, so that a missing carry replaces
/// each "− 1". The low bit of n is dropped.
///
/// The patent contradicts itself about the second input of adder 31. The input is all ones in the claim and in the description,
/// and zeros in the summary. This circuit uses ones.
fn patent_sums<'d>(
    d: &'d Designer,
    negative: Signal<'d>,
    exponent: Signal<'d>,
    [r11, r12, r13]: [Register<'d>; 3],
) -> (Signal<'d>, Signal<'d>, Signal<'d>) {
    let word = r12.format();
    let ones = d.raw_constant("ones", word.max_raw(), word);
    let zeros = d.raw_constant("zeros", 0, word);
    let carry = d.raw_constant("carry52", 1, Format::BIT).block(52);
    let adder31 = d.add_modulo("adder31", r12.q(), ones, None).block(31).doc("register 12 - 1 ulp");
    let inverse = d.not("inverse12", r12.q()).doc("inverse of register 12");
    let mux14 = d
        .choose("mux14", negative, [inverse, adder31])
        .block(14)
        .doc("the number that adder 15 adds to register 11");
    let adder15 = d
        .add_modulo("adder15", r11.q(), mux14, Some(negative))
        .block(15)
        .doc("cos(gamma +- dgamma) - 1 ulp, modulo 1.0");
    let adder16 = d
        .add_modulo("adder16", r13.q(), zeros, Some(carry))
        .block(16)
        .doc("register 13 + 1 ulp, modulo 1.0");
    let bits = exponent.format().width();
    let half = exponent.bits(1, Format::unsigned(bits as i32 - 1, 0));
    (adder15, half, adder16)
}

/// Returns the next value of register 13: −1.0, which makes f = 0, unless cos γ > 0.
fn facing_only<'d>(d: &'d Designer, cos_gamma: Signal<'d>, result: Signal<'d>) -> Signal<'d> {
    let facing = d.any("facing", cos_gamma).doc("1 if the surface faces the half vector");
    let dark = d.constant("minus_one", -1.0, Format::signed(0, result.format().frac));
    d.choose("facing_result", facing, [dark, result])
}

fn about(keys: &Keys, config: &Config) -> About {
    let patent = keys.patent();
    let mut notes = vec![
        "Registers, muxes, adders and multipliers have the block numbers of figure 1 of the patent.".into(),
        Topic::Microprogram.note(format!(
            "The control ROM is table 1 of the patent, {}.",
            match (keys.operands.colours.in_turn(), Shared::of(config).output_registered) {
                (true, _) => "with one more microinstruction for each colour",
                (_, true) => "with one more microinstruction for the output registers",
                _ => "bit for bit",
            }
        )),
        Topic::Microprogram.note(
            "Registers follow muxes 8 and 9: the multiplier gets the operands that the previous \
             microinstruction selected. The settling microinstructions of the patent leave time for this. If \
             ROM 18 is synchronous, dgamma addresses it one microinstruction before line 47 selects dgamma.",
        ),
        common::outputs_note(&keys.operands.colours, "register 13", "reaches microinstruction 5"),
    ];
    notes.push(Note::from(if patent {
        "Numbers are fractions modulo 1.0, as in the patent: every '- 1' is a missing carry, the low bit of n \
         is dropped, and no value is clamped."
    } else {
        "Cosines are clamped to 0 ... 1.0 when they are written. The result is 0 for cos gamma <= 0."
    }));
    About {
        device: "rough".to_owned(),
        title: "Specular intensity of a rough surface".to_owned(),
        formula: "out = colour * (n/2 * (cos(gamma +- dgamma) - 1) + 1)^2".to_owned(),
        source: "UA 60139, claim 1, figures 1, 2 and 4".to_owned(),
        notes,
    }
}
