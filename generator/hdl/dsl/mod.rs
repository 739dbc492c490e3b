//! The description language: datapath, microprogram and ports of a device, in Rust.
//!
//! A description is a function that calls a [`Designer`] and gets handles such as [`Signal`], [`Register`] and [`Mux`]. Every
//! signal has a fixed-point format *and* the interval of values that it can take. The sums and products of [`Designer::add`] and
//! [`Designer::mul`] are exact, so that they cannot overflow. Only [`Designer::narrow`] rounds, and only it and
//! [`Designer::operand_clamped`] saturate. [`Signal::bits`] takes some bits of a signal, and [`Designer::add_modulo`] drops the
//! carry. A microinstruction ([`step`]) is a list of settings, such as [`Register::load`] and [`Mux::pick`].
//!
//! ```
//! use glint_rtl::dsl::{Designer, end, step, valid};
//! use glint_base::fixed::{Format, Overflow, Rounding};
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
//! A function that *reports a mistake* stores it, and continues with a substitute value, so that one run finds several mistakes.
//! [`Designer::finish`] returns all stored mistakes, each with the names of the signals and the Rust source line.

macro_rules! described {
    ($handle:ident, $net:ident) => {
        impl $handle<'_> {
            /// Sets the block's number in the source's block diagram, which comments in the Verilog state.
            #[must_use]
            pub fn block(self, number: u16) -> Self {
                let _ = self.$net.block(number);
                self
            }

            /// Sets a comment of one line for the Verilog.
            #[must_use]
            pub fn doc(self, line: &str) -> Self {
                let _ = self.$net.doc(line);
                self
            }

            /// Sets a comment like `doc`, for the topic `topic`. A pipeline shows only comments of the topic
            /// [`Topic::Device`](crate::netlist::Topic::Device).
            #[must_use]
            pub fn doc_on(self, topic: crate::netlist::Topic, line: &str) -> Self {
                let _ = self.$net.doc_on(topic, line);
                self
            }
        }
    };
    ($handle:ident, $net:ident, $line:literal: $field:ident) => {
        described!($handle, $net);

        impl $handle<'_> {
            #[doc = concat!("States the number of the ", $line, " line in the source's figure.")]
            #[must_use]
            pub fn line(self, number: u16) -> Self {
                self.$net.designer().set_lines(self.$field, &[number]);
                self
            }
        }
    };
}

#[doc(hidden)]
pub mod fixture;
mod instance;
mod narrow;
mod operand_mux;
mod output_registers;
mod program;
mod registers;
mod rom;
mod rules;
mod sequencer;
mod shared;
mod signal;
mod write_port;

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::panic::Location;
use std::sync::atomic::{AtomicU64, Ordering};

pub use instance::Instance;
pub use operand_mux::{OperandMux, SharedProduct};
pub use program::{
    MicroprogramSource, Step, StepSetting, dispatch, end, hold, jump_if, loop_while, next, step,
    valid, wait_for_start,
};
pub use registers::{Counter, Flag, InputOperand, Register, Select};
pub use rom::Rom;
pub use signal::{Mux, Signal};

pub use crate::netlist::{About, CoreFunction, FunctionPort, Note, OPCODE, Topic};
use crate::retime::register_held;

use crate::netlist::{
    Design, Driver, FieldId, NetId, NetlistRom as NetRom, Op, Partition, RegisterKind, Role,
};
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, Diagnostics};
use glint_base::fixed::Format;
use glint_base::interval;

const BUFFERED_NOTE: &str = "Operands have buffers. A write at any time is for the next computation, and start \
                             loads the buffers into the operand registers, also in the clock of done. The \
                             outputs keep their values from valid at least until the next computation starts.";

/// Builds a [`Design`] from a hardware description; the [module documentation](self) has an example.
pub struct Designer {
    inner: RefCell<Inner>,
    /// Distinguishes this designer's handles from another designer's.
    serial: u64,
    /// The number of descriptions around this one, which is a part of the innermost; 0 for a whole device.
    depth: u32,
    start: NetId,
    idle: NetId,
    run: NetId,
}

/// A net that carries the product of a shared multiplier under one selection of its operands.
#[derive(Clone, Debug)]
pub(crate) struct SelectedProduct {
    /// Selects the operands of the shared multiplier.
    pub field: FieldId,
    /// The values of this field for which the net has the product in its format.
    pub values: Vec<u64>,
    /// The number of clocks between the selection and the product: the number of registers between the muxes and the multiplier.
    pub delay: u32,
}

