//! The hardware description of the device `normaliser`, which computes the unit vector v/|v| of a vector v of any length.
//!
//! A multiplier squares the components in turn, a shifter scales their sum v·v, and a table interpolates 1/√(v·v),
//! which scales all components. For example, v = (0, 0, 0.5) gives (0, 0, 1). The zero vector, which has no direction, gives (0,
//! 0, 0).

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_config::Config;
use glint_keys::normaliser::Keys;
use glint_rtl::dsl::{About, Designer, Signal, end, step, valid};

fn integer(bits: i32) -> Format {
    Format::unsigned(bits, 0)
}

pub fn describe(d: &Designer, config: &Config) {
    d.about(About {
        device: "normaliser".into(),
        title: "The unit vector of a direction".into(),
        formula: "(x, y, z)/sqrt(x^2 + y^2 + z^2)".into(),
        source: "M. J. Schulte and K. E. Wires, High-Speed Inverse Square Roots, ARITH-14, 1999"
            .into(),
        notes: vec!["The zero vector gives zeros.".into()],
    });
    let Keys { fraction, address, inverse, kept, rounding } = Keys::of(config);
    let [fraction, address, inverse] = [fraction, address, inverse].map(|bits| bits as i32);
    let kept = Format::signed(1, kept as i32);

    let operands = ["x", "y", "z"]
        .map(|name| d.operand(name, Format::signed(1, fraction)).doc("component of the vector"));
    let component = d.mux("component", operands.map(|it| it.q()));

    // Three squares of at most 4.0 fit.
    let squares = Format::unsigned(4, 2 * fraction);
    let square = d.mul("square", component.out(), component.out());
    let sum = d.register("sum", squares).doc("the sum of squares so far");
    let zero = d.constant("nothing", 0.0, squares);
    let so_far = d.mux("so_far", [sum.q(), zero]);
    let added = d.add("added", so_far.out(), square);
    sum.takes(d.narrow("added_kept", added, squares, Rounding::Truncate, Overflow::Wrap));

    let width = 2 * fraction + 4;
    let (word, places) = by_pairs(d, sum.q().read_as(integer(width)));
    let mantissa =
        d.register("mantissa", integer(width)).doc("the sum of squares, scaled to 1.0 ... 4.0");
    mantissa.takes(word);
    let shift = d
        .register("shift", places.format())
        .doc("number of pairs of leading zeros of the sum of squares");
    shift.takes(places);

    let root = d
        .register("inverse", Format::unsigned(1, inverse))
        .doc("1/sqrt of the scaled sum of squares");
    root.takes(inverse_root(d, mantissa.q(), address, inverse));

    let shifted = shifted(d, component.out(), shift.q(), fraction);
    let scaled = d.mul("scaled", shifted, root.q());
    let result = d.narrow("scaled_rounded", scaled, kept, rounding, Overflow::Saturate);
    let results = ["unit_x", "unit_y", "unit_z"].map(|name| {
        let register = d.register(name, kept).doc("component of the unit vector");
        register.takes(result);
        d.output(&format!("{name}_out"), register.q());
        register
    });

    let pick = |at: usize| component.pick(operands[at].q());
    d.microprogram([
        step("idle", []),
        step("square_x", [pick(0), so_far.pick(zero), sum.load()]),
        step("square_y", [pick(1), sum.load()]),
        step("square_z", [pick(2), sum.load()]),
        step("normalise", [mantissa.load(), shift.load()]),
        step("look_up", []),
        step("invert", [root.load()]),
        step("scale_x", [pick(0), results[0].load()]),
        step("scale_y", [pick(1), results[1].load()]),
        step("scale_z", [pick(2), results[2].load()]),
        step("result", [valid(), end()]),
    ]);
}

