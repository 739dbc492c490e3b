//! Builds the sequencer of a device, which executes its microprogram: the address counter, the run flag, the control ROM and the
//! handshake outputs.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::Designer;
use crate::netlist::microcode;
use crate::netlist::{
    Control, Driver, Field, FieldId, FieldKind, Microinstruction, NetId, NetlistRom as NetRom, Op,
    Partition, RegisterKind, Role, RomId, Sequence,
};
use glint_base::diagnostic::SourceLocation;
use glint_base::fixed::{Format, MAX_WIDTH};

/// The fields of the control word that the sequencer itself uses; `None` if the microprogram does not need one.
pub struct SequenceFields {
    /// The field that raises `valid`; `None` if `valid` follows a signal instead.
    pub valid: Option<FieldId>,
    pub wait: Option<FieldId>,
    pub again: Option<FieldId>,
    pub condition: Option<FieldId>,
    pub target: Option<FieldId>,
    pub dispatch: Option<FieldId>,
    pub table: Option<FieldId>,
    pub go_on: FieldId,
}

/// The dispatches of a microprogram.
pub struct Dispatches {
    /// The register of the operand that selects the next microinstruction.
    pub selector: NetId,
    /// The lists of addresses, each once. A list has an address for each value of the selector.
    pub tables: Vec<Vec<usize>>,
}

impl Dispatches {
    /// Returns the dispatches in a list of rules for the next microinstruction; `None` without a dispatch.
    pub fn of(sequences: &[Sequence]) -> Option<Self> {
        let mut found: Option<Self> = None;
        for sequence in sequences {
            let Sequence::Dispatch { selector, to } = sequence else { continue };
            let dispatches = found.get_or_insert(Self { selector: *selector, tables: Vec::new() });
            if !dispatches.tables.contains(to) {
                dispatches.tables.push(to.clone());
            }
        }
        found
    }
}

pub struct Sequencer {
    pub fields: SequenceFields,
    /// The one-bit conditions of loops and jumps, each once.
    pub conditions: Vec<NetId>,
    /// The addresses to which loops and jumps lead, each once.
    pub targets: Vec<usize>,
    pub dispatches: Option<Dispatches>,
    pub address_width: u32,
}

impl Sequencer {
    pub fn build(
        &self,
        d: &Designer,
        microinstructions: Vec<Microinstruction>,
        location: SourceLocation,
    ) {
        let Self { fields, conditions, targets, dispatches, address_width } = self;
        let op = |name: &str, format: Format, op: Op| d.add_named(name, format, Driver::Op(op));
        let bit = |name: &str, cell: Op| op(name, Format::BIT, cell);
        let wide = Format::unsigned(*address_width as i32, 0);
        let last_word = microinstructions.len() as i128 - 1;
        let run = d.run;
        let start = d.start;
        let go_on = d.field_net(fields.go_on).id();
        let zero = d.raw_constant("first_word", 0, wide).id();
        let one = d.raw_constant("one_word", 1, wide).id();

        let address = d.add_register("word_address", wide, (0, last_word), RegisterKind::Sequencer);
        d.set_doc(address, "the address of the current microinstruction");
        let following = op("following_word", wide, Op::Add { a: address, b: one, carry: None });
        // The next address while the microprogram continues: the target of a loop or jump, or the following address.
        let mut onward = following;
        if let Some(again) = fields.again {
            let condition = match (fields.condition, &conditions[..]) {
                (Some(field), inputs) => {
                    let (select, inputs) = (d.field_net(field).id(), inputs.to_vec());
                    bit("condition", Op::Mux { select, inputs })
                }
                (None, [only, ..]) => bit("condition", Op::Relabel(*only)),
                (None, []) => return,
            };
            let again = bit("loop_back", Op::And(d.field_net(again).id(), condition));
            let target = match fields.target {
                Some(field) => d.field_net(field),
                None => {
                    d.raw_constant("loop_start", targets.first().map_or(0, |&to| to as i128), wide)
                }
            };
            let inputs = vec![following, target.id()];
            onward = op("onward_word", wide, Op::Mux { select: again, inputs });
        }
        let mut dispatch = None;
        if let (Some(dispatches), Some(field)) = (dispatches, fields.dispatch) {
            let rom = dispatch_rom(d, dispatches, fields.table, wide, location);
            let target = d.with(|inner| inner.design.rom(rom).data);
            let (select, inputs) = (d.field_net(field).id(), vec![onward, target]);
            onward = op("dispatched_word", wide, Op::Mux { select, inputs });
            dispatch = Some(rom);
        }
        let next = op("next_word", wide, Op::Mux { select: go_on, inputs: vec![zero, onward] });
        // The address changes while a program runs and does not wait.
        let (busy, advance) = match fields.wait {
            None => (bit("busy", Op::Relabel(run)), run),
            Some(wait) => {
                let wait = d.field_net(wait).id();
                let working = bit("working", Op::Not(wait));
                let busy = bit("busy", Op::And(run, working));
                let released = bit("released", Op::Or(working, start));
                (busy, bit("advance", Op::And(run, released)))
            }
        };
        d.set_doc(busy, "high from the clock after start to the last clock");
        d.connect(address, next, Some(advance));
        let overlaps = d.with(|inner| inner.taken.is_some());
        let (next_run, idle) = if overlaps {
            // In its last clock, a computation lets the next one begin.
            let goes_on = bit("goes_on", Op::And(run, go_on));
            (bit("next_run", Op::Or(goes_on, start)), Op::Not(goes_on))
        } else {
            let next_run = bit("next_run", Op::Mux { select: run, inputs: vec![start, go_on] });
            (next_run, Op::Relabel(bit("not_busy", Op::Not(busy))))
        };
        d.connect(run, next_run, None);
        d.with(|inner| inner.design.nets[d.idle.index()].driver = Driver::Op(idle));
        for q in [run, address] {
            d.change(q, |register| register.reset = Some(0));
        }
        let last = bit("last_word", Op::Not(go_on));
        let done = bit("done", Op::And(run, last));
        d.set_doc(done, "high in the last clock of a computation");
        let source = match fields.valid {
            Some(field) => d.field_net(field).id(),
            None => valid_line(d),
        };
        let valid = bit("valid", Op::Relabel(source));
        d.set_doc(valid, "the results are on the outputs");
        control_rom(d, location, microinstructions, address);
        d.with(|inner| inner.design.control.dispatch = dispatch);

        d.port(valid, Role::Valid);
        d.port(busy, Role::Busy);
        d.port(done, Role::Done);
        d.with(|inner| inner.partition = Partition::Datapath);
        d.connect_write_port(busy);
        d.with(|inner| {
            // Inputs first, then the handshake, then results.
            inner.design.ports.sort_by_key(|port| match port.role {
                role if role.is_input() => 0,
                Role::Valid | Role::Busy | Role::Done | Role::TableReady => 1,
                _ => 2,
            });
        });
    }
}

