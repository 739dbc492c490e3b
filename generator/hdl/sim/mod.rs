//! The built-in simulator: runs many independent instances of a design clock by clock, and writes waveforms.
//!
//! The compiler turns a [`Design`] into a [`CompiledDesign`], a list of instructions in evaluation order. A [`Machine`]
//! executes the list for several instances at once, called lanes. A [`Circuit`] wraps the machine as one block of the
//! simulation kernel rust_hdl, which writes waveforms, and a [`Simulator`] adds the clock.

mod banks;
mod circuit;
mod compile;
mod compiler;
mod lower;
mod machine;
mod program;
mod slots;
#[cfg(test)]
mod tests;
mod vcd;
pub mod views;
mod wire;
mod word;

use std::io::Write;
use std::mem;

use anyhow::{Result, ensure};
use rust_hdl::core::simulate::simulate;

use crate::netlist::{Design, NetId};

pub use circuit::Circuit;
pub use machine::Machine;
pub use program::CompiledDesign;
pub use vcd::VcdWriter;

/// Half a clock in picoseconds, for waveforms.
const HALF_CLOCK: u64 = 5_000;

/// Two updates of rust_hdl are enough: the change itself, and an update that changes nothing.
const UPDATES: usize = 4;

/// `LANES` independent instances of a design, clocked by rust_hdl.
///
/// ```
/// # fn example(design: &glint_rtl::netlist::Design) -> anyhow::Result<()> {
/// let mut simulator: glint_rtl::sim::Simulator = glint_rtl::sim::Simulator::new(design)?;
/// let rst_n = simulator.input("rst_n").expect("a reset");
/// simulator.clock()?;
/// simulator.set(rst_n, 1);
/// simulator.clock()?;
/// let busy = design.find("busy").expect("an output");
/// assert_eq!(simulator.value(busy), 0);
/// # Ok(())
/// # }
/// ```
pub struct Simulator<const LANES: usize = 1> {
    circuit: Circuit<LANES>,
    name: String,
    inputs: Vec<String>,
    trace: Option<VcdWriter<Box<dyn Write + Send>>>,
    /// The simulated time, in picoseconds.
    time: u64,
}

impl<const LANES: usize> Simulator<LANES> {
    /// Makes a simulator at power-up: all inputs, registers and outputs of synchronous ROMs are 0. Fails if the design has
    /// mistakes in its structure, or too many ROM words.
    pub fn new(design: &Design) -> Result<Self> {
        Ok(Self {
            circuit: Circuit::new(design)?,
            name: design.name.clone(),
            inputs: design.inputs().map(|port| design.net(port.net).name.clone()).collect(),
            trace: None,
            time: 0,
        })
    }

    /// Returns the position of the input port `name` among [`Design::inputs`].
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| input == name)
    }

    /// Returns the names of the input ports by position.
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// Sets the input port at position `input` in every lane for the next clock. Bits beyond the width of the port are ignored.
    /// Panics if no input port has this position.
    pub fn set_lanes(&mut self, input: usize, lanes: [u64; LANES]) {
        self.circuit.inputs_mut()[input] = lanes;
    }

    /// Returns the values of all input ports by position, for a caller that sets many.
    pub fn inputs_mut(&mut self) -> &mut [[u64; LANES]] {
        self.circuit.inputs_mut()
    }

    /// Returns the bit pattern of a net in each lane, after the latest clock. Panics for an unnamed net that was optimised
    /// away.
    pub fn lanes(&self, net: NetId) -> [u64; LANES] {
        self.circuit.machine.lanes(net)
    }

    /// Returns the bit pattern of a net in one lane, after the latest clock. Panics for an unnamed net that was optimised away.
    pub fn lane(&self, net: NetId, lane: usize) -> u64 {
        self.circuit.machine.lane(net, lane)
    }

    /// Compares nets with expected values, as [`Machine::differences`] does.
    pub fn differences(
        &self,
        nets: &[NetId],
        expected: &[[u64; LANES]],
        known: Option<&[[u64; LANES]]>,
    ) -> [u64; LANES] {
        self.circuit.machine.differences(nets, expected, known)
    }

    /// Runs one clock: the falling edge, with which inputs change, and then the rising edge, at which registers load.
    ///
    /// # Errors
    /// Fails if the waveform cannot be written, or if the circuit still changes after all updates, which would be a bug.
    #[inline]
    pub fn clock(&mut self) -> Result<()> {
        self.half(false)?;
        self.half(true)
    }

    /// Runs one clock in which the input ports, by position, have the bit patterns `inputs`, without a copy. From the next
    /// clock on, the inputs have their earlier values again. Fails if the waveform cannot be written, or if signals do not
    /// settle. Panics unless `inputs` has exactly one entry for each input port.
    #[inline]
    pub fn clock_with(&mut self, inputs: &mut Vec<[u64; LANES]>) -> Result<()> {
        assert_eq!(inputs.len(), self.inputs.len(), "one for each input port");
        mem::swap(self.circuit.inputs_mut(), inputs);
        let clocked = self.clock();
        mem::swap(self.circuit.inputs_mut(), inputs);
        clocked
    }

    /// Evaluates all nets for inputs that were set since the last clock, without a rising edge. The next clock does not depend
    /// on this call. Fails if the waveform cannot be written, or if signals do not settle.
    pub fn settle(&mut self) -> Result<()> {
        self.half(false)
    }

    #[inline]
    fn half(&mut self, level: bool) -> Result<()> {
        self.circuit.clock.next = level.into();
        ensure!(
            simulate(&mut self.circuit, UPDATES),
            "the signals of `{}` do not settle within a clock",
            self.name
        );
        match &mut self.trace {
            None => Ok(()),
            Some(trace) => {
                self.time += HALF_CLOCK;
                trace.step(self.time, &self.circuit)
            }
        }
    }

    /// Writes the waveform of lane 0 from this call on, as VCD. A clock takes 10 ns, and the waveform starts at time 0. An
    /// earlier waveform that the caller has not ended is replaced. Fails if the file cannot be written.
    pub fn trace(&mut self, file: impl Write + Send + 'static) -> Result<()> {
        self.time = 0;
        let file: Box<dyn Write + Send> = Box::new(file);
        self.trace = Some(VcdWriter::new(file, &self.name, self.time, &self.circuit)?);
        Ok(())
    }

    /// Ends the waveform, if one is being written, and flushes the file. Fails if the file cannot be written.
    pub fn end_trace(&mut self) -> Result<()> {
        if let Some(trace) = self.trace.take() {
            trace.finish(self.time + HALF_CLOCK)?;
        }
        Ok(())
    }
}

impl Simulator {
    /// Sets an input port for the next clock, as [`Simulator::set_lanes`] does.
    #[inline]
    pub fn set(&mut self, input: usize, bits: u64) {
        self.set_lanes(input, [bits]);
    }

    /// Returns the bit pattern of a net after the latest clock. Panics for an unnamed net that was optimised away.
    #[inline]
    pub fn value(&self, net: NetId) -> u64 {
        self.lane(net, 0)
    }
}
