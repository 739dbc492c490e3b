//! `rough` clock by clock.

use super::{Arithmetic, Params};
use crate::base::fixed::Format;
use crate::config::Config;
use crate::golden::Model;
use crate::golden::frame::{Clocked, Datapath, Frame, Slot, State, idle, step};
use crate::golden::highlight::ProductSlots;

/// The golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    Box::new(clocked(Params::of(config)))
}

/// The device, clock by clock.
pub(super) struct Device {
    it: Arithmetic,
    cos_gamma: Slot,
    cos_dgamma: Slot,
    exponent: Slot,
    dgamma_negative: Slot,
    sin_gamma: Slot,
    cos_cos: Slot,
    sin_sin: Slot,
    result: Slot,
    /// f, as it is read from register 13.
    reflectance: Slot,
    /// Mux 17 addresses ROM 18 with register 2, and else with register 1.
    turned: Slot,
    /// The operand whose sine ROM 18 shows: an asynchronous one that of mux 17, a synchronous one that of the
    /// clock before.
    shown: Slot,
    addressed: Slot,
    products: ProductSlots,
}

impl AsRef<ProductSlots> for Device {
    fn as_ref(&self) -> &ProductSlots {
        &self.products
    }
}

impl Datapath for Device {
    const LOADS_ALONE: bool = true;

    #[inline]
    fn outputs(&self, s: &mut State) {
        self.products.show(s);
    }

    #[inline]
    fn edge(&self, s: &mut State) {
        let earlier = s[self.addressed];
        s[self.addressed] = s[if s[self.turned] == 1 { self.cos_dgamma } else { self.cos_gamma }];
        s[self.shown] = if self.it.params.sine_synchronous { earlier } else { s[self.addressed] };
    }
}

impl Device {
    /// The output of ROM 18.
    #[inline]
    fn sine(&self, s: &State) -> i64 {
        self.it.sine.at(s[self.shown])
    }

    /// Loads register 13.
    #[inline]
    fn load_result(&self, s: &mut State, value: i64) {
        s[self.result] = value;
        s[self.reflectance] = self.it.f_of(value);
    }
}

pub(super) fn clocked(params: Params) -> Clocked<Device> {
    let largest = params.largest_cosine();
    let product = |int| Format::unsigned(int, params.product_fraction as i32);
    let mut frame = Frame::default();
    let [cos_cos, sin_sin, sine] = if params.patent() {
        [params.cos_dgamma_format(); 3]
    } else {
        [product(1), product(0), Format::unsigned(0, params.sine_fraction as i32)]
    };
    let turned = frame.hidden_flag();
    let reflectance = frame.hidden();
    let device = Device {
        cos_gamma: frame.clamped("cos_gamma", params.cos_gamma_format(), 0, largest),
        cos_dgamma: frame.clamped("cos_dgamma", params.cos_dgamma_format(), 0, largest),
        exponent: frame.operand("exponent", params.keys.exponent_format()),
        dgamma_negative: frame.operand("dgamma_negative", Format::BIT),
        sin_gamma: frame.register("reg19_sin_gamma", sine),
        cos_cos: frame.register("reg11_cos_cos", cos_cos),
        sin_sin: frame.register("reg12_sin_sin", sin_sin),
        result: frame.register("reg13_result", params.result_format()),
        reflectance,
        turned,
        shown: frame.hidden(),
        addressed: frame.hidden(),
        products: params.keys.products().slots(&mut frame, reflectance),
        it: Arithmetic::new(params),
    };
    // Each odd microinstruction captures what the one before it let settle.
    let settle = || idle().asserts(turned);
    // Register 19 takes sin γ, register 11 cos γ·cos dγ.
    let first = step(|d: &Device, s| {
        s[d.sin_gamma] = d.sine(s);
        s[d.cos_cos] = d.it.cos_cos(s[d.cos_gamma], s[d.cos_dgamma]);
    });
    // Register 12 takes sin dγ·sin γ.
    let second = step(|d: &Device, s| s[d.sin_sin] = d.it.sin_sin(d.sine(s), s[d.sin_gamma]));
    // Register 13 takes n/2·(cos(γ ± dγ) − 1).
    let third = step(|d: &Device, s| {
        let adder_15 = d.it.adder_15(s[d.cos_cos], s[d.sin_sin], s[d.dgamma_negative]);
        d.load_result(s, d.it.scaled(adder_15, s[d.exponent], s[d.cos_gamma]));
    });
    // Register 13 takes the square of itself plus 1.0.
    let fourth = step(|d: &Device, s| {
        d.load_result(s, d.it.squared(s[d.result], s[d.cos_gamma]));
    });
    let mut program = vec![
        idle(),
        first,
        settle(),
        second.asserts(turned),
        settle(),
        third.asserts(turned),
        settle(),
        fourth.asserts(turned),
    ];
    program.extend(device.products.program());
    program.extend([settle().valid(), idle().end()]);
    frame.model(device, program)
}
