//! Generates the test benches of a core's wrappers, such as `<name>_axis_tb.v`, `<name>_axil_tb.v` and
//! `<name>_cfu_tb.v`.
//!
//! The benches send the finished computations of the core's own bench through the wrapper, up to 4096 results. A bench of a bus
//! wrapper leaves some out if there are more than 256 computations.

use anyhow::Result;
use glint_base::fill;

use super::fields::{StreamField, Transfer};
use super::points::{points, received, sent};
use super::processor::ids;
use super::table_ports;
use crate::observation::Vectors;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::instructions::{Instructions, OPCODE_BITS};
use crate::package::map::{Access, INTERRUPT_PENDING, Map, PortBits, PortPlacement};
use crate::package::output_files::OutputFiles;
use glint_base::fixed::mask;
use glint_rtl::netlist::OPCODE;
use glint_rtl::verilog::text::literal;

/// The largest number of points that a bench of a bus wrapper computes. If there are more, the bench uses every n-th point.
const ON_A_BUS: usize = 256;

/// A bus register of an operand or of results. The register has an address, the Verilog of the word to write or to expect, and
/// a mask with 1 at the bits of the port.
struct BenchRegister {
    at: String,
    word: String,
    mask: String,
}

/// Adds the benches and the files that they read. Adds nothing if no computation in `vectors` runs to its end.
///
/// # Errors
/// Fails if the core lacks its handshake, operands or results, or if a template fails.
pub fn files(job: &EmitJob, vectors: &Vectors, files: &mut OutputFiles) -> Result<()> {
    let (design, name) = (job.design, job.name());
    let points = points(design, vectors)?;
    if points.is_empty() {
        return Ok(());
    }
    let (operands, results) = (Transfer::sent(job)?, Transfer::received(job)?);
    let (in_high, out_high) = (operands.high(), results.high());
    let clocks = vectors.inputs.len();
    if job.inputs.around.stream {
        let user_bits = job.inputs.around.user_bits;
        // The longest pause lasts as long as about three points, so that the registers behind the core fill up.
        let pause = 3 * clocks / points.len() + 16;
        let text = fill!("stream_tb.v" {
            name: &'a str,
            is_line: bool = job.is_line(),
            sent: usize = points.len(),
            received: usize = points.iter().map(|point| point.results.len()).sum(),
            // The bench has four kinds of turns: nobody pauses, the sender, the receiver, or both. The transfers last for at
            // least two turns of each kind, and each turn is as long as six of the longest pauses.
            passes: usize = (8 * 6 * pause).div_ceil(clocks),
            pause: usize,
            limit: usize = clocks + 64,
            in_high: u32,
            out_high: u32,
            // A line's results carry one bit more, which says whether they are the last.
            word_high: u32 = out_high + u32::from(job.is_line()),
            user_bits: u32,
            keep: bool = job.inputs.around.keep,
            // Words of 32 bits that tuser needs.
            user_words: u32 = user_bits.div_ceil(32),
            offer_high: u32 = out_high + 1 + user_bits,
            table_ports: Vec<String> = table_ports::tied(design),
        })?;
        files.add_verilog(FileKind::Bench, vec![format!("{name}_axis_tb")], text);
        add_python(job, "axis", &["streams_carry_every_point"], files)?;
    }
    if let Some((interface, instructions)) = &job.instructions {
        let top = format!("{name}_{}", interface.key);
        let point_operands = &operands.fields;
        let text = fill!("processor_tb.v" {
            name: &'a str,
            top: &'a str = &top,
            is_cfu: bool = interface.key == "cfu",
            points: usize = points.len(),
            every: usize = points.len().div_ceil(ON_A_BUS),
            limit: usize = clocks + 64,
            in_high: u32,
            out_high: u32,
            words: [String; 2] = [0, 1].map(|word| source_word(instructions, word, point_operands)),
            // The bits of the opcode in the bench's variable `point`; empty without an opcode.
            opcode: String = opcode_bits(instructions, point_operands),
            ids: Vec<String> = ids(instructions),
            table_ports: Vec<String> = table_ports::tied(design),
            results: Vec<String> =
                results.fields.iter().map(|field| field_word(field, 0, "result")).collect(),
        })?;
        files.add_verilog(FileKind::Bench, vec![format!("{top}_tb")], text);
    }
    if let Some((bus, map)) = &job.registers {
        let top = format!("{name}_{}", bus.suffix);
        // Registers that are neither operands nor results, with the values after a reset.
        let (constants, read_only) = fixed(map);
        let text = fill!("registers_tb.v" {
            name: &'a str,
            top: &'a str = &top,
            wishbone: bool = bus.key == "wishbone",
            points: usize = points.len(),
            every: usize = points.len().div_ceil(ON_A_BUS),
            words: u32 = map.last() + 1,
            // The number of registers that the bits of an address can select.
            places: u32 = 1 << (map.address_bits() - 2),
            limit: usize = clocks + 64,
            in_high: u32,
            out_high: u32,
            address_high: u32 = map.address_bits() - 1,
            parts: Vec<BenchRegister> = accesses(&map.operands, &operands.fields, "point"),
            results: Vec<BenchRegister> = of_results(map, &results.fields),
            queue: Option<u32> = job.queue(),
            constants: Vec<(String, String)>,
            read_only: Vec<String>,
        })?;
        files.add_verilog(FileKind::Bench, vec![format!("{top}_tb")], text);
        let tests = &["registers_compute_every_point", "registers_keep_what_is_written"];
        add_python(job, bus.suffix, tests, files)?;
    }
    files.add(FileKind::BenchVectors, format!("{name}_sent.mem"), sent(&points, &operands));
    let received = received(&points, &results, job.is_line());
    files.add(FileKind::BenchVectors, format!("{name}_received.mem"), received);
    Ok(())
}

