//! The hardware description of the device `lyon`, which computes f = max(0, 1 − β·D²)^m with m = 2^s.
//!
//! D² is the squared length of the difference D = N − H between the unit normal N and the unit half vector H. With the key
//! `scale` = `"multiplier"`, β is n/(2·m) for the specular exponent n. With the default `"shift"`, as in the patent, β is
//! 2^shift/(2·m), where the operand `shift` is log₂ n, rounded.
//!
//! The source is the patent US 5 739 820 (Fig. 7C and 7D), which [seed 000](crate#symbols) cites. Seed 000 lists only the
//! blocks: two adders, four multipliers, shift register, counter, comparator and mux. Glint chose the wiring, and numbers each
//! kind of block from 1.

use glint_base::fixed::{Format, Overflow, Rounding};
use glint_config::{Config, Shared};
use glint_keys::lyon::{Keys, Scale};
use glint_rtl::blocks::squaring::Squarings;
use glint_rtl::dsl::{Designer, Signal, Step, StepSetting, loop_while, step};
use glint_rtl::netlist::{About, Note, Topic};

use super::common::{self, ColourProducts};

/// D², rounded to the fraction bits of its register.
struct SquaredDistance<'d> {
    value: Signal<'d>,
    /// The microinstructions before the one that loads D² into its register.
    steps: Vec<Step>,
    /// The settings of the microinstruction that loads D² into its register.
    settings: Vec<StepSetting>,
}

/// The scaled square and its microinstructions.
struct Scaled<'d> {
    /// β·D², whose number of fraction bits can differ from f's.
    value: Signal<'d>,
    steps: Vec<Step>,
    squarings: Squarings<'d>,
}

pub fn describe(d: &Designer, config: &Config) {
    let keys = Keys::of(config);
    let f = keys.f.format();
    let rounding_f = keys.f.rounding;
    d.about(about(&keys, config));

    let vector = Format::signed(1, keys.vector_fraction as i32);
    let component = |name: &str, of: &str| {
        d.operand(name, vector).doc(&format!("{of} of N - H, the normal minus the half vector")).q()
    };
    let components = [component("dx", "x"), component("dy", "y"), component("dz", "z")];
    let distance = if keys.squares_in_turn() {
        distance_in_turn(d, &keys, components)
    } else {
        distance(d, &keys, components)
    };
    let scaled = match keys.scale {
        Scale::Shift => by_shift(d, &keys, distance),
        Scale::Multiplier => by_multiplier(d, &keys, distance),
    };
    let colours = ColourProducts::new(d, &keys.colours, None);
    let accumulator = d.register("accumulator", f).doc("the powers of the base, at the end f");

    let format = Format::unsigned(1, f.frac);
    let value = d.narrow("beta_distance", scaled.value, format, rounding_f, Overflow::Saturate);
    let base = base(d, value.doc("beta*D^2, with as many fraction bits as f"), f);
    let operand = d
        .mux("multiplier4_operand", [base, accumulator.q()])
        .doc("the number that multiplier 4 squares");
    let multiplier4 = d.mul("multiplier4", operand.out(), operand.out()).block(4);
    accumulator.takes(d.narrow("square", multiplier4, f, rounding_f, Overflow::Saturate));
    let outputs = colours.results(accumulator.q(), keys.f.output_rounding);

    let mut steps = scaled.steps;
    let first = [operand.pick(base)].into_iter().chain(scaled.squarings.load());
    let again = [operand.pick(accumulator.q())];
    steps.extend(scaled.squarings.steps(accumulator, first, again));
    d.microprogram(steps.into_iter().chain(outputs));
}

