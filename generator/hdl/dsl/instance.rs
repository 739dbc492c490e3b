//! Instantiates a hardware description within another one, as a *part* whose operands are signals of the surrounding description.
//! For example, `shading` instantiates `dot-product`.
//!
//! The nets, registers and memories of the part join the surrounding design, with the name of the instance in front. The parts
//! run in turn. A part has no ports, sequencer or handshake of its own.

use std::collections::HashMap;
use std::panic::Location;

use super::program::{MicroprogramSource, Step, StepSetting, end, jump_if, step, valid};
use super::rules::read_by;
use super::{Designer, Inner, Signal};
use crate::netlist::{
    Design, Driver, Field, FieldId, FieldKind, Net, NetId, NetlistRom, Op, RegisterKind, Role,
    Sequence,
};
use glint_base::codes;
use glint_base::cone;
use glint_base::diagnostic::{Diagnostic, Diagnostics, SourceLocation};
use glint_base::fixed::Format;

/// The largest depth of parts inside parts, so that a description that instantiates itself is a mistake and no endless recursion.
const DEEPEST: u32 = 8;

/// An instance of another hardware description; [`Instance::out`] gives its results.
pub struct Instance<'d> {
    designer: &'d Designer,
    name: String,
    /// The results of the part, each with its name; `None` if the part has mistakes, which have been reported.
    outputs: Option<Vec<(String, Signal<'d>)>>,
}

impl<'d> Instance<'d> {
    /// Returns the result `output` of the part. A register stores the result until the part computes again. Reports a mistake
    /// if the part has no such result. In this case, and if the part has mistakes, returns a constant 0 of one bit.
    #[track_caller]
    pub fn out(&self, output: &str) -> Signal<'d> {
        let outputs = self.outputs.as_deref().unwrap_or_default();
        if let Some((_, signal)) = outputs.iter().find(|(name, _)| name == output) {
            return *signal;
        }
        if self.outputs.is_some() {
            let names: Vec<&str> = outputs.iter().map(|(name, _)| name.as_str()).collect();
            let message = format!(
                "the part `{}` has no output `{output}`: its outputs are {}",
                self.name,
                names.join(", ")
            );
            self.designer.error(codes::PART, message);
        }
        self.designer.raw_constant("nothing", 0, Format::BIT)
    }
}

