//! Operands, colour outputs and notes that the hardware descriptions of several devices share.

use glint_base::fixed::{Format, Rounding};
use glint_keys::common as keys;
use glint_rtl::blocks::colour::{ChannelBlocks, Colours};
use glint_rtl::blocks::line::{LineBlocks, OperandBlocks};
use glint_rtl::dsl::{Designer, InputOperand, Note, Signal, Step, Topic, end, step, valid};

/// Adds the operand `cos_gamma`, limited to 0 … 1.0.
#[track_caller]
pub fn cosine<'d>(d: &'d Designer, keys: &keys::Cosine) -> InputOperand<'d> {
    d.operand_clamped("cos_gamma", keys.format(), 0.0, 1.0)
        .doc("cosine of the angle between normal and half vector")
}

/// Adds the operand `exponent`, an unsigned integer.
#[track_caller]
pub fn exponent(d: &Designer, bits: u32) -> InputOperand<'_> {
    d.operand("exponent", Format::unsigned(bits as i32, 0)).doc("specular exponent n")
}

/// The products of the reflectance f with the three colours. The key `colour.multipliers` chooses one multiplier for all colours
/// or one for each.
pub struct ColourProducts<'d> {
    colours: Colours<'d>,
    in_turn: bool,
}

impl<'d> ColourProducts<'d> {
    /// Adds the colour operands. `blocks` are their numbers in the source's figure, if the source has one.
    #[track_caller]
    pub fn new(
        d: &'d Designer,
        keys: &keys::ColourKeys,
        blocks: Option<[ChannelBlocks; 3]>,
    ) -> Self {
        Self { colours: Colours::new(d, keys.bits as i32, blocks), in_turn: keys.in_turn() }
    }

    /// Adds the colour outputs. Returns the microinstructions that compute the products, which must come before the one that
    /// raises `valid`; none if each colour has its own multiplier.
    #[track_caller]
    pub fn outputs(&self, f: Signal<'d>, rounding: Rounding) -> Vec<Step> {
        if self.in_turn {
            return self.colours.outputs_in_turn(f, rounding);
        }
        self.colours.outputs(f, rounding);
        Vec::new()
    }

    /// Adds the colour outputs. Returns the microinstructions that compute the products, and one that raises `valid` and ends the
    /// microprogram.
    #[track_caller]
    pub fn results(&self, f: Signal<'d>, rounding: Rounding) -> Vec<Step> {
        let mut steps = self.outputs(f, rounding);
        steps.push(step("result", [valid(), end()]));
        steps
    }
}

/// Returns a paragraph for the page of a device: a busy device ignores writes of operands, and until when the outputs keep their
/// values.
///
/// If each colour has its own multiplier, the outputs follow the register that `follow` names, until a colour is written or the
/// next computation does `until`. For example, `follow` is "the accumulator", and `until` is "begins". With one multiplier for
/// all colours, the outputs are registers, and neither text is used.
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

/// The numbers that seed 000 gives to the accumulator for the angles along a scan line.
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