/// Builds D² = dx² + dy² + dz², from 0 to 12.0, with one multiplier for each square.
fn distance<'d>(d: &'d Designer, keys: &Keys, components: [Signal<'d>; 3]) -> SquaredDistance<'d> {
    let mut number = 0;
    let squares = components.map(|component| {
        number += 1;
        d.mul(&format!("multiplier{number}"), component, component).block(number)
    });
    let adder1 = d.add("adder1", squares[0], squares[1]).block(1);
    let adder2 = d.add("adder2", adder1, squares[2]).block(2).doc("D^2");
    SquaredDistance {
        value: rounded_distance(d, keys, adder2),
        steps: Vec::new(),
        settings: Vec::new(),
    }
}

/// Builds D² with one multiplier and one adder. A register collects the first two squares in two microinstructions, and the
/// next microinstruction adds the third square.
fn distance_in_turn<'d>(
    d: &'d Designer,
    keys: &Keys,
    components: [Signal<'d>; 3],
) -> SquaredDistance<'d> {
    let sum = d
        .register("distance_sum", Format::unsigned(4, 2 * components[0].format().frac))
        .doc("dx^2, later dx^2 + dy^2");
    let component = d.mux("component", components).doc("the component that is squared");
    let zero = d.raw_constant("no_sum", 0, sum.format());
    let addend = d.mux("addend", [zero, sum.q()]).doc("the sum of the squares before");
    let multiplier1 = d.mul("multiplier1", component.out(), component.out()).block(1);
    let adder1 = d
        .add("adder1", multiplier1, addend.out())
        .block(1)
        .doc("the sum of squares, at the end D^2");
    // As in `rounded_distance`, the interval of a sum does not consider that squares are not negative.
    let (rounding, overflow) = (Rounding::Truncate, Overflow::Wrap);
    sum.takes(d.narrow("sum_next", adder1, sum.format(), rounding, overflow));
    let [x, y, z] = components.map(|it| component.pick(it));
    SquaredDistance {
        value: rounded_distance(d, keys, adder1),
        steps: vec![
            step("distance_sum <- dx^2", [x, addend.pick(zero), sum.load()]),
            step("distance_sum <- distance_sum + dy^2", [y, addend.pick(sum.q()), sum.load()]),
        ],
        settings: vec![z, addend.pick(sum.q())],
    }
}

fn rounded_distance<'d>(d: &'d Designer, keys: &Keys, sum: Signal<'d>) -> Signal<'d> {
    let format = Format::unsigned(4, keys.distance_fraction as i32);
    // The interval of the sum does not consider that squares are not negative. The sum is from 0 to 12.0.
    d.narrow("distance_rounded", sum, format, keys.distance_rounding, Overflow::Wrap)
}

/// Builds the scaling of the patent: a register that shifts one bit in each clock, controlled by the counter.
///
/// The register starts with half of D²/2^(s+1), by wiring, so that it shifts at least once. A value that exceeds the format
/// saturates to the largest word, which is above 1.0.
fn by_shift<'d>(d: &'d Designer, keys: &Keys, distance: SquaredDistance<'d>) -> Scaled<'d> {
    let count = keys.squarings();
    let half_down = count as i32 + 2;
    // The format can represent every rounded log₂ of an exponent: 0 to `exponent.bits`.
    let format = Format::holding(0, keys.exponent_bits.into(), 0);
    let shift = d.operand("shift", format).doc("log2 of the specular exponent n, rounded").q();
    let register = d
        .register("shift_register", Format::unsigned(1, distance.value.format().frac + half_down))
        .doc("beta*D^2, after all shifts");
    let (squarings, counter, load_shift) = Squarings::sharing(d, count, shift);
    let counter = counter.doc("shifts that remain, then squarings that remain");
    let small = distance
        .value
        .shift_right(half_down)
        .named("distance_at_least_shift")
        .doc("half of D^2 at shift 0, by wiring");
    let twice = register.q().shift_left(1);
    let (rounding, overflow) = (Rounding::Truncate, Overflow::Saturate);
    let doubled = d.narrow("doubled", twice, register.format(), rounding, overflow);
    let input = d.mux("shift_input", [small, doubled]).doc("loads or shifts");
    register.takes(input.out());
    let more = d.any("more_shifts", counter.q()).doc("1 if this is not the last shift");
    let name = "shift_register <- 2 * shift_register";
    let load = [input.pick(small), register.load()];
    let shift_on: [StepSetting; 4] =
        [input.pick(doubled), register.load(), counter.count(), loop_while(more, name)];
    let load = load.into_iter().chain(load_shift).chain(distance.settings);
    let mut steps = vec![step("operands dx, dy, dz", [])];
    steps.extend(distance.steps);
    steps.extend([step("shift_register <- D^2 / (4*power)", load), step(name, shift_on)]);
    Scaled { value: register.q(), steps, squarings }
}

