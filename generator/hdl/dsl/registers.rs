//! Adds registers, operands, flags, counters and select lines to a description.

use super::{Designer, Signal, StepSetting};
use crate::netlist::{self, Driver, FieldId, FieldKind, NetId, Op, RegisterKind, Role};
use glint_base::codes;
use glint_base::fixed::Format;
use glint_base::interval::Interval;

impl Designer {
    /// Adds an operand: the input port `name`, its write strobe `<name>_write` and the register `<name>_reg`. A busy device
    /// ignores writes, unless [`Designer::buffer_operands`] adds a buffer `<name>_buffer` that takes them at any time.
    #[track_caller]
    pub fn operand(&self, name: &str, format: Format) -> InputOperand<'_> {
        self.operand_port(name, format, |port| port)
    }

    /// Adds an operand that saturates to the values from `low` to `high`, rounded to `format`. For example, with limits 0 and 1
    /// in `u1.20`, a write of 1.5 loads 1.
    #[track_caller]
    pub fn operand_clamped(
        &self,
        name: &str,
        format: Format,
        low: f64,
        high: f64,
    ) -> InputOperand<'_> {
        let format = self.sound(name, format);
        self.operand_port(name, format, |port| {
            let (least, most) = (format.quantise(low), format.quantise(high));
            let (from, to) = format.range();
            let mut value = port;
            let limit = |suffix: &str, raw: i128| {
                let exact = Format::holding(raw, raw, format.frac);
                self.raw_constant(&format!("{name}_{suffix}"), raw, exact)
            };
            if from < least {
                let least = limit("least", least);
                let under = self.less(&format!("{name}_under"), port, least);
                let (name, range) = (format!("{name}_at_least"), (least.range().0, to));
                value = self.chosen_within(&name, under, [value, least], range);
            }
            if to > most {
                let range = (value.range().0, most);
                let one_bit = most > 0 && range.0 >= 0 && most.count_ones() == 1 && to < 2 * most;
                let over = if one_bit {
                    // The value equals the limit at the limit itself, so that one bit suffices as the condition.
                    value.bit(most.trailing_zeros()).named(&format!("{name}_over"))
                } else {
                    self.less(&format!("{name}_over"), limit("most", most), value)
                };
                let name = format!("{name}_at_most");
                value = self.chosen_within(&name, over, [value, limit("most", most)], range);
            }
            value
        })
    }

    /// Makes a two-input mux; the caller must guarantee that its result stays within `range`.
    #[track_caller]
    fn chosen_within<'d>(
        &'d self,
        name: &str,
        select: Signal<'d>,
        inputs: [Signal<'d>; 2],
        range: Interval,
    ) -> Signal<'d> {
        let format = Format::holding(range.0, range.1, inputs[0].format().frac);
        let resized = inputs.map(|input| self.resized(input, format));
        let op = Op::Mux { select: select.id(), inputs: resized.to_vec() };
        self.signal(self.add_net(name, format, range, Driver::Op(op), true))
    }

    #[track_caller]
    fn operand_port<'d>(
        &'d self,
        name: &str,
        format: Format,
        limited: impl FnOnce(Signal<'d>) -> Signal<'d>,
    ) -> InputOperand<'d> {
        let port = self.add_named(name, format, Driver::Input);
        let strobe = self.add_named(&format!("{name}_write"), Format::BIT, Driver::Input);
        self.set_doc(strobe, &format!("writes {name}"));
        self.port(port, Role::Operand { strobe });
        self.port(strobe, Role::Strobe);
        let data = limited(self.signal(port));
        let (data, load) = match self.with(|inner| inner.taken) {
            None => {
                let strobed = [strobe, self.idle].map(|it| self.signal(it));
                (data, self.and(&format!("{name}_load"), strobed[0], strobed[1]).id())
            }
            Some(taken) => {
                let (own, kind) = (format!("{name}_buffer"), RegisterKind::Buffer);
                let buffer = self.add_register(&own, data.format(), data.range(), kind);
                self.set_doc(buffer, "buffer for the next computation");
                self.connect(buffer, data.id(), Some(strobe));
                // If the strobe and `start` come in the same clock, the register loads the written value directly.
                let (name, range) = (format!("{name}_next"), data.range());
                let inputs = [self.signal(buffer), data];
                (self.chosen_within(&name, self.signal(strobe), inputs, range), taken)
            }
        };
        let (own, kind) = (format!("{name}_reg"), RegisterKind::Operand);
        let q = self.add_register(&own, data.format(), data.range(), kind);
        self.connect(q, data.id(), Some(load));
        InputOperand { port: self.signal(port), strobe: self.signal(strobe), q: self.signal(q) }
    }

    /// Adds a register without reset that certain microinstructions load; its field is `<name>_load`. Connect its input by
    /// [`Register::takes`]. The name must differ from all operands, because both would have a net `<name>_load`.
    #[track_caller]
    pub fn register(&self, name: &str, format: Format) -> Register<'_> {
        let field = self.add_field(&format!("{name}_load"), 1, FieldKind::Enable);
        let enable = self.field_net(field).id();
        let format = self.sound(name, format);
        let q = self.add_register(name, format, format.range(), RegisterKind::Architectural);
        self.change(q, |register| register.enable = Some(enable));
        Register { q: self.signal(q), field }
    }

    /// Adds a register that loads on every clock, and so delays `source` by one clock.
    #[track_caller]
    pub fn pipeline<'d>(&'d self, name: &str, source: Signal<'d>) -> Signal<'d> {
        let source = self.own(source);
        let (low, high) = source.range();
        // The register is 0 from power-up to the first clock.
        let range = (low.min(0), high.max(0));
        let q = self.add_register(name, source.format(), range, RegisterKind::Internal);
        self.connect(q, source.id(), None);
        self.signal(q)
    }

    /// Adds select lines that several muxes share. `choices` names the values of the lines from 0 on; each selects the input with
    /// this number in every such mux. For example, `select("operand_select", &["cosines", "sines", "half_n", "square"])` has two
    /// lines.
    #[track_caller]
    pub fn select(&self, name: &str, choices: &[&str]) -> Select<'_> {
        let width = usize::BITS - choices.len().saturating_sub(1).leading_zeros();
        let names = choices.iter().map(|&choice| choice.to_owned()).collect();
        let field = self.add_field(name, width.max(1), FieldKind::Select(names));
        Select { designer: self, field }
    }

    /// Returns `select`. If it belongs to another designer, reports a mistake and returns new lines with the same choices.
    #[track_caller]
    pub(crate) fn own_select<'d>(&'d self, select: Select<'d>) -> Select<'d> {
        if self.serial == select.designer.serial {
            return select;
        }
        let line = self.own(select.designer.field_net(select.field)).name();
        let choices = select.choices();
        let choices: Vec<&str> = choices.iter().map(String::as_str).collect();
        self.select(&format!("{line}_own"), &choices)
    }

    /// Adds an output port of one bit that is 1 in the microinstructions with the setting [`Flag::raise`].
    #[track_caller]
    pub fn flag(&self, name: &str) -> Flag<'_> {
        let field = self.add_field(&format!("{name}_flag"), 1, FieldKind::Flag);
        let net = self.field_net(field);
        self.status(name, net);
        Flag { designer: self, field }
    }

    /// Adds a counter in the format of `start`. A microinstruction that sets `<name>_load` loads the value of `start`; one that
    /// sets only `<name>_count` subtracts one. Below 0 the counter wraps around.
    #[track_caller]
    pub fn down_counter<'d>(&'d self, name: &str, start: Signal<'d>) -> Counter<'d> {
        let start = self.own(start);
        let format = start.format();
        let load = self.add_field(&format!("{name}_load"), 1, FieldKind::Enable);
        let count = self.add_field(&format!("{name}_count"), 1, FieldKind::Enable);
        let (load_net, count_net) = (self.field_net(load), self.field_net(count));
        let q = self.add_register(name, format, format.range(), RegisterKind::Architectural);
        let q = self.signal(q);
        let one = self.raw_constant("one", 1, format);
        let less_one = Driver::Op(Op::Sub(q.id(), one.id()));
        let less_one = self.add_named(&format!("{name}_less_one"), format, less_one);
        let next = Op::Mux { select: load_net.id(), inputs: vec![less_one, start.id()] };
        let next = self.add_named(&format!("{name}_next"), format, Driver::Op(next));
        let enable = self.or(&format!("{name}_enable"), load_net, count_net);
        self.connect(q.id(), next, Some(enable.id()));
        Counter { q, load, count }
    }

    pub(crate) fn connect(&self, q: NetId, data: NetId, enable: Option<NetId>) {
        self.change(q, |it| (it.data, it.enable) = (Some(data), enable));
    }

    pub(crate) fn change(&self, q: NetId, change: impl FnOnce(&mut netlist::NetlistRegister)) {
        self.with(|inner| {
            if let Driver::Register(id) = inner.design.net(q).driver {
                change(&mut inner.design.registers[id.index()]);
            }
        });
    }
}

