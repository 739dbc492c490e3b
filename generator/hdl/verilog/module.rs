//! Writes the Verilog modules of the control unit and of the datapath. The module of a pipeline also uses sections of this
//! module.

use std::collections::{BTreeMap, BTreeSet};

use super::expression::Expressions;
use super::header::{self, Origin};
use super::interface::{Interface, unread};
use super::invariants::invariants;
use super::naming::{Naming, is_control_rom, rom_label};
use super::plan::{NetForm, Plan, address_width};
use super::rows::{Row, separated};
use super::text::{COLUMNS, annotated, comment, literal, range, statement};
use super::words::{in_fields, in_hex, word_note};
use super::writer;
use crate::netlist::{
    Design, Driver, Multiplier, NetId, NetlistRegister, Op, Partition, RegId, RomId,
};

/// Writes one module: the control unit, the datapath or a pipeline.
pub struct Builder<'a> {
    pub(super) plan: &'a Plan<'a>,
    naming: &'a Naming,
    interface: &'a Interface,
    partition: Partition,
    pub(super) expressions: Expressions<'a>,
    /// The choices of select fields that are labels of case statements, as field number and value.
    labels: BTreeSet<(usize, usize)>,
    /// The comment of the previous assignment, which is not repeated.
    last_note: String,
}

impl<'a> Builder<'a> {
    pub fn new(
        plan: &'a Plan<'a>,
        naming: &'a Naming,
        interface: &'a Interface,
        partition: Partition,
    ) -> Self {
        Self {
            plan,
            naming,
            interface,
            partition,
            expressions: Expressions::new(plan, naming.names.clone()),
            labels: BTreeSet::new(),
            last_note: String::new(),
        }
    }

    /// Returns the complete text of the module, with its header comment.
    pub fn module(mut self, origin: &Origin) -> String {
        // The statements determine which constants and choices are declared, and so come first.
        let items = self.items(&|_| true);
        let groups = self.groups(&|_| true);
        let initial = if self.naming.style.initial { self.initial() } else { Vec::new() };
        let mut body = writer::section("Constants", self.constants());
        let state = Row::declarations(&self.state(&|_| true));
        body.extend(writer::section("Registers", state));
        body.extend(writer::block("    initial begin", initial, "    end"));
        // Consecutive items of one line have no empty line between them.
        let mut after_line = false;
        for item in items {
            let is_line = item.len() == 1;
            body.extend((!(is_line && after_line)).then(String::new));
            body.extend(item);
            after_line = is_line;
        }
        for group in groups {
            body.extend(writer::block("    always @(posedge clk) begin", group, "    end"));
        }
        body.extend(self.unused());
        let formal = invariants(self.plan.design, self.naming, self.partition);
        body.extend(writer::block("`ifdef FORMAL", formal, "`endif"));
        let header = header::partition(self.plan.design, self.partition, origin, self.naming);
        let name = self.naming.module(self.partition);
        let parameters = parameters(self.naming, &self.interface.roms);
        writer::module(header, &name, &parameters, self.ports(), body)
    }

    pub(super) fn ports(&self) -> Vec<String> {
        let mut rows = Vec::new();
        if self.interface.clocked {
            rows.push(Row::port("input", "wire", 1, false, "clk", ""));
        }
        for (nets, direction) in
            [(&self.interface.inputs, "input"), (&self.interface.outputs, "output")]
        {
            for &net in nets {
                let kind = if direction == "output" { self.kind(net) } else { "wire" };
                rows.push(Row::net(self.plan, direction, kind, net));
            }
        }
        Row::ports(&rows)
    }

