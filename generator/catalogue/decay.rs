//! The hardware description that the devices `blinn` and `gauss` share: f = 2^(−n·decay(c)) ([symbols](crate#symbols)).
//!
//! The decay is −log₂ c in `blinn`, and γ²/(2 ln 2) in `gauss`. `gauss` computes the decay as the distance 1 − c times a smooth
//! ratio. `blinn` first scales c by 2^octave to a mantissa m from 1/2 to 1, and computes (1 − m) times a ratio plus the octave.
//! The relative error of the decay therefore stays small near c = 1, where n multiplies the error.
//!
//! In the sequential core, piecewise polynomials on one multiplier give the ratio and 2^−x. Another multiplier computes
//! distance times ratio, and n times decay. The integer part of n·decay becomes a shift. f is 0 if c ≤ 0.

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_config::Config;
use glint_keys::decay::{Decay, Keys};
use glint_rtl::blocks::exponential;
use glint_rtl::dsl::{Designer, Note, Signal, Topic, step};

use super::common::{self, ColourProducts};
use super::piecewise::{PolynomialDatapath, StepMultiplier, Tables};

/// The distance of the cosine c from 1, and in `blinn` the octave of c.
pub struct Distance<'d> {
    /// 1 − c in `gauss`, 1 − m in `blinn`, in units of its last place, less one unit, as an integer.
    pub u: Signal<'d>,
    /// An integer that is added to the product of distance and ratio; `None` for `gauss`.
    pub octave: Option<Signal<'d>>,
}

/// Adds everything but the operand `cos_gamma`, which the caller adds before: the operands `exponent` and the colours, both
/// tables of polynomials, the products, the outputs and the microprogram.
///
/// # Panics
/// Panics if the schema's check does not accept the configuration.
pub fn describe<'d>(
    d: &'d Designer,
    config: &Config,
    cos_gamma: Signal<'d>,
    of: Decay,
    Distance { u, octave }: Distance<'d>,
) {
    let keys = &Keys::of(config);
    let exponent = common::exponent(d, keys.operands.exponent_bits).q();
    let colours = ColourProducts::new(d, &keys.operands.colours, None);
    let f = keys.f.format();
    let ratios = keys.ratio(of).expect("a configuration that is checked");
    let powers = keys.power().expect("a configuration that is checked");

    let tables = Tables { split: true, synchronous: false, holds_highest: false };
    let fraction = keys.operands.cosine.fraction as i32;
    let bits = u.format().width() as i32;
    let sums = ["ratio", "ratio_sum1", "ratio_sum2"].map(Some);
    let number = u.bits(keys.unseen(), Format::unsigned(bits - keys.unseen() as i32, 0));
    let ratio = PolynomialDatapath::new(d, "ratio_", sums, number, &ratios, tables);
    let _ = ratio.q().doc("the decay divided by 1 - cos gamma");
    let ulp = d.raw_constant("ulp", 1, Format::unsigned(1 - fraction, fraction));
    let whole =
        d.add("distance_whole", u.read_as(Format::unsigned(bits - fraction, fraction)), ulp);
    let way = d.pipeline("way", whole).doc("1.0 - cos gamma * 2^octave");

    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let factor = d
        .register("factor", integer(keys.factor_bits(of)))
        .doc("the decay; decay_small selects its number of fraction bits");
    let small = d
        .register("decay_small", Format::BIT)
        .doc("1 if the decay is below 1/4 and has more fraction bits");
    let halvings = d
        .register("halvings", keys.halvings(of))
        .doc("n*decay: the number of halvings from 1.0 to f");
    let operand_select = d.select("operand_select", &["decay", "power"]);
    let first =
        d.bus("first", operand_select, [way, factor.q()]).doc("first operand of the multiplier");
    let second = d
        .bus("second", operand_select, [ratio.q(), exponent])
        .doc("second operand of the multiplier");
    let product = d.shared_mul("product", &first, &second).doc_on(
        Topic::Microprogram,
        "the shared product; its number of fraction bits depends on the operands",
    );
    // The product is below 2.0, because the decay is.
    let decay = product.of(way, ratio.q());
    let decay = d.narrow("decay", decay, keys.decay_format(), Rounding::Truncate, Overflow::Wrap);
    let (factor_next, large) = factor_of(d, keys, octave, decay.doc("without the octave"));
    factor.takes(factor_next);
    small.takes(d.not("decay_small_next", large));

    let power = product.of(factor.q(), exponent);
    let scaled = |name: &str, fraction: u32| {
        let power = power.shift_right(fraction as i32);
        d.narrow(name, power, halvings.format(), Rounding::Truncate, Overflow::Wrap)
    };
    let coarse = scaled("halvings_coarse", keys.coarse_fraction);
    let fine = scaled("halvings_fine", keys.decay_fraction);
    halvings.takes(d.choose("halvings_next", small.q(), [coarse, fine]));

    let sums = ["power", "power_sum1", "power_sum2"].map(Some);
    let number = halvings.q().bits(0, Format::unsigned(keys.argument as i32, 0));
    let exp2 = PolynomialDatapath::new(d, "power_", sums, number, &powers, tables);
    let _ = exp2.q().doc("2^-x, where x is the fraction of halvings");
    // An integer part that shifts all bits of f out need not be larger.
    let most = integer((f.frac as u32 + 2).ilog2() + 1);
    let whole = halvings.q().bits(keys.argument, integer(halvings.format().int as u32));
    let places = d.narrow("places", whole, most, Rounding::Truncate, Overflow::Saturate);
    let rounded = exponential::halved(d, "exp2", exp2.q(), places, f.frac, keys.f.rounding);
    let reflectance = d.register("reflectance", f).doc("f");
    reflectance.takes(ends(d, cos_gamma, rounded));
    let _ = d
        .output("f_out", reflectance.q())
        .doc("the reflectance f, for multipliers outside the core");

    let outputs = colours.results(reflectance.q(), keys.f.output_rounding);

    let names = ["polynomial_select", "factor_of_offset", "offset_of_step", "polynomial_product"];
    let multiplier = StepMultiplier::new(d, names, &[&ratio, &exp2], &[]);
    let horner = |it: &PolynomialDatapath<'d, '_>, k: usize, name: &str| {
        let what = if k == 0 {
            "all coefficients".to_owned()
        } else {
            format!("coefficients from {k} on")
        };
        step(&format!("{name} <- {what}"), multiplier.step(it, k))
    };
    let mut steps = vec![step("distance <- 1 - cos gamma", [])];
    steps.extend(ratio.steps().map(|k| horner(&ratio, k, "ratio")));
    let decayed = [first.pick(way), second.pick(ratio.q()), factor.load(), small.load()];
    steps.push(step("factor <- distance * ratio", decayed));
    let halved = [first.pick(factor.q()), second.pick(exponent), halvings.load()];
    steps.push(step("halvings <- n * factor", halved));
    steps.extend(exp2.steps().map(|k| horner(&exp2, k, "power")));
    steps.push(step("reflectance <- 2^-halvings", [reflectance.load()]));
    d.microprogram(steps.into_iter().chain(outputs));
}

