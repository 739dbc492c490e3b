//! Defines the facts about a core that manifests and pages state and the netlist does not have. The clocks of a computation, a
//! worked example and the bench's vectors come from simulation. The domain, formulas and bounds come from the contract.

use glint_formula::Comparison;
use glint_golden::Contract;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkedExample {
    /// The operands, in the order of the operand ports.
    pub operands: Vec<Quantity>,
    /// The outputs, in the order of the result ports: of the first result, if the computation has several.
    pub outputs: Vec<Quantity>,
    /// The outputs of every result, the first result first.
    pub results: Vec<Vec<Quantity>>,
}

/// The clock numbers of the handshake for a device that computes a line, as functions of the line's length. The clock that
/// takes `start` is number 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineClocks {
    pub length: String,
    /// The number of the last clock in which `valid` is high.
    pub last_valid: Linear,
    /// The number of the clock in which `done` is high.
    pub done: Linear,
    /// The number of the first clock in which the device takes the next `start`.
    pub next_start: Linear,
}

/// A linear function of the length of a line: `constant + each · length`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Linear {
    /// The value for the length 0, in clocks.
    pub constant: i64,
    /// The increase for each unit of the length, in clocks.
    pub each: i64,
}

impl Linear {
    pub fn at(self, length: i64) -> i64 {
        self.constant + self.each * length
    }

    /// Returns the function as text: `4 + length`, `4 + 2 · length`, or `4` if the length does not matter.
    pub fn text(self, length: &str) -> String {
        match self.each {
            0 => self.constant.to_string(),
            1 => format!("{} + {length}", self.constant),
            each => format!("{} + {each} · {length}", self.constant),
        }
    }
}

/// The contract of a device's results, in a form that an emitted program can use.
#[derive(Clone, Debug, PartialEq)]
pub struct ContractFacts {
    /// The operands, each with the smallest and the largest raw value for which the contract holds.
    pub domain: Vec<(String, (i64, i64))>,
    /// The result outputs, each with the name of the colour operand that belongs to it, if the device is a highlight.
    pub outputs: Vec<(String, Option<String>)>,
    /// The operand that gives the number of results beyond the first, if a computation can have several.
    pub length: Option<String>,
    /// Python expressions of the correct values: the values of `f` for a highlight, or one value for each output of another
    /// device. Empty if the contract states no bound.
    pub f: Vec<String>,
    /// For each output, the comparison under which the error is promised, or `None` for the whole domain. The list is `None`
    /// if the device does not state its promises as comparisons.
    pub conditions: Option<Vec<Option<Comparison>>>,
    /// Whether an output may differ from the formula by a multiple of its range, as [`Contract::wraps`] says.
    pub wraps: bool,
    /// The largest error of each output, in units of its last bit.
    pub bounds: Vec<f64>,
}

impl ContractFacts {
    pub fn new(contract: &dyn Contract) -> Self {
        let mut domain = Vec::new();
        for operand in contract.operands() {
            domain.push((operand.name.clone(), operand.domain));
        }
        // Each output of a highlight belongs to a colour operand, in the same order.
        let mut colours = contract.operands().iter().filter(|operand| operand.colour);
        let mut outputs = Vec::new();
        for output in contract.outputs() {
            let colour = colours.next().map(|colour| colour.name.clone());
            outputs.push((output.name.clone(), colour));
        }
        Self {
            domain,
            outputs,
            length: contract.length().map(str::to_owned),
            // Without a bound, results could not be compared with anything.
            f: match contract.highlight() {
                _ if !contract.bounds().are_stated() => Vec::new(),
                Some(highlight) => highlight.expressions(),
                None => contract.expressions(),
            },
            conditions: contract.conditions(),
            wraps: contract.wraps(),
            bounds: contract.bounds().outputs.iter().map(|bound| bound.units).collect(),
        }
    }
}

/// A computation with its results, as a user of the ports observes it. The clock that takes `start` is number 0. For example,
/// `rough` shows its result in clock 9, and `done` in clock 10.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Computation {
    /// The raw operands, in the order of [`ContractFacts::domain`].
    pub operands: Vec<i64>,
    /// The outputs in every clock in which `valid` is high.
    pub results: Vec<TimedResult>,
    /// The number of the clock in which `done` is high.
    pub done: u32,
}

impl Computation {
    /// Returns whether the last result is shown in the clock of `done`.
    pub fn ends_with_result(&self) -> bool {
        let last = self.results.last();
        last.is_some_and(|result| result.clock == self.done)
    }
}

/// A result of a computation, and the clock in which it is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimedResult {
    /// The number of the clock in which `valid` is high for this result.
    pub clock: u32,
    /// The raw outputs, in the order of [`ContractFacts::outputs`].
    pub outputs: Vec<i64>,
}

/// The value of a port. For example, `cos_gamma` with 20 fraction bits has the raw integer 1044480 and the value 0.99609375.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    pub name: String,
    /// The integer that the bits of the port denote.
    pub raw: i128,
    /// The number that the port represents: `raw · 2^-F` with F fraction bits.
    pub value: f64,
}

/// The inputs and expected outputs of every clock of a test bench.
///
/// The bench applies the inputs of a clock on the falling edge that begins the clock. The bench compares the outputs just
/// before the rising edge in the middle of the clock.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Vectors {
    /// For each clock, the bit patterns of all input ports except `clk`, in the order of the ports.
    pub inputs: Vec<Vec<u64>>,
    /// For each clock, the expected bit patterns of all output ports, in the order of the ports.
    pub expected: Vec<Vec<u64>>,
    /// The index of the first clock in which the bench compares results and status. The bench compares the handshake outputs
    /// from the first clock after a clock with reset.
    pub known_from: usize,
    /// The distance between two ROM words with computations that detect faults. The distance is 2 if every second word has
    /// some, and 0 if the bench has no computations for ROM words.
    pub word_stride: usize,
}