impl Designer {
    /// Instantiates `describe` as a part called `name`, with a signal for each of its operands. The microinstruction before the
    /// part's first one loads the part's operand registers. A description with parts calls [`Designer::dataflow`] instead of
    /// writing a microprogram.
    ///
    /// Reports a mistake if the names in `operands` differ from the part's operands, or a signal does not fit its operand's
    /// format. It is also a mistake if another part has the same name, or parts are nested more than 8 deep. A part must raise
    /// `valid` by a microinstruction, for one result, and must not wait for `start`. The part's own mistakes are reported too.
    ///
    /// ```
    /// use glint_rtl::dsl::{Designer, end, step, valid};
    /// use glint_base::fixed::Format;
    ///
    /// fn square(d: &Designer) {
    ///     let x = d.operand("x", Format::unsigned(4, 0));
    ///     let square = d.register("square", Format::unsigned(8, 0));
    ///     square.takes(d.mul("product", x.q(), x.q()));
    ///     d.output("square_out", square.q());
    ///     d.microprogram([
    ///         step("idle", []),
    ///         step("multiply", [square.load()]),
    ///         step("result", [valid(), end()]),
    ///     ]);
    /// }
    ///
    /// let d = Designer::new("sum_of_squares");
    /// let squared = ["a", "b"].map(|name| {
    ///     let operand = d.operand(name, Format::unsigned(4, 0));
    ///     d.instance(&format!("{name}_squared"), square, &[("x", operand.q())]).out("square_out")
    /// });
    /// d.output("sum_out", d.add("sum", squared[0], squared[1]));
    /// d.dataflow();
    /// let design = d.finish().unwrap();
    /// assert!(design.find("a_squared_square").is_some() && design.find("b_squared_square").is_some());
    /// ```
    #[track_caller]
    pub fn instance<'d>(
        &'d self,
        name: &str,
        describe: impl FnOnce(&Designer),
        operands: &[(&str, Signal<'d>)],
    ) -> Instance<'d> {
        let wrong = Instance { designer: self, name: name.to_owned(), outputs: None };
        if self.depth == DEEPEST {
            self.error(
                codes::PART,
                format!(
                    "the part `{name}` is nested {DEEPEST} deep: does a description contain itself?"
                ),
            );
            return wrong;
        }
        let load = format!("{name}_operands_load");
        if self.with(|inner| inner.names.contains(&load)) {
            self.error(codes::NAME_TWICE, format!("two parts are named `{name}`"));
            return wrong;
        }
        let part = Designer { depth: self.depth + 1, ..Designer::new(name) };
        describe(&part);
        part.register_outputs();
        part.keep_operand_logic();
        let design = match part.finish() {
            Ok(design) => design,
            Err(Diagnostics(mistakes)) => {
                let location = Location::caller();
                for mistake in mistakes {
                    self.report(mistake.note(format!("in the part `{name}`"), location));
                }
                return wrong;
            }
        };
        if let Some(why) = unfit(&design) {
            self.error(codes::PART, format!("`{name}` cannot be a part: {why}"));
            return wrong;
        }
        let given: Vec<&str> = operands.iter().map(|(operand, _)| *operand).collect();
        let mut asked: Vec<&str> = Vec::new();
        for port in &design.ports {
            if matches!(port.role, Role::Operand { .. }) {
                asked.push(&design.net(port.net).name);
            }
        }
        let same = given.len() == asked.len() && asked.iter().all(|it| given.contains(it));
        if !same {
            let [asked, given] = [asked, given].map(|names| names.join(", "));
            let message =
                format!("the part `{name}` has the operands {asked}, but is given {given}");
            self.error(codes::PART, message);
            return wrong;
        }
        let mut signals = HashMap::new();
        for &(operand, signal) in operands {
            let port = design.find(operand).unwrap_or(NetId(0));
            let what = format!("operand `{operand}` of `{name}`");
            let Some(fitted) = self.fitted(self.own(signal), design.net(port).format, &what) else {
                return wrong;
            };
            signals.insert(port, fitted);
        }
        let load = self.add_field(&load, 1, FieldKind::Enable);
        let (nets, fields) = (HashMap::new(), HashMap::new());
        InstanceBuilder { designer: self, name, design: &design, nets, fields }.place(
            &signals,
            load,
            Location::caller(),
        )
    }

    /// Makes the microprogram from the parts. The microprogram executes the parts in the order of their instances, and then
    /// loads each output that is no register yet into a register. All logic between the parts must be combinational.
    /// [`Designer::finish`] reports a mistake for a register or a synchronous ROM outside the parts that loads on every clock.
    #[track_caller]
    pub fn dataflow(&self) {
        self.register_outputs();
        self.program(Vec::new(), true);
    }

    /// Replaces `program` by the parts' microinstructions if the description calls [`Designer::dataflow`]. Otherwise reports a
    /// mistake if there are parts.
    pub(super) fn with_parts(&self, program: &mut MicroprogramSource) {
        let mut parts = self.with(|inner| std::mem::take(&mut inner.parts));
        if program.of_parts {
            self.with(delayed).into_iter().for_each(|it| self.report(it));
            if parts.is_empty() {
                parts.push(Step { location: program.location, ..step("idle", []) });
            }
            parts.push(Step { location: program.location, ..step("result", [valid(), end()]) });
            program.steps = parts;
        } else if let Some(first) = parts.get(2) {
            let message = "a description with parts cannot have a microprogram of its own: call `dataflow()` \
                           in place of `microprogram`";
            let found = Diagnostic::new(codes::PART, message.to_owned(), program.location);
            self.report(found.note("the first part".to_owned(), first.location));
        }
    }
}

