//! Holds the facts that simulation and contract add to a netlist: worked examples, computations with their results,
//! the clocks of a line, the vectors of a bench.

use std::iter::repeat;

use glint_golden::Contract;

/// A computation with all its numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkedExample {
    /// In the order of the operand ports.
    pub operands: Vec<Quantity>,
    /// In the order of the result ports; of several results the first.
    pub outputs: Vec<Quantity>,
    /// The outputs of every result.
    pub results: Vec<Vec<Quantity>>,
}

/// The numbers of the clocks in which a line ends, by the operand that says how long it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineClocks {
    /// The name of that operand.
    pub length: String,
    /// The last clock in which `valid` is high.
    pub last_valid: Linear,
    /// The clock in which `done` is high.
    pub done: Linear,
    /// The first clock in which the next `start` is taken.
    pub next_start: Linear,
}

/// A constant and a multiple of a length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Linear {
    /// For the length 0.
    pub constant: i64,
    /// For each interval.
    pub each: i64,
}

impl Linear {
    /// Returns the number for a length. For example, `4 + length` gives 24 for the length 20.
    pub fn at(self, length: i64) -> i64 {
        self.constant + self.each * length
    }

    /// Returns the formula with the length by its name, as `4 + length`.
    pub fn text(self, length: &str) -> String {
        match self.each {
            0 => self.constant.to_string(),
            1 => format!("{} + {length}", self.constant),
            each => format!("{} + {each} · {length}", self.constant),
        }
    }
}

/// The contract of a device's results, as far as a program can use it. For example, `rough` promises for `exponent` 1 to 1000
/// that each output is within 0.97 units of the formula.
#[derive(Clone, Debug, PartialEq)]
pub struct ContractFacts {
    /// The operands with the smallest and the largest raw value for which it promises anything.
    pub domain: Vec<(String, (i64, i64))>,
    /// The result outputs, each with the operand by which a highlight multiplies f.
    pub outputs: Vec<(String, Option<String>)>,
    /// The operand that says how many results there are beyond the first, where one does.
    pub length: Option<String>,
    /// Expressions of Python: the values that are right for a highlight's f, or else one for each output.
    pub f: Vec<String>,
    /// The largest error of an output, in its units.
    pub bound: f64,
}

impl ContractFacts {
    /// Extracts the parts of a contract that a program can use: domain, outputs, formulas and bound.
    pub fn new(contract: &dyn Contract) -> Self {
        let operands = contract.operands();
        let colours = operands.iter().filter(|operand| operand.colour);
        let colours = colours.map(|colour| Some(colour.name.clone())).chain(repeat(None));
        let domain = operands.iter();
        Self {
            domain: domain.map(|operand| (operand.name.clone(), operand.domain)).collect(),
            outputs: contract
                .outputs()
                .iter()
                .zip(colours)
                .map(|(output, colour)| (output.name.clone(), colour))
                .collect(),
            length: contract.length().map(str::to_owned),
            // Without a bound there is nothing that results could be held against.
            f: match contract.highlight() {
                _ if !contract.bound().is_stated() => Vec::new(),
                Some(highlight) => highlight.expressions(),
                None => contract.expressions(),
            },
            bound: contract.bound().units,
        }
    }
}

/// A computation as its handshake shows it. The clock in which `start` is taken is number 0. For example, `rough` shows its
/// result in clock 9, and `done` in clock 10.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Computation {
    /// Raw, in the order of [`ContractFacts::domain`].
    pub operands: Vec<i64>,
    /// The outputs in every clock in which `valid` is high.
    pub results: Vec<TimedResult>,
    /// The clock in which `done` is high.
    pub done: u32,
}

impl Computation {
    /// Returns whether the last result comes with `done`.
    pub fn ends_with_result(&self) -> bool {
        let last = self.results.last();
        last.is_some_and(|result| result.clock == self.done)
    }
}

/// A result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedResult {
    /// The clock in which `valid` is high.
    pub clock: u32,
    /// Raw, in the order of [`ContractFacts::outputs`].
    pub outputs: Vec<i64>,
}

/// A number on a port. For example, `cos_gamma` with 20 fraction bits has the raw integer 1044480 and the value 0.99609375.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// The port.
    pub name: String,
    /// The integer that its bits denote.
    pub raw: i128,
    /// `raw · 2^-F`.
    pub value: f64,
}

/// Stimulus and expected outputs, clock by clock.
///
/// The inputs of a clock are applied on the falling edge that begins it; its outputs are those just
/// before the rising edge in its middle, with these inputs applied.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Vectors {
    /// For each clock the bit patterns of all input ports but `clk`, in port order.
    pub inputs: Vec<Vec<u64>>,
    /// For each clock the bit patterns of all output ports, in port order.
    pub expected: Vec<Vec<u64>>,
    /// The first clock from which results and status are compared. Handshake outputs are compared from the
    /// first clock after one with reset.
    pub known_from: usize,
    /// The directed computations notice a fault in every word of the memories if this is 1, in every second word if it is 2, and
    /// so on. 0 if there are no directed computations.
    pub word_stride: usize,
}
