//! Defines the codes of mistakes in a description. For example, `G0301` is a name that Verilog does not take. [`pages`] reads
//! the page of each code from `diagnostics.md`, which is written by hand.

use std::fmt;

/// A kind of mistake: `G`, the number of its group, and its own. For example, `Code(203)` prints as `G0203`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(u16);

/// A value or a signal that its format does not hold.
pub const FORMAT: Code = Code(101);
/// Points that differ, or fraction bits that would be dropped.
pub const POINT: Code = Code(102);
/// A format beyond the limits.
pub const WIDE: Code = Code(103);
/// Widths that do not go together.
pub const WIDTH: Code = Code(104);
/// A sign where there must be none.
pub const SIGN: Code = Code(105);
/// An address beyond the words of a memory.
pub const MEMORY: Code = Code(106);
/// A net with two drivers.
pub const TWO_DRIVERS: Code = Code(201);
/// A net without a driver.
pub const UNDRIVEN: Code = Code(202);
/// A combinational loop.
pub const LOOP: Code = Code(203);
/// Logic that no output depends on.
pub const UNUSED: Code = Code(204);
/// A signal of another designer.
pub const FOREIGN: Code = Code(205);
/// A netlist that refers to something that does not exist.
pub const REFERENCE: Code = Code(206);
/// A name that Verilog does not take.
pub const NAME: Code = Code(301);
/// A name that is used twice.
pub const NAME_TWICE: Code = Code(302);
/// No microprogram, or two.
pub const MICROPROGRAM: Code = Code(401);
/// Microinstructions that lead nowhere, or that nothing leads to.
pub const SUCCESSOR: Code = Code(402);
/// A first microinstruction that does more than wait.
pub const IDLE: Code = Code(403);
/// `valid` without its result.
pub const VALID: Code = Code(404);
/// A loop that never ends.
pub const ENDLESS: Code = Code(405);
/// Two settings of the same lines.
pub const CLASH: Code = Code(406);
/// Control that no microinstruction uses.
pub const UNUSED_CONTROL: Code = Code(407);
/// An input that is not one of the mux.
pub const PICK: Code = Code(408);
/// A product that differs from the product of the selected operands.
pub const PRODUCT: Code = Code(409);
/// A part that does not fit.
pub const PART: Code = Code(501);
/// Buffers of operands that cannot be.
pub const BUFFER: Code = Code(502);
/// Registers behind results that cannot be.
pub const OUTPUT_REGISTER: Code = Code(503);
/// A microprogram that no pipeline can be made of.
pub const UNROLL: Code = Code(601);
/// A pipeline that its options do not allow.
pub const SCHEDULE: Code = Code(602);

const PAGES: &str = include_str!("diagnostics.md");

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{:04}", self.0)
    }
}

/// Returns the page of each code: the code, its title, and the text in Markdown.
pub fn pages() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    PAGES.split("\n## ").skip(1).filter_map(|page| {
        let (heading, text) = page.split_once('\n')?;
        let (code, title) = heading.split_once(": ")?;
        Some((code, title, text.trim()))
    })
}
