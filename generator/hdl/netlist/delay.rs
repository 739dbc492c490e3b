//! Finds the delay lines of a pipeline, which the Verilog may replace by memories.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::{Design, Driver, NetId, Op, Pipeline, RegId, WritePort};
use glint_base::target::DelayMemory;

/// The registers of a pipeline that carry values from one stage to a later stage, with no reader in between. All values of the
/// line travel between the same two stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DelayLine {
    /// The stage that computes the values.
    pub from: usize,
    /// The stage that reads the values.
    pub to: usize,
    /// Says when the values move to the next stage; `None` if they always move.
    pub enable: Option<NetId>,
    /// The values, in the order of their first registers in the design.
    pub values: Vec<Delayed>,
}

/// A value of a delay line, which passes through one register in each of several stages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Delayed {
    /// The value that enters the delay line, the data input of its first register.
    pub data: NetId,
    /// One register for each stage. Only the last has a reader besides the next register.
    pub registers: Vec<RegId>,
}

impl DelayLine {
    /// Returns the number of words of a memory that replaces the delay line. One more register behind the memory stores the
    /// memory's output: five registers become a memory of four words.
    pub fn words(&self) -> usize {
        self.values[0].passed().len()
    }
}

impl Delayed {
    /// Returns the registers that a memory replaces: all except the last, from which the value is read.
    pub fn passed(&self) -> &[RegId] {
        &self.registers[..self.registers.len() - 1]
    }

    /// Returns the register from which the value is read.
    pub fn last(&self) -> RegId {
        self.registers[self.registers.len() - 1]
    }
}

impl Design {
    /// Returns the delay lines that the Verilog writes as memories, because the target has small memories and a memory takes
    /// fewer look-up tables and registers.
    ///
    /// A memory returns the same value for each point as the registers would, however often the enable stops the pipeline. After
    /// a reset, which drops all points, it begins with its first word again. The side channel stays in registers, because the
    /// proof by induction follows its value from stage to stage. Registers inside a multiplier, and those with another enable
    /// than the first value between the same two stages, stay too.
    pub fn delay_lines(&self) -> Vec<DelayLine> {
        let Some(pipeline) = &self.pipeline else { return Vec::new() };
        let Some(memory) = pipeline.delay_memory else { return Vec::new() };
        let readers = self.readers();
        let next: Vec<Option<usize>> =
            (0..self.registers.len()).map(|at| self.next_of_line(pipeline, &readers, at)).collect();
        let mut lines: BTreeMap<(usize, usize), DelayLine> = BTreeMap::new();
        for (at, register) in self.registers.iter().enumerate() {
            let Some(data) = register.data else { continue };
            if next.contains(&Some(at)) {
                continue;
            }
            // The word of a block memory arrives too late in its clock for a write to a second memory. Its first register
            // therefore stays a register.
            let word = self.is_of_block_memory(data);
            let Some(first) = (if word { next[at] } else { Some(at) }) else { continue };
            let data = if word { register.q } else { data };
            let chain = std::iter::successors(Some(first), |&at| next[at]);
            let registers: Vec<RegId> = chain.map(|at| RegId(at as u32)).collect();
            let last = self.register(registers[registers.len() - 1]).q;
            let to = pipeline.clock_of(last);
            let (from, enable) =
                (pipeline.clock_of(self.register(registers[0]).q) - 1, register.enable);
            let empty = DelayLine { from, to, enable, values: Vec::new() };
            let line = lines.entry((from, to)).or_insert(empty);
            if line.enable == enable {
                line.values.push(Delayed { data, registers });
            }
        }
        let mut lines: Vec<DelayLine> = lines.into_values().collect();
        lines.retain(|line| {
            let bits = line.values.iter().map(|it| self.width(it.data)).sum();
            memory.pays(line.words(), bits)
        });
        self.retain_worthwhile(&mut lines, memory, pipeline.registers_beside_tables);
        lines
    }

    /// Removes the delay lines whose registers are beside look-up tables that are there anyway. `beside_tables` is the number of these
    /// registers. The lines with the most registers for each look-up table of their memory stay.
    fn retain_worthwhile(
        &self,
        lines: &mut Vec<DelayLine>,
        memory: DelayMemory,
        beside_tables: u32,
    ) {
        let bits_of = |line: &DelayLine| -> u32 {
            line.values.iter().map(|value| self.width(value.data)).sum()
        };
        let saved = |line: &DelayLine| bits_of(line) * line.words() as u32;
        let tables = |line: &DelayLine| memory.tables_for(line.words(), bits_of(line));
        let mut left = 0;
        for (at, register) in self.registers.iter().enumerate() {
            // The output register of a multiplier is inside its block.
            if self.multiplier(RegId(at as u32)).is_none() {
                left += self.width(register.q);
            }
        }
        let mut beside_tables = beside_tables;
        let mut best: Vec<&DelayLine> = lines.iter().collect();
        best.sort_by_key(|line| Reverse((saved(line) / tables(line), line.from, line.to)));
        let mut kept: BTreeSet<(usize, usize)> = BTreeSet::new();
        for line in best {
            if left <= beside_tables {
                break;
            }
            kept.insert((line.from, line.to));
            left -= saved(line);
            beside_tables += tables(line);
        }
        lines.retain(|line| kept.contains(&(line.from, line.to)));
    }

    /// Returns the register that follows register `at` in a delay line: its only reader, with the same enable. Neither register
    /// may have a reset or belong to the side channel or to a multiplier.
    fn next_of_line(
        &self,
        pipeline: &Pipeline,
        readers: &[Vec<NetReader>],
        at: usize,
    ) -> Option<usize> {
        let register = &self.registers[at];
        let [NetReader::Register(next)] = readers[register.q.index()][..] else { return None };
        let after = &self.registers[next];
        let is_alike = after.enable == register.enable
            && register.reset.is_none()
            && after.reset.is_none()
            && !pipeline.side_values.contains(&register.q)
            && self.multiplier(RegId(at as u32)).is_none();
        is_alike.then_some(next)
    }

    /// Returns whether a net carries, directly or through wiring, a word of a synchronous ROM.
    fn is_of_block_memory(&self, id: NetId) -> bool {
        match &self.net(id).driver {
            Driver::Rom(rom) => self.roms[rom.index()].synchronous,
            Driver::Op(
                op @ (Op::Slice { .. } | Op::Relabel(_) | Op::Extend(_) | Op::Concat(_)),
            ) => op.operands().into_iter().any(|it| self.is_of_block_memory(it)),
            _ => false,
        }
    }

    fn readers(&self) -> Vec<Vec<NetReader>> {
        let mut readers = vec![Vec::new(); self.nets.len()];
        for (at, register) in self.registers.iter().enumerate() {
            register.data.iter().for_each(|it| readers[it.index()].push(NetReader::Register(at)));
            register.enable.iter().for_each(|it| readers[it.index()].push(NetReader::Other));
        }
        for rom in &self.roms {
            let mut nets = vec![rom.address];
            nets.extend(rom.enable);
            nets.extend(rom.write.iter().flat_map(WritePort::nets));
            nets.iter().for_each(|it| readers[it.index()].push(NetReader::Other));
        }
        for net in &self.nets {
            if let Driver::Op(op) = &net.driver {
                op.operands().iter().for_each(|it| readers[it.index()].push(NetReader::Other));
            }
        }
        for port in &self.ports {
            readers[port.net.index()].push(NetReader::Other);
        }
        readers
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NetReader {
    /// The data input of a register.
    Register(usize),
    /// An enable, a ROM, a cell or a port.
    Other,
}