pub(crate) struct Inner {
    design: Design,
    views: HashMap<NetId, SelectedProduct>,
    program: Option<MicroprogramSource>,
    parts: Vec<Step>,
    placed: HashSet<NetId>,
    /// The fields to which a microinstruction gives a value.
    picked: HashSet<FieldId>,
    /// Select lines for which the microprogram may leave choices unused.
    partly_used: HashSet<FieldId>,
    /// The signal that `valid` follows, and after how many clocks; `None` if microinstructions raise `valid`.
    valid: Option<(NetId, u32)>,
    /// Whether combinational results get registers.
    registers_outputs: bool,
    /// Whether logic that depends on operands alone may get registers.
    registers_operand_logic: bool,
    /// The net that loads the operand registers from their buffers; `None` without buffers.
    taken: Option<NetId>,
    /// The output that tells when a memory loads a written word; `None` without a write port.
    table_ready: Option<NetId>,
    /// The numbers of the lines `valid_word` and `go_on` in the source's block diagram.
    sequencer_lines: Option<[u16; 2]>,
    diagnostics: Vec<Diagnostic>,
    names: HashSet<String>,
    /// For each name that several added nets would have, the number in the latest net's name.
    counts: HashMap<String, u32>,
    partition: Partition,
}

impl Designer {
    /// Makes an empty design; `name` becomes the name of the top module, and must be a Verilog identifier.
    ///
    /// The design already has the handshake inputs `rst_n` and `start`. [`Designer::finish`] adds the outputs `valid`, `busy`
    /// and `done`.
    #[track_caller]
    pub fn new(name: &str) -> Self {
        let inner = Inner {
            design: Design::empty(name),
            views: HashMap::new(),
            program: None,
            parts: Vec::new(),
            placed: HashSet::new(),
            picked: HashSet::new(),
            partly_used: HashSet::new(),
            valid: None,
            registers_outputs: false,
            registers_operand_logic: true,
            taken: None,
            table_ready: None,
            sequencer_lines: None,
            diagnostics: Vec::new(),
            names: HashSet::new(),
            counts: HashMap::new(),
            partition: Partition::Control,
        };
        static DESIGNERS: AtomicU64 = AtomicU64::new(0);
        let mut designer = Self {
            inner: RefCell::new(inner),
            serial: DESIGNERS.fetch_add(1, Ordering::Relaxed),
            depth: 0,
            start: NetId(0),
            idle: NetId(0),
            run: NetId(0),
        };
        let reset = designer.add_named("rst_n", Format::BIT, Driver::Input);
        designer.port(reset, Role::Reset);
        designer.set_doc(reset, "reset, active low");
        designer.start = designer.add_named("start", Format::BIT, Driver::Input);
        designer.port(designer.start, Role::Start);
        designer.set_doc(designer.start, "starts a computation if not busy");
        designer.run =
            designer.add_register("run", Format::BIT, Format::BIT.range(), RegisterKind::Sequencer);
        designer.set_doc(designer.run, "1 while a microprogram runs");
        designer.idle = designer.add_named("idle", Format::BIT, Driver::Undriven);
        designer.set_doc(designer.idle, "1 while operands can be written");
        designer.inner.borrow_mut().partition = Partition::Datapath;
        designer
    }

    /// Sets the texts about the device for the Verilog header, the manifest and the documentation.
    pub fn about(&self, about: About) {
        self.inner.borrow_mut().design.about = about;
    }

    /// States the functions among which the operand [`OPCODE`] selects. The emitted Verilog and C define a constant for each
    /// function, and the manifest lists them. The functions do not change the hardware.
    pub fn functions(&self, functions: Vec<CoreFunction>) {
        self.inner.borrow_mut().design.functions = functions;
    }

