//! Checks the structure of a [`Design`]: its names, drivers, widths, combinational loops and microprogram.
//!
//! The description language runs these checks on every design that a user describes; tests run them on generated pipelines. For
//! example, the checks report a net without a driver. Only co-simulation with the golden model notices a wrong formula.

use std::collections::HashMap;

use super::{Design, Driver, FieldKind, Net, NetId, Op, Role, Sequence, WritePort};
use glint_base::codes;
use glint_base::diagnostic::{Diagnostic, SourceLocation};
use glint_base::fixed::{MAX_WIDTH, mask};
use glint_base::identifier;

impl Design {
    /// Returns the mistakes in names and structure, such as a net with two drivers. Without such mistakes, checks the
    /// microprogram too.
    pub fn verify(&self) -> Vec<Diagnostic> {
        let mut found = self.verify_structure();
        self.names(&mut found);
        if found.is_empty() {
            self.microprogram(&mut found);
        }
        found
    }

    /// Returns the mistakes that make a design meaningless: references to missing parts, nets without a driver or with two
    /// drivers, wrong widths, and combinational loops. Names and the microprogram are not checked.
    pub fn verify_structure(&self) -> Vec<Diagnostic> {
        let mut found = Vec::new();
        // The later checks must not index parts that do not exist, or ask for an impossible width.
        self.references(&mut found);
        if !found.is_empty() {
            return found;
        }
        self.drivers(&mut found);
        self.widths(&mut found);
        self.roms(&mut found);
        if found.is_empty() {
            self.loops(&mut found);
        }
        found
    }

    fn references(&self, found: &mut Vec<Diagnostic>) {
        let mut missing = |index: usize, count: usize, what: &str, location: SourceLocation| {
            if index >= count {
                let message = format!(
                    "the netlist refers to {what} {index}, but the number of such entries is {count}"
                );
                found.push(Diagnostic::new(codes::REFERENCE, message, location));
            }
        };
        let nets = self.nets.len();
        let fields = self.control.fields.len();
        for net in &self.nets {
            let at = net.location;
            match &net.driver {
                Driver::Register(id) => missing(id.index(), self.registers.len(), "register", at),
                Driver::Rom(id) => missing(id.index(), self.roms.len(), "ROM", at),
                Driver::Field(id) => missing(id.index(), fields, "field", at),
                Driver::Op(op) => {
                    op.operands().iter().for_each(|net| missing(net.index(), nets, "net", at));
                }
                Driver::Undriven | Driver::Input | Driver::Constant(_) => {}
            }
        }
        // Only nets have a location in the description. Mistakes of all other parts get the location of the first net.
        let Some(first) = self.nets.first().map(|net| net.location) else { return };
        let mut referred: Vec<NetId> = Vec::new();
        for register in &self.registers {
            referred.push(register.q);
            referred.extend(register.data);
            referred.extend(register.enable);
        }
        for rom in &self.roms {
            referred.extend([rom.address, rom.data]);
            referred.extend(rom.enable);
            referred.extend(rom.write.iter().flat_map(WritePort::nets));
        }
        referred.extend(self.ports.iter().map(|port| port.net));
        referred.extend(self.control.fields.iter().map(|field| field.net));
        for net in referred {
            missing(net.index(), nets, "net", first);
        }
        for rom in self.roms.iter().filter_map(|rom| rom.shares) {
            missing(rom.index(), self.roms.len(), "ROM", first);
        }
        if fields > 0 {
            missing(self.control.rom.index(), self.roms.len(), "ROM", first);
        }
        for net in &self.nets {
            let format = net.format;
            let width =
                i64::from(format.int) + i64::from(format.frac) + i64::from(u8::from(format.signed));
            if !(1..=i64::from(MAX_WIDTH)).contains(&width) {
                let message =
                    format!("`{}` has {width} bits; a net has 1 to {MAX_WIDTH} bits", net.name);
                found.push(Diagnostic::new(codes::WIDE, message, net.location));
            }
        }
    }