/// Builds the ROM with the addresses to which the microprogram dispatches. The address of the ROM is the number of the list, in the
/// field `table`, and below it the selector.
fn dispatch_rom(
    d: &Designer,
    dispatches: &Dispatches,
    table: Option<FieldId>,
    word: Format,
    location: SourceLocation,
) -> RomId {
    let Dispatches { selector, tables } = dispatches;
    let (address, address_width) = match table {
        None => (*selector, d.net(*selector).format.width()),
        Some(field) => {
            let number = d.field_net(field).id();
            let width = d.net(number).format.width() + d.net(*selector).format.width();
            let parts = Op::Concat(vec![number, *selector]);
            let format = Format::unsigned(width as i32, 0);
            (d.add_named("dispatch_address", format, Driver::Op(parts)), width)
        }
    };
    let mut words: Vec<u64> = tables.iter().flatten().map(|&to| to as u64).collect();
    words.resize(1 << address_width, 0);
    let data = d.add_named("dispatch_target", word, Driver::Undriven);
    let doc = vec![format!(
        "the addresses of the microinstructions that {} selects",
        d.net(*selector).name
    )];
    d.with(|inner| {
        let rom = NetRom::new("dispatch", address, data, words, location);
        inner.design.add_rom(NetRom { doc, ..rom })
    })
}

/// Returns the net that drives `valid`: the signal of [`Designer::valid_after`] behind its registers. A reset clears the
/// registers, and so drops the results on their way.
fn valid_line(d: &Designer) -> NetId {
    let Some((mut source, clocks)) = d.with(|inner| inner.valid) else {
        return d.run;
    };
    for clock in 1..=clocks {
        let left = clocks - clock;
        let (name, kind) = (format!("valid_in_{left}"), RegisterKind::Internal);
        let q = d.add_register(&name, Format::BIT, (0, 1), kind);
        let doc = match left {
            0 => "a result has passed the datapath".to_owned(),
            1 => "a result follows in one clock".to_owned(),
            left => format!("a result follows in {left} clocks"),
        };
        d.set_doc(q, &doc);
        d.connect(q, source, None);
        d.change(q, |register| register.reset = Some(0));
        source = q;
    }
    source
}

