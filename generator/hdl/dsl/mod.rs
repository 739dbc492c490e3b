//! The description language: datapath, microprogram and ports of a device, in Rust.
//!
//! A description is a function that takes a [`Designer`] and builds with it. Handles ([`Signal`],
//! [`Register`], [`Mux`], …) are `Copy`. Every signal has a fixed-point format *and* the interval of
//! values that it can take; both follow by rule from the operands, so that nothing can overflow
//! unnoticed: sums and products are exact, and bits are given up only by [`Designer::narrow`], which
//! states rounding and overflow.
//!
//! A microinstruction ([`step`]) is a list of settings, which the blocks make: [`Mux::pick`],
//! [`Register::load`], [`Flag::raise`], [`Counter::load`] and [`Counter::count`]. Each stands for a field of
//! the control word; fields stand there in the order in which the blocks were created.
//!
//! ```
//! use glint::dsl::{Designer, end, step, valid};
//! use glint::fixed::{Format, Overflow, Rounding};
//!
//! let d = Designer::new("squarer");
//! let x = d.operand("x", Format::unsigned(0, 8));
//! let product = d.mul("square", x.q(), x.q());
//! let y = d.register("y", Format::unsigned(0, 8));
//! y.takes(d.narrow("y_rounded", product, y.format(), Rounding::Truncate, Overflow::Saturate));
//! d.output("y_out", y.q());
//! d.microprogram([
//!     step("idle", []),
//!     step("square", [y.load()]),
//!     step("result", [valid(), end()]),
//! ]);
//! let design = d.finish().unwrap();
//! assert_eq!(design.control.microprogram.len(), 3);
//! ```
//!
//! Mistakes are collected, not thrown: [`Designer::finish`] reports all of them, each with the names
//! of the signals and the Rust source line.

mod narrow;
mod operand_mux;
mod output_registers;
mod program;
mod registers;
mod rules;
mod signal;

use std::cell::RefCell;
use std::collections::HashMap;
use std::panic::Location;
use std::sync::atomic::{AtomicU64, Ordering};

pub use operand_mux::{OperandMux, SharedProduct};
pub use program::{
    Program, Setting, Step, end, hold, jump_if, loop_while, next, step, valid, wait_for_start,
};
pub use registers::{Counter, Flag, Operand, Register, Select};
pub use signal::{Mux, Signal};

pub use crate::hdl::netlist::About;
use crate::hdl::netlist::register_held;

use crate::base::diagnostic::{Diagnostic, Diagnostics, SourceLocation};
use crate::base::fixed::{Format, MAX_POINT, MAX_WIDTH};
use crate::hdl::netlist::{
    Control, Design, Driver, Field, FieldId, FieldKind, Net, NetId, Op, Partition, Port,
    Register as NetRegister, RegisterKind, Role, Rom as NetRom, RomId,
};

/// Builds a [`Design`]; see the [module documentation](self).
pub struct Designer {
    inner: RefCell<Inner>,
    /// Tells its handles from those of another.
    serial: u64,
    start: NetId,
    idle: NetId,
    run: NetId,
}

/// A net that carries the product of a shared multiplier under one selection of its operands.
#[derive(Clone, Debug)]
pub(crate) struct SelectedProduct {
    /// The select field of the multiplier's operands.
    pub field: FieldId,
    /// The values of the field under which the net means what its format says.
    pub values: Vec<u64>,
    /// How many clocks ago the field had that value: registers behind the multiplier.
    pub delay: u32,
}

pub(crate) struct Inner {
    design: Design,
    views: HashMap<NetId, SelectedProduct>,
    program: Option<Program>,
    /// What `valid` follows, and how many clocks later, when no microinstruction raises it.
    valid: Option<(NetId, u32)>,
    /// Whether results that are logic get registers.
    registers_outputs: bool,
    /// The numbers of the lines of `valid_word` and of `go_on` in the source's figure.
    sequencer_lines: Option<[u16; 2]>,
    diagnostics: Vec<Diagnostic>,
    names: HashMap<String, u32>,
    partition: Partition,
}