    fn names(&self, found: &mut Vec<Diagnostic>) {
        let mut seen: HashMap<&str, SourceLocation> = HashMap::new();
        let nets = self.nets.iter().map(|net| (net.name.as_str(), net.location));
        let roms = self.roms.iter().map(|rom| (rom.name.as_str(), rom.location));
        // The module of a configuration without a `name`.
        let module = self.about.device.replace('-', "_");
        for (name, location) in nets.chain(roms) {
            if name == "clk" {
                let message = "`clk` is the clock of every design; choose another name";
                found.push(Diagnostic::new(codes::NAME, message.to_owned(), location));
            } else if name == module {
                let message = format!(
                    "`{name}` is the name of the device and of its module; choose another name"
                );
                found.push(Diagnostic::new(codes::NAME, message, location));
            } else if let Err(why) = identifier::check(name) {
                let message = format!("`{name}` cannot be a Verilog name: {why}");
                found.push(Diagnostic::new(codes::NAME, message, location));
            }
            if let Some(first) = seen.insert(name, location) {
                let message = format!("the name `{name}` is used twice");
                let diagnostic = Diagnostic::new(codes::NAME_TWICE, message, location);
                found.push(diagnostic.note("the first".to_owned(), first));
            }
        }
        if let Err(why) = identifier::check(&self.name)
            && let Some(net) = self.nets.first()
        {
            let message = format!("`{}` cannot be the name of a Verilog module: {why}", self.name);
            found.push(Diagnostic::new(codes::NAME, message, net.location));
        }
    }

    fn drivers(&self, found: &mut Vec<Diagnostic>) {
        let inputs: Vec<NetId> = self.inputs().map(|port| port.net).collect();
        for (id, net) in self.iter() {
            let ports = inputs.iter().filter(|&&input| input == id).count();
            let wrong = match &net.driver {
                Driver::Undriven => Some(format!("nothing drives `{}`", net.name)),
                Driver::Register(of) if self.register(*of).q != id => {
                    Some(format!("the register of `{}` drives another net", net.name))
                }
                Driver::Rom(of) if self.rom(*of).data != id => {
                    Some(format!("the ROM of `{}` drives another net", net.name))
                }
                Driver::Field(of) if self.control.fields[of.index()].net != id => {
                    Some(format!("the field of `{}` drives another net", net.name))
                }
                Driver::Input if ports == 1 => None,
                Driver::Input if ports == 0 => {
                    Some(format!("`{}` is an input, but not among the ports", net.name))
                }
                _ if ports > 0 => Some(format!(
                    "`{}` is an input port twice, or is an input port without being an input",
                    net.name
                )),
                _ => None,
            };
            found.extend(
                wrong.map(|message| Diagnostic::new(codes::UNDRIVEN, message, net.location)),
            );
        }
        let has_reset = self.port(|role| role == Role::Reset).is_some();
        for register in &self.registers {
            let net = self.net(register.q);
            if register.data.is_none() {
                let message = format!("nothing drives the data input of register `{}`", net.name);
                found.push(Diagnostic::new(codes::UNDRIVEN, message, net.location));
            }
            if register.reset.is_some() && !has_reset {
                let message = format!(
                    "register `{}` has a reset, but the design has no reset port",
                    net.name
                );
                found.push(Diagnostic::new(codes::REFERENCE, message, net.location));
            }
        }
    }

    fn loops(&self, found: &mut Vec<Diagnostic>) {
        if let Err(path) = self.levelise() {
            let mut names: Vec<&str> =
                path.iter().rev().map(|&id| self.net(id).name.as_str()).collect();
            names.extend(names.first().copied());
            let message = format!("combinational loop: `{}`", names.join("` -> `"));
            found.push(Diagnostic::new(codes::LOOP, message, self.net(path[0]).location));
        }
    }