    /// Returns `reg` for a net that a procedural block assigns, and otherwise `wire`.
    fn kind(&self, net: NetId) -> &'static str {
        match &self.plan.design.net(net).driver {
            Driver::Register(register) if self.plan.delayed(*register).is_some() => "wire",
            Driver::Register(_) => "reg",
            Driver::Rom(rom) if self.plan.design.rom(*rom).synchronous => "reg",
            Driver::Op(Op::Mux { inputs, .. }) if inputs.len() > 2 => "reg",
            _ => "wire",
        }
    }

    /// Returns the outputs of the registers that the Verilog declares: none inside multipliers, and only the last of a delay
    /// line.
    fn registers(&self) -> impl Iterator<Item = NetId> {
        let design = self.plan.design;
        let written = (0..).map(RegId).zip(&design.registers).filter(|(id, register)| {
            design.multiplier(*id).is_none()
                && self.plan.delayed(*id) != Some(false)
                && self.plan.partition(register.q) == self.partition
        });
        written.map(|(_, register)| register.q)
    }

    /// Declares the registers and the words of synchronous ROMs that are `wanted` and no output ports.
    pub(super) fn state(&self, wanted: &dyn Fn(NetId) -> bool) -> Vec<Row> {
        let mut nets: Vec<NetId> = self.registers().collect();
        for rom in &self.plan.design.roms {
            if rom.synchronous && self.plan.partition(rom.data) == self.partition {
                nets.push(rom.data);
            }
        }
        let mut rows = Vec::new();
        for net in nets {
            if wanted(net) && !self.interface.outputs.contains(&net) {
                rows.push(Row::net(self.plan, "", self.kind(net), net));
            }
        }
        rows
    }

    /// Sets registers to 0 in an initial block. The words of synchronous ROMs are known after the first clock, and on some
    /// targets block memories have no initial values.
    fn initial(&self) -> Vec<String> {
        let design = self.plan.design;
        let mut lines = Vec::new();
        for net in self.registers() {
            let zero = literal(0, design.width(net));
            lines.push(format!("        {} = {zero};", design.net(net).name));
        }
        lines
    }

    pub(super) fn constants(&self) -> Vec<String> {
        let design = self.plan.design;
        let mut lines = Vec::new();
        for constant in &self.expressions.constants {
            lines.extend(localparam(&constant.name, constant.bits, constant.width, &constant.note));
        }
        for &(field, value) in &self.labels {
            let name = &self.naming.choices[field][value];
            let width = design.width(design.control.fields[field].net);
            lines.extend(localparam(name, value as u64, width, ""));
        }
        let is_control = self.partition == Partition::Control;
        if let (false, Some(width)) = (is_control, design.opcode_bits()) {
            lines.push(
                "    // For users of the core; the core itself does not need them.".to_owned(),
            );
            lines.push("    /* verilator lint_off UNUSEDPARAM */".to_owned());
            for (number, function) in design.functions.iter().enumerate() {
                let name = function.constant();
                lines.extend(localparam(&name, number as u64, width, &function.doc));
            }
            lines.push("    /* verilator lint_on UNUSEDPARAM */".to_owned());
        }
        lines
    }

    /// Returns the lines of each `wanted` declared cell, memory and registered multiplier of the module.
    pub(super) fn items(&mut self, wanted: &dyn Fn(NetId) -> bool) -> Vec<Vec<String>> {
        let design = self.plan.design;
        let mut items = Vec::new();
        for &id in &self.plan.live {
            let declared = self.plan.forms[id.index()] == NetForm::Declared;
            if self.plan.partition(id) != self.partition || !declared || !wanted(id) {
                continue;
            }
            match &design.net(id).driver {
                Driver::Op(Op::Mux { select, inputs }) if inputs.len() > 2 => {
                    items.push(self.case(id, *select, inputs));
                }
                Driver::Op(_) | Driver::Field(_) | Driver::Constant(_) => {
                    items.push(self.assign(id))
                }
                Driver::Rom(rom) if !design.rom(*rom).synchronous => items.push(self.rom(*rom)),
                _ => {}
            }
        }
        for &rom in &self.interface.roms {
            if design.rom(rom).synchronous && wanted(design.rom(rom).data) {
                items.push(self.rom(rom));
            }
        }
        for (at, register) in design.registers.iter().enumerate() {
            if let Some(multiplier) = design.multiplier(RegId(at as u32))
                && wanted(register.q)
            {
                items.push(self.multiplier(register, multiplier));
            }
        }
        items
    }

    fn assign(&mut self, id: NetId) -> Vec<String> {
        let mut note = self.plan.remark(id);
        let right = self.expressions.driver(id);
        let lines = statement(4, &format!("{} = {right};", self.target(id)));
        let net = self.plan.design.net(id);
        let repeats = note == self.last_note || (net.doc.is_empty() && net.block.is_none());
        self.last_note.clone_from(&note);
        if let [line] = &lines[..] {
            let behind = annotated(line.trim_start(), 4, &note);
            if behind.len() == 1 {
                return behind;
            }
        }
        // In a pipeline, a net that repeats the previous comment, or has only a format, gets no comment line.
        if repeats && self.plan.design.pipeline.is_some() {
            note.clear();
        }
        [comment(4, &note), lines].concat()
    }

    /// Returns the left side of a continuous assignment: a declaration such as `wire [7:0] sum`, or `assign sum` for an output
    /// port.
    fn target(&self, id: NetId) -> String {
        let net = self.plan.design.net(id);
        if self.interface.outputs.contains(&id) {
            return format!("assign {}", net.name);
        }
        let sign = if net.format.signed { "signed" } else { "" };
        let bits = range(net.format.width());
        let mut words = vec!["wire", sign, &bits, &net.name];
        words.retain(|word| !word.is_empty());
        words.join(" ")
    }

    /// Writes a mux of more than two inputs as a case statement, with the declaration of its net.
    fn case(&mut self, id: NetId, select: NetId, inputs: &[NetId]) -> Vec<String> {
        let design = self.plan.design;
        let name = &design.net(id).name;
        let mut labels = self.case_labels(select, inputs.len());
        labels.push("default".to_owned());
        let mut arms = Vec::new();
        for (label, input) in labels.iter().zip(inputs.iter().chain(inputs.last())) {
            let value = self.expressions.whole(*input);
            arms.extend(statement(12, &format!("{label}: {name} = {value};")));
        }
        let mut lines = comment(4, &self.plan.remark(id));
        if !self.interface.outputs.contains(&id) {
            let declaration = Row::net(self.plan, "", "reg", id).without_note();
            lines.extend(Row::declarations(&[declaration]));
        }
        lines.push("    always @* begin".to_owned());
        lines.push(format!("        case ({})", self.expressions.whole(select)));
        lines.extend(arms);
        lines.extend(["        endcase", "    end"].map(str::to_owned));
        lines
    }

    /// Returns the labels for the select values below `count`: localparams for the choices of a field of the control word, and
    /// otherwise numbers.
    fn case_labels(&mut self, select: NetId, count: usize) -> Vec<String> {
        let design = self.plan.design;
        let width = design.width(select);
        let field =
            design.control.fields.iter().position(|field| {
                self.plan.bits[select.index()] == self.plan.bits[field.net.index()]
            });
        let mut labels = Vec::new();
        for value in 0..count {
            labels.push(match field {
                Some(field) if value < self.naming.choices[field].len() => {
                    self.labels.insert((field, value));
                    self.naming.choices[field][value].clone()
                }
                _ => literal(value as u64, width),
            });
        }
        labels
    }

    /// Returns the memory and the read port of a ROM. A second read port of another ROM's memory has no memory of its own.
    fn rom(&mut self, id: RomId) -> Vec<String> {
        let rom = self.plan.design.rom(id);
        let case = self.naming.style.case;
        let what =
            if rom.doc.is_empty() { String::new() } else { format!(": {}", rom.doc.join(" ")) };
        let memory = &self.naming.memories[id.index()];
        let address = self.expressions.address(rom);
        let word =
            if case { format!("{memory}({address})") } else { format!("{memory}[{address}]") };
        let read = if rom.synchronous {
            let data = &self.plan.design.net(rom.data).name;
            let when = match rom.enable {
                Some(enable) => format!("if ({}) ", self.expressions.whole(enable)),
                None => String::new(),
            };
            format!("always @(posedge clk) {when}{data} <= {word};")
        } else {
            format!("{} = {word};", self.target(rom.data))
        };
        let mut lines = comment(4, &format!("{}{what}", rom_label(rom)));
        if rom.shares.is_none() {
            lines.extend(self.memory(id));
        }
        lines.extend(statement(4, &read));
        lines.extend(self.write(id));
        lines
    }

    /// Returns the statement that writes a memory, if it has a write port.
    fn write(&mut self, id: RomId) -> Vec<String> {
        let Some(write) = &self.plan.design.rom(id).write else { return Vec::new() };
        let memory = &self.naming.memories[id.index()];
        let enable = self.expressions.whole(write.enable);
        let address = self.expressions.write_address(self.plan.design.rom(id), write);
        let parts: Vec<String> =
            write.parts.iter().map(|&part| self.expressions.whole(part)).collect();
        let word = match &parts[..] {
            [part] => part.clone(),
            _ => format!("{{{}}}", parts.join(", ")),
        };
        let text = format!("always @(posedge clk) if ({enable}) {memory}[{address}] <= {word};");
        statement(4, &text)
    }

    /// Declares a memory and fills it: with its words in an `initial` block if `style.inline`, and otherwise from a memory file.
    /// With `style.case`, returns a function with a case statement instead.
    fn memory(&mut self, id: RomId) -> Vec<String> {
        let design = self.plan.design;
        let rom = design.rom(id);
        let (style, memory) = (self.naming.style, &self.naming.memories[id.index()]);
        let width = design.width(rom.data);
        if style.case {
            let at = self.expressions.fresh("address");
            let number = range(address_width(rom.words.len()));
            let mut lines = vec![
                format!("    function {} {memory};", range(width)),
                format!("        input {number} {at};"),
                format!("        case ({at})"),
            ];
            lines.extend(words(design, id, 12, &|address, bits| {
                format!("{}: {memory} = ", literal(address as u64, bits))
            }));
            lines.push(format!("            default: {memory} = {{{width}{{1'bx}}}};"));
            lines.extend(["        endcase", "    endfunction"].map(str::to_owned));
            return lines;
        }
        let attribute = match style.rom_style {
            Some(style) if rom.synchronous => {
                format!("(* {} *) ", style.attributes(rom.write.is_some()))
            }
            _ => String::new(),
        };
        let (range, last) = (range(width), rom.words.len().saturating_sub(1));
        let declaration = format!("    {attribute}reg {range} {memory} [0:{last}];");
        if style.inline {
            let mut lines = vec![declaration, "    initial begin".to_owned()];
            lines.extend(words(design, id, 8, &|address, _| format!("{memory}[{address}] = ")));
            lines.push("    end".to_owned());
            return lines;
        }
        let radix = if is_control_rom(design, id) { 'b' } else { 'h' };
        let parameter = &self.naming.parameters[id.index()];
        vec![declaration, format!("    initial $readmem{radix}({parameter}, {memory});")]
    }

    /// Returns the instance of a multiplier with an output register, with the declaration of its output.
    fn multiplier(&mut self, register: &NetlistRegister, multiplier: Multiplier) -> Vec<String> {
        let design = self.plan.design;
        let Multiplier { product, factors } = multiplier;
        let [a, b] = factors.map(|factor| self.expressions.whole(factor));
        let enable = match register.enable {
            Some(enable) => self.expressions.whole(enable),
            None => literal(1, 1),
        };
        let parameters = [
            format!(".A_WIDTH({})", design.width(factors[0])),
            format!(".B_WIDTH({})", design.width(factors[1])),
            format!(".SIGNED({})", u8::from(design.net(product).format.signed)),
        ];
        let connections = [
            ".clk(clk)".to_owned(),
            format!(".enable({enable})"),
            format!(".a({a})"),
            format!(".b({b})"),
            format!(".product({})", design.net(register.q).name),
        ];
        let mut lines = Row::declarations(&[Row::net(self.plan, "", "wire", register.q)]);
        lines.extend(writer::instance(
            &self.naming.multiplier(),
            &separated(parameters.to_vec()),
            &design.net(product).name,
            &separated(connections.to_vec()),
        ));
        lines
    }

    /// Returns the lines of each `always` block, for the `wanted` registers. Registers with the same enable share a block if
    /// all of them have a reset or none has one; their reset values may differ.
    pub(super) fn groups(&mut self, wanted: &dyn Fn(NetId) -> bool) -> Vec<Vec<String>> {
        /// The enable, and whether the reset sets the registers.
        type ResetGroup = (Option<NetId>, bool);
        let design = self.plan.design;
        let mut groups: Vec<(ResetGroup, Vec<RegId>)> = Vec::new();
        for member in self.written(wanted) {
            let register = design.register(member);
            let key = (register.enable, register.reset.is_some());
            match groups.iter_mut().find(|(group, _)| *group == key) {
                Some((_, members)) => members.push(member),
                None => groups.push((key, vec![member])),
            }
        }
        let mut blocks = Vec::new();
        for ((enable, _), members) in groups {
            blocks.push(self.group(enable, &members));
        }
        blocks
    }

    /// Returns the `wanted` registers that always blocks assign: not inside multipliers and delay lines.
    fn written(&self, wanted: &dyn Fn(NetId) -> bool) -> Vec<RegId> {
        let design = self.plan.design;
        let mut written = Vec::new();
        for (id, register) in (0..).map(RegId).zip(&design.registers) {
            if wanted(register.q)
                && self.plan.partition(register.q) == self.partition
                && design.multiplier(id).is_none()
                && self.plan.delayed(id).is_none()
            {
                written.push(id);
            }
        }
        written
    }

    /// Returns the loads of the registers `members`, such as `y <= sum;`.
    fn takes(&mut self, members: &[RegId], indent: usize) -> Vec<String> {
        let mut takes = Vec::new();
        for &member in members {
            let register = self.plan.design.register(member);
            let data = register.data.map(|data| self.expressions.whole(data)).unwrap_or_default();
            let text = format!("{} <= {data};", self.plan.design.net(register.q).name);
            takes.extend(statement(indent, &text));
        }
        takes
    }

    /// Returns the `always` blocks for the `wanted` registers of a pipeline, one block for each enable.
    pub(super) fn stage(&mut self, wanted: &dyn Fn(NetId) -> bool) -> Vec<String> {
        let mut groups: BTreeMap<Option<NetId>, Vec<RegId>> = BTreeMap::new();
        for id in self.written(wanted) {
            groups.entry(self.plan.design.register(id).enable).or_default().push(id);
        }
        let mut lines = Vec::new();
        for (enable, members) in groups {
            let mut when = "always @(posedge clk) ".to_owned();
            if let Some(enable) = enable {
                when += &format!("if ({}) ", self.expressions.whole(enable));
            }
            let takes = self.takes(&members, 8);
            match &takes[..] {
                [only] if when.len() + only.len() < COLUMNS - 4 => {
                    lines.push(format!("    {when}{}", only.trim_start()));
                }
                _ => {
                    lines.push(format!("    {when}begin"));
                    lines.extend(takes);
                    lines.push("    end".to_owned());
                }
            }
        }
        lines
    }

    fn group(&mut self, enable: Option<NetId>, members: &[RegId]) -> Vec<String> {
        let design = self.plan.design;
        let is_reset = members.iter().any(|member| design.register(*member).reset.is_some());
        let reset = if is_reset { self.plan.reset } else { None };
        let condition = enable.map(|enable| self.expressions.whole(enable));
        let nested = reset.is_some() || condition.is_some();
        let takes = self.takes(members, if nested { 12 } else { 8 });
        let mut lines = Vec::new();
        if let Some(reset) = reset {
            lines.push(format!("        if (!{}) begin", design.net(reset).name));
            for &member in members {
                let register = design.register(member);
                let value = literal(register.reset.unwrap_or(0), design.width(register.q));
                lines.push(format!("            {} <= {value};", design.net(register.q).name));
            }
        }
        match (reset, condition) {
            (Some(_), Some(condition)) => {
                lines.extend(statement(8, &format!("end else if ({condition}) begin")))
            }
            (Some(_), None) => lines.push("        end else begin".to_owned()),
            (None, Some(condition)) => {
                lines.extend(statement(8, &format!("if ({condition}) begin")))
            }
            (None, None) => {}
        }
        lines.extend(takes);
        if nested {
            lines.push("        end".to_owned());
        }
        lines
    }

    /// Declares a net that reads all otherwise unread bits, so that linters do not complain.
    pub(super) fn unused(&self) -> Vec<String> {
        let ranges = unread(self.plan, self.partition, self.interface);
        if ranges.is_empty() {
            return Vec::new();
        }
        let mut parts = vec!["1'b0".to_owned()];
        for (net, low, count) in ranges {
            let bits = self.plan.bits[net.index()].slice(low, count);
            parts.push(self.expressions.bits(&bits));
        }
        let net =
            statement(4, &format!("wire {} = &{{{}}};", self.naming.unused, parts.join(", ")));
        writer::section(
            "Unused: bits that nothing reads, for example those that a narrower format drops.",
            net,
        )
    }
}