/// Returns the decay as a factor of the multiplier, and a bit that is 1 if the decay is large.
///
/// A small decay, below ¼, is multiplied by large n and needs all its fraction bits; its three upper bits are zeros. A large
/// decay needs fewer fraction bits, but in `blinn` also the octave. Both factors therefore have about the same width, and the
/// bit only decides where the binary point of the product is.
fn factor_of<'d>(
    d: &'d Designer,
    keys: &Keys,
    octave: Option<Signal<'d>>,
    decay: Signal<'d>,
) -> (Signal<'d>, Signal<'d>) {
    let integer = |bits: u32| Format::unsigned(bits as i32, 0);
    let (fraction, coarse) = (keys.decay_fraction, keys.coarse_fraction);
    let one = decay.bits(fraction, integer(1));
    let mut whole = one;
    let mut large = d.any("decay_large", decay.bits(fraction - 2, integer(3)));
    if let Some(octave) = octave {
        whole = d.add("decay_whole", octave, one);
        let far = d.any("octave_any", octave).doc("1 if cos gamma is below one half");
        large = d.or("decay_far", large, far);
    }
    let width = whole.format().width() + coarse;
    let low = decay.bits(fraction - coarse, integer(coarse));
    let coarse = d.join("decay_coarse", &[whole, low], integer(width));
    let fine = decay.bits(0, integer(fraction - 2));
    (d.choose("factor_next", large, [fine, coarse]), large)
}

/// Replaces f by the values that need no table: 0 if cos γ ≤ 0, and all ones, the largest value below 1, if cos γ is 1.0.
fn ends<'d>(d: &'d Designer, cos_gamma: Signal<'d>, rounded: Signal<'d>) -> Signal<'d> {
    let format = rounded.format();
    let facing = d.any("facing", cos_gamma).doc("1 if the surface faces the half vector");
    let aligned =
        cos_gamma.bit(cos_gamma.format().frac as u32).named("aligned").doc("1 if cos gamma is 1.0");
    let ones = d.raw_constant("ones", format.max_raw(), format);
    let lit = d.choose("lit", aligned, [rounded, ones]);
    let dark = d.raw_constant("dark", 0, format);
    d.choose("reflectance_next", facing, [dark, lit])
}

/// Returns the paragraphs about interpretations, formats and limits for the pages of `blinn` and `gauss`.
pub fn notes(keys: &Keys) -> Vec<Note> {
    vec![
        Topic::Microprogram.note(
            "There are two multipliers. One evaluates both polynomials. The other multiplies 1 - cos gamma by \
             the ratio, and n by the decay.",
        ),
        "A piecewise polynomial gives 2^-x, where x is the fraction of n*decay. The integer part of n*decay \
         shifts the result right.".into(),
        "The decay is 1 - cos gamma times a ratio that changes little. A piecewise polynomial gives the ratio. \
         So the relative error of the decay stays small near cos gamma = 1, which matters because n multiplies \
         the decay."
            .into(),
        "Cosines are clamped to 0 ... 1.0 when they are written. The result is 0 for cos gamma <= 0, also for \
         n = 0. For cos gamma = 1.0 it is all ones, which is 1.0 - 1 ulp."
            .into(),
        common::outputs_note(&keys.operands.colours, "the register of f", "reaches the microinstruction that loads it"),
    ]
}