    fn widths(&self, found: &mut Vec<Diagnostic>) {
        for (id, net) in self.iter() {
            let (low, high) = net.range;
            if low > high || !net.format.holds(low) || !net.format.holds(high) {
                let message = format!(
                    "`{}` is {}, but takes values from {low} to {high} ulp",
                    net.name, net.format
                );
                found.push(Diagnostic::new(codes::FORMAT, message, net.location));
            }
            if let Driver::Op(op) = &net.driver
                && let Err(why) = self.cell(id, op)
            {
                let named = |net: &Net| format!("`{}` ({})", net.name, net.format);
                let operands: Vec<String> =
                    op.operands().into_iter().map(|operand| named(self.net(operand))).collect();
                let (result, cell) = (named(net), op.mnemonic());
                let message = format!("{result} = {cell} of {}: {why}", operands.join(", "));
                found.push(Diagnostic::new(codes::WIDTH, message, net.location));
            }
        }
        for register in &self.registers {
            let net = self.net(register.q);
            if register.data.is_some_and(|data| self.width(data) != self.width(register.q)) {
                let message = format!("register `{}` and its data differ in width", net.name);
                found.push(Diagnostic::new(codes::WIDTH, message, net.location));
            }
            if register.enable.is_some_and(|enable| self.width(enable) != 1) {
                let message = format!("the enable of register `{}` is not one bit", net.name);
                found.push(Diagnostic::new(codes::WIDTH, message, net.location));
            }
        }
    }

