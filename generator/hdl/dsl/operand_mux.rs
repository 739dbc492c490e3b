//! Builds a multiplier that several products share, and the muxes that select its operands.
//!
//! The operands have different formats, so an [`OperandMux`] carries bits without a binary point. [`SharedProduct::of`] returns
//! the product for a certain selection, exact and with its format and interval. [`Designer::finish`] proves that a register loads
//! such a product only while the microprogram selects its operands.

use super::{Designer, Select, SelectedProduct, Signal, StepSetting};
use crate::netlist::{Driver, FieldId, Op};
use glint_base::codes;
use glint_base::fixed::Format;
use glint_base::interval::{self, Interval, hull};

/// A mux whose inputs may have different formats, in front of a shared multiplier.
#[derive(Clone)]
pub struct OperandMux<'d> {
    designer: &'d Designer,
    name: String,
    field: FieldId,
    out: Signal<'d>,
    inputs: Vec<Signal<'d>>,
    /// The number of registers behind the mux.
    delay: u32,
}

described!(OperandMux, out);

impl Designer {
    /// Returns a mux whose inputs may have different formats. Reports a mistake unless the mux has one input for each choice of
    /// `select`.
    #[track_caller]
    pub fn bus<'d>(
        &'d self,
        name: &str,
        select: Select<'d>,
        inputs: impl IntoIterator<Item = Signal<'d>>,
    ) -> OperandMux<'d> {
        let inputs = self.own_all(&inputs.into_iter().collect::<Vec<_>>());
        let select = self.own_select(select);
        select.check_inputs(name, inputs.len());
        let (low, high) = hull(inputs.iter().map(|input| input.range())).unwrap_or((0, 0));
        let format = Format::holding(low, high, 0);
        let mut carried = Vec::new();
        for input in &inputs {
            let frac = input.format().frac;
            let carrier = Format { frac, int: format.int - frac, ..format };
            carried.push(self.resized(*input, carrier));
        }
        let op = Op::Mux { select: self.field_net(select.field()).id(), inputs: carried };
        let out = self.signal(self.add_net(name, format, (low, high), Driver::Op(op), true));
        OperandMux {
            designer: self,
            name: name.to_owned(),
            field: select.field(),
            out,
            inputs,
            delay: 0,
        }
    }

    /// Returns the product of a multiplier between two muxes that have the same select lines. Reports a mistake if the muxes
    /// differ in select lines, number of inputs or registers behind them.
    ///
    /// If only one of the muxes has negative inputs, the multiplier takes the bits of that mux below its sign as an unsigned
    /// number. Each factor then has one bit less than in a product of signed numbers, which may save DSP blocks. For example, a
    /// factor of 18 bits fits a DSP block of ECP5, and a factor of 19 bits does not. For a negative operand, this product is too
    /// large by the other operand at the weight of the sign; [`SharedProduct::of`] subtracts this.
    #[track_caller]
    pub fn shared_mul<'d>(
        &'d self,
        name: &str,
        first: &OperandMux<'d>,
        second: &OperandMux<'d>,
    ) -> SharedProduct<'d> {
        let (alike, other) = ((first.field, first.delay), (second.field, second.delay));
        if alike != other || first.inputs.len() != second.inputs.len() {
            self.error(codes::PRODUCT, format!(
                "multiplier `{name}`: `{}` and `{}` must have the same number of inputs and the same select \
                 lines, and both or neither must hold the selection",
                first.name, second.name
            ));
        }
        let [a, b] = [first, second].map(|bus| bus.out.format());
        let (out, excess) = match (a.signed, b.signed) {
            // If the signal is a sign bit alone, no bits lie below it.
            (true, false) if a.width() > 1 => {
                self.unsigned_core(name, [first, second], |low| (low, second.out))
            }
            (false, true) if b.width() > 1 => {
                self.unsigned_core(name, [second, first], |low| (first.out, low))
            }
            _ => (self.mul(name, first.out, second.out), None),
        };
        SharedProduct {
            out,
            excess,
            delay: first.delay,
            field: first.field,
            pairs: first.inputs.iter().copied().zip(second.inputs.iter().copied()).collect(),
        }
    }

    /// Multiplies `other` by the bits of `signed` below its sign bit, as an unsigned number. Also returns the excess that the
    /// caller must subtract; `None` if no product needs it. For example, the low bits of the 4-bit number −3 give 5 = −3 + 8, so
    /// the product is too large by 8 · `other`. `ordered` gets these low bits, and returns them and `other` in the order of the
    /// muxes in the call of [`Designer::shared_mul`].
    #[track_caller]
    fn unsigned_core<'d>(
        &'d self,
        name: &str,
        [signed, other]: [&OperandMux<'d>; 2],
        ordered: impl FnOnce(Signal<'d>) -> (Signal<'d>, Signal<'d>),
    ) -> (Signal<'d>, Option<Excess<'d>>) {
        let low = signed.out.format().width() - 1;
        let (first, second) = ordered(signed.out.bits(0, Format::unsigned(low as i32, 0)));
        let out = self.mul(name, first, second);
        // The amount needs only the bits of the largest input of the other mux that is multiplied by a negative input.
        let mut most = 0;
        let mut is_corrected = false;
        for (input, opposite) in signed.inputs.iter().zip(&other.inputs) {
            if input.range().0 < 0 {
                let products = interval::product(input.range(), opposite.range());
                is_corrected |= Format::holding(products.0, products.1, 0).width() > low;
                most = opposite.range().1.max(most);
            }
        }
        if !is_corrected {
            // Every product of a negative input has so few bits that the excess lies above them.
            return (out, None);
        }
        let format = Format::holding(0, most.max(1), 0);
        let inputs =
            vec![self.raw_constant("zeros", 0, format).id(), other.out.bits(0, format).id()];
        let op = Op::Mux { select: signed.out.bit(low).id(), inputs };
        let range = (0, format.max_raw());
        let amount = self.add_net(&format!("{name}_excess"), format, range, Driver::Op(op), true);
        let amount = self.signal(amount).doc("correction of the product for a negative operand");
        (out, Some(Excess { amount, low }))
    }
}

