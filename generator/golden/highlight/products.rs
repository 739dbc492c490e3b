//! What a reflectance multiplies.

use std::ops::Deref;

use crate::base::fixed::{Format, Rounding};
use crate::golden::frame::{Clocked, Datapath, Frame, Microinstruction, Slot, State, idle, step};
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
    in_turn: bool,
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
            in_turn: false,
        }
    }

    /// The same colours made one after the other, a microinstruction each, if `in_turn`; each at once otherwise.
    #[must_use]
    pub fn in_turn(self, in_turn: bool) -> Self {
        Self { in_turn, ..self }
    }

    /// Their operands and outputs in a clock model that has the raw f in a slot.
    pub fn slots(&self, frame: &mut Frame, f: Slot) -> ProductSlots {
        let pairs = self.operands.iter().zip(&self.outputs).map(|(operand, output)| {
            let slot = if self.in_turn {
                let held = frame.register(&format!("{}_intensity", operand.name), output.format);
                frame.shows(&output.name, held);
                held
            } else {
                frame.output(&output.name, output.format)
            };
            (frame.operand(&operand.name, operand.format), slot)
        });
        ProductSlots { f, pairs: pairs.collect(), narrow: self.narrow, in_turn: self.in_turn }
    }
}

/// Products in a clock model.
pub struct ProductSlots {
    f: Slot,
    /// Operand and output, or the register that holds it.
    pairs: Vec<(Slot, Slot)>,
    narrow: Narrow,
    in_turn: bool,
}

/// A device that multiplies colours by f: its slots, with those of the products. Registers and outputs change by loads
/// alone.
pub struct Shading<D> {
    device: D,
    products: ProductSlots,
}

impl<D> Deref for Shading<D> {
    type Target = D;

    #[inline]
    fn deref(&self) -> &D {
        &self.device
    }
}

impl<D> AsRef<ProductSlots> for Shading<D> {
    #[inline]
    fn as_ref(&self) -> &ProductSlots {
        &self.products
    }
}

impl<D: Send + Sync + 'static> Datapath for Shading<D> {
    const LOADS_ALONE: bool = true;

    #[inline]
    fn outputs(&self, state: &mut State) {
        self.products.show(state);
    }
}

/// The device at power-up: the products of what `program` leaves in the slot f are made, and shown in its last
/// microinstruction.
pub fn shading<D: Send + Sync + 'static>(
    mut frame: Frame,
    device: D,
    (products, f): (Products, Slot),
    mut program: Vec<Microinstruction<Shading<D>>>,
) -> Clocked<Shading<D>> {
    let products = products.slots(&mut frame, f);
    program.extend(products.program());
    program.push(idle().valid().end());
    frame.model(Shading { device, products }, program)
}

impl ProductSlots {
    /// The microinstructions that make the products, before the one with the result; none where they are made at once.
    pub fn program<D: AsRef<Self>>(&self) -> Vec<Microinstruction<D>> {
        fn make<D: AsRef<ProductSlots>, const COLOUR: usize>(device: &D, state: &mut State) {
            let it = device.as_ref();
            let (operand, held) = it.pairs[COLOUR];
            state[held] = it.narrow.apply(state[it.f] * state[operand]);
        }
        if self.in_turn {
            vec![step(make::<D, 0>), step(make::<D, 1>), step(make::<D, 2>)]
        } else {
            Vec::new()
        }
    }

    /// Sets the outputs, where they are made at once.
    #[inline]
    pub fn show(&self, state: &mut State) {
        if self.in_turn {
            return;
        }
        for &(operand, output) in &self.pairs {
            state[output] = self.narrow.apply(state[self.f] * state[operand]);
        }
    }
}