/// Returns an assignment for each word of a ROM, such as `rom[3] = 8'h1f;`. `place` returns the left side with its `=`, from
/// the number of the word and the width of this number in bits.
fn words(
    design: &Design,
    id: RomId,
    indent: usize,
    place: &dyn Fn(usize, u32) -> String,
) -> Vec<String> {
    let rom = design.rom(id);
    let width = design.width(rom.data);
    let bits = address_width(rom.words.len());
    let mut lines = Vec::new();
    for (address, &word) in rom.words.iter().enumerate() {
        let value = if is_control_rom(design, id) {
            format!("{width}'b{}", in_fields(design, word))
        } else {
            format!("{width}'h{}", in_hex(word, width))
        };
        let note = word_note(design, id, address).unwrap_or_default();
        lines.extend(annotated(&format!("{}{value};", place(address, bits)), indent, &note));
    }
    lines
}

/// Returns the parameters with the names of the ROMs' memory files, separated by commas. ROMs with words in the Verilog itself
/// need none.
pub fn parameters(naming: &Naming, roms: &[RomId]) -> Vec<String> {
    let mut texts = Vec::new();
    for rom in roms {
        if naming.style.inline || naming.second.contains(rom) {
            continue;
        }
        let (name, file) = (&naming.parameters[rom.index()], &naming.files[rom.index()]);
        let text = format!("parameter {name} = \"{file}\"");
        // The line also has a margin and a comma.
        let is_too_long = text.len() + 5 > COLUMNS;
        texts.push(if is_too_long { text.replacen(" = ", " =\n            ", 1) } else { text });
    }
    separated(texts)
}

fn localparam(name: &str, value: u64, width: u32, note: &str) -> Vec<String> {
    let bits = range(width);
    let space = if bits.is_empty() { "" } else { " " };
    annotated(&format!("localparam {bits}{space}{name} = {};", literal(value, width)), 4, note)
}
