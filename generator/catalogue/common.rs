//! Operands and colour outputs that the hardware descriptions of several devices share.
//!
//! The operands are `cos_gamma` (c = cos γ, where γ is the angle between the surface normal and the half vector) and `exponent`
//! (the specular exponent n). The colour outputs are the colours times the reflectance f. [`outputs_note`] writes a paragraph for
//! the device's page. The paragraph says that a busy device ignores writes of operands, and until when the outputs keep their
//! values.

use glint_base::fixed::{Format, Rounding};
use glint_keys::common as keys;
use glint_rtl::blocks::colour::{ChannelBlocks, Colours};
use glint_rtl::blocks::line::{LineBlocks, OperandBlocks};
use glint_rtl::dsl::{Designer, InputOperand, Note, Signal, Step, Topic, end, step, valid};

/// Adds the operand `cos_gamma`. Its register limits written values to 0 … 1.0.
#[track_caller]
pub fn cosine<'d>(d: &'d Designer, keys: &keys::Cosine) -> InputOperand<'d> {
    d.operand_clamped("cos_gamma", keys.format(), 0.0, 1.0)
        .doc("cosine of the angle between normal and half vector")
}

/// Adds the operand `exponent`, an unsigned integer with `bits` bits.
#[track_caller]
pub fn exponent(d: &Designer, bits: u32) -> InputOperand<'_> {
    d.operand("exponent", Format::unsigned(bits as i32, 0)).doc("specular exponent n")
}

/// The products of the reflectance f with the three colours. The configuration key `colour.multipliers` chooses one multiplier
/// for all colours or one multiplier for each colour.
pub struct ColourProducts<'d> {
    colours: Colours<'d>,
    in_turn: bool,
}

impl<'d> ColourProducts<'d> {
    /// Adds the colour operands to the description. `blocks` are the numbers of their blocks in the figure of the device's
    /// source, or `None` if the source has no figure.
    #[track_caller]
    pub fn new(
        d: &'d Designer,
        keys: &keys::ColourKeys,
        blocks: Option<[ChannelBlocks; 3]>,
    ) -> Self {
        Self { colours: Colours::new(d, keys.bits as i32, blocks), in_turn: keys.in_turn() }
    }

    /// Adds the colour outputs, which are the colours times `f`. Returns the microinstructions that compute the products; these
    /// microinstructions must come before the microinstruction that raises `valid`. The list is empty if each colour has its own
    /// multiplier.
    #[track_caller]
    pub fn outputs(&self, f: Signal<'d>, rounding: Rounding) -> Vec<Step> {
        if self.in_turn {
            return self.colours.outputs_in_turn(f, rounding);
        }
        self.colours.outputs(f, rounding);
        Vec::new()
    }

    /// Adds the colour outputs. Returns the microinstructions that compute the products, followed by a microinstruction that
    /// raises `valid` and ends the microprogram. If each colour has its own multiplier, the list has only this last
    /// microinstruction.
    #[track_caller]
    pub fn results(&self, f: Signal<'d>, rounding: Rounding) -> Vec<Step> {
        let mut steps = self.outputs(f, rounding);
        steps.push(step("result", [valid(), end()]));
        steps
    }
}

/// Returns a paragraph for the page of a device. The paragraph says that a busy device ignores writes of operands, and until when
/// the outputs keep their values.
///
/// If each colour has its own multiplier, the outputs follow the register that `follow` names, until a colour is written or the
/// next computation does `until`. For example, `follow` is "the accumulator", and `until` is "begins". With one multiplier for
/// all colours, the paragraph uses neither text: the outputs are then registers, which keep their values until the next
/// computation reaches the products.
pub fn outputs_note(keys: &keys::ColourKeys, follow: &str, until: &str) -> Note {
    if keys.in_turn() {
        return Topic::Writes.note(
            "Writes while busy are ignored. One multiplier multiplies f by the colours in turn. The outputs \
             are registers: they keep their values from valid until the next computation reaches these \
             products.",
        );
    }
    Topic::Writes.note(format!(
        "Writes while busy are ignored. The outputs depend on {follow} and the colour registers: they keep \
         their values from valid until a colour is written or the next computation {until}."
    ))
}

/// The numbers that seed 000 gives to the inputs and blocks of the accumulator, which computes the angles of the points along a
/// scan line. Seed 000 is the patent of the device `quad-cosine`.
pub const LINE_BLOCKS: LineBlocks = LineBlocks {
    delta: OperandBlocks { inputs: (17, 18), register: 2 },
    start: OperandBlocks { inputs: (19, 20), register: 3 },
    length_inputs: (23, 24),
    counter: 5,
    adder: 6,
    mux: 7,
    register: 8,
    count: 34,
    select: 36,
    write: 37,
};
