//! What a reflectance multiplies.

use crate::base::fixed::{Format, Rounding};
use crate::golden::frame::{Frame, Slot, State};
use crate::golden::narrow::Narrow;
use crate::golden::{Operand, Output};

/// What is multiplied by f: three colours, or one amplitude.
#[derive(Clone, Debug)]
pub struct Products {
    /// Of f.
    pub(super) f: Format,
    pub(super) bits: u32,
    pub(super) rounding: Rounding,
    pub(super) narrow: Narrow,
    pub(super) operands: Vec<Operand>,
    pub(super) outputs: Vec<Output>,
}

impl Products {
    /// The colours of the building block `Colours`; every value is in the domain.
    pub fn colours(f: Format, bits: u32, rounding: Rounding) -> Self {
        let colours = ["red", "green", "blue"];
        let doc =
            |colour| format!("{colour} of the light times the surface's specular coefficient");
        let outputs = colours.map(|colour| format!("{colour}_out"));
        Self::new(f, bits, rounding, colours.map(|it| (it, doc(it))).into(), outputs.into())
    }

    /// The amplitude of the building block `Colours::amplitude`; every value is in the domain.
    pub fn amplitude(f: Format, bits: u32, rounding: Rounding) -> Self {
        let doc = "intensity of the light times the surface's specular coefficient, at the peak";
        let operand = vec![("amplitude", doc.to_owned())];
        Self::new(f, bits, rounding, operand, vec!["intensity_out".to_owned()])
    }

    /// Nothing: f alone.
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
        let operand = |(name, doc): (&str, String)| Operand {
            name: name.to_owned(),
            format,
            domain: (0, format.max_raw() as i64),
            colour: true,
            doc,
        };
        Self {
            f,
            bits,
            rounding,
            narrow: Narrow::new(f.frac as u32, format, rounding),
            operands: operands.into_iter().map(operand).collect(),
            outputs: outputs.into_iter().map(|name| Output { name, format }).collect(),
        }
    }

    /// Their operands and outputs in a clock model.
    pub fn slots(&self, frame: &mut Frame) -> ProductSlots {
        let pairs = self.operands.iter().zip(&self.outputs).map(|(operand, output)| {
            (
                frame.operand(&operand.name, operand.format),
                frame.output(&output.name, output.format),
            )
        });
        ProductSlots { pairs: pairs.collect(), narrow: self.narrow }
    }
}

/// Products in a clock model.
pub struct ProductSlots {
    /// Operand and output.
    pairs: Vec<(Slot, Slot)>,
    narrow: Narrow,
}

impl ProductSlots {
    /// The outputs for a raw f.
    #[inline]
    pub fn show(&self, f: i64, state: &mut State) {
        for &(operand, output) in &self.pairs {
            state[output] = self.narrow.apply(f * state[operand]);
        }
    }
}