/// Builds β·D² with β = n/2^(s+1) for every n, with a multiplier that the patent does not have. The division is a shift by
/// wiring. The product is rounded to the fraction bits of f, and saturates just below 2.
fn by_multiplier<'d>(d: &'d Designer, keys: &Keys, distance: SquaredDistance<'d>) -> Scaled<'d> {
    let count = keys.squarings();
    let exponent = common::exponent(d, keys.exponent_bits).q();
    let register = d.register("distance", distance.value.format()).doc("D^2");
    register.takes(distance.value);
    let squarings = Squarings::new(d, count);
    let beta = exponent.shift_right(count as i32 + 1).named("beta").doc("n/(2*power), by wiring");
    let multiplier5 = d.mul("multiplier5", register.q(), beta).block(5);
    let scaled = d.register("scaled", Format::unsigned(1, keys.f.fraction as i32)).doc("beta*D^2");
    let (rounding, overflow) = (keys.f.rounding, Overflow::Saturate);
    let product = d.narrow("multiplier5_rounded", multiplier5, scaled.format(), rounding, overflow);
    scaled.takes(product);
    let load = [register.load()].into_iter().chain(distance.settings);
    let mut steps = vec![step("operands dx, dy, dz", [])];
    steps.extend(distance.steps);
    steps.extend([
        step("distance <- D^2", load),
        step("scaled <- beta * distance", [scaled.load()]),
    ]);
    Scaled { value: scaled.q(), steps, squarings }
}

/// Returns `1 − β·D²` as the complement of β·D². The complement is one unit in the last place (an ulp) too small, and so always
/// below 1.0. If β·D² is 1.0 or more, the comparator makes the mux pass 0 instead.
fn base<'d>(d: &'d Designer, value: Signal<'d>, f: Format) -> Signal<'d> {
    let one = d.constant("one", 1.0, Format::unsigned(1, f.frac));
    let comparator = d.less("comparator", value, one).doc("1 if beta*D^2 is below 1.0");
    let inverse = d.not("inverse", value.bits(0, f)).doc("1.0 - beta*D^2 - 1 ulp");
    let zero = d.raw_constant("zero", 0, f);
    d.choose("base", comparator, [zero, inverse]).doc("base of the power, or 0")
}

fn clocks_note(keys: &Keys, config: &Config) -> Note {
    let shift = keys.scale == Scale::Shift;
    let (squares, colours) = (keys.squares_in_turn(), keys.colours.in_turn());
    let output = Shared::of(config).output_registered && !colours;
    Topic::Latency.note(format!(
        "valid is high {}{} clocks after start. One clock each is for {}D^2, scaling, base{} and result, and \
         for each squaring after the first{}.",
        keys.squarings()
            + 4
            + 2 * u32::from(squares)
            + 3 * u32::from(colours)
            + u32::from(output),
        if shift { " + shift" } else { "" },
        if squares { "the squares of dx and dy, " } else { "" },
        match (colours, output) {
            (true, _) => ", each colour",
            (_, true) => ", the output registers",
            _ => "",
        },
        if shift { " and each shift after the first" } else { "" },
    ))
}

fn about(keys: &Keys, config: &Config) -> About {
    let m = keys.power;
    let shift = keys.scale == Scale::Shift;
    let (beta, scaling) = if shift {
        (
            "2^shift",
            "The host loads shift = log2 n, rounded. So beta differs from n/(2*power) by a factor of at most \
             1.42.",
        )
    } else {
        (
            "n",
            "Beta is n/(2*power) for every n. Multiplier 5 is Glint's own and replaces the patent's shift \
             register.",
        )
    };
    let mut notes = vec![
        "The source lists the blocks; their connections are an interpretation. For unit vectors D^2 = 2*(1 - \
         cos gamma), so the function equals the one of cosine-power, without a scalar product."
            .into(),
        scaling.into(),
        clocks_note(keys, config),
        "The formula does not distinguish surfaces that face away: for cos gamma <= 0, which is D^2 >= 2, f is \
         not 0 if n is small. A host that needs 0 there must not start the device."
            .into(),
        "Components may have any value of their format. D^2 is exact: it has room for 12.0, the largest sum of \
         three squares."
            .into(),
        common::outputs_note(&keys.colours, "the accumulator", "begins"),
    ];
    let shifting = "The shift register shifts by one place per clock, shift + 1 times. One counter counts the \
                    shifts and then the squarings.";
    notes.extend(shift.then(|| Topic::Microprogram.note(shifting)));
    About {
        device: "lyon".to_owned(),
        title: format!("Specular intensity from a difference vector, power {m}"),
        formula: format!(
            "out = colour * max(0, 1 - beta*D^2)^{m}, beta = {beta}/(2*{m}), D = N - H"
        ),
        source: "US 5 739 820, Fig. 7C and 7D, the first analogue in seed 000".to_owned(),
        notes,
    }
}
