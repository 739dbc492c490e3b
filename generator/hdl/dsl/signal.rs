//! Defines signals, and the operations on them: wiring, arithmetic, comparisons and muxes.

use std::cmp::Ordering;

use super::{Designer, StepSetting};
use crate::netlist::{Driver, FieldId, NetId, Op, Topic};
use glint_base::codes;
use glint_base::fixed::Format;
use glint_base::interval::{self, Interval, hull};

/// A signal of a hardware description: the handle of a net.
#[derive(Clone, Copy)]
pub struct Signal<'d> {
    designer: &'d Designer,
    id: NetId,
}

impl<'d> Signal<'d> {
    pub(crate) fn new(designer: &'d Designer, id: NetId) -> Self {
        Self { designer, id }
    }

    pub(crate) fn id(self) -> NetId {
        self.id
    }

    pub(crate) fn designer(self) -> &'d Designer {
        self.designer
    }

    pub fn name(self) -> String {
        self.designer.net(self.id).name
    }

    pub fn format(self) -> Format {
        self.designer.with(|inner| inner.design.net(self.id).format)
    }

    /// Returns the smallest and the largest raw value that the signal can have.
    pub fn range(self) -> Interval {
        self.designer.with(|inner| inner.design.net(self.id).range)
    }

    /// Sets the block's number in the source's block diagram, which comments in the Verilog state.
    #[must_use]
    pub fn block(self, number: u16) -> Self {
        self.designer.with(|inner| inner.design.nets[self.id.index()].block = Some(number));
        self
    }

    /// Sets a comment of one line, which the Verilog shows at the signal.
    #[must_use]
    pub fn doc(self, line: &str) -> Self {
        self.designer.set_doc(self.id, line);
        self
    }

    /// Sets a comment of one line that belongs to `topic`. A pipeline shows only comments of the topic [`Topic::Device`].
    #[must_use]
    pub fn doc_on(self, topic: Topic, line: &str) -> Self {
        self.designer.with(|inner| inner.design.nets[self.id.index()].doc_topic = topic);
        self.doc(line)
    }

    /// Names a net that the description language made as wiring, so that Verilog and waveforms show it under this name.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        self.designer.with(|inner| {
            let net = &mut inner.design.nets[self.id.index()];
            inner.names.remove(&net.name);
            inner.names.insert(name.to_owned());
            name.clone_into(&mut net.name);
            net.named = true;
        });
        self
    }

    /// Divides by 2^places by moving the binary point, without logic: 2 places turn `u0.8` into `u-2.10`.
    #[must_use]
    #[track_caller]
    pub fn shift_right(self, places: i32) -> Self {
        let mut format = self.format();
        format.int = format.int.saturating_sub(places);
        format.frac = format.frac.saturating_add(places);
        self.relabelled(format)
    }

    /// Multiplies by 2^places by moving the binary point, without logic: 2 places turn `u0.8` into `u2.6`.
    #[must_use]
    #[track_caller]
    pub fn shift_left(self, places: i32) -> Self {
        self.shift_right(places.saturating_neg())
    }

    /// Appends zeros up to `frac` fraction bits: `with_fraction(12)` turns `u0.8` into `u0.12`. Reports a mistake if the signal
    /// has more fraction bits.
    #[must_use]
    #[track_caller]
    pub fn with_fraction(self, frac: i32) -> Self {
        let (own, format) = (self.name(), self.format());
        let places = frac.saturating_sub(format.frac);
        if places == 0 {
            return self;
        }
        if places < 0 {
            let message = format!(
                "`{own}` is {format}, and {frac} fraction bits would drop some of its bits: use `narrow`"
            );
            self.designer.error(codes::POINT, message);
            return self;
        }
        let scaled = Format { frac, ..format };
        let sound = self.designer.sound(&format!("{own}_scaled"), scaled);
        if sound != scaled {
            return self.designer.raw_constant("zeros", 0, sound);
        }
        let zeros = self.designer.raw_constant("zeros", 0, Format::unsigned(places, 0));
        let (low, high) = self.range();
        let range = (low << places, high << places);
        self.wiring("scaled", scaled, range, Op::Concat(vec![self.id, zeros.id]))
    }

    /// Reads the bits from bit `low` up as a number of `format`. For example, `x.bits(4, Format::unsigned(4, 0))` is the upper
    /// half of a `u8.0` signal `x`. Reports a mistake if the signal has too few bits.
    #[must_use]
    #[track_caller]
    pub fn bits(self, low: u32, format: Format) -> Self {
        let (own, have) = (self.name(), self.format().width());
        let format = self.designer.sound(&format!("{own}_bits"), format);
        if low.saturating_add(format.width()) > have {
            let last = u64::from(low) + u64::from(format.width()) - 1;
            let message = format!(
                "bits {low} to {last} of `{own}` do not all exist: the signal has {have} bits"
            );
            self.designer.error(codes::WIDTH, message);
            return self.designer.raw_constant("zeros", 0, format);
        }
        // The top bits of a value that is never negative are monotonic in it, so that their interval follows.
        let (from, to) = self.range();
        let top = low + format.width() == have && !format.signed && from >= 0;
        let range = if top { (from >> low, to >> low) } else { format.range() };
        self.wiring("bits", format, range, Op::Slice { of: self.id, low })
    }

    /// Returns bit number `at`, counted from the lowest, 0. Reports a mistake if the signal has no such bit.
    #[must_use]
    #[track_caller]
    pub fn bit(self, at: u32) -> Self {
        self.bits(at, Format::BIT)
    }

    /// Appends the bits of `low` below this signal, and reads the result in `format`, as a shift register does with the bit
    /// that enters. Reports a mistake unless `format` is as wide as both signals together.
    #[must_use]
    #[track_caller]
    pub fn above(self, low: Signal<'d>, format: Format) -> Self {
        let low = self.designer.own(low);
        let width = self.format().width() + low.format().width();
        let (own, other) = (self.name(), low.name());
        let format = self.designer.sound(&format!("{own}_above"), format);
        if width != format.width() {
            let message = format!(
                "`{own}` above `{other}` has {width} bits, and {format} has another number of bits"
            );
            self.designer.error(codes::WIDTH, message);
            return self.designer.raw_constant("zeros", 0, format);
        }
        let op = Op::Concat(vec![self.id, low.id]);
        self.wiring("above", format, format.range(), op)
    }

    /// Returns the same value as a signed signal: `u0.8` becomes `s0.8`, one bit wider.
    #[must_use]
    #[track_caller]
    pub fn as_signed(self) -> Self {
        let format = self.format();
        if format.signed {
            return self;
        }
        let signed = Format { signed: true, ..format };
        self.designer.signal(self.designer.resized(self, signed))
    }

    /// Reads the low bits in another format, without conversion: 255 in `u8.0` is read as −1 in `s7.0`. Reports a mistake if
    /// `format` is wider than the signal.
    #[must_use]
    #[track_caller]
    pub fn read_as(self, format: Format) -> Self {
        self.bits(0, format)
    }

    #[track_caller]
    fn relabelled(self, format: Format) -> Self {
        let range = self.range();
        self.wiring("shifted", format, range, Op::Relabel(self.id))
    }

    #[track_caller]
    pub(crate) fn wiring(self, suffix: &str, format: Format, range: Interval, op: Op) -> Self {
        let name = format!("{}_{suffix}", self.name());
        let id = self.designer.add_wiring(&name, format, range, Driver::Op(op));
        self.designer.signal(id)
    }

    /// Truncates or extends this signal to `format`. The new net has the signal's name, `_` and `suffix`.
    #[track_caller]
    pub(crate) fn resized_as(self, suffix: &str, format: Format, range: Interval) -> Self {
        let op = match format.width().cmp(&self.format().width()) {
            Ordering::Greater => Op::Extend(self.id),
            Ordering::Equal => Op::Relabel(self.id),
            Ordering::Less => Op::Slice { of: self.id, low: 0 },
        };
        self.wiring(suffix, format, range, op)
    }
}

