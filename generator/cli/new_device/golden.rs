//! Defines the golden model and the accuracy contract. The model is written from the formula and not from the description, so
//! that comparing the two finds mistakes in either.

use super::Keys;
use glint::config::Config;
use glint::fixed::{Format, Rounding};
use glint::golden::device::{self, Formula};
use glint::golden::frame::{Frame, idle, step};
use glint::golden::narrow::Narrow;
use glint::golden::{Contract, Model, Term};

/// Returns registers and outputs, and what each microinstruction does to them.
fn device(config: &Config) -> device::Device {
    let keys = Keys::of(config);
    let result = Format::unsigned(1, keys.result as i32);
    let rounded = Narrow::new(2 * keys.operand, result, Rounding::Nearest);
    let mut frame = Frame::default();
    let x = frame.operand("x", Format::unsigned(0, keys.operand as i32));
    let square = frame.register("square", result);
    frame.shows("square_out", square);
    frame.device([
        idle(),
        step(move |s| s[square] = rounded.apply(s[x] * s[x])),
        idle().valid().end(),
    ])
}

/// Returns the golden model.
pub fn model(config: &Config) -> Box<dyn Model> {
    device(config).model()
}

/// Returns the contract: the formula, and a bound on the error of the output.
pub fn contract(config: &Config) -> Box<dyn Contract> {
    device(config).contract(Square)
}

struct Square;

impl Formula for Square {
    fn exact(&self, operands: &[f64]) -> Vec<f64> {
        vec![operands[0] * operands[0]]
    }

    /// Each term is a proved upper limit of an error, in units of the output's last place. Rounding to the nearest is off by half a
    /// unit at most.
    ///
    /// Leave this method out if you have no proof: the command `certify` then finds a bound.
    fn terms(&self, _output: usize) -> Vec<Term> {
        vec![Term { key: "result.fraction", what: "rounding of the result", units: 0.5 }]
    }

    fn expressions(&self) -> Vec<String> {
        vec!["x ** 2".to_owned()]
    }
}
