//! A multiplier shared by operands of different formats.
//!
//! The formats of what a shared multiplier multiplies differ from word to word, so its operand muxes
//! carry bits, not values: a [`Bus`] is as wide as its widest input. The product means something only
//! together with the selection, and [`SharedProduct::of`] gives it back its format: exact, with its
//! range, for one selection or for several that agree in their point. [`crate::check`] then proves for
//! every word that a register which takes such a view is loaded under a selection that it is for.

use super::signal::product_range;
use super::{Designer, Select, Setting, Signal, View};
use crate::fixed::Format;
use crate::netlist::{Driver, FieldId, Op};

/// A mux of operands of different formats.
#[derive(Clone)]
pub struct Bus<'d> {
    designer: &'d Designer,
    name: String,
    field: FieldId,
    out: Signal<'d>,
    inputs: Vec<Signal<'d>>,
}

impl Designer {
    /// A mux whose inputs may differ in format, under `select`.
    #[track_caller]
    pub fn bus<'d>(
        &'d self,
        name: &str,
        select: Select<'d>,
        inputs: impl IntoIterator<Item = Signal<'d>>,
    ) -> Bus<'d> {
        let inputs: Vec<_> = inputs.into_iter().collect();
        select.check_inputs(name, inputs.len());
        let low = inputs
            .iter()
            .map(|input| input.range().0)
            .min()
            .unwrap_or(0);
        let high = inputs
            .iter()
            .map(|input| input.range().1)
            .max()
            .unwrap_or(0);
        let format = Format::holding(low, high, 0);
        let carried = inputs
            .iter()
            .map(|input| {
                let have = input.format();
                self.resized(
                    *input,
                    Format {
                        frac: have.frac,
                        int: format.int - have.frac,
                        signed: format.signed,
                    },
                )
            })
            .collect();
        let op = Op::Mux {
            select: self.field_net(select.field()).id(),
            inputs: carried,
        };
        let out = self.signal(self.add_net(name, format, (low, high), Driver::Op(op), true));
        Bus {
            designer: self,
            name: name.to_owned(),
            field: select.field(),
            out,
            inputs,
        }
    }

    /// The product of two buses under the same select lines.
    #[track_caller]
    pub fn shared_mul<'d>(
        &'d self,
        name: &str,
        first: &Bus<'d>,
        second: &Bus<'d>,
    ) -> SharedProduct<'d> {
        if first.field != second.field || first.inputs.len() != second.inputs.len() {
            self.error(format!(
                "multiplier `{name}`: `{}` and `{}` must have as many inputs under the same select lines",
                first.name, second.name
            ));
        }
        SharedProduct {
            out: self.mul(name, first.out, second.out),
            field: first.field,
            pairs: first
                .inputs
                .iter()
                .copied()
                .zip(second.inputs.iter().copied())
                .collect(),
        }
    }
}

impl<'d> Bus<'d> {
    /// The knob: passes `input` on. It must be one of the inputs.
    #[track_caller]
    pub fn pick(&self, input: Signal<'d>) -> Setting {
        Setting::pick_of(self.designer, self.field, &self.name, input, &self.inputs)
    }

    /// The block number in the source's figure.
    #[must_use]
    pub fn block(self, number: u16) -> Self {
        let _ = self.out.block(number);
        self
    }

    /// One line for the reader of the Verilog.
    #[must_use]
    pub fn doc(self, line: &str) -> Self {
        let _ = self.out.doc(line);
        self
    }
}

/// The product of two buses.
#[derive(Clone)]
pub struct SharedProduct<'d> {
    out: Signal<'d>,
    field: FieldId,
    pairs: Vec<(Signal<'d>, Signal<'d>)>,
}

impl<'d> SharedProduct<'d> {
    /// The product of `first` and `second`, which must stand opposite each other on the two buses.
    #[track_caller]
    pub fn of(&self, first: Signal<'d>, second: Signal<'d>) -> Signal<'d> {
        self.of_any(&[(first, second)])
    }

    /// The product of any of the pairs, which must have one point: what a register takes in several
    /// words.
    #[track_caller]
    pub fn of_any(&self, pairs: &[(Signal<'d>, Signal<'d>)]) -> Signal<'d> {
        let d = self.out.designer();
        let mut values = Vec::new();
        let mut points = Vec::new();
        let mut range: Option<(i128, i128)> = None;
        for (first, second) in pairs {
            let found = self
                .pairs
                .iter()
                .position(|(a, b)| a.id() == first.id() && b.id() == second.id());
            let Some(at) = found else {
                d.error(format!(
                    "`{}` never multiplies `{}` by `{}`",
                    self.out.name(),
                    first.name(),
                    second.name()
                ));
                continue;
            };
            values.push(at as u64);
            points.push(first.format().frac + second.format().frac);
            let (low, high) = product_range(first.range(), second.range());
            range = Some(range.map_or((low, high), |(from, to)| (from.min(low), to.max(high))));
        }
        let (Some(range), Some(&frac)) = (range, points.first()) else {
            return self.out;
        };
        if points.iter().any(|point| *point != frac) {
            d.error(format!(
                "the products of `{}` that are taken together have {points:?} fraction bits: append zeros to an operand",
                self.out.name()
            ));
        }
        let format = Format::holding(range.0, range.1, frac);
        let op = if format.width() == self.out.format().width() {
            Op::Relabel(self.out.id())
        } else if format.width() < self.out.format().width() {
            Op::Slice {
                of: self.out.id(),
                low: 0,
            }
        } else {
            Op::Extend(self.out.id())
        };
        let view = self.out.wiring("view", format, range, op);
        let field = self.field;
        d.with(|inner| inner.views.insert(view.id(), View { field, values }));
        view
    }

    /// The block number in the source's figure.
    #[must_use]
    pub fn block(self, number: u16) -> Self {
        let _ = self.out.block(number);
        self
    }

    /// One line for the reader of the Verilog.
    #[must_use]
    pub fn doc(self, line: &str) -> Self {
        let _ = self.out.doc(line);
        self
    }
}
