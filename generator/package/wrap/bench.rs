//! `<name>_axis_tb.v`, and `<name>_axil_tb.v` or `<name>_wb_tb.v`: benches of the wrappers, with the points of the core's.

use anyhow::Result;
use askama::Template;

use super::fields::{Field, bits, operands, results};
use super::points::{points, received, sent};
use crate::base::fixed::mask;
use crate::hdl::netlist::Design;
use crate::package::map::{INTERRUPT_PENDING, Map, Part, Placed, Register};
use crate::package::surroundings::Bus;
use crate::package::{EmitInputs, Vectors, render};

/// Points that a bench writes to registers, at most: those between are left out.
const ON_A_BUS: usize = 256;

/// The view of the bench in Python.
#[derive(Template)]
#[template(path = "test_wrapper.py")]
struct Python<'a> {
    name: &'a str,
    wrapper: &'a str,
    tests: &'a [&'a str],
}

#[derive(Template)]
#[template(path = "stream_tb.v")]
struct Stream<'a> {
    name: &'a str,
    is_line: bool,
    sent: usize,
    received: usize,
    passes: usize,
    pause: usize,
    limit: usize,
    in_high: u32,
    out_high: u32,
    /// The highest bit of a line's result words, which say whether they are the last.
    word_high: u32,
    user_bits: u32,
    /// Words of 32 bits that tuser needs.
    user_words: u32,
    offer_high: u32,
}

#[derive(Template)]
#[template(path = "registers_tb.v")]
struct Registers<'a> {
    name: &'a str,
    top: String,
    wishbone: bool,
    points: usize,
    every: usize,
    words: u32,
    /// Registers that addresses have room for.
    places: u32,
    limit: usize,
    in_high: u32,
    out_high: u32,
    address_high: u32,
    parts: Vec<Access>,
    results: Vec<Access>,
    /// Addresses of registers that are neither operands nor results, and what is read there after a reset.
    constants: Vec<(String, String)>,
    read_only: Vec<String>,
}

/// A register of an operand or of results, as a bench accesses it.
struct Access {
    at: String,
    word: String,
    mask: String,
}

/// The benches of a core's wrappers and their files, pairs of a plain name and its text; none without a computation in the
/// vectors.
///
/// # Errors
/// A core without its handshake.
pub fn benches(
    design: &Design,
    inputs: &EmitInputs,
    map: Option<(Bus, &Map)>,
    vectors: &Vectors,
) -> Result<Vec<(String, String)>> {
    let points = points(design, vectors)?;
    if points.is_empty() || !inputs.around.stream && map.is_none() {
        return Ok(Vec::new());
    }
    let name = design.name.as_str();
    let (operands, results) = (operands(design), results(design));
    let is_line = inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some());
    let count: usize = points.iter().map(|point| point.results.len()).sum();
    let (in_high, out_high) = (bits(&operands)? - 1, bits(&results)? - 1);
    let clocks = vectors.inputs.len();
    let mut files = Vec::new();
    if inputs.around.stream {
        let user_bits = inputs.around.user_bits;
        // As long as three points, so that places behind the core fill up.
        let pause = 3 * clocks / points.len() + 16;
        let bench = Stream {
            name,
            is_line,
            sent: points.len(),
            received: count,
            // Each of the four turns is there twice, of six pauses each.
            passes: (8 * 6 * pause).div_ceil(clocks),
            pause,
            limit: clocks + 64,
            in_high,
            out_high,
            word_high: out_high + u32::from(is_line),
            user_bits,
            user_words: user_bits.div_ceil(32),
            offer_high: out_high + 1 + user_bits,
        };
        files.push((format!("{name}_axis_tb.v"), render(&bench)?));
        let tests = &["streams_carry_every_point"];
        let python = Python { name, wrapper: "axis", tests };
        files.push((format!("test_{name}_axis.py"), render(&python)?));
    }
    if let Some((bus, map)) = map {
        let top = format!("{name}_{}", bus.suffix());
        let (constants, read_only) = fixed(map);
        let bench = Registers {
            name,
            wishbone: bus == Bus::Wishbone,
            points: points.len(),
            every: points.len().div_ceil(ON_A_BUS),
            words: map.last() + 1,
            places: 1 << (map.address_bits() - 2),
            limit: clocks + 64,
            in_high,
            out_high,
            address_high: map.address_bits() - 1,
            parts: accesses(&map.operands, &operands, "point"),
            results: of_results(map, &results),
            constants,
            read_only,
            top: top.clone(),
        };
        files.push((format!("{top}_tb.v"), render(&bench)?));
        let tests = &["registers_compute_every_point", "registers_keep_what_is_written"];
        let python = Python { name, wrapper: bus.suffix(), tests };
        files.push((format!("test_{top}.py"), render(&python)?));
    }
    files.push((format!("{name}_sent.mem"), sent(&points, &operands)));
    files.push((format!("{name}_received.mem"), received(&points, &results, is_line)));
    Ok(files)
}

fn address(place: u32) -> String {
    format!("32'h{:02x}", 4 * place)
}

/// The registers before the operands with their values after a reset, and those that cannot be written.
fn fixed(map: &Map) -> (Vec<(String, String)>, Vec<String>) {
    let value = |register: &Register| {
        let value = register.bits.iter().map(|bits| bits.reset << bits.low).sum::<u64>();
        (address(register.place), format!("32'h{value:08x}"))
    };
    let own = |register: &&Register| register.place <= INTERRUPT_PENDING;
    let read_only = |register: &&Register| {
        use crate::package::map::Access::Read;
        register.bits.iter().all(|bits| bits.access == Read)
    };
    (
        map.registers.iter().filter(own).map(value).collect(),
        map.registers.iter().filter(read_only).map(|it| address(it.place)).collect(),
    )
}

/// The registers of ports, each in the words of a point.
fn accesses(ports: &[Placed], fields: &[Field], net: &str) -> Vec<Access> {
    let of_port = |(port, field)| {
        let Placed { parts, .. }: &Placed = port;
        parts.iter().map(move |part| access(part, field, net))
    };
    ports.iter().zip(fields).flat_map(of_port).collect()
}

fn access(part: &Part, field: &Field, net: &str) -> Access {
    let bits = (field.padded() - part.low).min(32);
    let low = field.low + part.low;
    let all = format!("{net}[{}:{low}]", low + bits - 1);
    let top = format!("{net}[{}]", low + bits - 1);
    // Bits above an operand are anything; those above a result copies of its sign.
    let above = match net {
        "point" => format!("{net}[0]"),
        _ if field.signed => top,
        _ => "1'b0".to_owned(),
    };
    let word = match 32 - bits {
        0 => all,
        more => format!("{{{{{more}{{{above}}}}}, {all}}}"),
    };
    Access { at: address(part.place), word, mask: format!("32'h{:08x}", mask(part.width)) }
}

/// All results in one register are side by side as in a stream.
fn of_results(map: &Map, fields: &[Field]) -> Vec<Access> {
    if map.last() > map.last_operand() + 1 || fields.len() == 1 {
        return accesses(&map.results, fields, "result");
    }
    let all = Field {
        name: String::new(),
        label: String::new(),
        signed: false,
        width: fields.iter().map(Field::padded).sum(),
        low: 0,
        strobe: String::new(),
    };
    let part = Part { place: map.last(), at: 0, low: 0, width: all.width };
    vec![access(&part, &all, "result")]
}
