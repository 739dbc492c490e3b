//! The shared description of `blinn` and `gauss`: `f = 2^(−n·decay)`, where the decay is a function of cos γ alone.
//!
//! The decay is read from straight segments (the first product), the exponent multiplies it (the second,
//! in the same multiplier), and 2^−y of their product is one look at tables and a shift.

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_keys::decay::Keys;
use glint_rtl::blocks::colour::Colours;
use glint_rtl::blocks::exponential::{self, ExponentialFormats};
use glint_rtl::blocks::multipartite::{Cut, Offset};
use glint_rtl::blocks::segmented::{self, Bend, Segmentation, SegmentedFormats};
use glint_rtl::dsl::{Designer, Note, Signal, Topic, step};

use super::common;

/// Where the two devices differ.
pub struct Curve<'d> {
    /// The operand of the table, an integer of `operand_bits` bits.
    pub u: Signal<'d>,
    /// Bits of the operand.
    pub operand_bits: u32,
    /// The contents of the table, a function of u as an integer: from 0 to below 1, increasing and convex.
    pub table: &'d dyn Fn(f64) -> f64,
    /// An integer that the decay has in front of what the table holds.
    pub octave: Option<Signal<'d>>,
    /// log₂ of what the sum of both is multiplied by to give the decay.
    pub scale: i32,
    /// The contents of the table, in words.
    pub doc: &'static str,
}

/// Everything behind the operand `cos_gamma`: operands, the two products, 2^−y, outputs, microprogram.
pub fn describe<'d>(d: &'d Designer, keys: &Keys, cos_gamma: Signal<'d>, curve: &Curve<'d>) {
    let exponent = common::exponent(d, keys.operands.exponent_bits).q();
    let colours = Colours::new(d, keys.operands.colours.bits as i32, None);
    let f = keys.f.format();
    let exponential = ExponentialFormats {
        cut: cut(keys),
        fraction: keys.fraction as i32,
        synchronous: keys.synchronous,
    };
    // An integer part that shifts every bit of f out, and no larger.
    let most = f.frac as u32 + 2;
    let halvings_format = Format::unsigned(most.ilog2() as i32 + 1, exponential.cut.bits() as i32);

    let operand_select = d.select("operand_select", &["segment", "power"]);
    let decay = d.register("decay", Format::unsigned(0, keys.decay_fraction as i32)).doc(curve.doc);
    let halvings =
        d.register("halvings", halvings_format).doc("n*decay: how often f is half of 1.0");
    let reflectance = d.register("reflectance", f).doc("f");

    let line = look_up(d, keys, curve, decay.format());
    let (factor, small) = factor(d, keys, curve, decay.q());
    let first =
        d.bus("first", operand_select, [line.slope, factor]).doc("first operand of the multiplier");
    let second = d
        .bus("second", operand_select, [line.rest, exponent])
        .doc("second operand of the multiplier");
    let product = d
        .shared_mul("product", &first, &second)
        .doc_on(Topic::Microprogram, "its point depends on the operands");
    decay.takes(line.at(d, "curve", product.of(line.slope, line.rest)));

    let power = product.of(factor, exponent);
    let scaled = |name: &str, fraction: i32| {
        d.narrow(
            name,
            power.shift_right(fraction - curve.scale),
            halvings_format,
            Rounding::Truncate,
            Overflow::Saturate,
        )
    };
    let coarse = scaled("halvings_coarse", keys.coarse_fraction as i32);
    let fine = scaled("halvings_fine", decay.format().frac);
    halvings.takes(d.choose("halvings_next", small, [coarse, fine]));

    let rounded =
        exponential::halvings(d, "exp2", halvings.q(), &exponential, f.frac, keys.f.rounding);
    reflectance.takes(ends(d, cos_gamma, halvings.q(), rounded));
    let _ = d.output("f_out", reflectance.q()).doc("the reflectance, for a user's own multipliers");
    let outputs = common::colour_outputs(
        &keys.operands.colours,
        keys.f.output_rounding,
        &colours,
        reflectance.q(),
    );

    let steps = vec![
        step("segment of the decay addressed by cos gamma", []),
        step("decay <- base + slope * rest", [decay.load()]),
        step("halvings <- n * decay", [first.pick(factor), second.pick(exponent), halvings.load()]),
        step("tables of 2^-x addressed by the fraction", []),
        step("reflectance <- 2^-halvings", [reflectance.load()]),
    ];
    d.microprogram(steps.into_iter().chain(outputs));
}