    /// Checks the widths and signs that [`Op`] documents. The error is the violated rule.
    fn cell(&self, id: NetId, op: &Op) -> Result<(), &'static str> {
        let width = |id: NetId| self.width(id);
        let signed = |id: NetId| self.net(id).format.signed;
        let own = width(id);
        let same = |operands: &[NetId]| operands.iter().all(|&operand| width(operand) == own);
        const EQUAL: &str = "the widths must be equal";
        const BIT: &str = "the result must have one bit";
        match op {
            Op::Relabel(a) | Op::Not(a) => ok(same(&[*a]), EQUAL),
            Op::Extend(a) => ok(width(*a) < own, "the result must be wider"),
            Op::Slice { of, low } => ok(
                low.checked_add(own).is_some_and(|top| top <= width(*of)),
                "the slice must lie within the operand",
            ),
            Op::Concat(parts) => ok(
                parts.iter().map(|&part| width(part)).sum::<u32>() == own,
                "the widths must add up",
            ),
            Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b) | Op::Sub(a, b) => {
                ok(same(&[*a, *b]), EQUAL)
            }
            Op::Add { a, b, carry } => {
                ok(carry.is_none_or(|carry| width(carry) == 1), "the carry must have one bit")?;
                ok(same(&[*a, *b]), EQUAL)
            }
            Op::Mul(a, b) => {
                ok(signed(*a) == signed(*b), "both operands must be signed, or both unsigned")?;
                ok(
                    width(*a) + width(*b) == own,
                    "the product must be as wide as both operands together",
                )
            }
            Op::Equal(a, b) => {
                ok(width(*a) == width(*b), EQUAL)?;
                ok(own == 1, BIT)
            }
            Op::Less(a, b) => {
                ok(width(*a) == width(*b), EQUAL)?;
                ok(signed(*a) == signed(*b), "both operands must be signed, or both unsigned")?;
                ok(own == 1, BIT)
            }
            Op::Any(_) | Op::All(_) => ok(own == 1, BIT),
            Op::Mux { select, inputs } => {
                ok(inputs.len() >= 2, "a mux must have at least two inputs")?;
                let needed = usize::BITS - (inputs.len() - 1).leading_zeros();
                ok(width(*select) >= needed, "the mux has too few select lines")?;
                ok(same(inputs), EQUAL)
            }
        }
    }

    fn roms(&self, found: &mut Vec<Diagnostic>) {
        for rom in &self.roms {
            let width = self.width(rom.data);
            if let Some(at) = rom.words.iter().position(|&word| word & !mask(width) != 0) {
                let message = format!("ROM `{}`: word {at} does not fit {width} bits", rom.name);
                found.push(Diagnostic::new(codes::FORMAT, message, rom.location));
            }
            if rom.enable.is_some_and(|enable| self.width(enable) != 1) {
                let message = format!("the enable of ROM `{}` is not one bit", rom.name);
                found.push(Diagnostic::new(codes::WIDTH, message, rom.location));
            }
            if let Some(write) = &rom.write {
                let parts: u32 = write.parts.iter().map(|&part| self.width(part)).sum();
                if self.width(write.enable) != 1 || parts != width {
                    let message = format!(
                        "the write port of `{}` needs an enable of one bit and words of {width} bits",
                        rom.name
                    );
                    found.push(Diagnostic::new(codes::WIDTH, message, rom.location));
                }
            }
            let (comments, words) = (rom.comments.len(), rom.words.len());
            if comments != 0 && comments != words {
                let message = format!("ROM `{}`: {comments} comments for {words} words", rom.name);
                found.push(Diagnostic::new(codes::REFERENCE, message, rom.location));
            }
        }
        let fields = self.control.fields.iter();
        let wide: u32 = fields.map(|field| self.width(field.net)).sum();
        if wide > 0 {
            let rom = self.rom(self.control.rom);
            let word = self.width(rom.data);
            if wide > word {
                let message =
                    format!("the fields take {wide} bits, but the control word has {word} bits");
                found.push(Diagnostic::new(codes::WIDTH, message, rom.location));
            }
        }
    }

    fn microprogram(&self, found: &mut Vec<Diagnostic>) {
        let control = &self.control;
        let microprogram = &control.microprogram;
        let mut reached = vec![false; microprogram.len()];
        let mut pending = vec![0];
        while let Some(at) = pending.pop() {
            let Some(reached) = reached.get_mut(at) else {
                if let Some(last) = microprogram.last() {
                    let message =
                        format!("the last microinstruction, `{}`, does not end", last.name);
                    found.push(Diagnostic::new(codes::SUCCESSOR, message, last.location));
                }
                continue;
            };
            if !std::mem::replace(reached, true) {
                pending.extend(control.successors(at));
            }
        }
        for (microinstruction, reached) in microprogram.iter().zip(reached) {
            if !reached {
                let message =
                    format!("microinstruction `{}` cannot be reached", microinstruction.name);
                found.push(Diagnostic::new(codes::SUCCESSOR, message, microinstruction.location));
            }
        }
        if let Some(idle) = microprogram.first() {
            if !matches!(idle.sequence, Sequence::Next | Sequence::Dispatch { .. }) {
                let message = format!(
                    "microinstruction `{}`, in which the device waits for `start`, must continue with the \
                     next microinstruction, or dispatch",
                    idle.name
                );
                found.push(Diagnostic::new(codes::IDLE, message, idle.location));
            }
            for (field, value) in control.fields.iter().zip(&idle.values) {
                if *value != 0 && matches!(field.kind, FieldKind::Enable | FieldKind::Flag) {
                    let message = format!(
                        "microinstruction `{}` sets `{}`, but the device waits for `start` in this \
                         microinstruction",
                        idle.name, field.name
                    );
                    found.push(Diagnostic::new(codes::IDLE, message, idle.location));
                }
            }
        }
        for (at, field) in control.fields.iter().enumerate() {
            if field.kind == FieldKind::Enable
                && microprogram.iter().all(|microinstruction| microinstruction.values[at] == 0)
            {
                let message = format!("no microinstruction sets `{}`", field.name);
                let location = self.net(field.net).location;
                found.push(Diagnostic::new(codes::UNUSED_CONTROL, message, location));
            }
        }
    }
}

fn ok(holds: bool, why: &'static str) -> Result<(), &'static str> {
    if holds { Ok(()) } else { Err(why) }
}