impl Designer {
    /// An empty design; `name` becomes the name of the top module.
    ///
    /// The common handshake is there from the start: inputs `rst_n` and `start`, outputs `valid`,
    /// `busy` and `done` (the outputs join when the microprogram is known).
    #[track_caller]
    pub fn new(name: &str) -> Self {
        let inner = Inner {
            design: Design {
                name: name.to_owned(),
                about: About::default(),
                nets: Vec::new(),
                registers: Vec::new(),
                roms: Vec::new(),
                ports: Vec::new(),
                control: Control::none(),
                pipeline: None,
            },
            views: HashMap::new(),
            program: None,
            valid: None,
            registers_outputs: false,
            sequencer_lines: None,
            diagnostics: Vec::new(),
            names: HashMap::new(),
            partition: Partition::Control,
        };
        static DESIGNERS: AtomicU64 = AtomicU64::new(0);
        let mut designer = Self {
            inner: RefCell::new(inner),
            serial: DESIGNERS.fetch_add(1, Ordering::Relaxed),
            start: NetId(0),
            idle: NetId(0),
            run: NetId(0),
        };
        let reset = designer.add_named("rst_n", Format::BIT, Driver::Input);
        designer.port(reset, Role::Reset);
        designer.set_doc(reset, "reset, active low");
        designer.start = designer.add_named("start", Format::BIT, Driver::Input);
        designer.port(designer.start, Role::Start);
        designer.set_doc(designer.start, "begins a computation when not busy");
        designer.run =
            designer.add_register("run", Format::BIT, Format::BIT.range(), RegisterKind::Sequencer);
        designer.set_doc(designer.run, "a microprogram is running");
        designer.idle = designer.add_named("idle", Format::BIT, Driver::Undriven);
        designer.set_doc(designer.idle, "operands may be written");
        designer.inner.borrow_mut().partition = Partition::Datapath;
        designer
    }

    /// States what the header of the emitted Verilog, the manifest and the documentation say of the device.
    pub fn about(&self, about: About) {
        self.inner.borrow_mut().design.about = about;
    }

