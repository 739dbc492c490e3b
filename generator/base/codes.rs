//! Defines the codes for the kinds of mistakes in a hardware description. [`pages`] reads each code's explanation from
//! `diagnostics.md`.

use std::fmt;

/// The code of a kind of mistake. For example, `Code(203)` prints as `G0203`. The first two digits are the code's group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(u16);

/// G0101: a constant, a memory word or a signal has a value that the required format cannot represent.
pub const FORMAT: Code = Code(101);
/// G0102: two operands have different binary points, or an operation would drop fraction bits without a stated rounding.
pub const POINT: Code = Code(102);
/// G0103: a format has too many bits, or its binary point is too far from its bits.
pub const WIDE: Code = Code(103);
/// G0104: an operation's operands have wrong widths, or a mux has a wrong number of inputs.
pub const WIDTH: Code = Code(104);
/// G0105: an operation that takes only unsigned signals has a signed operand.
pub const SIGN: Code = Code(105);
/// G0106: the address of a ROM can exceed the number of words.
pub const MEMORY: Code = Code(106);
/// G0201: two drivers drive the same net.
pub const TWO_DRIVERS: Code = Code(201);
/// G0202: nothing drives a net or the data input of a register.
pub const UNDRIVEN: Code = Code(202);
/// G0203: nets form a combinational loop.
pub const LOOP: Code = Code(203);
/// G0204: no output depends on a net or an operand, or a mux always passes the same input. Synthesis would remove such logic.
pub const UNUSED: Code = Code(204);
/// G0205: a signal or a setting belongs to another `Designer`.
pub const FOREIGN: Code = Code(205);
/// G0206: the netlist refers to a net, a register, a memory, a field or a port that does not exist.
pub const REFERENCE: Code = Code(206);
/// G0301: a name is no legal Verilog identifier. For example, `wire` is a keyword.
pub const NAME: Code = Code(301);
/// G0302: two nets, memories, parts or microinstructions have the same name.
pub const NAME_TWICE: Code = Code(302);
/// G0401: the description has no microprogram, two microprograms, or a microprogram with fewer than two microinstructions.
pub const MICROPROGRAM: Code = Code(401);
/// G0402: a microinstruction has no successor, two successors or an unknown one, or no other microinstruction leads to it.
pub const SUCCESSOR: Code = Code(402);
/// G0403: the first microinstruction, in which the device waits for `start`, also loads or raises something.
pub const IDLE: Code = Code(403);
/// G0404: a microinstruction raises `valid` before the result is loaded, none raises it, or `valid` cannot follow the stated
/// signal.
pub const VALID: Code = Code(404);
/// G0405: a loop never ends, because nothing in it changes its condition.
pub const ENDLESS: Code = Code(405);
/// G0406: one microinstruction gives two values to the same field of the control word.
pub const CLASH: Code = Code(406);
/// G0407: no microinstruction uses a mux input, a choice or a register that the description declares.
pub const UNUSED_CONTROL: Code = Code(407);
/// G0408: a microinstruction selects a signal that is no input of the mux, or several inputs.
pub const PICK: Code = Code(408);
/// G0409: a register loads a product of a shared multiplier while the muxes select other operands, or the muxes of a multiplier
/// do not match.
pub const PRODUCT: Code = Code(409);
/// G0501: an instance of another description does not fit. For example, it lacks an operand.
pub const PART: Code = Code(501);
/// G0502: operands cannot have buffers: the microprogram waits for `start` in the middle, or an operand was declared first.
pub const BUFFER: Code = Code(502);
/// G0503: the microinstruction that shows the results decides on a condition, so the outputs cannot have registers.
pub const OUTPUT_REGISTER: Code = Code(503);
/// G0601: a microprogram cannot be unrolled into a pipeline. For example, one of its loops has no bound.
pub const UNROLL: Code = Code(601);
/// G0602: no pipeline has the requested clock frequency, number of stages, interval, rate or number of multipliers.
pub const SCHEDULE: Code = Code(602);

const PAGES: &str = include_str!("diagnostics.md");

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{:04}", self.0)
    }
}

/// Returns the code as text, such as `G0203`, the title, and the explanation in Markdown for each code.
pub fn pages() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    PAGES.split("\n## ").skip(1).filter_map(|page| {
        let (heading, text) = page.split_once('\n')?;
        let (code, title) = heading.split_once(": ")?;
        Some((code, title, text.trim()))
    })
}
