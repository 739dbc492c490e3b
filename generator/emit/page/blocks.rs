//! The blocks of the datapath: what stands in the source's figure, and what it takes to be complete.

use super::markdown::{Align, Table, code, prose};
use crate::fixed::Format;
use crate::netlist::{Design, Driver, NetId, Op, RegisterKind, Unit};

/// The blocks in order of their number; those that the source does not number follow.
pub fn table(design: &Design) -> Table {
    let blocks = Blocks::new(design);
    let mut rows: Vec<(Option<u16>, Vec<String>)> = design
        .iter()
        .filter(|(id, _)| blocks.shown[id.index()])
        .map(|(id, net)| {
            let cells = vec![
                code(&net.name),
                blocks.kind(id),
                format(net.format),
                blocks.takes(id),
                prose(&net.doc),
            ];
            (net.block, cells)
        })
        .collect();
    for rom in design.roms.iter().filter(|rom| !is_control(design, rom)) {
        let cells = vec![
            code(&rom.name),
            "ROM".to_owned(),
            format!("{} bits", design.width(rom.data)),
            list(&blocks.sources([rom.address])),
            format!("{} words, see below", rom.words.len()),
        ];
        rows.push((rom.block, cells));
    }
    rows.sort_by_key(|(number, _)| number.map_or(u32::MAX, u32::from));
    let mut table = Table::new(&[
        (NUMBER, Align::Right),
        ("block", Align::Left),
        ("kind", Align::Left),
        ("format", Align::Left),
        ("takes", Align::Left),
        ("what it is", Align::Left),
    ]);
    for (number, cells) in rows {
        let number = number.map_or_else(String::new, |number| number.to_string());
        table.row([number].into_iter().chain(cells));
    }
    table.without_empty(NUMBER)
}

/// How a format is told: a single bit is no number.
pub fn format(format: Format) -> String {
    match format.width() {
        1 => "1 bit".to_owned(),
        _ => format.to_string(),
    }
}

/// The heading of the column with the source's numbers.
pub const NUMBER: &str = "no.";

fn is_control(design: &Design, rom: &crate::netlist::Rom) -> bool {
    rom.data == design.rom(design.control.rom).data
}

struct Blocks<'a> {
    design: &'a Design,
    /// The nets that have a row.
    shown: Vec<bool>,
    ports: Vec<NetId>,
}

impl<'a> Blocks<'a> {
    fn new(design: &'a Design) -> Self {
        let ports: Vec<NetId> = design.ports.iter().map(|port| port.net).collect();
        let shown = design
            .iter()
            .map(|(id, net)| {
                let hardware = match &net.driver {
                    Driver::Register(register) => {
                        design.register(*register).kind != RegisterKind::Internal
                    }
                    Driver::Op(op) => matches!(op, Op::Mul(..)) || !net.doc.is_empty(),
                    _ => false,
                };
                net.unit == Unit::Datapath
                    && (net.named && hardware || net.block.is_some())
                    && !ports.contains(&id)
            })
            .collect();
        Self {
            design,
            shown,
            ports,
        }
    }

    fn kind(&self, id: NetId) -> String {
        // Of what is multiplied, before it is extended to a sign.
        let width = |net: &NetId| match &self.design.net(*net).driver {
            Driver::Op(Op::Extend(of)) if !self.shown[net.index()] => self.design.width(*of),
            _ => self.design.width(*net),
        };
        let plain = match &self.design.net(id).driver {
            Driver::Register(register) => match self.design.register(*register).kind {
                RegisterKind::Operand => "operand register",
                _ => "register",
            },
            Driver::Constant(_) => "constant",
            Driver::Rom(_) => "ROM",
            Driver::Op(op) => match op {
                // What the selection is made by is what it is made of: narrowing that saturates.
                Op::Mux { select, inputs } if self.limits(*select, inputs) => "limiter",
                Op::Mux { inputs, .. } => return format!("{}:1 mux", inputs.len()),
                Op::Mul(a, b) => return format!("{} × {} multiplier", width(a), width(b)),
                Op::Add { .. } => "adder",
                Op::Sub(..) => "subtractor",
                Op::Equal(..) | Op::Less(..) => "comparator",
                Op::Not(_) => "inverter",
                Op::And(..) | Op::Or(..) | Op::Xor(..) | Op::Any(_) | Op::All(_) => "gate",
                Op::Relabel(of) | Op::Slice { of, .. } | Op::Extend(of)
                    if !self.shown[of.index()]
                        && matches!(self.design.net(*of).driver, Driver::Op(_)) =>
                {
                    return self.kind(*of);
                }
                Op::Relabel(_) | Op::Slice { .. } | Op::Extend(_) | Op::Concat(_) => "wiring",
            },
            Driver::Undriven | Driver::Input | Driver::Field(_) => "",
        };
        plain.to_owned()
    }

    fn limits(&self, select: NetId, inputs: &[NetId]) -> bool {
        let by = self.sources([select]);
        !by.is_empty() && by == self.sources(inputs.iter().copied())
    }

    /// What a block works on, and what selects among it.
    fn takes(&self, id: NetId) -> String {
        match &self.design.net(id).driver {
            Driver::Register(register) => list(&self.sources(self.design.register(*register).data)),
            Driver::Op(Op::Mux { select, inputs }) if !self.limits(*select, inputs) => {
                let by = match self.design.net(*select).driver {
                    Driver::Field(_) => vec![self.design.net(*select).name.clone()],
                    _ => self.sources([*select]),
                };
                let inputs = self.sources(inputs.iter().copied());
                format!("{}; by {}", list(&inputs), list(&by))
            }
            // Of a limiter, whose select says nothing new, this is what it limits.
            Driver::Op(op) => list(&self.sources(op.operands())),
            _ => String::new(),
        }
    }

    /// The blocks, ports and ROMs behind nets, in the order in which they are met.
    fn sources(&self, nets: impl IntoIterator<Item = NetId>) -> Vec<String> {
        let mut found = Vec::new();
        let mut seen = vec![false; self.design.nets.len()];
        let mut pending: Vec<NetId> = nets.into_iter().collect();
        pending.reverse();
        while let Some(id) = pending.pop() {
            if std::mem::replace(&mut seen[id.index()], true) {
                continue;
            }
            let net = self.design.net(id);
            if self.shown[id.index()] || self.ports.contains(&id) {
                found.push(net.name.clone());
                continue;
            }
            match &net.driver {
                Driver::Rom(rom) => found.push(self.design.rom(*rom).name.clone()),
                Driver::Register(register) => pending.extend(self.design.register(*register).data),
                Driver::Op(op) => pending.extend(op.operands().into_iter().rev()),
                Driver::Undriven | Driver::Input | Driver::Constant(_) | Driver::Field(_) => {}
            }
        }
        found
    }
}

fn list(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| code(name)).collect();
    names.join(", ")
}
