//! `<name>_registers.v` and its bus, `<name>_axil.v` or `<name>_wb.v`: the core behind registers, and what is
//! proved of them.

use anyhow::Result;
use askama::Template;

use super::fields::{packed, results, sink};
use super::{Wrappers, script};
use crate::hdl::netlist::{Design, Role};
use crate::hdl::verilog::rows::separated;
use crate::hdl::verilog::text::{comment, literal, range, statement};
use crate::package::map::{self, Map, Part, Placed, Register};
use crate::package::surroundings::Bus;
use crate::package::{EmitInputs, render};

/// An operand where it is kept.
struct Operand {
    name: String,
    strobe: String,
    range: String,
    zero: String,
    lanes: Vec<Lane>,
}

/// Bits that a byte of a register writes.
struct Lane {
    word: String,
    number: u32,
    byte: u32,
    /// Of the operand, and of the data.
    bits: String,
    data: String,
}

/// A register as it is read.
struct Word {
    number: u64,
    index: String,
    read: String,
}

/// An operand's part in a register.
struct OperandWord {
    number: u32,
    name: String,
    width: u32,
    bits: String,
}

#[derive(Template)]
#[template(path = "registers.v")]
struct Registers<'a> {
    name: &'a str,
    regenerate: &'a str,
    /// The map, as comments.
    map: Vec<String>,
    address_high: u32,
    word_high: u32,
    operands: Vec<Operand>,
    /// What is read of the first registers, and of all others.
    constants: Vec<String>,
    words: Vec<Word>,
    last_number: u32,
    no_constant: String,
    result_wires: Vec<String>,
    connections: Vec<String>,
    control: String,
    enable: String,
    pending: String,
    last_operand: String,
    writable: Vec<String>,
    readable: Vec<String>,
    read_result: Vec<String>,
    unused: Vec<String>,
}

#[derive(Template)]
#[template(path = "registers_formal.sv")]
struct Formal<'a> {
    name: &'a str,
    address_high: u32,
    word_high: u32,
    word_count: u32,
    control_number: u32,
    last_operand_number: u32,
    first_result_number: u32,
    last_result_number: u32,
    operands: Vec<Operand>,
    operand_words: Vec<OperandWord>,
    stub_ports: Vec<String>,
    stub_free: Vec<String>,
    /// Declarations of what the proof sees of the inside.
    inside: Vec<String>,
}

#[derive(Template)]
#[template(path = "axil.v")]
struct AxiLite<'a> {
    name: &'a str,
    regenerate: &'a str,
    address_high: u32,
}

#[derive(Template)]
#[template(path = "axil_formal.sv")]
struct AxiLiteFormal<'a> {
    name: &'a str,
    address_high: u32,
}

#[derive(Template)]
#[template(path = "wb.v")]
struct Wishbone<'a> {
    name: &'a str,
    regenerate: &'a str,
    address_high: u32,
}

#[derive(Template)]
#[template(path = "wb_formal.sv")]
struct WishboneFormal<'a> {
    name: &'a str,
    address_high: u32,
}

/// The registers and their bus.
///
/// # Errors
/// A template that fails.
pub fn wrapper(design: &Design, inputs: &EmitInputs, bus: Bus, map: &Map) -> Result<Wrappers> {
    let (name, regenerate) = (design.name.as_str(), inputs.config.as_str());
    let address_high = map.address_bits() - 1;
    let (suffix, rtl, formal) = match bus {
        Bus::AxiLite => (
            "axil",
            render(&AxiLite { name, regenerate, address_high })?,
            render(&AxiLiteFormal { name, address_high })?,
        ),
        Bus::Wishbone => (
            "wb",
            render(&Wishbone { name, regenerate, address_high })?,
            render(&WishboneFormal { name, address_high })?,
        ),
    };
    let registers = format!("{name}_registers");
    let bus = format!("{name}_{suffix}");
    Ok(Wrappers {
        rtl: vec![
            (format!("{bus}.v"), rtl),
            (format!("{registers}.v"), render(&block(design, inputs, map))?),
        ],
        formal: vec![
            (format!("{bus}_formal.sv"), formal),
            (format!("{bus}_formal.ys"), script(&bus)?),
            (format!("{registers}_formal.sv"), render(&proof(design, map))?),
            (format!("{registers}_formal.ys"), script(&registers)?),
        ],
    })
}