/// Returns a mistake for each register and synchronous memory outside the parts that loads on every clock. The microprogram of a
/// dataflow does not wait for this clock.
fn delayed(inner: &mut Inner) -> Vec<Diagnostic> {
    let Inner { design, placed, .. } = inner;
    let mut delayed: Vec<NetId> = Vec::new();
    for register in &design.registers {
        if register.kind == RegisterKind::Internal {
            delayed.push(register.q);
        }
    }
    for rom in &design.roms {
        if rom.synchronous {
            delayed.push(rom.data);
        }
    }
    let mut found = Vec::new();
    for id in delayed {
        if placed.contains(&id) {
            continue;
        }
        let net = design.net(id);
        let message = format!(
            "`{}` follows its input after one clock, and `dataflow()` does not wait for this clock: read the \
             memory without a clock, remove the register, or put it into a part",
            net.name
        );
        found.push(Diagnostic::new(codes::PART, message, net.location));
    }
    found
}

/// Returns the reason why a design cannot be a part, or `None` if it can.
fn unfit(design: &Design) -> Option<String> {
    let control = &design.control;
    let Some(valid) = control.fields.iter().position(|field| field.name == "valid_word") else {
        return Some("`valid` follows a signal, because there are several results".to_owned());
    };
    let mut shown = false;
    for (at, it) in control.microprogram.iter().enumerate() {
        shown |= it.values[valid] == 1;
        let why = match it.sequence {
            Sequence::WaitStart => "waits for `start`",
            Sequence::Dispatch { .. } => "dispatches, which parts cannot",
            Sequence::LoopWhile { to, .. } if shown && to <= at => {
                "goes back to compute another result"
            }
            _ => continue,
        };
        return Some(format!("the microinstruction `{}` {why}", it.name));
    }
    None
}

struct InstanceBuilder<'d, 'p> {
    designer: &'d Designer,
    name: &'p str,
    design: &'p Design,
    nets: HashMap<NetId, NetId>,
    fields: HashMap<FieldId, FieldId>,
}