    /// A constant of the given format; `value` must be exactly representable.
    #[track_caller]
    pub fn constant(&self, name: &str, value: f64, format: Format) -> Signal<'_> {
        let format = self.sound(name, format);
        let raw = format.quantise(value);
        if format.to_f64(raw) != value {
            self.error(format!("constant `{name}`: {value} is not representable in {format}"));
        }
        let id = self.add_wiring(name, format, (raw, raw), Driver::Constant(format.bits(raw)));
        self.signal(id)
    }

    /// The constant `raw`, an integer, in the given format.
    #[track_caller]
    pub fn raw_constant(&self, name: &str, raw: i128, format: Format) -> Signal<'_> {
        let format = self.sound(name, format);
        if !format.holds(raw) {
            self.error(format!("constant `{name}`: {raw} does not fit {format}"));
        }
        let id = self.add_wiring(name, format, (raw, raw), Driver::Constant(format.bits(raw)));
        self.signal(id)
    }

    /// A wire that [`Designer::drive`] connects later: a forward reference.
    #[track_caller]
    pub fn wire(&self, name: &str, format: Format) -> Signal<'_> {
        self.signal(self.add_named(name, format, Driver::Undriven))
    }

    /// Connects a [`Designer::wire`].
    #[track_caller]
    pub fn drive(&self, wire: Signal<'_>, source: Signal<'_>) {
        let wire = self.own(wire);
        let (format, net) = (wire.format(), self.net(wire.id()));
        if net.driver != Driver::Undriven {
            self.error_at(
                format!("`{}` has two drivers: `{}` is the second", net.name, source.name()),
                [("the first is here", net.location)],
            );
            return;
        }
        if let Some(id) = self.fitted(source, format, &format!("wire `{}`", net.name)) {
            self.inner.borrow_mut().design.nets[wire.id().index()].driver =
                Driver::Op(Op::Relabel(id));
        }
    }

    /// A read-only memory: word `address` of `words` (raw values of `format`).
    ///
    /// `doc` says what an entry means. The address must be an integer that stays within the words. A
    /// `synchronous` ROM reads on the rising edge, as block RAM does: its output belongs to the
    /// address of the clock before.
    #[track_caller]
    pub fn rom(
        &self,
        name: &str,
        address: Signal<'_>,
        format: Format,
        words: &[i128],
        synchronous: bool,
    ) -> Rom<'_> {
        let address = self.own(address);
        let format = self.sound(&format!("{name}_word"), format);
        let (low, high) = address.range();
        if address.format().frac != 0 || low < 0 || high >= words.len() as i128 {
            self.error(format!(
                "ROM `{name}` has {} words, but its address `{}` ({}) runs from {low} to {high}",
                words.len(),
                address.name(),
                address.format()
            ));
        }
        if let Some((at, raw)) = words.iter().enumerate().find(|(_, raw)| !format.holds(**raw)) {
            self.error(format!("ROM `{name}`: word {at} is {raw}, which does not fit {format}"));
        }
        let range = words
            .iter()
            .fold(None, |range: Option<(i128, i128)>, &raw| {
                Some(range.map_or((raw, raw), |(low, high)| (low.min(raw), high.max(raw))))
            })
            .unwrap_or((0, 0));
        // A synchronous read starts from the power-up value 0.
        let range = if synchronous { (range.0.min(0), range.1.max(0)) } else { range };
        let id = RomId(self.inner.borrow().design.roms.len() as u32);
        let data = self.add_net(&format!("{name}_word"), format, range, Driver::Rom(id), true);
        self.inner.borrow_mut().design.roms.push(NetRom {
            name: name.to_owned(),
            address: address.id(),
            data,
            synchronous,
            enable: None,
            shares: None,
            words: words.iter().map(|&raw| format.bits(raw)).collect(),
            doc: Vec::new(),
            comments: Vec::new(),
            block: None,
            location: Location::caller(),
        });
        Rom { designer: self, id }
    }

    /// An output port that carries a result.
    #[track_caller]
    pub fn output<'d>(&'d self, name: &str, source: Signal<'d>) -> Signal<'d> {
        self.output_as(name, source, Role::Result)
    }

    /// An output port that shows a signal of the control block.
    #[track_caller]
    pub fn status<'d>(&'d self, name: &str, source: Signal<'d>) -> Signal<'d> {
        self.output_as(name, source, Role::Status)
    }

    #[track_caller]
    fn output_as<'d>(&'d self, name: &str, source: Signal<'d>, role: Role) -> Signal<'d> {
        let source = self.own(source);
        let id = self.add_net(
            name,
            source.format(),
            source.range(),
            Driver::Op(Op::Relabel(source.id())),
            true,
        );
        self.port(id, role);
        self.signal(id)
    }

    /// The microprogram. Microinstruction 0 is where the device waits for `start`; it is executed once more after
    /// it, so that operands written together with `start` have settled.
    #[track_caller]
    pub fn microprogram(&self, steps: impl IntoIterator<Item = Step>) {
        let program = Program { steps: steps.into_iter().collect(), location: Location::caller() };
        if self.inner.borrow_mut().program.replace(program).is_some() {
            self.error("a second microprogram".to_owned());
        }
    }

    /// Lets `valid` follow `signal`, one bit, `clocks` clocks later: for a datapath with registers between
    /// what a microinstruction starts and the outputs, so that a result may come out in every clock. No microinstruction raises
    /// [`valid`] then. The microinstructions that the last result needs to come out stand at the end of the
    /// microprogram, so that the device is busy until then; a reset drops results that are on their way.
    #[track_caller]
    pub fn valid_after(&self, signal: Signal<'_>, clocks: u32) {
        let signal = self.own(signal);
        if signal.format().width() != 1 {
            self.error(format!("valid follows `{}`, which has more than one bit", signal.name()));
        } else if self.inner.borrow_mut().valid.replace((signal.id(), clocks)).is_some() {
            self.error(format!("valid follows `{}` and another signal", signal.name()));
        }
    }

    /// States the numbers, in the source's figure, of two lines that every control unit has: the one by which
    /// a microinstruction sets `valid`, and the one by which it lets the program go on.
    pub fn sequencer_lines(&self, valid: u16, go_on: u16) {
        self.inner.borrow_mut().sequencer_lines = Some([valid, go_on]);
    }

    /// Puts registers behind results that are logic. The microinstruction that sets `valid` loads them, and one more after
    /// it sets `valid`; other outputs stay as they are. The key `output.registered` asks for it.
    pub fn register_outputs(&self) {
        self.inner.borrow_mut().registers_outputs = true;
    }

    /// The finished design, assembled and checked.
    ///
    /// # Errors
    /// Every mistake of the description, each with the signals and the Rust source line.
    pub fn finish(self) -> Result<Design, Diagnostics> {
        let program = self.inner.borrow_mut().program.take();
        if let Some(mut program) = program {
            let place = program.location;
            self.placed(place, || {
                if self.with(|inner| inner.registers_outputs) {
                    output_registers::insert(&self, &mut program);
                }
                program::assemble(&self, &program);
            });
        } else {
            let place = self.net(self.start).location;
            self.report(Diagnostic::new("the design has no microprogram".to_owned(), place));
        }
        let Inner { mut design, views, mut diagnostics, .. } = self.inner.into_inner();
        if diagnostics.is_empty() {
            diagnostics = design.verify();
        }
        if diagnostics.is_empty() {
            diagnostics = rules::check(&design, &views);
        }
        if !diagnostics.is_empty() {
            return Err(Diagnostics(diagnostics));
        }
        register_held(&mut design);
        Ok(design)
    }
}