fn block<'a>(design: &'a Design, inputs: &'a EmitInputs, map: &Map) -> Registers<'a> {
    let word_bits = map.address_bits() - 2;
    let place = |place: u32| literal(place.into(), word_bits);
    let connections = design.ports.iter().map(|port| {
        let name = design.net(port.net).name.as_str();
        let to = match port.role {
            Role::Reset => "rst_n".to_owned(),
            Role::Start => "start".to_owned(),
            Role::Busy => "busy".to_owned(),
            Role::Done => "done".to_owned(),
            Role::Operand { .. } => format!("operand_{name}"),
            Role::Strobe if map.operands.iter().any(|it| it.strobe == name) => "start".to_owned(),
            role if role.is_input() => "1'b0".to_owned(),
            _ => format!("core_{name}"),
        };
        format!(".{name}({to})")
    });
    let connections = std::iter::once(".clk(clk)".to_owned()).chain(connections);
    let mut unused = vec!["write_data".to_owned(), "write_bytes".to_owned()];
    let mut result_wires = Vec::new();
    for port in design.outputs() {
        let net = design.net(port.net);
        if matches!(port.role, Role::Busy | Role::Done) {
            continue;
        }
        let range = range(net.format.width());
        result_wires.push(format!("wire {range} core_{};", net.name).replace("  ", " "));
        if port.role != Role::Result {
            unused.push(format!("core_{}", net.name));
        }
    }
    Registers {
        name: &design.name,
        regenerate: &inputs.config,
        map: described(map),
        address_high: map.address_bits() - 1,
        word_high: word_bits - 1,
        operands: operands(map),
        constants: constants(map),
        words: words(design, map),
        last_number: map.last(),
        no_constant: literal(0, word_bits - 2),
        result_wires,
        connections: separated(connections.collect()),
        control: place(map::CONTROL),
        enable: place(map::INTERRUPT_ENABLE),
        pending: place(map::INTERRUPT_PENDING),
        last_operand: place(map.last_operand()),
        writable: within("writable", "write_at", (map::CONTROL, map.last_operand()), word_bits),
        readable: within("readable", "read_at", (0, map.last()), word_bits),
        read_result: within(
            "read_result",
            "read_at",
            (map.last_operand() + 1, map.last()),
            word_bits,
        ),
        unused: sink(&unused),
    }
}

/// Whether an address is one of these places: comparisons of its upper bits, which take no adder as
/// comparisons of size do.
fn within(wire: &str, at: &str, (first, last): (u32, u32), word_bits: u32) -> Vec<String> {
    let mut terms = Vec::new();
    let mut place = first;
    while place <= last {
        let fits = |bits: &u32| place % (1 << bits) == 0 && place + (1 << bits) - 1 <= last;
        let bits = (0..=word_bits).rev().find(fits).unwrap_or(0);
        terms.push(match word_bits - bits {
            0 => "1'b1".to_owned(),
            1 if place == 0 => format!("~{at}[{}]", word_bits + 1),
            1 => format!("{at}[{}]", word_bits + 1),
            upper if bits == 0 => format!("({at} == {})", literal(place.into(), upper)),
            upper => {
                let value = literal((place >> bits).into(), upper);
                format!("({at}[{}:{}] == {value})", word_bits + 1, bits + 2)
            }
        });
        place += 1 << bits;
    }
    statement(4, &format!("wire {wire} = {};", terms.join(" | ")))
}

/// A line a register, and one for each of its bits that have a name of their own.
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

/// As lines of a comment, below the name of a register.
fn indented(text: &str) -> Vec<String> {
    let line = |line: String| line.replacen("//", "//          ", 1);
    comment(12, text).into_iter().map(|text| line(text.trim_start().to_owned())).collect()
}

fn operands(map: &Map) -> Vec<Operand> {
    let word_bits = map.address_bits() - 2;
    let operand = |operand: &Placed| {
        let width = operand.format.width();
        let lanes = operand.parts.iter().flat_map(|part| {
            (0..part.width.div_ceil(8)).map(move |byte| {
                let (low, high) = (8 * byte, (8 * byte + 8).min(part.width) - 1);
                Lane {
                    word: literal(part.place.into(), word_bits),
                    number: part.place,
                    byte,
                    bits: select(width, part.low + low, part.low + high),
                    data: select(32, low, high),
                }
            })
        });
        Operand {
            name: operand.name.clone(),
            strobe: operand.strobe.clone(),
            range: range(width),
            zero: literal(0, width),
            lanes: lanes.collect(),
        }
    };
    map.operands.iter().map(operand).collect()
}

/// Bits of a net of that width; nothing where that is all of it.
fn select(width: u32, low: u32, high: u32) -> String {
    match (low, high) {
        (0, high) if high + 1 == width => String::new(),
        (low, high) if low == high => format!("[{low}]"),
        (low, high) => format!("[{high}:{low}]"),
    }
}

