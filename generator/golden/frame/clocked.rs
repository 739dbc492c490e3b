//! A device that the frame runs, clock by clock.

use std::sync::Arc;

use super::{Datapath, Frame, Microinstruction, Next, Operand, Slot, State};
use crate::base::fixed::mask;
use crate::golden::Model;
use crate::golden::handshake::{After, Handshake};

/// The handshake's own, which stand before the device's.
pub(super) const HANDSHAKE: [&str; 5] = ["valid", "busy", "done", "run", "word_address"];

impl Frame {
    /// The model at power-up. The first microinstruction is the one in which the device idles, the last ends
    /// the program.
    ///
    /// # Panics
    /// If there is no microinstruction.
    pub fn model<D: Datapath>(
        mut self,
        datapath: D,
        program: impl IntoIterator<Item = Microinstruction<D>>,
    ) -> Clocked<D> {
        let program: Vec<_> = program.into_iter().collect();
        assert!(!program.is_empty(), "a device idles in its first microinstruction");
        // Of signals that differ in one clock the first is reported: one that a user of the device sees.
        self.shown.sort_by_key(|shown| !shown.output);
        let signals = self.shown.iter().map(|shown| shown.name.clone()).collect();
        let operands = self.operands.iter();
        let inputs =
            operands.flat_map(|it| [it.name.clone(), format!("{}_write", it.name)]).collect();
        let names = |first: &[&str], then: Vec<String>| {
            first.iter().map(|&name| name.to_owned()).chain(then).collect::<Vec<_>>()
        };
        let is_register =
            |slot: Slot| self.shown.iter().any(|shown| !shown.output && shown.slot == slot);
        let shows_flags = self.shown.iter().any(|shown| self.flags.contains(&shown.slot));
        let logic = (self.shown.iter().enumerate())
            .filter(|(_, it)| it.output && !self.flags.contains(&it.slot) && !is_register(it.slot))
            .map(|(at, _)| at)
            .collect();
        let mut model = Clocked {
            datapath: Arc::new(datapath),
            handshake: Handshake::default(),
            pulses: 0,
            state: State(vec![0; self.slots].into()),
            values: vec![0; HANDSHAKE.len() + self.shown.len()].into(),
            fixed: Arc::new(Fixed {
                inputs: names(&["rst_n", "start"], inputs),
                signals: names(&HANDSHAKE, signals),
                operands: self.operands,
                shown: self
                    .shown
                    .into_iter()
                    .map(|shown| (shown.slot, mask(shown.format.width())))
                    .collect(),
                levels: levels(&program, &self.flags),
                flags: self.flags,
                shows_flags,
                valid_delay: self.valid_delay,
                program,
                logic,
                taken: Vec::new(),
                buffers: Vec::new(),
            }),
        };
        model.settle(false);
        model
    }
}

/// What does not change.
pub(super) struct Fixed<D> {
    pub(super) program: Vec<Microinstruction<D>>,
    pub(super) operands: Vec<Operand>,
    pub(super) shown: Vec<(Slot, u64)>,
    /// Where among these the results are that are logic.
    pub(super) logic: Vec<usize>,
    /// Results with the registers that take them.
    pub(super) taken: Vec<(Slot, Slot)>,
    /// What takes the writes of each operand; empty where the operand registers do.
    pub(super) buffers: Vec<Slot>,
    pub(super) flags: Vec<Slot>,
    /// What each microinstruction makes of them.
    pub(super) levels: Vec<Vec<i64>>,
    /// Some of them are outputs.
    pub(super) shows_flags: bool,
    pub(super) valid_delay: u32,
    pub(super) inputs: Vec<String>,
    pub(super) signals: Vec<String>,
}

/// The levels of flags in each microinstruction.
pub(super) fn levels<D>(program: &[Microinstruction<D>], flags: &[Slot]) -> Vec<Vec<i64>> {
    let level = |it: &Microinstruction<D>, flag| i64::from(it.asserts.contains(flag));
    program.iter().map(|it| flags.iter().map(|flag| level(it, flag)).collect()).collect()
}