/// Adds nothing if the core has no bench in Python.
fn add_python(job: &EmitJob, wrapper: &str, tests: &[&str], files: &mut OutputFiles) -> Result<()> {
    if job.inputs.example.is_some() && job.inputs.accuracy.is_some() {
        let name = job.name();
        let text = fill!("test_wrapper.py" {
            name: &'a str, wrapper: &'a str, tests: &'a [&'a str],
        })?;
        files.add(FileKind::CocotbBench, format!("test_{name}_{wrapper}.py"), text);
    }
    Ok(())
}

/// Returns the byte address of the word address `place` as a Verilog literal: 8 gives `32'h20`.
fn address(place: u32) -> String {
    format!("32'h{:02x}", 4 * place)
}

/// Returns the addresses of the registers before the operands, with their values after a reset, and the addresses of all
/// registers that cannot be written.
fn fixed(map: &Map) -> (Vec<(String, String)>, Vec<String>) {
    let (mut own, mut read_only) = (Vec::new(), Vec::new());
    for register in &map.registers {
        if register.place <= INTERRUPT_PENDING {
            let value: u64 = register.bits.iter().map(|bits| bits.reset << bits.low).sum();
            own.push((address(register.place), format!("32'h{value:08x}")));
        }
        if register.bits.iter().all(|bits| bits.access == Access::Read) {
            read_only.push(address(register.place));
        }
    }
    (own, read_only)
}

/// Returns the bus registers of `ports`. `fields` gives their positions in the bench's variable `net`.
fn accesses(ports: &[PortPlacement], fields: &[StreamField], net: &str) -> Vec<BenchRegister> {
    let mut accesses = Vec::new();
    for (port, field) in ports.iter().zip(fields) {
        for part in &port.parts {
            accesses.push(access(part, field, net));
        }
    }
    accesses
}

/// Returns the bus register that holds `part` of a port. `field` gives the position of the port in the bench's variable `net`,
/// which is `point` for an operand and `result` for a result.
fn access(part: &PortBits, field: &StreamField, net: &str) -> BenchRegister {
    let word = field_word(field, part.low, net);
    BenchRegister { at: address(part.place), word, mask: format!("32'h{:08x}", mask(part.width)) }
}

/// Returns a word of 32 bits with the bits of a field from the bit `first` on, in the bench's variable `net`.
fn field_word(field: &StreamField, first: u32, net: &str) -> String {
    let bits = (field.padded() - first).min(32);
    let low = field.low + first;
    let all = format!("{net}[{}:{low}]", low + bits - 1);
    let top = format!("{net}[{}]", low + bits - 1);
    // The bits above an operand may have any value. The bits above a signed result are copies of its sign bit, otherwise 0.
    let above = match net {
        "point" => format!("{net}[0]"),
        _ if field.signed => top,
        _ => "1'b0".to_owned(),
    };
    match 32 - bits {
        0 => all,
        more => format!("{{{{{more}{{{above}}}}}, {all}}}"),
    }
}

/// Returns the Verilog of a source register of an instruction, with the operands in the bench's variable `point`. The bits beside
/// them may have any value.
fn source_word(instructions: &Instructions, word: u32, fields: &[StreamField]) -> String {
    let mut parts = Vec::new();
    let mut end = 0;
    for operand in instructions.operands.iter().filter(|operand| operand.word == word) {
        let field = fields.iter().find(|field| field.name == operand.port);
        let field = field.expect("an operand of the core is a field of its points");
        parts.push(format!("point{}", field.bits()));
        end = operand.low + field.width;
    }
    if end < 32 {
        parts.push(format!("{{{}{{point[0]}}}}", 32 - end));
    }
    parts.reverse();
    format!("{{{}}}", parts.join(", "))
}

/// Returns the bits of the opcode in the bench's variable `point`, as four bits; empty if the core has no opcode.
fn opcode_bits(instructions: &Instructions, fields: &[StreamField]) -> String {
    let field = fields.iter().find(|field| field.name == OPCODE);
    match (&instructions.opcode, field) {
        (Some((_, bits)), Some(field)) => match OPCODE_BITS - bits {
            0 => format!("point{}", field.bits()),
            above => format!("{}, point{}", literal(0, above), field.bits()),
        },
        _ => String::new(),
    }
}

/// Returns the bus registers of the results. If results share one register, the list has one entry, in which they are
/// adjacent, each in whole bytes, as in a stream.
fn of_results(map: &Map, fields: &[StreamField]) -> Vec<BenchRegister> {
    if map.last() > map.last_written() + 1 || fields.len() == 1 {
        return accesses(&map.results, fields, "result");
    }
    let all = StreamField {
        name: String::new(),
        label: String::new(),
        signed: false,
        width: fields.iter().map(StreamField::padded).sum(),
        low: 0,
        strobe: String::new(),
    };
    let part = PortBits { place: map.last(), at: 0, low: 0, width: all.width };
    vec![access(&part, &all, "result")]
}