/// A value that the user writes before a computation: an input port, a write strobe and a register.
#[derive(Clone, Copy)]
pub struct InputOperand<'d> {
    port: Signal<'d>,
    strobe: Signal<'d>,
    q: Signal<'d>,
}

impl<'d> InputOperand<'d> {
    /// Returns the output of the operand register: the written value, limited if [`Designer::operand_clamped`] made the operand.
    /// With buffers, it is the value at the latest accepted `start`.
    pub fn q(self) -> Signal<'d> {
        self.q
    }

    /// Sets the register's number in the source's block diagram, which comments in the Verilog state.
    #[must_use]
    pub fn block(self, number: u16) -> Self {
        let _ = self.q.block(number);
        self
    }

    /// Sets the numbers of the data input and of the write strobe in the source's block diagram.
    #[must_use]
    pub fn inputs(self, data: u16, strobe: u16) -> Self {
        let _ = self.port.block(data);
        let _ = self.strobe.block(strobe);
        self
    }

    /// Sets a comment of one line, which the Verilog shows at the port and at the register.
    #[must_use]
    pub fn doc(self, line: &str) -> Self {
        let _ = self.port.doc(line);
        let _ = self.q.doc(line);
        self
    }
}

/// A register that loads in the microinstructions with [`Register::load`], and otherwise keeps its value.
#[derive(Clone, Copy)]
pub struct Register<'d> {
    q: Signal<'d>,
    field: FieldId,
}

