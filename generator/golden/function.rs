//! `function`: a formula of one operand by Horner's rule in integers, on the coefficients of its table.
//!
//! The table is data: what vouches for it is that every operand was computed and set against the formula.

use std::sync::Arc;

use super::device::{self, Formula};
use super::frame::{Frame, idle, step_by};
use super::{Contract, Model, Term};
use crate::approximate::{Function, Outside, Piecewise};
use crate::base::fixed::exp2;
use crate::config::Config;
use crate::keys::function::found;

/// Registers: the operand, and the sums from each coefficient on, of which the first is the result.
fn device(it: &Arc<Piecewise>) -> device::Device {
    let (first, last) = it.domain;
    let top = it.degree();
    let mut frame = Frame::default();
    let x = match it.outside {
        Outside::Clamp => frame.clamped("x", it.operand, first, last),
        Outside::Wrap | Outside::Anything => frame.operand("x", it.operand),
    };
    let registers = Piecewise::REGISTERS.iter().zip(&it.sums).take(top.max(1));
    let sums: Vec<_> = registers.map(|(name, format)| frame.register(name, *format)).collect();
    frame.shows("result_out", sums[0]);
    let add = |k: usize| {
        let (own, above) = (sums[k], sums.get(k + 1).copied());
        step_by(it, move |it, s| {
            let place = it.place(s[x]);
            // The highest coefficient is a word of the table and no register.
            let above = above.map_or(it.words[place.word][top], |above| s[above]);
            let sum = it.sum(k, place, above) >> if k == 0 { it.guard() } else { 0 };
            s[own] = it.sums[k].raw(it.sums[k].bits(sum.into())) as i64;
        })
    };
    let adds = (0..top.max(1)).rev().map(add);
    let program = [idle()].into_iter().chain(adds).chain([idle().valid().end()]);
    frame.device(program.collect::<Vec<_>>()).domain("x", first, last)
}

/// The golden model.
///
/// # Panics
/// If the check of the schema has not accepted the configuration.
pub fn model(config: &Config) -> Box<dyn Model> {
    device(&found(config).expect("a configuration that is checked").1).model()
}

/// The accuracy contract.
///
/// # Panics
/// As [`model`].
pub fn contract(config: &Config) -> Box<dyn Contract> {
    let (function, it) = found(config).expect("a configuration that is checked");
    let bound = it.bound;
    device(&it).contract(Stated { function, bound })
}

/// The formula with the bound that was proved at every operand.
struct Stated {
    function: Function,
    bound: f64,
}

impl Formula for Stated {
    fn exact(&self, operands: &[f64]) -> Vec<f64> {
        let raw = (operands[0] * exp2(self.function.operand.frac)) as i64;
        let value = self.function.limits(raw).map_or(f64::NAN, |limits| limits.middle());
        vec![value * exp2(-(self.function.fraction as i32))]
    }

    fn terms(&self) -> Vec<Term> {
        let rounding = self.bound.min(0.5);
        vec![
            Term { key: "result.fraction", what: "rounding of the result", units: rounding },
            Term {
                key: "result.error",
                what: "the polynomials and their roundings, at every operand",
                units: self.bound - rounding,
            },
        ]
    }

    fn expressions(&self) -> Vec<String> {
        vec![self.function.formula.python()]
    }
}
