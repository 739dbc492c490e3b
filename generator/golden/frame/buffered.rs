//! The same device with a buffer in front of each operand register (`operands.buffered`).

use std::sync::Arc;

use super::clocked::Fixed;
use super::{Clocked, Datapath, Slot, State};

impl<D: Datapath> Clocked<D> {
    /// It at power-up.
    pub(super) fn with_operand_buffers(&self) -> Self {
        let it = &*self.fixed;
        let (mut shown, mut signals) = (it.shown.clone(), it.signals.clone());
        let mut buffers = Vec::new();
        let first = self.state.0.len();
        for (at, operand) in it.operands.iter().enumerate() {
            let slot = Slot(first + at);
            let register = it.shown.iter().find(|(shown, _)| *shown == operand.slot);
            let mask = register.map_or(0, |(_, mask)| *mask);
            buffers.push(slot);
            shown.push((slot, mask));
            signals.push(format!("{}_buffer", operand.name));
        }
        let fixed = Fixed {
            buffers,
            shown,
            signals,
            program: it.program.clone(),
            operands: it.operands.clone(),
            logic: it.logic.clone(),
            taken: it.taken.clone(),
            flags: it.flags.clone(),
            levels: it.levels.clone(),
            shows_flags: it.shows_flags,
            valid_delay: it.valid_delay,
            inputs: it.inputs.clone(),
        };
        self.at_power_up(fixed, first + it.operands.len())
    }

    /// The same datapath with so many slots, all 0.
    pub(super) fn at_power_up(&self, fixed: Fixed<D>, slots: usize) -> Self {
        let mut model = Self {
            datapath: self.datapath.clone(),
            handshake: self.handshake,
            pulses: 0,
            state: State(vec![0; slots].into()),
            values: vec![0; fixed.signals.len()].into(),
            fixed: Arc::new(fixed),
        };
        model.settle(false);
        model
    }
}

impl<D> Fixed<D> {
    /// What the buffers take of data and strobes, and at a start the operand registers of the buffers. Whether there was
    /// anything to take.
    pub(super) fn write_buffers(&self, state: &mut State, ports: &[u64], starts: bool) -> bool {
        let mut taken = starts;
        let buffers = self.operands.iter().zip(&self.buffers);
        for ((operand, &buffer), ports) in buffers.zip(ports.chunks_exact(2)) {
            if ports[1] & 1 == 1 {
                taken = true;
                state[buffer] = operand.held(ports[0]);
            }
            if starts {
                state[operand.slot] = state[buffer];
            }
        }
        taken
    }
}
