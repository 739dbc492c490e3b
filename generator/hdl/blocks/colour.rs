//! Builds the colour operands and outputs of a device. The outputs are the products of the colours with the reflectance f,
//! rounded to integers.
//!
//! Each colour has its own multiplier, or one multiplier makes all products in turn.

use crate::dsl::{Designer, InputOperand, Signal, Step, step};
use glint_base::fixed::{Format, Overflow, Rounding};

/// The numbers of the blocks of one colour in the source's block diagram.
#[derive(Clone, Copy, Debug)]
pub struct ChannelBlocks {
    /// The data input and the write strobe of the colour operand.
    pub inputs: (u16, u16),
    /// The operand register.
    pub register: u16,
    pub multiplier: u16,
    pub output: u16,
}

/// The colour operands, integers: the intensity of the light times the material's specular coefficient k_s.
pub struct Colours<'d> {
    designer: &'d Designer,
    format: Format,
    channels: Vec<Channel<'d>>,
}

struct Channel<'d> {
    /// The output without `_out`, such as `red`.
    name: &'static str,
    operand: InputOperand<'d>,
    blocks: Option<ChannelBlocks>,
}

impl<'d> Colours<'d> {
    /// Adds the operands `red`, `green` and `blue`, unsigned integers of `bits` bits. `blocks` are their numbers in the source's
    /// block diagram, if it has numbers.
    #[track_caller]
    pub fn new(designer: &'d Designer, bits: i32, blocks: Option<[ChannelBlocks; 3]>) -> Self {
        let format = Format::unsigned(bits, 0);
        let names = ["red", "green", "blue"];
        let mut channels = Vec::new();
        for (at, name) in names.into_iter().enumerate() {
            let own = blocks.map(|blocks| blocks[at]);
            let mut operand =
                designer.operand(name, format).doc("intensity of the light, times k_s");
            if let Some(blocks) = own {
                operand = operand.block(blocks.register).inputs(blocks.inputs.0, blocks.inputs.1);
            }
            channels.push(Channel { name, operand, blocks: own });
        }
        Self { designer, format, channels }
    }

    /// Adds a single operand `amplitude` of `bits` bits, an unsigned integer, for the output `intensity_out`. A device with one
    /// colour channel, or light without a colour, has this operand.
    #[track_caller]
    pub fn amplitude(designer: &'d Designer, bits: i32, blocks: Option<ChannelBlocks>) -> Self {
        let format = Format::unsigned(bits, 0);
        let mut operand = designer
            .operand("amplitude", format)
            .doc("intensity of the light, times k_s, at the peak of the highlight");
        if let Some(blocks) = blocks {
            operand = operand.block(blocks.register).inputs(blocks.inputs.0, blocks.inputs.1);
        }
        Self { designer, format, channels: vec![Channel { name: "intensity", operand, blocks }] }
    }

    /// Adds outputs that one multiplier computes in turn, and returns a microinstruction for each. An output is a
    /// register with `f` times the operand, rounded by `rounding` and saturated to the operand's width. The register is named
    /// `<colour>_intensity`, or `intensity_rounded` for the operand `amplitude`. `f` must not change until the last output is
    /// loaded.
    #[must_use]
    #[track_caller]
    pub fn outputs_in_turn(&self, f: Signal<'d>, rounding: Rounding) -> Vec<Step> {
        let d = self.designer;
        let operands = self.channels.iter().map(|channel| channel.operand.q());
        let colour = d.mux("colour", operands).doc("the colour that is multiplied by f");
        let product = d.mul("colour_product", f, colour.out()).doc("the output before rounding");
        let narrowed =
            d.narrow("colour_rounded", product, self.format, rounding, Overflow::Saturate);
        let mut steps = Vec::new();
        for Channel { name, operand, blocks } in &self.channels {
            let register_name = intensity_name(name);
            let register = d.register(&register_name, self.format).doc("output register");
            register.takes(narrowed);
            let out = d.output(&format!("{name}_out"), register.q()).doc("output intensity");
            if let Some(blocks) = blocks {
                let _ = out.block(blocks.output);
            }
            let does = format!("{register_name} <- f * {}", operand.q().name());
            steps.push(step(&does, [colour.pick(operand.q()), register.load()]));
        }
        steps
    }

    /// Adds the outputs `<colour>_out` or `intensity_out`: `f` times the operand, rounded by `rounding` to an integer and
    /// saturated to the operand's width.
    #[track_caller]
    pub fn outputs(&self, f: Signal<'d>, rounding: Rounding) {
        self.outputs_of(f, rounding, false);
    }

    /// Does the same as [`Colours::outputs`], but adds a register behind each multiplier that loads on every clock. An output
    /// therefore shows the product of the clock before.
    #[track_caller]
    pub fn outputs_staged(&self, f: Signal<'d>, rounding: Rounding) {
        self.outputs_of(f, rounding, true);
    }

    #[track_caller]
    fn outputs_of(&self, f: Signal<'d>, rounding: Rounding, staged: bool) {
        let d = self.designer;
        for channel in &self.channels {
            let Channel { name, operand, blocks } = channel;
            let mut product =
                d.mul(&format!("{name}_product"), f, operand.q()).doc("the output before rounding");
            let exact =
                if staged { d.pipeline(&format!("{name}_product_held"), product) } else { product };
            let rounded = intensity_name(name);
            let narrowed = d.narrow(&rounded, exact, self.format, rounding, Overflow::Saturate);
            let mut out = d.output(&format!("{name}_out"), narrowed).doc("output intensity");
            if let Some(blocks) = blocks {
                product = product.block(blocks.multiplier);
                out = out.block(blocks.output);
            }
            let _ = (product, out);
        }
    }
}

/// Returns the name of the rounded product behind the output `<name>_out`.
fn intensity_name(name: &str) -> String {
    match name {
        "intensity" => "intensity_rounded".to_owned(),
        colour => format!("{colour}_intensity"),
    }
}
