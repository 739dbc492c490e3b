//! Generates the bus wrapper of a core: `<name>_registers.v` with the registers, `<name>_axil.v` or `<name>_wb.v` with the
//! bus, and the formal properties of both.
//!
//! A host writes the operands to registers, starts the core and reads the results.

use anyhow::Result;
use glint_base::fill;

use super::fields::sink;
use super::started::{FULL, OFFERING, TAKE, WAITING, count_width, started};
use super::words::{Word, constants, select, within, words};
use super::{CoreStub, WrapperProof, add_proof, connected, core_wire, seen_inside};
use crate::package::bus::Bus;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::map::{self, BusRegister, Map, RegisterBits};
use crate::package::output_files::OutputFiles;
use glint_rtl::netlist::Role;
use glint_rtl::verilog::text::{comment, literal, range, statement};

/// An operand, with the byte lanes through which bus registers write it.
struct OperandWords {
    name: String,
    range: String,
    zero: String,
    is_of_table: bool,
    lanes: Vec<ByteLane>,
}

/// The bits of an operand that one byte of a bus register writes. `number` and `word` are the word address of the register, as
/// a Verilog literal in `word`. `byte` is the number of the byte in the register, from 0 for the lowest.
struct ByteLane {
    word: String,
    number: u32,
    byte: u32,
    /// The part-selects of the bits in the operand and in the written word.
    bits: String,
    data: String,
}

pub fn modules(job: &EmitJob, bus: &Bus, map: &Map, files: &mut OutputFiles) -> Result<()> {
    let [module, module_proof] =
        (bus.module)(job.name(), job.regenerate(), map.address_bits() - 1)?;
    let core = started(job.design, job.queue()).name.clone();
    let registers = format!("{}_registers", job.name());
    let bus = format!("{}_{}", job.name(), bus.suffix);
    files.add_verilog(FileKind::BusWrapper, vec![bus.clone()], module);
    files.add_verilog(FileKind::BusWrapper, vec![registers.clone()], block(job, map)?);
    // In the proof of the bus, a stub replaces the registers. In the proof of the registers, a stub replaces the core.
    let bus_proof = WrapperProof::new(module_proof, vec![registers.clone()]);
    add_proof(job, &bus, bus_proof, files)?;
    add_proof(job, &registers, WrapperProof::new(proof(job, map)?, vec![core]), files)
}

/// The registers of a queue of results, as Verilog.
struct QueueRegisters {
    depth: u32,
    /// The range of a count from 0 to the depth, and the count 0 and 1 as literals.
    count: String,
    no_count: String,
    one: String,
    /// The word address of the register whose read takes a result.
    last_result: String,
}

impl QueueRegisters {
    fn new(depth: u32, map: &Map) -> Self {
        let count_bits = count_width(depth);
        Self {
            depth,
            count: range(count_bits),
            no_count: literal(0, count_bits),
            one: literal(1, count_bits),
            last_result: literal(map.last().into(), map.address_bits() - 2),
        }
    }
}

