//! Defines the codes of mistakes in a hardware description. For example, `G0301` means that a name is no Verilog identifier.
//! [`pages`] reads the explanation of each code from `diagnostics.md`.

use std::fmt;

/// The code of a kind of mistake: `G`, the number of its group, and its number in the group. For example, `Code(203)` prints as
/// `G0203`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(u16);

/// A value or a signal that its format cannot represent.
pub const FORMAT: Code = Code(101);
/// Binary points that differ, or fraction bits that would be dropped.
pub const POINT: Code = Code(102);
/// A format with too many bits, or with its binary point too far from its bits.
pub const WIDE: Code = Code(103);
/// Widths that do not match.
pub const WIDTH: Code = Code(104);
/// A signed signal where only an unsigned one is allowed.
pub const SIGN: Code = Code(105);
/// An address that exceeds the words of a memory.
pub const MEMORY: Code = Code(106);
/// A net with two drivers.
pub const TWO_DRIVERS: Code = Code(201);
/// A net without a driver.
pub const UNDRIVEN: Code = Code(202);
/// A combinational loop.
pub const LOOP: Code = Code(203);
/// Logic that no output depends on.
pub const UNUSED: Code = Code(204);
/// A name that is no Verilog identifier.
pub const FOREIGN: Code = Code(205);
/// A name that two things have.
pub const REFERENCE: Code = Code(206);
/// A description without a microprogram, or with two.
pub const NAME: Code = Code(301);
/// A microinstruction without a successor, or one that no other reaches.
pub const NAME_TWICE: Code = Code(302);
/// A first microinstruction that does more than wait for `start`.
pub const MICROPROGRAM: Code = Code(401);
/// `valid` in a microinstruction whose result is not loaded yet.
pub const SUCCESSOR: Code = Code(402);
/// A first microinstruction that does more than wait.
pub const IDLE: Code = Code(403);
/// Two settings of one field in the same microinstruction.
pub const VALID: Code = Code(404);
/// A field that no microinstruction uses.
pub const ENDLESS: Code = Code(405);
/// A setting that selects an input which the mux does not have.
pub const CLASH: Code = Code(406);
/// A register that takes a product while other operands are selected.
pub const UNUSED_CONTROL: Code = Code(407);
/// A part that cannot be used in this description.
pub const PICK: Code = Code(408);
/// Operand buffers that this description cannot have.
pub const PRODUCT: Code = Code(409);
/// Output registers that this description cannot have.
pub const PART: Code = Code(501);
/// A microprogram that cannot be unrolled into a pipeline.
pub const BUFFER: Code = Code(502);
/// A pipeline that cannot meet its options.
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

/// Returns the explanation of each code: the code, its title, and the text in Markdown.
pub fn pages() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    PAGES.split("\n## ").skip(1).filter_map(|page| {
        let (heading, text) = page.split_once('\n')?;
        let (code, title) = heading.split_once(": ")?;
        Some((code, title, text.trim()))
    })
}
