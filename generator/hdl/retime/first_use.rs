//! Finds, for each net, the first clock of a computation in which its value is used. [`super::operands`] thus knows how many
//! clocks the logic from the operands to the net may take.

use std::collections::{HashSet, VecDeque};

use crate::netlist::{Design, Driver, NetId, Op, passed_on, setting_of};

/// Returns for each net the first clock in which its value reaches an output, the sequencer, or a register that is loaded. The
/// first microinstruction is clock 0; a net that is never used has `usize::MAX`.
///
/// If a microinstruction determines the select of a mux, only the chosen input counts. Outputs, enables and the sequencer use
/// their nets in every clock.
pub fn needed(design: &Design) -> Vec<usize> {
    let mut walk = UseSearch {
        design,
        clocks: clocks_to(design),
        needed: vec![usize::MAX; design.nets.len()],
        seen: HashSet::new(),
    };
    let addresses = 0..design.control.microprogram.len();
    for port in design.outputs() {
        walk.at_once(port.net);
    }
    for register in &design.registers {
        let (Some(data), Some(enable)) = (register.data, register.enable) else { continue };
        walk.at_once(enable);
        for at in addresses.clone() {
            if setting_of(design, &design.control.microprogram[at], enable) != Some(0) {
                walk.from(at, data);
            }
        }
    }
    for rom in design.roms.iter().filter(|rom| rom.synchronous) {
        rom.enable.into_iter().for_each(|enable| walk.at_once(enable));
    }
    // The run flag of the sequencer has no enable.
    if let Some(register) = design.registers.get(design.control.run.index()) {
        register.data.into_iter().for_each(|data| walk.at_once(data));
    }
    walk.needed
}

struct UseSearch<'a> {
    design: &'a Design,
    /// For each microinstruction, the smallest number of clocks after microinstruction 0; `usize::MAX` if it is never executed.
    clocks: Vec<usize>,
    needed: Vec<usize>,
    seen: HashSet<(usize, NetId)>,
}

impl UseSearch<'_> {
    /// Notes a use in every microinstruction.
    fn at_once(&mut self, net: NetId) {
        (0..self.design.control.microprogram.len()).for_each(|at| self.from(at, net));
    }

    /// Notes a use of `net`, and of every net on which it depends, in microinstruction `at`. Registers without an enable and
    /// synchronous ROMs lead to the microinstructions before.
    fn from(&mut self, at: usize, net: NetId) {
        let design = self.design;
        let mut pending = vec![(at, net)];
        while let Some((at, net)) = pending.pop() {
            if !self.seen.insert((at, net)) {
                continue;
            }
            let needed = &mut self.needed[net.index()];
            *needed = self.clocks[at].min(*needed);
            let before = || design.control.predecessors(at, 1).into_iter();
            match &design.net(net).driver {
                Driver::Register(id) if design.register(*id).enable.is_none() => {
                    let data = design.register(*id).data;
                    pending.extend(before().filter_map(|at| Some((at, data?))));
                }
                Driver::Rom(rom) if design.rom(*rom).synchronous => {
                    let address = design.rom(*rom).address;
                    pending.extend(before().map(|at| (at, address)));
                }
                driver => {
                    if let Driver::Op(Op::Mux { select, .. }) = driver {
                        pending.push((at, *select));
                    }
                    let inputs = passed_on(design, &design.control.microprogram[at], net);
                    pending.extend(inputs.into_iter().map(|input| (at, input)));
                }
            }
        }
    }
}

/// Returns the smallest number of clocks from microinstruction 0 to each microinstruction, or `usize::MAX` if no path reaches it.
fn clocks_to(design: &Design) -> Vec<usize> {
    let mut clocks = vec![usize::MAX; design.control.microprogram.len()];
    let mut pending = VecDeque::from([(0, 0)]);
    while let Some((at, after)) = pending.pop_front() {
        if clocks[at] == usize::MAX {
            clocks[at] = after;
            pending.extend(design.control.successors(at).into_iter().map(|to| (to, after + 1)));
        }
    }
    clocks
}
