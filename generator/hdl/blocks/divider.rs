//! Builds an iterative divider, which computes one bit of the quotient a clock by trial subtraction (restoring division).
//!
//! The first remainder is the dividend. A step doubles the remainder and subtracts the divisor if the difference is not
//! negative. Each step gives one bit of the quotient, from the top bit down: 1 if the step subtracted. The last remainder is
//! exact, so every bit of the quotient is correct. Only a quotient of 1.0 becomes the largest fraction below 1.

use crate::dsl::{Counter, Designer, Mux, Register, Signal, StepSetting};
use glint_base::codes;
use glint_base::fixed::{Format, Overflow, Rounding};

/// Computes `dividend / divisor`, truncated to a fraction `u0.Q`. Neither operand may be negative, and the dividend must not
/// exceed the divisor. For example, 1 / 3 with Q = 4 gives 5/16.
///
/// A quotient of 1.0 becomes `1.0 − ulp` (all bits 1), and so does a division by 0. A device that must avoid a division by 0
/// keeps the divisor above 0.
///
/// A division takes a microinstruction that [loads](Self::load) the operands, and Q executions of a microinstruction that
/// [steps](Self::step), which is one microinstruction in a loop:
///
/// ```
/// use glint_rtl::blocks::divider::Divider;
/// use glint_rtl::dsl::{Designer, end, loop_while, step, valid};
/// use glint_base::fixed::Format;
///
/// let d = Designer::new("ratio");
/// let a = d.operand("a", Format::unsigned(8, 0));
/// let b = d.operand("b", Format::unsigned(8, 0));
/// let ratio = Divider::new(&d, "ratio", a.q(), b.q(), 12);
/// d.output("ratio_out", ratio.quotient());
/// d.microprogram([
///     step("operands", []),
///     step("load", ratio.load()),
///     step("bit", ratio.step().into_iter().chain([loop_while(ratio.more(), "bit")])),
///     step("result", [valid(), end()]),
/// ]);
/// assert!(d.finish().is_ok());
/// ```
pub struct Divider<'d> {
    quotient: Register<'d>,
    divisor: Register<'d>,
    remainder: Register<'d>,
    remaining: Counter<'d>,
    source: Mux<'d>,
    dividend: Signal<'d>,
    stepped: Signal<'d>,
    more: Signal<'d>,
}

impl<'d> Divider<'d> {
    /// Makes a divider of `bits` quotient bits. The quotient's register is `name`, the others are `<name>_divisor`,
    /// `<name>_remainder` and the counter `<name>_remaining`. Reports a mistake if `bits` is less than 2, or if an operand can be
    /// negative.
    #[track_caller]
    pub fn new(
        d: &'d Designer,
        name: &str,
        dividend: Signal<'d>,
        divisor: Signal<'d>,
        bits: i32,
    ) -> Self {
        let part = |suffix: &str| format!("{name}_{suffix}");
        if bits < 2 {
            let message = format!(
                "divider `{name}` has a quotient of {bits} bits: request at least two bits"
            );
            d.error(codes::WIDE, message);
        }
        for operand in [dividend, divisor] {
            let (low, high) = operand.range();
            if low < 0 {
                d.error(codes::SIGN, format!(
                    "divider `{name}`: `{}` has values from {low} to {high} ulp: divide absolute values, or \
                     narrow the operand to an unsigned format, which saturates at 0",
                    operand.name()
                ));
            }
        }
        let quotient_bits = bits.max(2);
        let frac = dividend.format().frac.max(divisor.format().frac);
        let aligned_divisor = divisor.with_fraction(frac);
        let format = aligned_divisor.format();
        // Neither the dividend nor a remainder exceeds the divisor, so that the upper bits are 0.
        let cut = |name: &str, signal: Signal<'d>| {
            d.narrow(name, signal, format, Rounding::Truncate, Overflow::Wrap)
        };
        let dividend = cut(&part("dividend"), dividend.with_fraction(frac));

        let held = d.register(&part("divisor"), format).doc("the divisor");
        held.takes(aligned_divisor);
        let remainder = d
            .register(&part("remainder"), format)
            .doc("the dividend, later the remainder, at most the divisor");
        let quotient = d
            .register(name, Format::unsigned(0, quotient_bits))
            .doc("the quotient; each step shifts in one bit");
        let most = i128::from(quotient_bits) - 1;
        let last = d.raw_constant(&part("last"), most, Format::holding(0, most, 0));
        let remaining =
            d.down_counter(&part("remaining"), last).doc("quotient bits after the next one");

        let doubled = remainder.q().shift_left(1).with_fraction(frac);
        let trial = d
            .sub(&part("trial"), doubled, held.q())
            .doc("negative if the divisor exceeds the remainder");
        let negative = trial.bit(trial.format().width() - 1);
        let bit = d.not(&part("bit"), negative).doc("the next quotient bit: 1 if the divisor fits");
        let left = d.choose(&part("left"), bit, [doubled, trial]);
        let stepped = cut(&part("stepped"), left);
        let source = d.mux(&part("source"), [dividend, stepped]);
        remainder.takes(source.out());
        let upper = quotient.q().bits(0, Format::unsigned(quotient_bits - 1, 0));
        quotient.takes(upper.above(bit, quotient.format()));
        Self {
            quotient,
            divisor: held,
            remainder,
            remaining,
            source,
            dividend,
            stepped,
            more: d
                .any(&part("more"), remaining.q())
                .doc("1 if the next quotient bit is not the last"),
        }
    }

    /// Returns the quotient in the format `u0.Q`, which is complete after all Q steps.
    pub fn quotient(&self) -> Signal<'d> {
        self.quotient.q()
    }

    /// Returns the settings of a microinstruction that loads dividend and divisor. The registers take the values at the end of
    /// its clock.
    #[track_caller]
    pub fn load(&self) -> [StepSetting; 4] {
        [
            self.source.pick(self.dividend),
            self.remainder.load(),
            self.divisor.load(),
            self.remaining.load(),
        ]
    }

    /// Returns the settings of a microinstruction that computes the next bit of the quotient. The register takes the bit at the
    /// end of the clock. A quotient of Q bits needs Q executions of this microinstruction after [`Self::load`].
    #[track_caller]
    pub fn step(&self) -> [StepSetting; 4] {
        [
            self.source.pick(self.stepped),
            self.remainder.load(),
            self.quotient.load(),
            self.remaining.count(),
        ]
    }

    /// Returns the loop condition: 1 as long as another step must follow.
    pub fn more(&self) -> Signal<'d> {
        self.more
    }
}