    /// Adds a constant. Reports a mistake if `format` cannot represent `value` exactly: `u0.8` can represent 0.75 but not 0.1.
    #[track_caller]
    pub fn constant(&self, name: &str, value: f64, format: Format) -> Signal<'_> {
        let format = self.sound(name, format);
        let raw = format.quantise(value);
        if format.to_f64(raw) != value {
            let message = format!("constant `{name}`: {value} is not representable in {format}");
            self.error(codes::FORMAT, message);
        }
        let id = self.add_wiring(name, format, (raw, raw), Driver::Constant(format.bits(raw)));
        self.signal(id)
    }

    /// Adds the constant with the raw value `raw`: 192 in `u0.8` is 0.75. If `raw` does not fit, reports a mistake and returns
    /// the constant 0.
    #[track_caller]
    pub fn raw_constant(&self, name: &str, mut raw: i128, format: Format) -> Signal<'_> {
        let format = self.sound(name, format);
        if !format.holds(raw) {
            self.error(codes::FORMAT, format!("constant `{name}`: {raw} does not fit {format}"));
            raw = 0;
        }
        let id = self.add_wiring(name, format, (raw, raw), Driver::Constant(format.bits(raw)));
        self.signal(id)
    }

    /// Returns a wire that is used before its driver exists, as in a feedback path. Connect the driver later by
    /// [`Designer::drive`].
    #[track_caller]
    pub fn wire(&self, name: &str, format: Format) -> Signal<'_> {
        self.signal(self.add_named(name, format, Driver::Undriven))
    }

    /// Connects the driver of a [`Designer::wire`]. Reports a mistake if the wire already has one, or if `source` does not fit
    /// its format.
    #[track_caller]
    pub fn drive(&self, wire: Signal<'_>, source: Signal<'_>) {
        let wire = self.own(wire);
        let (format, net) = (wire.format(), self.net(wire.id()));
        if net.driver != Driver::Undriven {
            let message =
                format!("`{}` has two drivers: `{}` is the second", net.name, source.name());
            self.error_at(codes::TWO_DRIVERS, message, [("the first is here", net.location)]);
            return;
        }
        if let Some(id) = self.fitted(source, format, &format!("wire `{}`", net.name)) {
            self.inner.borrow_mut().design.nets[wire.id().index()].driver =
                Driver::Op(Op::Relabel(id));
        }
    }

    /// Adds a read-only memory. The words are raw values of `format`; `address` selects the word that it reads.
    ///
    /// Reports a mistake if the address has fraction bits or can exceed the words, or if a word does not fit `format`. A
    /// `synchronous` ROM reads on the rising edge, as block RAM does. The output is the word at the address of the clock
    /// before, and 0 at power-up.
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
            self.error(codes::MEMORY, format!(
                "ROM `{name}` has {} words, but its address `{}` ({}) runs from {low} to {high}",
                words.len(),
                address.name(),
                address.format()
            ));
        }
        // A synchronous ROM has the output 0 at power-up.
        let first = synchronous.then_some(0);
        let mut range = interval::of_values(words.iter().copied().chain(first)).unwrap_or((0, 0));
        if let Some((at, raw)) = words.iter().enumerate().find(|(_, raw)| !format.holds(**raw)) {
            let message = format!("ROM `{name}`: word {at} is {raw}, which does not fit {format}");
            self.error(codes::FORMAT, message);
            range = format.range();
        }
        let data = self.add_net(&format!("{name}_word"), format, range, Driver::Undriven, true);
        let bits = words.iter().map(|&raw| format.bits(raw)).collect();
        let rom = NetRom::new(name, address.id(), data, bits, Location::caller());
        let id = self.with(|inner| inner.design.add_rom(NetRom { synchronous, ..rom }));
        Rom { designer: self, id }
    }

    /// Adds an output port for a result, in the format of `source`.
    #[track_caller]
    pub fn output<'d>(&'d self, name: &str, source: Signal<'d>) -> Signal<'d> {
        self.output_as(name, source, Role::Result)
    }

    /// Adds an output port for a signal of the control unit that is no result.
    #[track_caller]
    pub fn status<'d>(&'d self, name: &str, source: Signal<'d>) -> Signal<'d> {
        self.output_as(name, source, Role::Status)
    }

    #[track_caller]
    fn output_as<'d>(&'d self, name: &str, source: Signal<'d>, role: Role) -> Signal<'d> {
        let source = self.own(source);
        let driver = Driver::Op(Op::Relabel(source.id()));
        let id = self.add_net(name, source.format(), source.range(), driver, true);
        self.port(id, role);
        self.signal(id)
    }

    /// Sets the microprogram. Reports a mistake if the description already has one. The device waits for `start` in
    /// microinstruction 0, and executes this microinstruction once more after `start`, so that logic behind the operands has one
    /// clock.
    #[track_caller]
    pub fn microprogram(&self, steps: impl IntoIterator<Item = Step>) {
        self.program(steps.into_iter().collect(), false);
    }

    #[track_caller]
    fn program(&self, steps: Vec<Step>, of_parts: bool) {
        let program = MicroprogramSource { steps, of_parts, location: Location::caller() };
        if self.inner.borrow_mut().program.replace(program).is_some() {
            self.error(codes::MICROPROGRAM, "the description has a second microprogram".to_owned());
        }
    }

    /// Makes `valid` follow the one-bit `signal` with a delay of `clocks` clocks.
    ///
    /// This serves a datapath with registers between the operation that a microinstruction starts and the outputs: a result may
    /// come in every clock. No microinstruction may raise [`valid`] then. The microprogram must keep the device busy until the
    /// last result is on the outputs. A reset drops the results on their way. Reports a mistake if `signal` has several bits, or
    /// if `valid` already follows a signal.
    #[track_caller]
    pub fn valid_after(&self, signal: Signal<'_>, clocks: u32) {
        let signal = self.own(signal);
        if signal.format().width() != 1 {
            let message =
                format!("`valid` follows `{}`, which has more than one bit", signal.name());
            self.error(codes::VALID, message);
        } else if self.inner.borrow_mut().valid.replace((signal.id(), clocks)).is_some() {
            let message = format!("`valid` follows two signals: `{}` is the second", signal.name());
            self.error(codes::VALID, message);
        }
    }

    /// Sets the numbers of two control lines in the source's block diagram. A microinstruction raises `valid` by the line
    /// `valid`, and lets the program continue by the line `go_on`.
    pub fn sequencer_lines(&self, valid: u16, go_on: u16) {
        self.inner.borrow_mut().sequencer_lines = Some([valid, go_on]);
    }

    /// Requests a register behind every output that is combinational logic. A microinstruction that raises `valid` in the
    /// description loads these registers instead, and an additional microinstruction then raises `valid`. If `valid` follows a
    /// signal, these registers load on every clock, and `valid` comes one clock later.
    pub fn register_outputs(&self) {
        self.inner.borrow_mut().registers_outputs = true;
    }

    /// Forbids [`Designer::finish`] to insert registers into logic that depends on operands alone. Otherwise `finish` inserts
    /// registers where a value is first used some clocks after `start`.
    pub fn keep_operand_logic(&self) {
        self.inner.borrow_mut().registers_operand_logic = false;
    }

    /// Adds a buffer in front of every operand register, so that no clock is lost between two computations. A user may write
    /// the buffers at any time. `start`, which the device also accepts in the last clock of a computation, copies the buffers
    /// into the registers. Reports a mistake if an operand is already declared.
    #[track_caller]
    pub fn buffer_operands(&self) {
        if self.with(|inner| inner.design.ports.iter().any(|it| it.role == Role::Strobe)) {
            let message = "an operand is declared before its buffer is asked for".to_owned();
            self.error(codes::BUFFER, message);
            return;
        }
        let taken = Driver::Op(Op::And(self.start, self.idle));
        let taken = self.add_named("operands_load", Format::BIT, taken);
        self.set_doc(taken, "start, if it is accepted");
        self.set_doc(self.start, "starts a computation if not busy, or in the last clock of one");
        self.set_doc(
            self.idle,
            "1 while start is accepted: not busy, or the last clock of a computation",
        );
        self.inner.borrow_mut().taken = Some(taken);
    }

    /// Replaces the note about writes while the device is busy.
    fn replace_note(&self, note: &str) {
        self.with(|inner| {
            let notes = &mut inner.design.about.notes;
            notes.retain(|note| note.topic != Topic::Writes);
            notes.push(Topic::Writes.note(note));
        });
    }

    /// Returns the finished and checked design. [`Design::warnings`] lists the logic on which no output depends.
    ///
    /// # Errors
    /// Fails if the description has mistakes. The whole design is checked only if its functions have reported none.
    pub fn finish(self) -> Result<Design, Diagnostics> {
        let program = self.inner.borrow_mut().program.take();
        if let Some(mut program) = program {
            let location = program.location;
            self.located(location, || {
                self.with_parts(&mut program);
                if self.with(|inner| inner.registers_outputs) {
                    output_registers::insert(&self, &mut program);
                }
                if self.with(|inner| inner.taken.is_some()) {
                    self.replace_note(BUFFERED_NOTE);
                }
                program::assemble(&self, &program);
            });
        } else {
            let first = self.with(|inner| inner.parts.get(1).map(|step| step.location));
            let location = first.unwrap_or(self.net(self.start).location);
            let message = match first {
                Some(_) => "no microprogram executes the parts: call `dataflow()` after the parts",
                None => "the design has no microprogram",
            };
            self.report(Diagnostic::new(codes::MICROPROGRAM, message.to_owned(), location));
        }
        let inner = self.inner.into_inner();
        let registers_operand_logic = inner.registers_operand_logic;
        let Inner { mut design, views, picked, partly_used, mut diagnostics, .. } = inner;
        if diagnostics.is_empty() {
            diagnostics = design.verify();
        }
        if diagnostics.is_empty() {
            diagnostics = rules::check(&design, &views, &picked);
        }
        if !diagnostics.is_empty() {
            return Err(Diagnostics(diagnostics));
        }
        design.warnings = rules::warnings(&design, &partly_used);
        if registers_operand_logic {
            register_held(&mut design);
        }
        Ok(design)
    }
}