fn block(job: &EmitJob, map: &Map) -> Result<String> {
    let started = started(job.design, job.queue());
    let design = started.as_ref();
    let word_bits = map.address_bits() - 2;
    let place = |place: u32| literal(place.into(), word_bits);
    let connections = connected(design, "clk", |role, name| match role {
        Role::Reset => Some("rst_n".to_owned()),
        Role::Start | Role::Busy | Role::Done => Some(name.to_owned()),
        Role::Operand { .. } | Role::TableAddress | Role::TableWord => {
            Some(format!("operand_{name}"))
        }
        Role::TableWrite => Some("table_pending".to_owned()),
        Role::Strobe if job.queue().is_some() && name == TAKE => Some(TAKE.to_owned()),
        Role::Status if [FULL, OFFERING, WAITING].contains(&name) => Some(name.to_owned()),
        Role::Strobe if map.operands.iter().any(|it| it.strobe == name) => Some("start".to_owned()),
        _ => None,
    });
    let mut unused = vec!["write_data".to_owned(), "write_bytes".to_owned()];
    let mut result_wires = Vec::new();
    for port in design.outputs() {
        let is_of_queue = port.role == Role::Status && job.queue().is_some();
        if is_of_queue || matches!(port.role, Role::Busy | Role::Done | Role::TableReady) {
            continue;
        }
        result_wires.push(core_wire(design, port));
        if port.role != Role::Result {
            unused.push(format!("core_{}", design.net(port.net).name));
        }
    }
    let among = |wire, at, places| within(wire, at, places, word_bits);
    fill!("registers.v" {
        name: &'a str = job.name(),
        core: &'a str = &design.name,
        regenerate: &'a str = job.regenerate(),
        map: Vec<String> = described(map),
        address_high: u32 = map.address_bits() - 1,
        word_high: u32 = word_bits - 1,
        operands: Vec<OperandWords> = operands(map),
        // `constants` are read from the registers that never change, and `words` from all other registers.
        constants: Vec<String> = constants(map),
        words: Vec<Word> = words(design, map, job.queue()),
        queue: Option<QueueRegisters> = job.queue().map(|depth| QueueRegisters::new(depth, map)),
        last_number: u32 = map.last(),
        no_constant: String = literal(0, word_bits - 2),
        result_wires: Vec<String>,
        connections: Vec<String>,
        // The wires that make a start and a read of a result wait.
        start_waits: &'a str = if job.queue().is_some() { "start_waits" } else { "under_way" },
        // The wire that lets a write change registers.
        written: &'a str = if job.queue().is_some() { "written" } else { "write_answer" },
        result_waits: &'a str = if job.queue().is_some() { "result_waits" } else { "under_way" },
        control: String = place(map::CONTROL),
        enable: String = place(map::INTERRUPT_ENABLE),
        pending: String = place(map::INTERRUPT_PENDING),
        last_operand: String = place(map.last_operand()),
        writable: Vec<String> = among("writable", "write_at", (map::CONTROL, map.last_written())),
        readable: Vec<String> = among("readable", "read_at", (0, map.last())),
        writes_table: Vec<String> = map
            .table_places()
            .map_or_else(Vec::new, |places| among("writes_table", "write_at", places)),
        // The register whose write loads a word.
        table_address: String = place(map.last_written()),
        read_result: Vec<String> =
            among("read_result", "read_at", (map.last_written() + 1, map.last())),
        unused: Vec<String> = sink(&unused),
    })
}

/// Returns lines of a Verilog comment: each register, and each of its fields that has a name of its own.
fn described(map: &Map) -> Vec<String> {
    let mut lines = Vec::new();
    for register in &map.registers {
        lines.push(format!("//  0x{:02x}  {}", register.offset(), register.name));
        lines.extend(indented(&register.doc));
        for bits in register.bits.iter().filter(|bits| bits.name != "value") {
            let place = match bits.width {
                1 => format!("[{}]", bits.low),
                _ => format!("[{}:{}]", bits.low + bits.width - 1, bits.low),
            };
            lines.extend(indented(&format!("{place} {}: {}", bits.name, bits.doc)));
        }
    }
    lines
}

fn indented(text: &str) -> Vec<String> {
    let lines = comment(12, text).into_iter();
    lines.map(|line| line.trim_start().replacen("//", "//          ", 1)).collect()
}

fn operands(map: &Map) -> Vec<OperandWords> {
    let word_bits = map.address_bits() - 2;
    let mut words = Vec::new();
    for operand in map.written() {
        let width = operand.format.width();
        let mut lanes = Vec::new();
        for part in &operand.parts {
            for byte in 0..part.width.div_ceil(8) {
                let (low, high) = (8 * byte, (8 * byte + 8).min(part.width) - 1);
                lanes.push(ByteLane {
                    word: literal(part.place.into(), word_bits),
                    number: part.place,
                    byte,
                    bits: select(width, part.low + low, part.low + high),
                    data: select(32, low, high),
                });
            }
        }
        words.push(OperandWords {
            name: operand.name.clone(),
            range: range(width),
            zero: literal(0, width),
            is_of_table: map.table.iter().any(|port| port.name == operand.name),
            lanes,
        });
    }
    words
}

/// Returns the Verilog assertion about a read: the word must have the value of each field at the field's bits, and 0
/// elsewhere. A register of a result must read as 0 until a computation has finished.
fn read(map: &Map, register: &BusRegister, queue: Option<u32>) -> Vec<String> {
    let mut parts = Vec::new();
    let mut above = 32;
    for bits in register.bits.iter().rev() {
        let end = bits.low + bits.width;
        if end < above {
            parts.push(literal(0, above - end));
        }
        parts.push(source(map, register, bits, queue));
        above = bits.low;
    }
    if above > 0 {
        parts.push(literal(0, above));
    }
    let value = format!("{{{}}}", parts.join(", "));
    let value = match queue {
        _ if register.place <= map.last_written() => value,
        None => format!("($past(dut.finished) ? {value} : 0)"),
        Some(_) => format!("($past(dut.finished || dut.core.done) ? {value} : 0)"),
    };
    statement(12, &format!("assert (read_data == {value});"))
}