described!(Register, q, "load": field);

impl<'d> Register<'d> {
    pub fn q(self) -> Signal<'d> {
        self.q
    }

    pub fn format(self) -> Format {
        self.q.format()
    }

    /// Returns the load enable, which is 1 in the microinstructions that load the register.
    pub fn loading(self) -> Signal<'d> {
        self.q.designer().field_net(self.field)
    }

    /// Connects the data input. Reports a mistake unless the register's format has the binary point of `data` and can represent
    /// the range of `data`; [`Designer::narrow`] converts a signal first. A second connection is a mistake too.
    #[track_caller]
    pub fn takes(self, data: Signal<'d>) {
        let d = self.q.designer();
        let net = d.net(self.q.id());
        let taken = |id| d.with(|inner| inner.design.register(id).data.is_some());
        if matches!(net.driver, Driver::Register(id) if taken(id)) {
            let message =
                format!("`{}` has two drivers: `{}` is the second", net.name, data.name());
            d.error_at(codes::TWO_DRIVERS, message, [("the register", net.location)]);
            return;
        }
        if let Some(id) = d.fitted(data, net.format, &format!("register `{}`", net.name)) {
            d.connect(self.q.id(), id, Some(d.field_net(self.field).id()));
        }
    }

    /// Loads the register at the end of the clock.
    #[track_caller]
    pub fn load(self) -> StepSetting {
        StepSetting::field(self.q.designer(), self.field, 1, format!("{}.load", self.q.name()))
    }
}

#[derive(Clone, Copy)]
pub struct Select<'d> {
    designer: &'d Designer,
    field: FieldId,
}

impl<'d> Select<'d> {
    /// Returns the select lines as a signal, for logic that also depends on them.
    pub fn out(self) -> Signal<'d> {
        self.designer.field_net(self.field)
    }

    pub(crate) fn field(self) -> FieldId {
        self.field
    }

    /// Sets the numbers of the lines in the source's block diagram, the most significant first.
    #[must_use]
    pub fn lines(self, numbers: &[u16]) -> Self {
        self.designer.set_lines(self.field, numbers);
        self
    }

    /// Allows choices of these lines that the microprogram never makes, for example for other configurations.
    /// [`Designer::finish`] otherwise warns of them.
    #[must_use]
    pub fn partly_used(self) -> Self {
        self.designer.with(|inner| inner.partly_used.insert(self.field));
        self
    }

    fn choices(self) -> Vec<String> {
        self.designer.with(|inner| match &inner.design.control.fields[self.field.index()].kind {
            FieldKind::Select(choices) => choices.clone(),
            _ => Vec::new(),
        })
    }

    #[track_caller]
    pub(crate) fn check_inputs(self, name: &str, inputs: usize) {
        let choices = self.choices().len();
        if inputs != choices {
            self.designer.error(
                codes::WIDTH,
                format!(
                    "mux `{name}` has {inputs} inputs, but its select lines have {choices} choices"
                ),
            );
        }
    }
}

#[derive(Clone, Copy)]
pub struct Flag<'d> {
    designer: &'d Designer,
    field: FieldId,
}

impl Flag<'_> {
    /// Makes the output 1 in this microinstruction.
    #[track_caller]
    pub fn raise(self) -> StepSetting {
        let name = self.designer.field_net(self.field).name();
        StepSetting::field(self.designer, self.field, 1, name)
    }
}

/// A counter that [`Counter::load`] loads with its start value, and from which [`Counter::count`] subtracts one.
#[derive(Clone, Copy)]
pub struct Counter<'d> {
    q: Signal<'d>,
    load: FieldId,
    count: FieldId,
}

described!(Counter, q, "count": count);

impl<'d> Counter<'d> {
    pub fn q(self) -> Signal<'d> {
        self.q
    }

    /// Returns the count enable, which is 1 in the microinstructions that count.
    pub fn counting(self) -> Signal<'d> {
        self.q.designer().field_net(self.count)
    }

    /// Loads the start value at the end of the clock.
    #[track_caller]
    pub fn load(self) -> StepSetting {
        StepSetting::field(self.q.designer(), self.load, 1, format!("{}.load", self.q.name()))
    }

    /// Subtracts one at the end of the clock.
    #[track_caller]
    pub fn count(self) -> StepSetting {
        StepSetting::field(self.q.designer(), self.count, 1, format!("{}.count", self.q.name()))
    }
}