/// What is read of the registers that never change.
fn constants(map: &Map) -> Vec<String> {
    let value = |register: &Register| {
        let value = register.bits.iter().map(|bits| bits.reset << bits.low).sum::<u64>();
        format!("32'h{value:08x}")
    };
    map.registers[..map::CONSTANTS as usize].iter().map(value).collect()
}

/// What is read of each other register.
fn words(design: &Design, map: &Map) -> Vec<Word> {
    let word_bits = map.address_bits() - 2;
    let start_pad = literal(0, 24 - word_bits);
    let mut reads = vec![
        "{30'd0, finished, under_way}".to_owned(),
        format!("{{{start_pad}, start_word, 6'd0, start_on_write, 1'b0}}"),
        "{31'd0, interrupt_enable}".to_owned(),
        "{31'd0, interrupt_pending}".to_owned(),
    ];
    for operand in &map.operands {
        let parts = operand.parts.iter();
        reads.extend(
            parts.map(|part| extended(operand, part, &format!("operand_{}", operand.name))),
        );
    }
    if map.last() > map.last_operand() + 1 || map.results.len() == 1 {
        for result in &map.results {
            let parts = result.parts.iter();
            reads
                .extend(parts.map(|part| extended(result, part, &format!("core_{}", result.name))));
        }
    } else {
        let fields = results(design);
        let all: u32 = fields.iter().map(super::fields::Field::padded).sum();
        let mut parts = packed(&fields, "core_");
        if all < 32 {
            parts.insert(0, literal(0, 32 - all));
        }
        reads.push(format!("{{{}}}", parts.join(", ")));
    }
    let word =
        |(number, read): (u64, String)| Word { number, index: literal(number, word_bits), read };
    (u64::from(map::CONSTANTS)..).zip(reads).map(word).collect()
}

/// A part of a port in 32 bits, with copies of the sign.
fn extended(port: &Placed, part: &Part, net: &str) -> String {
    let width = port.format.width();
    let bits = format!("{net}{}", select(width, part.low, part.low + part.width - 1));
    let top = match width {
        1 => net.to_owned(),
        _ => format!("{net}[{}]", width - 1),
    };
    match 32 - part.width {
        0 => bits,
        1 if port.format.signed => format!("{{{top}, {bits}}}"),
        pad if port.format.signed => format!("{{{{{pad}{{{top}}}}}, {bits}}}"),
        pad => format!("{{{}, {bits}}}", literal(0, pad)),
    }
}

fn proof<'a>(design: &'a Design, map: &Map) -> Formal<'a> {
    let mut stub_ports = vec!["input wire clk".to_owned()];
    let mut stub_free = Vec::new();
    for port in &design.ports {
        let net = design.net(port.net);
        let range = range(net.format.width());
        let sign = if net.format.signed { "signed " } else { "" };
        let direction = if port.role.is_input() { "input" } else { "output" };
        stub_ports.push(format!("{direction} wire {sign}{range} {}", net.name).replace("  ", " "));
        if matches!(port.role, Role::Result | Role::Status) {
            stub_free
                .push(format!("(* anyseq *) reg {range} any_{};", net.name).replace("  ", " "));
            stub_free.push(format!("assign {0} = any_{0};", net.name));
        }
    }
    let word_bits = map.address_bits() - 2;
    let own = [
        ("start", 1),
        ("start_on_write", 1),
        ("start_word", word_bits),
        ("interrupt_enable", 1),
        ("interrupt_pending", 1),
        ("finished", 1),
        ("core.run", 1),
        ("core.ends", 1),
    ];
    let mut inside: Vec<(String, u32)> =
        own.into_iter().map(|(net, width)| (net.to_owned(), width)).collect();
    for operand in &map.operands {
        let width = operand.format.width();
        inside.push((format!("operand_{}", operand.name), width));
        inside.push((format!("core.{}", operand.name), width));
    }
    let declared = |(net, width): (String, u32)| {
        format!("(* hierconn *) wire {} \\dut.{net} ;", range(width)).replace("  ", " ")
    };
    let operand_words = map.operands.iter().flat_map(|operand| {
        operand.parts.iter().map(|part| OperandWord {
            number: part.place,
            name: operand.name.clone(),
            width: part.width,
            bits: select(operand.format.width(), part.low, part.low + part.width - 1),
        })
    });
    Formal {
        name: &design.name,
        address_high: map.address_bits() - 1,
        word_high: word_bits - 1,
        word_count: map.last() + 1,
        control_number: map::CONTROL,
        last_operand_number: map.last_operand(),
        first_result_number: map.last_operand() + 1,
        last_result_number: map.last(),
        operands: operands(map),
        operand_words: operand_words.collect(),
        stub_ports: separated(stub_ports),
        stub_free,
        inside: inside.into_iter().map(declared).collect(),
    }
}
