//! Runs the golden model that a [`Frame`] describes, clock by clock: the handshake, the microinstructions and the registers. It
//! also makes variants of a model, with registers behind its results or with buffers in front of its operands.

use std::mem;
use std::sync::Arc;

use super::{Does, Frame, FrameOperand, FrameStep, Next, Slot, State, Value, idle};
use crate::Model;
use glint_base::fixed::mask;

/// The handshake's signals, which precede the device's signals.
const HANDSHAKE: [&str; 5] = ["valid", "busy", "done", "run", "word_address"];

/// The last signal of the handshake of a device whose tables can be written.
const TABLE_READY: &str = "table_ready";

#[derive(Clone)]
pub(super) struct ModelConstants {
    pub(super) program: Vec<FrameStep>,
    pub(super) operands: Vec<FrameOperand>,
    /// The slots of the signals with masks of the signals' widths, the outputs first.
    pub(super) shown: Vec<(Slot, u64)>,
    /// The number of outputs in `shown`.
    pub(super) outputs: usize,
    /// The outputs that are combinational logic.
    pub(super) logic: Vec<(Slot, Value)>,
    pub(super) edges: Vec<Does>,
    /// Pairs of slots: a result that is combinational logic, and the output register that loads it.
    pub(super) taken: Vec<(Slot, Slot)>,
    /// The registers that a strobe loads: the operand registers, or the buffers in front of them.
    written: Vec<Slot>,
    buffered: bool,
    flags: Vec<Slot>,
    handshake: usize,
    pub(super) valid_delay: u32,
    inputs: Vec<String>,
    signals: Vec<String>,
}

/// A golden model that executes microinstructions clock by clock.
///
/// An idle device executes microinstruction 0. After `start`, it executes microinstruction 0 once more and then continues with
/// number 1. A register that a microinstruction loads takes its value at the rising edge that ends the microinstruction, even if
/// `rst_n` is low at that edge.
#[derive(Clone)]
pub struct ClockedModel {
    pub(super) fixed: Arc<ModelConstants>,
    /// Whether a computation is running; this is also the output `busy`.
    run: bool,
    /// The microinstruction that is being executed; 0 when idle.
    address: usize,
    /// Whether the microinstructions of the latest clocks raised `valid`, one bit a clock; bit 0 is the latest clock.
    pulses: u64,
    pub(super) state: Box<State>,
    values: Box<[u64]>,
}

impl Frame {
    /// Returns the golden model after power-up. The first microinstruction of `program` is the idle one; the last must end the
    /// program. Panics if there is no microinstruction.
    pub fn model(mut self, program: impl IntoIterator<Item = FrameStep>) -> ClockedModel {
        let program: Vec<_> = program.into_iter().collect();
        assert!(!program.is_empty(), "a device idles in its first microinstruction");
        // A comparison reports the first signal that differs in a clock, which should be an output that a user of the device
        // sees.
        self.shown.sort_by_key(|shown| !shown.output);
        let mut inputs: Vec<String> = ["rst_n", "start"].map(str::to_owned).into();
        let mut written = Vec::new();
        for operand in &self.operands {
            inputs.push(operand.name.clone());
            inputs.push(format!("{}_write", operand.name));
            written.push(operand.slot);
        }
        let mut signals: Vec<String> = HANDSHAKE.map(str::to_owned).into();
        if self.has_write_port {
            signals.push(TABLE_READY.to_owned());
        }
        let handshake = signals.len();
        let mut shown = Vec::new();
        for signal in &self.shown {
            signals.push(signal.name.clone());
            shown.push((signal.slot, mask(signal.format.width())));
        }
        let fixed = ModelConstants {
            inputs,
            signals,
            shown,
            outputs: self.shown.iter().filter(|it| it.output).count(),
            program,
            written,
            buffered: false,
            operands: self.operands,
            logic: self.logic,
            edges: self.edges,
            taken: Vec::new(),
            flags: self.flags,
            handshake,
            valid_delay: self.valid_delay,
        };
        ClockedModel::at_power_up(fixed, self.slots)
    }
}

impl ModelConstants {
    /// Loads the operand registers, or the buffers in front of them, from `ports`: the data and the strobe of each operand in
    /// turn. Returns whether anything was loaded.
    fn write(&self, state: &mut State, ports: &[u64]) -> bool {
        let mut taken = false;
        let registers = self.operands.iter().zip(&self.written);
        for ((operand, &register), ports) in registers.zip(ports.chunks_exact(2)) {
            if ports[1] & 1 == 1 {
                taken = true;
                state[register] = operand.held(ports[0]);
            }
        }
        taken
    }
}

impl ClockedModel {
    /// Makes a model of `slots` slots, all 0.
    fn at_power_up(fixed: ModelConstants, slots: usize) -> Self {
        let mut model = Self {
            run: false,
            address: 0,
            pulses: 0,
            state: vec![0; slots].into(),
            values: vec![0; fixed.signals.len()].into(),
            fixed: Arc::new(fixed),
        };
        model.settle(false);
        model
    }

    pub fn is_valid(&self) -> bool {
        self.values[0] == 1
    }

    /// Returns a variant with a register behind each output that is combinational logic ([`Model::with_output_registers`]).
    /// Returns `None` if `taking` does.
    pub(crate) fn registered(&self) -> Option<Self> {
        let mut it = ModelConstants::clone(&self.fixed);
        let mut slots = self.state.len();
        for at in 0..it.shown.len() {
            let (slot, mask) = it.shown[at];
            if it.logic.iter().any(|(logic, _)| *logic == slot) {
                let register = Slot(slots);
                slots += 1;
                it.taken.push((slot, register));
                it.shown[at].0 = register;
                it.shown.push((register, mask));
                it.signals.push(format!("{}_reg", it.signals[it.handshake + at]));
            }
        }
        if slots == self.state.len() {
            return Some(self.clone());
        }
        if it.valid_delay > 0 {
            it.valid_delay += 1;
            it.program.last_mut()?.next = Next::Following;
            it.program.push(idle().end());
            it.program.iter_mut().for_each(|it| it.takes_results = true);
        } else {
            it.program = taking(&it.program)?;
        }
        Some(Self::at_power_up(it, slots))
    }

