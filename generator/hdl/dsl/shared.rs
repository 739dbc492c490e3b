//! Gives the other modules of the description language access to the state of a [`Designer`]: nets, registers, fields, ports and
//! mistakes.

use std::panic::Location;

use super::{Designer, Inner, Signal};
use crate::netlist::{
    Driver, Field, FieldId, FieldKind, Net, NetId, Partition, Port, RegisterKind, Role,
};
use glint_base::codes::{self, Code};
use glint_base::diagnostic::{Diagnostic, SourceLocation};
use glint_base::fixed::{Format, MAX_POINT, MAX_WIDTH};
use glint_base::interval::Interval;

impl Designer {
    pub(crate) fn signal(&self, id: NetId) -> Signal<'_> {
        Signal::new(self, id)
    }

    pub(crate) fn net(&self, id: NetId) -> Net {
        self.inner.borrow().design.net(id).clone()
    }

    pub(crate) fn with<T>(&self, act: impl FnOnce(&mut Inner) -> T) -> T {
        act(&mut self.inner.borrow_mut())
    }

    /// Adds a net that the author named, with the whole range of its format.
    #[track_caller]
    pub(crate) fn add_named(&self, name: &str, format: Format, driver: Driver) -> NetId {
        let format = self.sound(name, format);
        self.add_net(name, format, format.range(), driver, true)
    }

    /// Adds an unnamed net, such as an extension. A second `sum_wide` becomes `sum_wide_2`.
    #[track_caller]
    pub(crate) fn add_wiring(
        &self,
        name: &str,
        format: Format,
        range: Interval,
        driver: Driver,
    ) -> NetId {
        let name = self.with(|Inner { names, counts, .. }| {
            if !names.contains(name) {
                return name.to_owned();
            }
            let count = counts.entry(name.to_owned()).or_insert(1);
            loop {
                *count += 1;
                let candidate = format!("{name}_{count}");
                if !names.contains(&candidate) {
                    return candidate;
                }
            }
        });
        self.add_net(&name, format, range, driver, false)
    }

    /// Runs `act`, and gives all nets and ROMs that it adds the source location `location`.
    pub(crate) fn located<T>(&self, location: SourceLocation, act: impl FnOnce() -> T) -> T {
        let own = self.with(|inner| (inner.design.nets.len(), inner.design.roms.len()));
        let made = act();
        self.with(|Inner { design, .. }| {
            let nets = design.nets[own.0..].iter_mut();
            let roms = design.roms[own.1..].iter_mut();
            let all = nets.map(|net| &mut net.location);
            for it in all.chain(roms.map(|rom| &mut rom.location)) {
                *it = location;
            }
        });
        made
    }

    /// Returns `format` if a net can have it: 1 to [`MAX_WIDTH`] bits and −[`MAX_POINT`] to [`MAX_POINT`] fraction bits.
    /// Otherwise reports a mistake and returns a format of one bit, so that the rest of the description is checked too.
    #[track_caller]
    pub(crate) fn sound(&self, name: &str, format: Format) -> Format {
        let width = i64::from(format.int) + i64::from(format.frac) + i64::from(format.signed);
        let point = format.frac.clamp(-MAX_POINT, MAX_POINT);
        if !(1..=i64::from(MAX_WIDTH)).contains(&width) {
            let message = format!(
                "`{name}` would have {width} bits ({format}); a net has 1 to {MAX_WIDTH} bits"
            );
            self.error(codes::WIDE, message);
        } else if point != format.frac {
            self.error(codes::WIDE, format!(
                "`{name}` would have {} fraction bits ({format}); a net has -{MAX_POINT} to {MAX_POINT} \
                 fraction bits",
                format.frac
            ));
        } else {
            return format;
        }
        Format::unsigned(1 - point, point)
    }

    #[track_caller]
    pub(crate) fn add_net(
        &self,
        name: &str,
        format: Format,
        range: Interval,
        driver: Driver,
        named: bool,
    ) -> NetId {
        let sound = self.sound(name, format);
        let range = if sound == format { range } else { (0, 1) };
        let format = sound;
        // Inside the closure, the caller would be this file.
        let location = Location::caller();
        self.with(|inner| {
            let net = Net::new(name.to_owned(), format, driver, location);
            inner.names.insert(name.to_owned());
            inner.design.add_net(Net { range, named, partition: inner.partition, ..net })
        })
    }

    #[track_caller]
    pub(crate) fn add_register(
        &self,
        name: &str,
        format: Format,
        range: Interval,
        kind: RegisterKind,
    ) -> NetId {
        let q = self.add_net(name, format, range, Driver::Undriven, true);
        self.with(|inner| inner.design.add_register(q, kind).q)
    }

    #[track_caller]
    pub(crate) fn add_field(&self, name: &str, width: u32, kind: FieldKind) -> FieldId {
        let id = self.with(|inner| FieldId(inner.design.control.fields.len() as u32));
        let net = self.add_named(name, Format::unsigned(width as i32, 0), Driver::Field(id));
        self.with(|inner| {
            // Fields come out of the control unit, whoever uses them.
            inner.design.nets[net.index()].partition = Partition::Control;
            inner.design.control.fields.push(Field {
                name: name.to_owned(),
                net,
                kind,
                lines: Vec::new(),
            });
        });
        id
    }

    pub(crate) fn port(&self, net: NetId, role: Role) {
        self.with(|inner| inner.design.ports.push(Port { net, role }));
    }

    pub(crate) fn set_doc(&self, id: NetId, doc: &str) {
        self.with(|inner| doc.clone_into(&mut inner.design.nets[id.index()].doc));
    }

    pub(crate) fn set_lines(&self, field: FieldId, numbers: &[u16]) {
        self.with(|inner| inner.design.control.fields[field.index()].lines = numbers.to_vec());
    }

    pub(crate) fn field_net(&self, field: FieldId) -> Signal<'_> {
        let net = self.with(|inner| inner.design.control.fields[field.index()].net);
        self.signal(net)
    }

    /// Returns `signal`. If it belongs to another designer, reports a mistake and returns a constant of the same format.
    #[track_caller]
    pub(crate) fn own(&self, signal: Signal<'_>) -> Signal<'_> {
        let other = signal.designer();
        if other.serial == self.serial {
            return self.signal(signal.id());
        }
        let name = |designer: &Self| designer.with(|inner| inner.design.name.clone());
        self.error(
            codes::FOREIGN,
            format!(
                "`{}` is a signal of the designer of `{}`, not of the designer of `{}`",
                signal.name(),
                name(other),
                name(self)
            ),
        );
        let driver = Driver::Constant(0);
        self.signal(self.add_wiring(&signal.name(), signal.format(), signal.range(), driver))
    }

    /// Applies [`Designer::own`] to each signal, in a loop, because a closure would report a source line of this file.
    #[track_caller]
    pub(crate) fn own_all(&self, signals: &[Signal<'_>]) -> Vec<Signal<'_>> {
        let mut own = Vec::with_capacity(signals.len());
        for signal in signals {
            own.push(self.own(*signal));
        }
        own
    }

    /// Returns `source` as a net of exactly `format`, or reports a mistake if the binary points differ or the range does not
    /// fit. `what` names the purpose in the message.
    #[track_caller]
    pub(crate) fn fitted(&self, source: Signal<'_>, format: Format, what: &str) -> Option<NetId> {
        let (low, high) = source.range();
        if source.format().frac != format.frac || !format.holds(low) || !format.holds(high) {
            self.error(codes::FORMAT, format!(
                "{what} is {format}, but `{}` is {} with values from {low} to {high} ulp: narrow the signal \
                 or change the format",
                source.name(),
                source.format(),
            ));
            return None;
        }
        Some(self.resized(source, format))
    }

    #[track_caller]
    pub(crate) fn error(&self, code: Code, message: String) {
        self.report(Diagnostic::new(code, message, Location::caller()));
    }

    #[track_caller]
    pub(crate) fn error_at<const N: usize>(
        &self,
        code: Code,
        message: String,
        notes: [(&str, SourceLocation); N],
    ) {
        let mut diagnostic = Diagnostic::new(code, message, Location::caller());
        for (note, location) in notes {
            diagnostic = diagnostic.note(note.to_owned(), location);
        }
        self.report(diagnostic);
    }

    pub(crate) fn report(&self, diagnostic: Diagnostic) {
        self.with(|inner| inner.diagnostics.push(diagnostic));
    }
}