/// Limits the control word to 64 bits: moves fields into ROMs of their own with the same address, the last field first. The fields of
/// parts move first. Among the fields of the description itself, only the enables of registers can move.
fn moved_beside(d: &Designer, microinstructions: &mut [Microinstruction], address: NetId) {
    let width_of = |field: &Field| d.net(field.net).format.width();
    let mut fields = d.with(|inner| inner.design.control.fields.clone());
    let mut total: u32 = fields.iter().map(width_of).sum();
    let mut left: Vec<u32> = (0..fields.len() as u32).collect();
    let mut beside: Vec<(Field, Vec<u64>)> = Vec::new();
    let is_of_part = |field: &Field| d.with(|inner| inner.placed.contains(&field.net));
    let (of_parts, own): (Vec<usize>, Vec<usize>) =
        (0..fields.len()).rev().partition(|at| is_of_part(&fields[*at]));
    let enables = own.into_iter().filter(|at| matches!(fields[*at].kind, FieldKind::Enable));
    let mut moved = BTreeSet::new();
    for at in of_parts.into_iter().chain(enables) {
        if total > MAX_WIDTH {
            total -= width_of(&fields[at]);
            moved.insert(at);
        }
    }
    for at in moved.into_iter().rev() {
        left.remove(at);
        let field = fields.remove(at);
        let values = microinstructions.iter_mut().map(|it| it.values.remove(at)).collect();
        beside.push((field, values));
    }
    d.with(|inner| {
        for (at, field) in fields.iter().enumerate() {
            inner.design.nets[field.net.index()].driver = Driver::Field(FieldId(at as u32));
        }
        inner.design.control.fields = fields;
        let numbers: HashMap<FieldId, FieldId> =
            (0..).zip(&left).map(|(at, before)| (FieldId(*before), FieldId(at))).collect();
        let renumbered = |fields: &HashSet<FieldId>| -> HashSet<FieldId> {
            fields.iter().filter_map(|field| numbers.get(field).copied()).collect()
        };
        inner.partly_used = renumbered(&inner.partly_used);
        inner.picked = renumbered(&inner.picked);
        inner.views.retain(|_, view| numbers.contains_key(&view.field));
        for view in inner.views.values_mut() {
            view.field = numbers[&view.field];
        }
    });
    let mut number = 1;
    while !beside.is_empty() {
        number += 1;
        let (mut width, mut count) = (0, 0);
        for (field, _) in &beside {
            width += width_of(field);
            if width > MAX_WIDTH {
                break;
            }
            count += 1;
        }
        let taken: Vec<_> = beside.drain(..count).collect();
        let widths: Vec<u32> = taken.iter().map(|(field, _)| width_of(field)).collect();
        let mut words = Vec::new();
        for at in 0..microinstructions.len() {
            let values: Vec<u64> = taken.iter().map(|(_, values)| values[at]).collect();
            words.push(microcode::pack(&widths, &values));
        }
        let mut low: u32 = widths.iter().sum();
        let name = format!("control{number}");
        let format = Format::unsigned(low as i32, 0);
        let data = d.add_named(&format!("{name}_word"), format, Driver::Undriven);
        let location = d.net(data).location;
        let names: Vec<&str> = taken.iter().map(|(field, _)| field.name.as_str()).collect();
        let doc =
            vec![format!("fields that the control word has no room for: {}", names.join(", "))];
        d.with(|inner| {
            let rom = NetRom::new(&name, address, data, words, location);
            inner.design.add_rom(NetRom { doc, ..rom });
            for ((field, _), width) in taken.iter().zip(&widths) {
                low -= width;
                inner.design.nets[field.net.index()].driver =
                    Driver::Op(Op::Slice { of: data, low });
            }
        });
    }
}

fn control_rom(
    d: &Designer,
    location: SourceLocation,
    mut microinstructions: Vec<Microinstruction>,
    address: NetId,
) {
    moved_beside(d, &mut microinstructions, address);
    let fields = d.with(|inner| inner.design.control.fields.clone());
    let widths: Vec<u32> = fields.iter().map(|field| d.net(field.net).format.width()).collect();
    let packed = microinstructions.iter().map(|it| microcode::pack(&widths, &it.values)).collect();
    let comments = microinstructions.iter().map(|it| it.name.clone()).collect();
    let width: u32 = widths.iter().sum();
    let format = Format::unsigned(width as i32, 0);
    let data = d.add_named("control_word", format, Driver::Undriven);
    let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
    let doc = vec![format!(
        "the microprogram, one word per microinstruction; fields: {}",
        names.join(", ")
    )];
    d.with(|inner| {
        let rom = NetRom::new("control", address, data, packed, location);
        let rom = inner.design.add_rom(NetRom { doc, comments, ..rom });
        let register = |q: NetId| match inner.design.net(q).driver {
            Driver::Register(id) => id,
            _ => unreachable!("the sequencer's registers drive their nets"),
        };
        let (address, run) = (register(address), register(d.run));
        let overlaps = inner.taken.is_some();
        inner.design.control = Control {
            fields,
            microprogram: microinstructions,
            rom,
            dispatch: None,
            address,
            run,
            overlaps,
        };
    });
}