    /// Computes the values of the signals after an edge. `still` states that no register and no output has changed; then only the
    /// handshake is updated.
    #[inline]
    fn settle(&mut self, still: bool) {
        let it = &*self.fixed;
        let here = &it.program[self.address];
        for &flag in &it.flags {
            self.state[flag] = here.asserts.contains(&flag).into();
        }
        let valid = match it.valid_delay {
            0 => here.valid,
            clocks => self.pulses >> (clocks - 1) & 1 == 1,
        };
        let (run, done) = (self.run.into(), self.run && matches!(here.next, Next::End));
        let (first, then) = self.values.split_at_mut(it.handshake);
        let table_ready = (!self.run).into();
        let all = [valid.into(), run, done.into(), run, self.address as u64, table_ready];
        first.copy_from_slice(&all[..it.handshake]);
        if still {
            return;
        }
        for (slot, value) in &it.logic {
            self.state[*slot] = value(&self.state);
        }
        for (value, &(slot, mask)) in then.iter_mut().zip(&it.shown) {
            *value = self.state[slot] as u64 & mask;
        }
    }
}

impl Model for ClockedModel {
    fn inputs(&self) -> &[String] {
        &self.fixed.inputs
    }

    fn signals(&self) -> &[String] {
        &self.fixed.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let (it, state) = (&*self.fixed, &mut self.state);
        let (rst_n, start) = (inputs[0] & 1 == 1, inputs[1] & 1 == 1);
        let here = &it.program[self.address];
        if here.takes_results {
            for &(logic, register) in &it.taken {
                state[register] = state[logic];
            }
        }
        it.edges.iter().for_each(|does| does(state));
        let next = match &here.next {
            Next::RepeatWhile(holds) if holds(state) => self.address,
            Next::SkipIf(count, holds) if holds(state) => self.address + 1 + *count as usize,
            Next::Dispatch(selector, to) => to[state[*selector] as usize],
            Next::End => 0,
            _ => self.address + 1,
        };
        if let Some(does) = &here.does {
            does(state);
        }
        let ends = matches!(here.next, Next::End);
        // With operand buffers, the device also accepts `start` in the last microinstruction.
        let starts = start && (!self.run || ends && it.buffered);
        let mut taken = (it.buffered || !self.run) && it.write(state, &inputs[2..]);
        if it.buffered && starts {
            taken = true;
            for (operand, &buffer) in it.operands.iter().zip(&it.written) {
                state[operand.slot] = state[buffer];
            }
        }
        // Registers and outputs keep their values if nothing loads a register, no operation runs at every edge, and there are no
        // flags.
        let still = here.does.is_none()
            && !(taken || here.takes_results)
            && it.edges.is_empty()
            && it.flags.is_empty();
        self.pulses = if rst_n { self.pulses << 1 | u64::from(here.valid) } else { 0 };
        (self.run, self.address) = match self.run {
            _ if !rst_n => (false, 0),
            false => (start, 0),
            true => (!ends || starts, next),
        };
        self.settle(still);
    }

    fn values(&self) -> &[u64] {
        &self.values
    }

    fn with_output_registers(&self) -> Option<Box<dyn Model>> {
        Some(Box::new(self.registered()?))
    }

    fn clocked(&self) -> Option<&ClockedModel> {
        Some(self)
    }

    fn with_operand_buffers(&self) -> Option<Box<dyn Model>> {
        let mut it = ModelConstants::clone(&self.fixed);
        let mut slots = self.state.len();
        it.buffered = !it.operands.is_empty();
        for (operand, written) in it.operands.iter().zip(&mut it.written) {
            let register = it.shown.iter().find(|(shown, _)| *shown == operand.slot);
            *written = Slot(slots);
            it.shown.push((Slot(slots), register.map_or(0, |(_, mask)| *mask)));
            it.signals.push(format!("{}_buffer", operand.name));
            slots += 1;
        }
        Some(Box::new(Self::at_power_up(it, slots)))
    }
}

/// Returns the program of a device with output registers. Each microinstruction that raised `valid` loads the output registers
/// instead, and an added microinstruction after it raises `valid`. Returns `None` if a microinstruction with `valid` selects its
/// successor by a condition or a dispatch.
fn taking(program: &[FrameStep]) -> Option<Vec<FrameStep>> {
    let mut longer = Vec::new();
    // The number of microinstructions in front of `at`, with the added ones.
    let moved = |at: usize| at + program[..at].iter().filter(|it| it.valid).count();
    for (at, step) in program.iter().enumerate() {
        let mut here = step.clone();
        if let Next::SkipIf(count, _) = &mut here.next {
            let skipped = program.iter().skip(at + 1).take(*count as usize);
            *count += skipped.filter(|it| it.valid).count() as u32;
        }
        if let Next::Dispatch(_, to) = &mut here.next {
            *to = to.iter().map(|&at| moved(at)).collect();
        }
        if !here.valid {
            longer.push(here);
            continue;
        }
        if matches!(here.next, Next::RepeatWhile(_) | Next::SkipIf(..) | Next::Dispatch(..)) {
            return None;
        }
        let next = mem::replace(&mut here.next, Next::Following);
        longer.push(FrameStep { valid: false, takes_results: true, ..here });
        longer.push(FrameStep { next, ..idle().valid() });
    }
    Some(longer)
}