/// How the fraction of n·decay is cut.
fn cut(keys: &Keys) -> Cut {
    let offsets = keys.offsets().map(|(bits, address)| Offset { bits, address });
    Cut { address: keys.address, offsets: offsets.collect() }
}

fn look_up<'d>(
    d: &'d Designer,
    keys: &Keys,
    curve: &Curve<'d>,
    value: Format,
) -> segmented::Line<'d> {
    let cut = Segmentation {
        operand_bits: curve.operand_bits,
        segments: keys.segments.clone(),
        tail: Some(keys.tail),
        packed: true,
    };
    let shape = SegmentedFormats {
        fraction: value.frac,
        slope_fraction: keys.slope_fraction as i32,
        synchronous: keys.synchronous,
    };
    let entry = |segment| segmented::chord(segment, shape, Bend::Convex, curve.table);
    segmented::look_up(d, "curve", curve.u, &cut, shape, entry, None)
}

/// The decay as an operand of the multiplier, and whether it is a small one.
///
/// A small decay, below ¼ in the table's unit, meets large n and needs all its fraction bits; its two
/// upper bits are zeros. Any other needs few, and has an octave number in front. So both are of about one
/// width, and which it was decides only where the point of the product is.
fn factor<'d>(
    d: &'d Designer,
    keys: &Keys,
    curve: &Curve<'d>,
    decay: Signal<'d>,
) -> (Signal<'d>, Signal<'d>) {
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let width = decay.format().width();
    let coarse_bits = keys.coarse_fraction;
    let mut coarse = decay.bits(width - coarse_bits, integer(coarse_bits));
    let mut large = d.any("decay_large", decay.bits(width - 2, integer(2)));
    if let Some(octave) = curve.octave {
        coarse = d.join(
            "decay_coarse",
            &[octave, coarse],
            integer(octave.format().width() + coarse_bits),
        );
        let far = d.any("octave_any", octave).doc("cos gamma is below one half");
        large = d.or("decay_far", large, far);
    }
    let small = d.not("decay_small", large).doc("the decay is below 1/4, and all its bits count");
    let fine = decay.bits(0, integer(width - 2));
    let factor =
        d.choose("factor", small, [coarse, fine]).doc("the decay, its point by decay_small");
    (factor, small)
}

/// f where it is known without tables: 0 for cos γ ≤ 0, and all ones, as near 1 as it can be, where cos γ is 1.0
/// or n·decay is 0.
fn ends<'d>(
    d: &'d Designer,
    cos_gamma: Signal<'d>,
    halvings: Signal<'d>,
    rounded: Signal<'d>,
) -> Signal<'d> {
    let format = rounded.format();
    let facing = d.any("facing", cos_gamma).doc("the surface faces the half vector");
    let fades = d.any("fades", halvings);
    let aligned =
        cos_gamma.bit(cos_gamma.format().frac as u32).named("aligned").doc("cos gamma is 1.0");
    let level = d.not("level", fades);
    let peak = d.or("peak", aligned, level).doc("f is 1.0, less an ulp");
    let ones = d.raw_constant("ones", format.max_raw(), format);
    let lit = d.choose("lit", peak, [rounded, ones]);
    let dark = d.raw_constant("dark", 0, format);
    d.choose("reflectance_next", facing, [dark, lit])
}

/// Returns the [`About::notes`](glint_rtl::dsl::About::notes) of both devices.
pub fn notes(keys: &Keys) -> Vec<Note> {
    vec![
        Topic::Microprogram.note(
            "Two products a point, in one shared multiplier (a second one would save a clock of six and cost one to \
             two DSP blocks): the rise within a segment of the decay, and n times the decay.",
        ),
        "2^-x over the fraction of n*decay comes from tables that are added (symmetric multipartite), for which \
         it is stored less the line 1 - x/2; the integer shifts it right."
            .into(),
        "The straight segments of the decay shrink toward cos gamma = 1, by factors of four of 1 - cos gamma, so \
         that the decay keeps its relative accuracy, which is what n multiplies. The table is addressed by the \
         inverse of cos gamma, an ulp below 1 - cos gamma, which costs no subtractor: its contents make up for it."
            .into(),
        "Cosines are limited to 0 ... 1.0 as they are written; cos gamma <= 0 gives 0, for n = 0 too. Else n = 0 \
         gives what cos gamma = 1.0 gives: all ones, an ulp below 1.0."
            .into(),
        common::outputs_note(&keys.operands.colours, "the register of f", "reaches microinstruction 4"),
    ]
}