impl<'d> InstanceBuilder<'d, '_> {
    /// Adds the part to the surrounding design. `operands` has the signal for each operand port, and the field `load` loads the
    /// operand registers.
    fn place(
        mut self,
        operands: &HashMap<NetId, NetId>,
        load: FieldId,
        location: SourceLocation,
    ) -> Instance<'d> {
        let (d, design) = (self.designer, self.design);
        let mut shown: Vec<(String, NetId)> = Vec::new();
        for port in &design.ports {
            if port.role == Role::Result {
                shown.push((design.net(port.net).name.clone(), design.renamed(port.net)));
            }
        }
        for id in kept(design, &shown) {
            self.net(id);
        }
        for (id, placed) in &self.nets {
            let driver = match operands.get(id) {
                Some(operand) => Driver::Op(Op::Relabel(*operand)),
                None => self.placed_driver(&design.net(*id).driver),
            };
            d.with(|inner| inner.design.nets[placed.index()].driver = driver);
        }
        let load_net = d.field_net(load).id();
        for register in design.registers.iter().filter(|it| self.nets.contains_key(&it.q)) {
            let (kind, enable) = match register.kind {
                RegisterKind::Operand => (RegisterKind::Architectural, Some(load_net)),
                kind => (kind, register.enable.map(|enable| self.nets[&enable])),
            };
            d.with(|inner| {
                let made = inner.design.add_register(self.nets[&register.q], kind);
                (made.data, made.enable) = (register.data.map(|data| self.nets[&data]), enable);
            });
        }
        for rom in design.roms.iter().filter(|it| self.nets.contains_key(&it.data)) {
            let placed = NetlistRom {
                name: self.named(&rom.name),
                address: self.nets[&rom.address],
                data: self.nets[&rom.data],
                enable: rom.enable.map(|enable| self.nets[&enable]),
                block: None,
                ..rom.clone()
            };
            d.with(|inner| inner.design.add_rom(placed));
        }
        self.program(load, location);
        let outputs = shown.into_iter().map(|(name, id)| (name, d.signal(self.nets[&id])));
        Instance { designer: d, name: self.name.to_owned(), outputs: Some(outputs.collect()) }
    }

    /// Translates a driver to the surrounding design. [`Self::place`] connects registers and memories later, when they exist.
    fn placed_driver(&self, driver: &Driver) -> Driver {
        match driver {
            Driver::Op(op) => Driver::Op(op.map(|id| self.nets[id])),
            Driver::Field(field) => Driver::Field(self.fields[field]),
            Driver::Register(_) | Driver::Rom(_) => Driver::Undriven,
            other => other.clone(),
        }
    }

    fn named(&self, name: &str) -> String {
        format!("{}_{name}", self.name)
    }

    fn net(&mut self, id: NetId) {
        let (d, net) = (self.designer, self.design.net(id).clone());
        let name = self.named(&net.name);
        let placed = d.with(|inner| {
            inner.names.insert(name.clone());
            let id = inner.design.add_net(Net { name: name.clone(), block: None, ..net.clone() });
            inner.placed.insert(id);
            id
        });
        self.nets.insert(id, placed);
        if let Driver::Field(field) = net.driver {
            let kind = self.design.control.fields[field.index()].kind.clone();
            let own = d.with(|inner| {
                let fields = &mut inner.design.control.fields;
                fields.push(Field { name, net: placed, kind, lines: Vec::new() });
                let own = FieldId(fields.len() as u32 - 1);
                // The check of the part itself has already reported unused choices.
                inner.partly_used.insert(own);
                own
            });
            self.fields.insert(field, own);
        }
    }

    /// Appends the microinstructions of this part. The last microinstruction of the previous part (for the first part `operands`,
    /// which follows `idle`) loads this part's operands.
    fn program(&self, load: FieldId, location: SourceLocation) {
        let (d, control) = (self.designer, &self.design.control);
        let named = |at: usize| format!("{}: {}", self.name, control.microprogram[at].name);
        let mut fields: Vec<_> = self.fields.iter().collect();
        fields.sort_unstable();
        let mut steps: Vec<Step> = Vec::new();
        for (at, microinstruction) in control.microprogram.iter().enumerate() {
            let mut settings = Vec::new();
            for &(field, own) in &fields {
                let value = microinstruction.values[field.index()];
                let stated = &control.fields[field.index()];
                if value != 0 || matches!(stated.kind, FieldKind::Select(_)) {
                    let what = format!("{}.{}", self.name, stated.name);
                    settings.push(StepSetting::field(d, *own, value, what));
                }
            }
            if let Sequence::LoopWhile { condition, to } = microinstruction.sequence {
                let condition = d.signal(self.nets[&condition]);
                settings.push(jump_if(condition, &named(to)));
            }
            let mut step = step(&named(at), settings);
            step.location = microinstruction.location;
            steps.push(step);
        }
        d.with(|inner| {
            if inner.parts.is_empty() {
                inner.parts =
                    ["idle", "operands"].map(|name| Step { location, ..step(name, []) }).into();
            }
        });
        let load = StepSetting::field(d, load, 1, format!("{}.operands_load", self.name));
        d.with(|inner| {
            if let Some(before) = inner.parts.last_mut() {
                before.settings.push(load);
            }
            inner.parts.extend(steps);
        });
    }
}

/// Returns the nets on which the results `shown` and the conditions of the microprogram depend, in the order of the design.
/// Strobes, sequencer and handshake are not among them, because the surrounding design has its own.
fn kept(design: &Design, shown: &[(String, NetId)]) -> Vec<NetId> {
    let mut roots: Vec<NetId> = shown.iter().map(|(_, id)| *id).collect();
    for microinstruction in &design.control.microprogram {
        if let Sequence::LoopWhile { condition, .. } = microinstruction.sequence {
            roots.push(condition);
        }
    }
    let reached = cone::reached(roots, |id| match design.net(id).driver {
        Driver::Field(_) => Vec::new(),
        Driver::Register(it) if design.register(it).kind == RegisterKind::Operand => {
            design.register(it).data.into_iter().collect()
        }
        _ => read_by(design, id),
    });
    let mut kept: Vec<NetId> = reached.into_iter().collect();
    kept.sort_unstable();
    kept
}
