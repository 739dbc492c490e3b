//! Colour operands and output multipliers.

use crate::dsl::{Designer, Operand, Signal};
use crate::fixed::{Format, Overflow, Rounding};

/// The numbers of one colour channel in the source's figure.
#[derive(Clone, Copy, Debug)]
pub struct ChannelBlocks {
    /// Data input and write strobe of the operand.
    pub inputs: (u16, u16),
    /// Operand register.
    pub register: u16,
    /// Output multiplier.
    pub multiplier: u16,
    /// Output.
    pub output: u16,
}

/// The colour operands `red`, `green`, `blue`: the intensity of the light times k_s, integers.
pub struct Colours<'d> {
    designer: &'d Designer,
    format: Format,
    channels: Vec<(&'static str, Operand<'d>, Option<ChannelBlocks>)>,
}

impl<'d> Colours<'d> {
    /// Operands of `bits` bits, with the source's numbers where it has some.
    #[track_caller]
    pub fn new(designer: &'d Designer, bits: i32, blocks: Option<[ChannelBlocks; 3]>) -> Self {
        let format = Format::unsigned(bits, 0);
        let names = ["red", "green", "blue"];
        let mut channels = Vec::new();
        for (at, name) in names.into_iter().enumerate() {
            let blocks = blocks.map(|blocks| blocks[at]);
            let mut operand = designer
                .operand(name, format)
                .doc("intensity of the light times k_s");
            if let Some(blocks) = blocks {
                operand = operand
                    .block(blocks.register)
                    .inputs(blocks.inputs.0, blocks.inputs.1);
            }
            channels.push((name, operand, blocks));
        }
        Self {
            designer,
            format,
            channels,
        }
    }

    /// The outputs `<colour>_out = f · colour`, rounded to integers.
    #[track_caller]
    pub fn outputs(&self, f: Signal<'d>, rounding: Rounding) {
        let d = self.designer;
        for (name, operand, blocks) in &self.channels {
            let mut product = d
                .mul(&format!("{name}_product"), f, operand.q())
                .doc("an output before it is rounded");
            let narrowed = d.narrow(
                &format!("{name}_intensity"),
                product,
                self.format,
                rounding,
                Overflow::Saturate,
            );
            let mut out = d
                .output(&format!("{name}_out"), narrowed)
                .doc("intensity on the output");
            if let Some(blocks) = blocks {
                product = product.block(blocks.multiplier);
                out = out.block(blocks.output);
            }
            let _ = (product, out);
        }
    }
}