/// Arithmetic blocks. Results are exact: their formats can represent every value that the operands can give.
impl Designer {
    /// Aligns the binary points and adds: two `u0.8` signals that may have any value give `u1.8`.
    #[track_caller]
    pub fn add<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        self.sum(name, a, b, None)
    }

    /// Returns `a + b`, plus the bit `carry` in the last place of the operand with more fraction bits.
    #[track_caller]
    pub fn add_carry<'d>(
        &'d self,
        name: &str,
        a: Signal<'d>,
        b: Signal<'d>,
        carry: Signal<'d>,
    ) -> Signal<'d> {
        self.sum(name, a, b, Some(carry))
    }

    #[track_caller]
    fn sum<'d>(
        &'d self,
        name: &str,
        a: Signal<'d>,
        b: Signal<'d>,
        carry: Option<Signal<'d>>,
    ) -> Signal<'d> {
        let (a, b) = aligned(self.own(a), self.own(b));
        let carry = self.own_all(carry.as_slice()).pop();
        let (a_range, b_range) = (a.range(), b.range());
        let carry_most = i128::from(carry.is_some());
        let range = (a_range.0 + b_range.0, a_range.1 + b_range.1 + carry_most);
        let format = Format::holding(range.0, range.1, a.format().frac);
        let op = Op::Add {
            a: self.resized(a, format),
            b: self.resized(b, format),
            carry: carry.map(Signal::id),
        };
        self.signal(self.add_net(name, format, range, Driver::Op(op), true))
    }

    /// Returns `a + b` modulo 2^width, plus `carry` in the last place: 200 + 100 in `u8.0` gives 44. Reports a mistake unless
    /// both signals have the same format. The patent's arithmetic of `rough` uses this sum.
    #[track_caller]
    pub fn add_modulo<'d>(
        &'d self,
        name: &str,
        a: Signal<'d>,
        b: Signal<'d>,
        carry: Option<Signal<'d>>,
    ) -> Signal<'d> {
        let (a, b, carry) = (self.own(a), self.own(b), self.own_all(carry.as_slice()).pop());
        let format = a.format();
        if format != b.format() {
            self.error(codes::WIDTH, format!(
                "`{name}` adds `{}` ({format}) and `{}` ({}) modulo the width: the formats must be equal",
                a.name(),
                b.name(),
                b.format()
            ));
            return a;
        }
        let op = Op::Add { a: a.id(), b: b.id(), carry: carry.map(Signal::id) };
        self.signal(self.add_net(name, format, format.range(), Driver::Op(op), true))
    }

    /// Aligns the binary points and subtracts: two operands `u0.8` that may have any value give `s0.8`. The result is unsigned if
    /// the ranges show that it is never negative.
    #[track_caller]
    pub fn sub<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = aligned(self.own(a), self.own(b));
        let (a_range, b_range) = (a.range(), b.range());
        let range = (a_range.0 - b_range.1, a_range.1 - b_range.0);
        let format = Format::holding(range.0, range.1, a.format().frac);
        let op = Op::Sub(self.resized(a, format), self.resized(b, format));
        self.signal(self.add_net(name, format, range, Driver::Op(op), true))
    }

    /// Multiplies: two `u0.8` signals give `u0.16`. If only one signal is signed, the other one becomes signed first, one bit
    /// wider.
    #[track_caller]
    pub fn mul<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = (self.own(a), self.own(b));
        let (a, b) = if a.format().signed == b.format().signed {
            (a, b)
        } else {
            (a.as_signed(), b.as_signed())
        };
        let (fa, fb) = (a.format(), b.format());
        let frac = fa.frac + fb.frac;
        let width = (fa.width() + fb.width()) as i32;
        let format = Format { signed: fa.signed, int: width - frac - i32::from(fa.signed), frac };
        let range = interval::product(a.range(), b.range());
        self.signal(self.add_net(name, format, range, Driver::Op(Op::Mul(a.id(), b.id())), true))
    }

    /// Inverts every bit. The raw value is `−a − 1` for a signed signal, and `largest − a` for an unsigned one.
    #[track_caller]
    pub fn not<'d>(&'d self, name: &str, a: Signal<'d>) -> Signal<'d> {
        let a = self.own(a);
        let format = a.format();
        let (low, high) = a.range();
        let top = if format.signed { -1 } else { format.max_raw() };
        let net =
            self.add_net(name, format, (top - high, top - low), Driver::Op(Op::Not(a.id())), true);
        self.signal(net)
    }

    /// Joins the bits of `high` and `low` by wiring: 2 in `u2.0` and 5 in `u3.0` give 21 in `u5.0`. Reports a mistake if a part
    /// is signed, because its bits would be read as another number.
    #[track_caller]
    pub fn concat<'d>(&'d self, name: &str, high: Signal<'d>, low: Signal<'d>) -> Signal<'d> {
        let (mut high, mut low) = (self.own(high), self.own(low));
        for part in [&mut high, &mut low] {
            let have = part.format();
            if have.signed {
                self.error(codes::SIGN, format!(
                    "`{name}` puts `{}`, which is {have}, beside other bits of an unsigned number: convert \
                     the signal with `read_as`, or use `join`",
                    part.name()
                ));
                *part = part.read_as(Format::unsigned(have.width() as i32, 0));
            }
        }
        let width = low.format().width();
        let format = Format::unsigned((high.format().width() + width) as i32, 0);
        let (from, to) = (high.range().0 << width, high.range().1 << width);
        let range = (from + low.range().0, to + low.range().1);
        let op = Op::Concat(vec![high.id(), low.id()]);
        self.signal(self.add_net(name, format, range, Driver::Op(op), true))
    }

    /// Replaces the low bits of the constant `high`, which must be 0, by `low`, without logic. For example, `high` = 0b1000 and a
    /// `low` of three bits give the addresses 8 to 15. If `low` is as wide as `format`, returns `low` itself; it must not be
    /// wider.
    #[track_caller]
    pub fn beside<'d>(&'d self, high: Signal<'d>, low: Signal<'d>, format: Format) -> Signal<'d> {
        let low_bits = low.format().width();
        let (from, to) = (high.range().0, high.range().0 + low.range().1);
        if low_bits == format.width() {
            return low;
        }
        let top = high.bits(low_bits, Format::unsigned((format.width() - low_bits) as i32, 0));
        low.wiring("beside", format, (from, to), Op::Concat(vec![top.id(), low.id()]))
    }

    /// Joins the bits of all parts by wiring, the first part in the top bits. Reports a mistake unless `format` is as wide as all
    /// parts together.
    #[track_caller]
    pub fn join<'d>(&'d self, name: &str, parts: &[Signal<'d>], format: Format) -> Signal<'d> {
        let parts = self.own_all(parts);
        let width: u32 = parts.iter().map(|part| part.format().width()).sum();
        let format = self.sound(name, format);
        if width != format.width() {
            let message = format!(
                "`{name}` joins {width} bits to a word of {} bits ({format})",
                format.width()
            );
            self.error(codes::WIDTH, message);
            return self.raw_constant("zeros", 0, format);
        }
        // If no part can be negative, the result is monotonic in every part.
        let ends = parts.iter().try_fold((0, 0), |(low, high), part| {
            let (from, to) = part.range();
            let width = part.format().width();
            (from >= 0).then_some((low << width | from, high << width | to))
        });
        let range = match ends {
            Some((low, high)) if !format.signed => (low, high),
            _ => format.range(),
        };
        let nets = parts.iter().map(|part| part.id()).collect();
        self.signal(self.add_wiring(name, format, range, Driver::Op(Op::Concat(nets))))
    }

    /// Returns `a` and `b`. Reports a mistake unless both have one bit.
    #[track_caller]
    pub fn and<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = (self.one_bit(a), self.one_bit(b));
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::And(a, b))))
    }

    /// Returns `a` or `b`. Reports a mistake unless both have one bit.
    #[track_caller]
    pub fn or<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = (self.one_bit(a), self.one_bit(b));
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::Or(a, b))))
    }

    /// Returns the exclusive or. Reports a mistake unless `a` and `b` have one bit.
    #[track_caller]
    pub fn xor<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = (self.one_bit(a), self.one_bit(b));
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::Xor(a, b))))
    }

    /// Returns whether the value of `a` is below the value of `b`. Binary points and signs may differ.
    #[track_caller]
    pub fn less<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = self.comparable(a, b);
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::Less(a, b))))
    }

    /// Returns whether the values are equal. Binary points and signs may differ.
    #[track_caller]
    pub fn equal<'d>(&'d self, name: &str, a: Signal<'d>, b: Signal<'d>) -> Signal<'d> {
        let (a, b) = self.comparable(a, b);
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::Equal(a, b))))
    }

    /// Returns a bit that is 1 if any bit of `a` is 1.
    #[track_caller]
    pub fn any<'d>(&'d self, name: &str, a: Signal<'d>) -> Signal<'d> {
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::Any(self.own(a).id()))))
    }

    /// Returns a bit that is 1 if every bit of `a` is 1.
    #[track_caller]
    pub fn all<'d>(&'d self, name: &str, a: Signal<'d>) -> Signal<'d> {
        self.signal(self.add_named(name, Format::BIT, Driver::Op(Op::All(self.own(a).id()))))
    }

    /// Returns input 0 or 1 by the bit `select` of the datapath, in a format that can represent both. Reports a mistake if
    /// `select` has several bits, or if the inputs have different binary points.
    #[track_caller]
    pub fn choose<'d>(
        &'d self,
        name: &str,
        select: Signal<'d>,
        inputs: [Signal<'d>; 2],
    ) -> Signal<'d> {
        let select = self.one_bit(select);
        self.mux_of(name, select, &inputs)
    }

    /// Returns a mux that the microprogram controls by its own field, `<name>_select`.
    ///
    /// Reports a mistake if there is no input, or if the inputs have different binary points. [`Signal::with_fraction`] aligns
    /// binary points, and [`Designer::bus`] takes any inputs.
    #[track_caller]
    pub fn mux<'d>(&'d self, name: &str, inputs: impl IntoIterator<Item = Signal<'d>>) -> Mux<'d> {
        let inputs: Vec<_> = inputs.into_iter().collect();
        let names: Vec<String> = inputs.iter().map(|input| input.name()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let select = self.select(&format!("{name}_select"), &names);
        self.mux_on(name, select, inputs)
    }

    /// Returns a mux that shared select lines control. Reports a mistake unless the mux has one input for each choice, and all
    /// inputs have the same binary point.
    #[track_caller]
    pub fn mux_on<'d>(
        &'d self,
        name: &str,
        select: super::Select<'d>,
        inputs: impl IntoIterator<Item = Signal<'d>>,
    ) -> Mux<'d> {
        let inputs: Vec<_> = inputs.into_iter().collect();
        let select = self.own_select(select);
        select.check_inputs(name, inputs.len());
        let out = self.mux_of(name, self.field_net(select.field()).id(), &inputs);
        Mux { out, field: select.field() }
    }

    #[track_caller]
    fn mux_of<'d>(&'d self, name: &str, select: NetId, inputs: &[Signal<'d>]) -> Signal<'d> {
        let inputs = self.own_all(inputs);
        let Some(first) = inputs.first() else {
            self.error(codes::WIDTH, format!("mux `{name}` has no inputs"));
            return self.raw_constant("zeros", 0, Format::BIT);
        };
        let frac = first.format().frac;
        if let Some(other) = inputs.iter().find(|input| input.format().frac != frac) {
            self.error(codes::POINT, format!(
                "mux `{name}`: `{}` is {} and `{}` is {}; the binary points differ: align them with \
                 `with_fraction`, or use a `bus`",
                first.name(),
                first.format(),
                other.name(),
                other.format()
            ));
            return *first;
        }
        let (low, high) = hull(inputs.iter().map(|input| input.range())).unwrap_or((0, 0));
        let format = Format::holding(low, high, frac);
        let resized = inputs.iter().map(|input| self.resized(*input, format)).collect();
        let op = Op::Mux { select, inputs: resized };
        self.signal(self.add_net(name, format, (low, high), Driver::Op(op), true))
    }

    #[track_caller]
    fn one_bit(&self, a: Signal<'_>) -> NetId {
        let a = self.own(a);
        if a.format().width() != 1 {
            let message = format!("`{}` is {}, but one bit is required here", a.name(), a.format());
            self.error(codes::WIDTH, message);
        }
        a.id()
    }

    #[track_caller]
    fn comparable(&self, a: Signal<'_>, b: Signal<'_>) -> (NetId, NetId) {
        let (a, b) = aligned(self.own(a), self.own(b));
        let (low, high) = hull([a.range(), b.range()]).unwrap_or((0, 0));
        let format = Format::holding(low, high, a.format().frac);
        (self.resized(a, format), self.resized(b, format))
    }

    /// Returns `a` as a net of exactly `format`, which must have the same binary point. Upper bits that do not fit are dropped,
    /// which is harmless for an operand of a sum whose result fits the format.
    #[track_caller]
    pub(crate) fn resized(&self, a: Signal<'_>, format: Format) -> NetId {
        let a = self.own(a);
        let have = a.format();
        debug_assert_eq!(have.frac, format.frac);
        if have == format {
            return a.id();
        }
        let suffix = match format.width().cmp(&have.width()) {
            Ordering::Greater => "wide",
            Ordering::Equal => "same",
            Ordering::Less => "low",
        };
        let fits = interval::fits(a.range(), format);
        let range = if fits { a.range() } else { format.range() };
        a.resized_as(suffix, format, range).id()
    }
}

#[track_caller]
fn aligned<'d>(a: Signal<'d>, b: Signal<'d>) -> (Signal<'d>, Signal<'d>) {
    let frac = a.format().frac.max(b.format().frac);
    (a.with_fraction(frac), b.with_fraction(frac))
}

/// A mux that a field of the microprogram controls.
#[derive(Clone, Copy)]
pub struct Mux<'d> {
    out: Signal<'d>,
    field: FieldId,
}

described!(Mux, out, "select": field);

impl<'d> Mux<'d> {
    pub fn out(self) -> Signal<'d> {
        self.out
    }

    /// Selects `input`. Reports a mistake unless `input` is exactly one input of the mux.
    #[track_caller]
    pub fn pick(self, input: Signal<'d>) -> StepSetting {
        StepSetting::pick(self.out.designer(), self.field, &self.out.name(), input)
    }

    /// Returns the select lines of the mux as one signal.
    pub fn select(self) -> Signal<'d> {
        self.out.designer().field_net(self.field)
    }
}
