//! Multiplies the reflectance f by the colour operands, in the golden models and accuracy contracts of highlight devices.
//!
//! [`Products`] has the operands, the outputs and the rounding, and the order in which the hardware computes the products. It
//! does not compute f.

use crate::frame::{ClockedModel, Frame, FrameStep, Slot, State, idle, step};
use crate::narrow::Narrow;
use crate::{Operand, Output};
use glint_base::fixed::{Format, Rounding};

/// The products of the reflectance f with the operands that it multiplies: three colours, or one amplitude.
#[derive(Clone, Debug)]
pub struct Products {
    /// The format of f.
    pub(super) f: Format,
    pub(super) bits: u32,
    pub(super) rounding: Rounding,
    pub(super) narrow: Narrow,
    pub(super) operands: Vec<Operand>,
    pub(super) outputs: Vec<Output>,
    schedule: ProductOrder,
}

/// The clocks in which the hardware computes the products.
#[derive(Clone, Copy, Debug)]
enum ProductOrder {
    /// All products are combinational logic behind f and the colours.
    AtOnce,
    /// One multiplier makes the products, each in a microinstruction of its own.
    InTurn,
    /// Registers take the products at every rising edge.
    AtEdges,
}

impl Products {
    /// Returns the products of the reflectance f with the three colour operands red, green and blue, each of `bits` bits. `f` is
    /// the format of the reflectance, and `rounding` rounds the products. The contract covers all values of the colours.
    pub fn colours(f: Format, bits: u32, rounding: Rounding) -> Self {
        let colours = ["red", "green", "blue"];
        let doc =
            |colour| format!("{colour} of the light times the surface's specular coefficient");
        let outputs = colours.map(|colour| format!("{colour}_out"));
        Self::new(f, bits, rounding, colours.map(|it| (it, doc(it))).into(), outputs.into())
    }

    /// Returns the product of the reflectance f with the single operand `amplitude` of `bits` bits. `f` is the format of the
    /// reflectance, and `rounding` rounds the product. The contract covers all values of the amplitude.
    pub fn amplitude(f: Format, bits: u32, rounding: Rounding) -> Self {
        let doc = "intensity of the light times the surface's specular coefficient, at the peak";
        let operand = vec![("amplitude", doc.to_owned())];
        Self::new(f, bits, rounding, operand, vec!["intensity_out".to_owned()])
    }

    /// Returns an empty set of products, for a device that outputs the reflectance f itself. The accuracy contract then covers f
    /// alone.
    pub fn none(f: Format) -> Self {
        Self::new(f, 1, Rounding::Nearest, Vec::new(), Vec::new())
    }

    fn new(
        f: Format,
        bits: u32,
        rounding: Rounding,
        operands: Vec<(&str, String)>,
        outputs: Vec<String>,
    ) -> Self {
        let format = Format::unsigned(bits as i32, 0);
        let domain = (0, format.max_raw() as i64);
        let mut colours = Vec::new();
        for (name, doc) in operands {
            let name = name.to_owned();
            colours.push(Operand { name, format, domain, clamped: false, colour: true, doc });
        }
        Self {
            f,
            bits,
            rounding,
            narrow: Narrow::new(f.frac as u32, format, rounding),
            operands: colours,
            outputs: outputs.into_iter().map(|name| Output { name, format }).collect(),
            schedule: ProductOrder::AtOnce,
        }
    }

    /// Sets how the hardware makes the products f · colour. If `in_turn`, one multiplier makes them one after the other, each in
    /// a microinstruction of its own; otherwise they are combinational logic behind f and the colours.
    #[must_use]
    pub fn in_turn(self, in_turn: bool) -> Self {
        Self { schedule: if in_turn { ProductOrder::InTurn } else { ProductOrder::AtOnce }, ..self }
    }

    /// Sets how the hardware makes the products f · colour. If `at_edges`, registers take the products at every rising edge;
    /// otherwise the products are combinational logic behind f and the colours.
    #[must_use]
    pub fn at_edges(self, at_edges: bool) -> Self {
        Self {
            schedule: if at_edges { ProductOrder::AtEdges } else { ProductOrder::AtOnce },
            ..self
        }
    }

    /// Adds the colour operands and the outputs to a golden model that has the raw f in the slot `f`. Returns the
    /// microinstructions that compute the products before the microinstruction with the result. The list is empty unless the
    /// products are computed one after the other.
    pub fn slots(&self, frame: &mut Frame, f: Slot) -> Vec<FrameStep> {
        let mut program = Vec::new();
        for (operand, output) in self.operands.iter().zip(&self.outputs) {
            let (colour, narrow) = (frame.operand(&operand.name, operand.format), self.narrow);
            let product = move |s: &State| narrow.apply(s[f] * s[colour]);
            match self.schedule {
                ProductOrder::AtOnce => frame.output(&output.name, output.format, product),
                ProductOrder::InTurn => {
                    let name = format!("{}_intensity", operand.name);
                    let held = frame.register(&name, output.format);
                    frame.shows(&output.name, held);
                    program.push(step(move |s| s[held] = product(s)));
                }
                ProductOrder::AtEdges => {
                    let held = frame.hidden();
                    frame.every_edge(move |s| s[held] = product(s));
                    frame.output(&output.name, output.format, move |s| s[held]);
                }
            }
        }
        program
    }

    /// Returns the golden model that executes `program` and then computes the products. `program` must leave f in the slot `f`;
    /// the last microinstruction shows the products.
    pub fn behind(&self, mut frame: Frame, f: Slot, mut program: Vec<FrameStep>) -> ClockedModel {
        program.extend(self.slots(&mut frame, f));
        program.push(idle().valid().end());
        frame.model(program)
    }
}
