//! Multiplies the reflectance f by the colour operands, in the golden models and accuracy contracts of highlight devices.

use crate::frame::{ClockedModel, Frame, FrameStep, Slot, State, idle, step};
use crate::narrow::Narrow;
use crate::{Operand, Output};
use glint_base::fixed::{Format, Rounding};

/// The products of f with three colours or one amplitude: operands, outputs, rounding, and the order in which the hardware
/// computes them.
#[derive(Clone, Debug)]
pub struct Products {
    pub(super) f: Format,
    pub(super) bits: u32,
    pub(super) rounding: Rounding,
    pub(super) narrow: Narrow,
    pub(super) operands: Vec<Operand>,
    pub(super) outputs: Vec<Output>,
    schedule: ProductOrder,
}

/// When the hardware computes the products.
#[derive(Clone, Copy, Debug)]
enum ProductOrder {
    /// As combinational logic behind f and the colours.
    AtOnce,
    /// By one multiplier, each in a microinstruction of its own.
    InTurn,
    /// At every rising edge, into registers.
    AtEdges,
}

impl Products {
    /// Multiplies f by the operands red, green and blue of `bits` bits, rounded by `rounding`. The contract covers all values of
    /// the colours.
    pub fn colours(f: Format, bits: u32, rounding: Rounding) -> Self {
        let colours = ["red", "green", "blue"];
        let doc =
            |colour| format!("{colour} of the light times the surface's specular coefficient");
        let outputs = colours.map(|colour| format!("{colour}_out"));
        Self::new(f, bits, rounding, colours.map(|it| (it, doc(it))).into(), outputs.into())
    }

    /// Multiplies f by the operand `amplitude` of `bits` bits, rounded by `rounding`. The contract covers all values of the
    /// amplitude.
    pub fn amplitude(f: Format, bits: u32, rounding: Rounding) -> Self {
        let doc = "intensity of the light times the surface's specular coefficient, at the peak";
        let operand = vec![("amplitude", doc.to_owned())];
        Self::new(f, bits, rounding, operand, vec!["intensity_out".to_owned()])
    }

    /// Makes no products, for a device that outputs f. The contract then covers f alone.
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

    /// Selects one multiplier that computes the products one after the other, each in its own microinstruction. With `in_turn`
    /// false, the products are combinational logic.
    #[must_use]
    pub fn in_turn(self, in_turn: bool) -> Self {
        Self { schedule: if in_turn { ProductOrder::InTurn } else { ProductOrder::AtOnce }, ..self }
    }

    /// Selects registers that take the products at every rising edge. With `at_edges` false, the products are combinational
    /// logic.
    #[must_use]
    pub fn at_edges(self, at_edges: bool) -> Self {
        Self {
            schedule: if at_edges { ProductOrder::AtEdges } else { ProductOrder::AtOnce },
            ..self
        }
    }

    /// Adds the colour operands and the outputs to `frame`, in which the slot `f` has the raw f. Returns the microinstructions
    /// that compute the products one after the other; none if no microinstruction is necessary.
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

    /// Returns the golden model that executes `program` and then computes the products. `program` must leave f in the slot `f`.
    pub fn behind(&self, mut frame: Frame, f: Slot, mut program: Vec<FrameStep>) -> ClockedModel {
        program.extend(self.slots(&mut frame, f));
        program.push(idle().valid().end());
        frame.model(program)
    }
}
