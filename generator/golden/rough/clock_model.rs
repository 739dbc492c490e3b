//! Builds the golden model of the device `rough` from the registers and microinstructions of the device.

use std::sync::Arc;

use super::{Derived as _, RoughArithmetic, keys_of};
use crate::Model;
use crate::frame::{Frame, idle, step_by};
use glint_base::fixed::Format;
use glint_config::Config;

/// Returns the golden model. It has no address register for a synchronous ROM 18 (the table of sines). The hardware sets the
/// ROM's address one microinstruction before it uses the sine. The operands do not change in between, so a synchronous and an
/// asynchronous ROM 18 show the same sine.
pub fn model(config: &Config) -> Box<dyn Model> {
    let it = Arc::new(RoughArithmetic::new(keys_of(config)));
    let keys = &it.keys;
    let largest = keys.largest_cosine();
    let product = |int| Format::unsigned(int, keys.product_fraction as i32);
    let [cos_cos, sin_sin, sine] = if keys.patent() {
        [keys.cos_dgamma_format(); 3]
    } else {
        [product(1), product(0), Format::unsigned(0, keys.sine_fraction as i32)]
    };
    let mut frame = Frame::default();
    let cos_gamma = frame.clamped("cos_gamma", keys.cos_gamma_format(), 0, largest);
    let cos_dgamma = frame.clamped("cos_dgamma", keys.cos_dgamma_format(), 0, largest);
    let exponent = frame.operand("exponent", keys.operands.exponent_format());
    let negative = frame.operand("dgamma_negative", Format::BIT);
    let reg19 = frame.register("reg19_sin_gamma", sine);
    let reg11 = frame.register("reg11_cos_cos", cos_cos);
    let reg12 = frame.register("reg12_sin_sin", sin_sin);
    let reg13 = frame.register("reg13_result", keys.result_format());
    // f, as it is read from register 13.
    let reflectance = frame.hidden();
    // Each odd microinstruction captures the values that settled in the microinstruction before it.
    let mut program = vec![
        idle(),
        step_by(&it, move |it, s| {
            s[reg19] = it.sine.at(s[cos_gamma]);
            s[reg11] = it.cos_cos(s[cos_gamma], s[cos_dgamma]);
        }),
        idle(),
        step_by(&it, move |it, s| s[reg12] = it.sin_sin(it.sine.at(s[cos_dgamma]), s[reg19])),
        idle(),
        // Register 13 takes n/2·(cos(γ ± dγ) − 1).
        step_by(&it, move |it, s| {
            let adder_15 = it.adder_15(s[reg11], s[reg12], s[negative]);
            s[reg13] = it.scaled(adder_15, s[exponent], s[cos_gamma]);
            s[reflectance] = it.f_of(s[reg13]);
        }),
        idle(),
        // Register 13 takes the square of its value plus 1.0.
        step_by(&it, move |it, s| {
            s[reg13] = it.squared(s[reg13], s[cos_gamma]);
            s[reflectance] = it.f_of(s[reg13]);
        }),
    ];
    program.extend(keys.products().slots(&mut frame, reflectance));
    program.extend([idle().valid(), idle().end()]);
    Box::new(frame.model(program))
}