/// Returns the Verilog expression of the value that a field must have, as wide as the field.
fn source(map: &Map, register: &BusRegister, bits: &RegisterBits, queue: Option<u32>) -> String {
    if register.place < map::CONSTANTS {
        return literal(bits.reset, bits.width);
    }
    match (register.name.as_str(), bits.name.as_str()) {
        ("status", WAITING) => "dut.core.waiting".to_owned(),
        ("status", name) => match (name, queue) {
            ("busy", None) => "dut.start | dut.core.run".to_owned(),
            ("busy", Some(_)) => "dut.start | dut.core.busy".to_owned(),
            (_, None) => "dut.finished".to_owned(),
            (_, Some(_)) => "(dut.finished & ~dut.start & ~dut.core.busy)".to_owned(),
        },
        ("control", "start") => literal(0, bits.width),
        ("control", name) => format!("dut.{name}"),
        ("interrupt_enable" | "interrupt_pending", _) => format!("dut.{}", register.name),
        _ => {
            let is_operand = register.place <= map.last_written();
            let mut ports = map.written().chain(&map.results);
            let found = ports.find_map(|port| {
                let mut parts = port.parts.iter();
                let part = parts.find(|it| (it.place, it.at) == (register.place, bits.low))?;
                Some((port, *part))
            });
            let Some((port, part)) = found else { return literal(0, bits.width) };
            let (width, high) = (port.format.width(), part.low + part.width - 1);
            let net = if is_operand { "dut.operand_" } else { "dut.core." };
            let net = format!("{net}{}", port.name);
            let all = format!("{net}{}", select(width, part.low, high));
            match bits.width - part.width {
                0 => all,
                copies => {
                    format!("{{{copies}{{{net}{}}}}}, {all}", select(width, width - 1, width - 1))
                }
            }
        }
    }
}

fn proof(job: &EmitJob, map: &Map) -> Result<String> {
    let queue = job.queue();
    let started = started(job.design, queue);
    let word_bits = map.address_bits() - 2;
    let own = [
        ("start", 1),
        ("start_on_write", 1),
        ("start_word", word_bits),
        ("interrupt_enable", 1),
        ("interrupt_pending", 1),
        ("finished", 1),
        ("core.rst_n", 1),
    ];
    let of_core = match queue {
        None => vec![("core.run", 1), ("core.ends", 1)],
        Some(depth) => vec![
            (TAKE, 1),
            ("core.take", 1),
            ("core.busy", 1),
            ("core.done", 1),
            ("core.full", 1),
            ("core.offering", 1),
            ("core.waiting", count_width(depth)),
        ],
    };
    let nets = own.into_iter().chain(of_core);
    let mut inside: Vec<(String, u32)> = nets.map(|(net, width)| (net.to_owned(), width)).collect();
    if !map.table.is_empty() {
        inside.push(("table_pending".to_owned(), 1));
        inside.push(("core.table_ready".to_owned(), 1));
        inside.push(("core.table_write".to_owned(), 1));
    }
    for operand in map.written() {
        let width = operand.format.width();
        inside.push((format!("operand_{}", operand.name), width));
        inside.push((format!("core.{}", operand.name), width));
    }
    inside.extend(
        map.results.iter().map(|result| (format!("core.{}", result.name), result.format.width())),
    );
    let reads = map.registers.iter().map(|register| (register.place, read(map, register, queue)));
    fill!("registers_formal.sv" {
        name: &'a str = job.name(),
        address_high: u32 = map.address_bits() - 1,
        word_high: u32 = word_bits - 1,
        word_count: u32 = map.last() + 1,
        control_number: u32 = map::CONTROL,
        last_written_number: u32 = map.last_written(),
        first_result_number: u32 = map.last_written() + 1,
        table: Option<(u32, u32)> = map.table_places(),
        last_result_number: u32 = map.last(),
        operands: Vec<OperandWords> = operands(map),
        // The place of each register, and the word that a read of it gives.
        reads: Vec<(u32, Vec<String>)> = reads.collect(),
        stub: &'a CoreStub = &match queue {
            None => CoreStub::new(&started),
            Some(_) => CoreStub::of_queue(&started),
        },
        queue: Option<QueueRegisters> = queue.map(|depth| QueueRegisters::new(depth, map)),
        inside: Vec<String> = inside.into_iter().map(seen_inside).collect(),
    })
}