impl<'d> OperandMux<'d> {
    /// Selects `input`. Reports a mistake unless `input` is exactly one input of the mux.
    #[track_caller]
    pub fn pick(&self, input: Signal<'d>) -> StepSetting {
        StepSetting::pick_of(self.designer, self.field, &self.name, input, &self.inputs)
    }

    /// Adds a register `<name>_held` behind the mux. The register loads on every clock, and so contains the operand that the
    /// previous microinstruction selected.
    ///
    /// The mux then takes time of one clock, and the multiplier has the next clock to itself. A microprogram selects the operands
    /// in one microinstruction, and loads the product in the next one under the same selection ([`hold`](super::hold)).
    #[must_use]
    #[track_caller]
    pub fn held(self) -> Self {
        let name = format!("{}_held", self.name);
        let doc = "the input that the previous microinstruction selected";
        let out = self.designer.pipeline(&name, self.out).doc(doc);
        Self { out, delay: self.delay + 1, ..self }
    }
}

/// The amount by which a product of unsigned numbers is too large if an operand is negative.
#[derive(Clone, Copy)]
struct Excess<'d> {
    /// The other operand if the sign of the negative operand is set, and otherwise 0.
    amount: Signal<'d>,
    /// The weight of the lowest bit of `amount`, as a power of two: the number of the operand's sign bit.
    low: u32,
}

/// The product of a multiplier whose two factors come from muxes under the same selection.
#[derive(Clone)]
pub struct SharedProduct<'d> {
    out: Signal<'d>,
    excess: Option<Excess<'d>>,
    /// The number of registers between the muxes and the multiplier.
    delay: u32,
    field: FieldId,
    pairs: Vec<(Signal<'d>, Signal<'d>)>,
}

described!(SharedProduct, out);

impl<'d> SharedProduct<'d> {
    /// Returns the exact product of `first` and `second`. Reports a mistake unless they are inputs of the two muxes under the
    /// same selection.
    #[track_caller]
    pub fn of(&self, first: Signal<'d>, second: Signal<'d>) -> Signal<'d> {
        self.of_any(&[(first, second)])
    }

    /// Returns a product of any of the `pairs`, in one format that can represent all of them. A register that loads different
    /// products in different microinstructions takes this signal. Reports a mistake if the products have different binary points,
    /// or if a pair is never multiplied.
    #[track_caller]
    pub fn of_any(&self, pairs: &[(Signal<'d>, Signal<'d>)]) -> Signal<'d> {
        let d = self.out.designer();
        let mut values = Vec::new();
        let mut points = Vec::new();
        let mut range: Option<Interval> = None;
        for (first, second) in pairs {
            let (first, second) = (d.own(*first), d.own(*second));
            let found =
                self.pairs.iter().position(|(a, b)| a.id() == first.id() && b.id() == second.id());
            let Some(at) = found else {
                let [own, first, second] = [self.out, first, second].map(Signal::name);
                let message = format!("`{own}` never multiplies `{first}` by `{second}`");
                d.error(codes::PRODUCT, message);
                continue;
            };
            values.push(at as u64);
            points.push(first.format().frac + second.format().frac);
            let products = interval::product(first.range(), second.range());
            range = hull(range.into_iter().chain([products]));
        }
        let (Some(range), Some(&frac)) = (range, points.first()) else {
            return self.out;
        };
        if points.iter().any(|point| *point != frac) {
            d.error(codes::POINT, format!(
                "the selected products of `{}` have different numbers of fraction bits, {points:?}: append \
                 zeros to an operand",
                self.out.name()
            ));
        }
        let format = Format::holding(range.0, range.1, frac);
        let view = match self.excess {
            Some(excess) if range.0 < 0 && format.width() > excess.low => {
                self.corrected(format, range, excess)
            }
            _ => self.out.resized_as("view", format, range),
        };
        let described = SelectedProduct { field: self.field, values, delay: self.delay };
        d.with(|inner| inner.views.insert(view.id(), described));
        view
    }

    /// Subtracts the excess from the upper bits of the product.
    #[track_caller]
    fn corrected(&self, format: Format, range: Interval, excess: Excess<'d>) -> Signal<'d> {
        let d = self.out.designer();
        let upper = Format::unsigned((format.width() - excess.low) as i32, 0);
        let whole = Format::unsigned(format.width() as i32, 0);
        let raw = self.out.resized_as("wide", whole, whole.range());
        let too_large = raw.bits(excess.low, upper);
        let amount = excess.amount.resized_as("wide", upper, upper.range());
        let name = format!("{}_upper", self.out.name());
        let op = Op::Sub(too_large.id(), amount.id());
        let upper = d.add_wiring(&name, upper, upper.range(), Driver::Op(op));
        let lower = raw.bits(0, Format::unsigned(excess.low as i32, 0));
        let op = Op::Concat(vec![upper, lower.id()]);
        self.out.wiring("view", format, range, op)
    }
}