/// Shifts a word left by pairs of bits until one of its two top bits is 1. Returns the shifted word and the number of pairs.
/// Zeros stay 0.
pub(super) fn by_pairs<'d>(d: &'d Designer, mut word: Signal<'d>) -> (Signal<'d>, Signal<'d>) {
    let width = word.format().width();
    let mut places = Vec::new();
    for bit in (1..=(width - 1).ilog2()).rev() {
        let step = 1u32 << bit;
        let top = word.bits(width - step, integer(step as i32));
        let used = d.any(&format!("top{step}"), top);
        let rest = word.bits(0, integer((width - step) as i32));
        let shifted = rest.with_fraction(step as i32).shift_left(step as i32);
        word = d.choose(&format!("left{step}"), used, [shifted, word]);
        places.push(d.not(&format!("free{step}"), used));
    }
    let count = integer(places.len() as i32);
    (word, d.join("pairs", &places, count))
}

/// Builds 1/√m for the mantissa m, from 1.0 to below 4.0, by a chord between two rounded values. The zero vector alone has the
/// mantissa 0, and gets 0. `address` is the number of address bits of the table, and `inverse` the number of fraction bits of the
/// result in u1.`inverse`.
pub(super) fn inverse_root<'d>(
    d: &'d Designer,
    mantissa: Signal<'d>,
    address: i32,
    inverse: i32,
) -> Signal<'d> {
    let width = mantissa.format().width() as i32;
    // The position within a segment has as many bits as half a unit of the result needs.
    let along = (width - address).min(inverse - address + 2);
    let first = 1i128 << (address - 2);
    let count = 1i128 << address;
    let value = |prefix: i128| {
        let m = 4.0 * prefix as f64 / count as f64;
        ((1i64 << inverse) as f64 / m.sqrt() + 0.5).floor() as i128
    };
    let fall = |prefix: i128| value(prefix) - value(prefix + 1);
    let fall_bits = 128 - fall(first).leading_zeros() as i32;
    // Only the zero vector has a mantissa below 1.0. Its word is 0.
    let words: Vec<i128> = (0..count)
        .map(|at| if at < first { 0 } else { value(at) << fall_bits | fall(at) })
        .collect();
    let prefix = mantissa.bits((width - address) as u32, integer(address));
    let rest = mantissa.bits((width - address - along) as u32, integer(along));
    let rom = d
        .rom("inverse_roots", prefix, integer(inverse + 1 + fall_bits), &words, true)
        .doc("1/sqrt at the start of a segment, then the decrease over the segment");
    let word = rom.out();
    let start = word.bits(fall_bits as u32, Format::unsigned(1, inverse));
    let slope = word.bits(0, integer(fall_bits));
    let fallen = d.mul("fallen", slope, rest).shift_right(along);
    let whole =
        d.narrow("fallen_cut", fallen, integer(fall_bits), Rounding::Truncate, Overflow::Saturate);
    let left = d.sub("inverse_found", start, whole.shift_right(inverse));
    // The fall over a segment is less than the value at its start.
    let format = Format::unsigned(1, inverse);
    d.narrow("inverse_kept", left, format, Rounding::Truncate, Overflow::Wrap)
}

/// Returns a component times 2^`places`, divided by 2: from −2 to 2, with one more fraction bit. The square of the result is at
/// most the mantissa, so the bits that are dropped at the top are copies of the sign.
fn shifted<'d>(d: &'d Designer, x: Signal<'d>, places: Signal<'d>, fraction: i32) -> Signal<'d> {
    let wide = Format::signed(2, fraction);
    let keep = |name: &str, x| d.narrow(name, x, wide, Rounding::Truncate, Overflow::Wrap);
    let mut row = keep("component_extended", x);
    for bit in 0..places.format().width() {
        let step = 1i32 << bit;
        let name = format!("component_by{step}");
        let moved = keep(&format!("{name}_kept"), row.shift_left(step));
        row = d.choose(&name, places.bit(bit), [row, moved]);
    }
    row.shift_right(1)
}
