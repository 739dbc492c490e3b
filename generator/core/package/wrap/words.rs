//! Writes the Verilog that decodes a register address, and the word that a read of each bus register returns.

use super::fields::{Transfer, results};
use super::started::count_width;
use crate::package::map::{self, Map, PortBits, PortPlacement};
use glint_rtl::netlist::Design;
use glint_rtl::verilog::text::{literal, statement};

/// A bus register, with the Verilog expression that a read of it returns.
pub struct Word {
    /// The address in words of 32 bits.
    pub number: u64,
    pub index: String,
    /// A Verilog expression of 32 bits.
    pub read: String,
    /// Whether the register holds a result, which reads as 0 until a computation has finished.
    pub is_result: bool,
}

/// Returns the Verilog of a wire that is 1 if the byte address in the net `at` lies from word `first` to word `last`, both
/// included. Words have `word_bits` address bits. The Verilog compares upper address bits with constants, because a comparison
/// by size would take an adder. For example, words 8 to 11 are the words whose upper address bits are 2.
pub fn within(wire: &str, at: &str, (first, last): (u32, u32), word_bits: u32) -> Vec<String> {
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

/// Returns the part-select of bits `low` to `high` of a net with `width` bits. For example, bits 4 to 7 of 32 give `[7:4]`,
/// and all bits an empty text.
pub fn select(width: u32, low: u32, high: u32) -> String {
    match (low, high) {
        (0, high) if high + 1 == width => String::new(),
        (low, high) if low == high => format!("[{low}]"),
        (low, high) => format!("[{high}:{low}]"),
    }
}

/// Returns the contents of the constant registers as Verilog literals of 32 bits, in the order of the addresses.
pub fn constants(map: &Map) -> Vec<String> {
    let mut constants = Vec::new();
    for register in &map.registers[..map::CONSTANTS as usize] {
        let value: u64 = register.bits.iter().map(|bits| bits.reset << bits.low).sum();
        constants.push(format!("32'h{value:08x}"));
    }
    constants
}

/// Returns the words of all registers that can change. `queue` is the number of results that can wait, if there is a queue.
pub fn words(design: &Design, map: &Map, queue: Option<u32>) -> Vec<Word> {
    let word_bits = map.address_bits() - 2;
    let start_pad = literal(0, 24 - word_bits);
    let mut reads = vec![
        status(queue),
        format!("{{{start_pad}, start_word, 6'd0, start_on_write, 1'b0}}"),
        "{31'd0, interrupt_enable}".to_owned(),
        "{31'd0, interrupt_pending}".to_owned(),
    ];
    for operand in map.written() {
        let parts = operand.parts.iter();
        reads.extend(
            parts.map(|part| extended(operand, part, &format!("operand_{}", operand.name), false)),
        );
    }
    if map.last() > map.last_written() + 1 || map.results.len() == 1 {
        for result in &map.results {
            let parts = result.parts.iter();
            reads.extend(
                parts.map(|part| extended(result, part, &format!("core_{}", result.name), true)),
            );
        }
    } else {
        let all = Transfer { fields: results(design), bits: 32 };
        reads.push(format!("{{{}}}", all.packed("core_").join(", ")));
    }
    let mut words = Vec::new();
    for (number, read) in (u64::from(map::CONSTANTS)..).zip(reads) {
        let index = literal(number, word_bits);
        let is_result = number > u64::from(map.last_written());
        words.push(Word { number, index, read, is_result });
    }
    words
}

fn status(queue: Option<u32>) -> String {
    match queue {
        None => "{30'd0, finished, under_way}".to_owned(),
        Some(depth) => {
            let pad = literal(0, 24 - count_width(depth));
            format!("{{{pad}, waiting, 6'd0, finished & ~under_way, under_way}}")
        }
    }
}

/// Returns one part of a port, extended to 32 bits: a signed result by its sign bit, and any other port with zeros.
fn extended(port: &PortPlacement, part: &PortBits, net: &str, is_result: bool) -> String {
    let width = port.format.width();
    let bits = format!("{net}{}", select(width, part.low, part.low + part.width - 1));
    let signed = is_result && port.format.signed;
    let top = match width {
        1 => net.to_owned(),
        _ => format!("{net}[{}]", width - 1),
    };
    match 32 - part.width {
        0 => bits,
        1 if signed => format!("{{{top}, {bits}}}"),
        pad if signed => format!("{{{{{pad}{{{top}}}}}, {bits}}}"),
        pad => format!("{{{}, {bits}}}", literal(0, pad)),
    }
}