/// A device, clock by clock.
pub struct Clocked<D> {
    pub(super) datapath: Arc<D>,
    pub(super) fixed: Arc<Fixed<D>>,
    pub(super) handshake: Handshake,
    /// Whether the microinstructions of the latest clocks said `valid`, the latest in bit 0.
    pub(super) pulses: u64,
    pub(super) state: State,
    pub(super) values: Box<[u64]>,
}

impl<D> Clone for Clocked<D> {
    fn clone(&self) -> Self {
        Self {
            datapath: self.datapath.clone(),
            fixed: self.fixed.clone(),
            handshake: self.handshake,
            pulses: self.pulses,
            state: self.state.clone(),
            values: self.values.clone(),
        }
    }
}

impl<D: Datapath> Clocked<D> {
    /// Whether `valid` is high.
    pub fn is_valid(&self) -> bool {
        self.values[0] == 1
    }

    /// What is shown of the state, of which nothing that is shown has changed if it is `still`.
    #[inline]
    pub(super) fn settle(&mut self, still: bool) {
        let it = &*self.fixed;
        let Handshake { run, address } = self.handshake;
        let here = &it.program[address as usize];
        let state = &mut *self.state.0;
        for (flag, &level) in it.flags.iter().zip(&it.levels[address as usize]) {
            state[flag.0] = level;
        }
        let valid = match it.valid_delay {
            0 => here.valid,
            clocks => self.pulses >> (clocks - 1) & 1 == 1,
        };
        let done = run && matches!(here.next, Next::End);
        let handshake = [valid.into(), run.into(), done.into(), run.into(), address.into()];
        let (first, then) = self.values.split_at_mut(HANDSHAKE.len());
        first.copy_from_slice(&handshake);
        if still {
            return;
        }
        self.datapath.outputs(&mut self.state);
        let state = &*self.state.0;
        for (value, (slot, mask)) in then.iter_mut().zip(&it.shown) {
            *value = state[slot.0] as u64 & mask;
        }
    }
}

impl<D: Datapath> Model for Clocked<D> {
    fn inputs(&self) -> &[String] {
        &self.fixed.inputs
    }

    fn signals(&self) -> &[String] {
        &self.fixed.signals
    }

    fn clock(&mut self, inputs: &[u64]) {
        let it = &*self.fixed;
        let (rst_n, start) = (inputs[0] & 1 == 1, inputs[1] & 1 == 1);
        let here = &it.program[self.handshake.address as usize];
        let datapath = &*self.datapath;
        if here.takes_results {
            for &(logic, register) in &it.taken {
                self.state[register] = self.state[logic];
            }
        }
        datapath.edge(&mut self.state);
        let after = match here.next {
            Next::Following => After::Next,
            Next::RepeatWhile(condition) if condition(datapath, &self.state) => After::Again,
            Next::SkipIf(count, condition) if condition(datapath, &self.state) => {
                After::To(self.handshake.address + 1 + count)
            }
            Next::RepeatWhile(_) | Next::SkipIf(..) => After::Next,
            Next::End if start && !it.buffers.is_empty() => After::Restart,
            Next::End => After::End,
        };
        (here.does)(datapath, &mut self.state);
        let mut still = here.idle && !here.takes_results && D::LOADS_ALONE && !it.shows_flags;
        if !it.buffers.is_empty() {
            let ends = matches!(here.next, Next::End);
            let starts = start && (ends || !self.handshake.run);
            still &= !it.write_buffers(&mut self.state, &inputs[2..], starts);
        } else if !self.handshake.run {
            for (operand, ports) in it.operands.iter().zip(inputs[2..].chunks_exact(2)) {
                if ports[1] & 1 == 1 {
                    still = false;
                    self.state[operand.slot] = operand.held(ports[0]);
                }
            }
        }
        self.pulses = if rst_n { self.pulses << 1 | u64::from(here.valid) } else { 0 };
        self.handshake.clock(rst_n, start, after);
        self.settle(still);
    }

    fn values(&self) -> &[u64] {
        &self.values
    }

    fn with_output_registers(&self) -> Option<Box<dyn Model>> {
        let model: Self = Self::with_output_registers(self)?;
        Some(Box::new(model))
    }

    fn with_operand_buffers(&self) -> Option<Box<dyn Model>> {
        Some(Box::new(Self::with_operand_buffers(self)))
    }
}