/// What the parts of the DSL share.
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

    /// A net that the author named.
    #[track_caller]
    pub(crate) fn add_named(&self, name: &str, format: Format, driver: Driver) -> NetId {
        let format = self.sound(name, format);
        self.add_net(name, format, format.range(), driver, true)
    }

    /// A net that the DSL adds; `name` is made distinct.
    #[track_caller]
    pub(crate) fn add_wiring(
        &self,
        name: &str,
        format: Format,
        range: (i128, i128),
        driver: Driver,
    ) -> NetId {
        let name = self.with(|inner| {
            let taken = |name: &str| inner.design.nets.iter().any(|net| net.name == name);
            if !taken(name) {
                return name.to_owned();
            }
            let count = inner.names.entry(name.to_owned()).or_insert(1);
            loop {
                *count += 1;
                let candidate = format!("{name}_{count}");
                if !inner.design.nets.iter().any(|net| net.name == candidate) {
                    return candidate;
                }
            }
        });
        self.add_net(&name, format, range, driver, false)
    }

    /// What `act` adds stands at `place`, wherever in the builder it is made: its names may be at fault.
    pub(crate) fn placed<T>(&self, place: SourceLocation, act: impl FnOnce() -> T) -> T {
        let own = self.with(|inner| (inner.design.nets.len(), inner.design.roms.len()));
        let made = act();
        self.with(|Inner { design, .. }| {
            let nets = design.nets[own.0..].iter_mut();
            let roms = design.roms[own.1..].iter_mut();
            let places = nets.map(|net| &mut net.location);
            for location in places.chain(roms.map(|rom| &mut rom.location)) {
                *location = place;
            }
        });
        made
    }

    /// The format, if a net can have it. If not that is an error, and one bit is what to go on with, so that
    /// the rest of the description is checked too.
    #[track_caller]
    pub(crate) fn sound(&self, name: &str, format: Format) -> Format {
        let width = i64::from(format.int) + i64::from(format.frac) + i64::from(format.signed);
        let point = format.frac.clamp(-MAX_POINT, MAX_POINT);
        if !(1..=i64::from(MAX_WIDTH)).contains(&width) {
            self.error(format!(
                "`{name}` would be {width} bits wide ({format}); a net has 1 to {MAX_WIDTH}"
            ));
        } else if point != format.frac {
            self.error(format!(
                "`{name}` would have {} fraction bits ({format}); -{MAX_POINT} to {MAX_POINT} are possible",
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
        range: (i128, i128),
        driver: Driver,
        named: bool,
    ) -> NetId {
        let sound = self.sound(name, format);
        let range = if sound == format { range } else { (0, 1) };
        let format = sound;
        // Inside the closure the caller would be this file.
        let location = Location::caller();
        self.with(|inner| {
            let id = NetId(inner.design.nets.len() as u32);
            inner.design.nets.push(Net {
                name: name.to_owned(),
                format,
                range,
                driver,
                block: None,
                doc: String::new(),
                named,
                partition: inner.partition,
                location,
            });
            id
        })
    }

    /// A register; returns the net that it drives.
    #[track_caller]
    pub(crate) fn add_register(
        &self,
        name: &str,
        format: Format,
        range: (i128, i128),
        kind: RegisterKind,
    ) -> NetId {
        let id = self.with(|inner| crate::hdl::netlist::RegId(inner.design.registers.len() as u32));
        let q = self.add_net(name, format, range, Driver::Register(id), true);
        self.with(|inner| {
            inner.design.registers.push(NetRegister {
                q,
                data: None,
                enable: None,
                reset: None,
                kind,
            });
        });
        q
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

    pub(crate) fn field_net(&self, field: FieldId) -> Signal<'_> {
        let net = self.with(|inner| inner.design.control.fields[field.index()].net);
        self.signal(net)
    }

    /// The signal; of another designer that is an error, and what to go on with a constant like it.
    #[track_caller]
    pub(crate) fn own(&self, signal: Signal<'_>) -> Signal<'_> {
        let other = signal.designer();
        if other.serial == self.serial {
            return self.signal(signal.id());
        }
        let name = |designer: &Self| designer.with(|inner| inner.design.name.clone());
        self.error(format!(
            "`{}` is a signal of the designer of `{}`, and not of that of `{}`",
            signal.name(),
            name(other),
            name(self)
        ));
        let driver = Driver::Constant(0);
        self.signal(self.add_wiring(&signal.name(), signal.format(), signal.range(), driver))
    }

    /// The same of several. (In a closure the caller would be this library.)
    #[track_caller]
    pub(crate) fn own_all(&self, signals: &[Signal<'_>]) -> Vec<Signal<'_>> {
        let mut own = Vec::with_capacity(signals.len());
        for signal in signals {
            own.push(self.own(*signal));
        }
        own
    }

    /// `source` as a net of exactly `format`, or an error that names `what` it was for.
    #[track_caller]
    pub(crate) fn fitted(&self, source: Signal<'_>, format: Format, what: &str) -> Option<NetId> {
        let (low, high) = source.range();
        if source.format().frac != format.frac || !format.holds(low) || !format.holds(high) {
            self.error(format!(
                "{what} is {format}, but `{}` is {} with values from {low} to {high} ulp: narrow it or change the format",
                source.name(),
                source.format(),
            ));
            return None;
        }
        Some(self.resized(source, format))
    }

    #[track_caller]
    pub(crate) fn error(&self, message: String) {
        self.report(Diagnostic::new(message, Location::caller()));
    }

    #[track_caller]
    pub(crate) fn error_at<const N: usize>(
        &self,
        message: String,
        notes: [(&str, SourceLocation); N],
    ) {
        let mut diagnostic = Diagnostic::new(message, Location::caller());
        for (note, place) in notes {
            diagnostic = diagnostic.note(note.to_owned(), place);
        }
        self.report(diagnostic);
    }

    pub(crate) fn report(&self, diagnostic: Diagnostic) {
        self.with(|inner| inner.diagnostics.push(diagnostic));
    }
}

/// A read-only memory.
#[derive(Clone, Copy)]
pub struct Rom<'d> {
    designer: &'d Designer,
    id: RomId,
}

impl<'d> Rom<'d> {
    /// The word read.
    pub fn out(self) -> Signal<'d> {
        let data = self.designer.with(|inner| inner.design.rom(self.id).data);
        self.designer.signal(data)
    }

    /// States the block number in the source's figure.
    #[must_use]
    pub fn block(self, number: u16) -> Self {
        self.designer.with(|inner| inner.design.roms[self.id.index()].block = Some(number));
        self
    }

    /// Adds a line to the ROM's comment: what an entry means.
    #[must_use]
    pub fn doc(self, line: &str) -> Self {
        self.designer.with(|inner| inner.design.roms[self.id.index()].doc.push(line.to_owned()));
        self
    }

    /// States a comment for each word.
    #[must_use]
    pub fn comments(self, comments: Vec<String>) -> Self {
        self.designer.with(|inner| inner.design.roms[self.id.index()].comments = comments);
        self
    }
}
