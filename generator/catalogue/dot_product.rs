//! The hardware description of the device `dot-product`, which computes cos γ = max(0, N·H / |N|).
//!
//! N is a vector of any length, such as an interpolated surface normal. H is a unit vector, such as the half vector. γ is the
//! angle between them. The device adds up N·H and N·N, and multiplies N·H by 1/√(N·N), which it interpolates in a table. With the
//! key `two_sided` it computes |N·H| / |N|. A result above 1 becomes 1, and the zero vector N gives 0.

use super::normaliser::{by_pairs, inverse_root};
use glint_base::fixed::{Format, Overflow, Rounding};
use glint_config::Config;
use glint_keys::dot_product::Keys;
use glint_rtl::dsl::{About, Designer, Signal, end, step, valid};

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let lower = if keys.two_sided { "abs(" } else { "max(0, " };
    d.about(About {
        device: "dot-product".into(),
        title: "The cosine between a vector of any length and a unit vector".into(),
        formula: format!("min(1, {lower}(nx*hx + ny*hy + nz*hz)/sqrt(nx^2 + ny^2 + nz^2)))"),
        source: "J. F. Blinn, Models of Light Reflection for Computer Synthesized Pictures, SIGGRAPH 1977".into(),
        notes: vec![
            "The normal may have any length, for example after interpolation. If it is the zero vector, the \
             cosine is 0.".into(),
            "A rounded unit vector may be longer than 1. A product above 1 becomes 1.".into(),
            "The components of the half vector must be from -1 to 1. For other components no error bound is \
             stated.".into(),
        ],
    });
    let [fraction, other, kept] = [keys.fraction, keys.other, keys.kept].map(|bits| bits as i32);
    let component = |name: &str, fraction: i32, vector: &str| {
        let doc = format!("{} of the {vector}", &name[1..]);
        d.operand(name, Format::signed(1, fraction)).doc(&doc)
    };
    let normal = ["nx", "ny", "nz"].map(|name| component(name, fraction, "normal"));
    let half = ["hx", "hy", "hz"].map(|name| component(name, other, "half vector"));
    let first = d.mux("first", normal.map(|it| it.q()));
    let second = d.mux("second", half.map(|it| it.q()));

    // Three products of at most 4.0 fit. The bits above are copies of the sign.
    let sum_of = |name: &str, product, format: Format, doc: &str| {
        let sum = d.register(name, format).doc(doc);
        let zero = d.constant(&format!("no_{name}"), 0.0, format);
        let so_far = d.mux(&format!("{name}_so_far"), [sum.q(), zero]);
        let added = d.add(&format!("{name}_added"), so_far.out(), product);
        let name = format!("{name}_kept");
        sum.takes(d.narrow(&name, added, format, Rounding::Truncate, Overflow::Wrap));
        (sum, so_far, zero)
    };
    let product = d.mul("product", first.out(), second.out());
    let format = Format::signed(4, fraction + other);
    let (sum, sum_so_far, no_sum) = sum_of("sum", product, format, "the sum of products so far");
    let square = d.mul("square", first.out(), first.out());
    let format = Format::unsigned(4, 2 * fraction);
    let (squares, squares_so_far, no_squares) =
        sum_of("squares", square, format, "the sum of squares so far");

    let width = Format::unsigned(2 * fraction + 4, 0);
    let (word, places) = by_pairs(d, squares.q().read_as(width));
    let mantissa = d.register("mantissa", width).doc("the sum of squares, scaled to 1.0 ... 4.0");
    mantissa.takes(word);
    let shift = d
        .register("shift", places.format())
        .doc("number of pairs of leading zeros of the sum of squares");
    shift.takes(places);
    let distance = d
        .register("distance", keys.distance())
        .doc("the sum of products, for a normal scaled to a length of 1.0 to 2.0");
    let products = if keys.two_sided { size(d, sum.q()) } else { sum.q() };
    distance.takes(shifted(d, products, shift.q(), &keys));
    let root = d.register("inverse", keys.shortened()).doc("1/sqrt of the scaled sum of squares");
    let found = inverse_root(d, mantissa.q(), keys.address as i32, keys.inverse as i32);
    let (rounding, overflow) = (Rounding::Nearest, Overflow::Saturate);
    root.takes(d.narrow("inverse_rounded", found, keys.shortened(), rounding, overflow));

    let scaled = d.mul("scaled", distance.q(), root.q());
    let wide = Format::unsigned(2, kept);
    let rounded = d.narrow("rounded", scaled, wide, keys.rounding, Overflow::Saturate);
    let one = d.constant("one", 1.0, wide);
    let limited = d.choose("limited", d.less("below", rounded, one), [one, rounded]);
    let cosine = d.register("cosine", Format::unsigned(1, kept)).doc("the result");
    let format = cosine.format();
    cosine.takes(d.narrow("limited_kept", limited, format, Rounding::Truncate, Overflow::Saturate));
    d.output("cosine_out", cosine.q());

    let pair = |at: usize| {
        let picked = [first.pick(normal[at].q()), second.pick(half[at].q())];
        picked.into_iter().chain([sum.load(), squares.load()])
    };
    d.microprogram([
        step("idle", []),
        step("x", pair(0).chain([sum_so_far.pick(no_sum), squares_so_far.pick(no_squares)])),
        step("y", pair(1)),
        step("z", pair(2)),
        step("normalise", [mantissa.load(), shift.load()]),
        step("look_up", [distance.load()]),
        step("invert", [root.load()]),
        step("scale", [cosine.load()]),
        step("result", [valid(), end()]),
    ]);
}

/// Returns the absolute value of a number in its own format, which lacks one value: the most negative number keeps its sign
/// bit.
fn size<'d>(d: &'d Designer, number: Signal<'d>) -> Signal<'d> {
    let format = number.format();
    let zero = d.constant("none", 0.0, format);
    let negated = d.sub("negated", zero, number);
    let negated = d.narrow("negated_kept", negated, format, Rounding::Truncate, Overflow::Wrap);
    let is_negative = number.bit(format.width() - 1);
    d.choose("without_sign", is_negative, [number, negated])
}

/// Returns the sum of products times 2^`places`, divided by 2. Each stage drops the low bits that the later shifts cannot move
/// into the result. The result is rounded to the nearest value of the format [`Keys::distance`], and a negative sum becomes 0.
fn shifted<'d>(d: &'d Designer, sum: Signal<'d>, places: Signal<'d>, keys: &Keys) -> Signal<'d> {
    let mut row = sum;
    for bit in (0..places.format().width()).rev() {
        let step = 1i32 << bit;
        let format = Format::signed(4, (keys.distance().frac + step - 1).min(sum.format().frac));
        let name = format!("distance_by{step}");
        let keep = |name: &str, x| d.narrow(name, x, format, Rounding::Truncate, Overflow::Wrap);
        let stays = keep(&format!("{name}_not"), row);
        let moved = keep(&format!("{name}_kept"), row.shift_left(step));
        row = d.choose(&name, places.bit(bit), [stays, moved]);
    }
    let (rounding, overflow) = (Rounding::Nearest, Overflow::Saturate);
    d.narrow("distance_rounded", row.shift_right(1), keys.distance(), rounding, overflow)
}
