//! Compiles a [`Design`] to a [`CompiledDesign`], a list of instructions that the simulator executes.

use std::collections::{HashMap, HashSet};

use anyhow::{Result, ensure};

use crate::netlist::{Design, Driver, NetId, NetlistRegister, Role};
use crate::sim::banks;
use crate::sim::compiler::Compiler;
use crate::sim::program::{
    CompiledDesign, Instruction, MemoryWrite, ReadEdge, RegisterEdge, Slot, Sources, drop_of,
};
use glint_base::diagnostic::Diagnostics;
use glint_base::fixed::mask;

impl CompiledDesign {
    /// Compiles a design. Fails with the mistakes of [`Design::verify_structure`], or if the ROMs together have 2^32 words or
    /// more.
    pub fn new(design: &Design) -> Result<Self> {
        let mistakes = design.verify_structure();
        ensure!(mistakes.is_empty(), Diagnostics(mistakes));
        let words: usize = design.roms.iter().map(|rom| rom.words.len()).sum();
        ensure!(u32::try_from(words).is_ok(), "the ROMs are too large: {words} words");
        let mut compiler = Compiler::new(design);
        for net in design.levelise().unwrap_or_default() {
            let slot = compiler.net(net);
            compiler.of_net[net.index()] = slot;
        }
        Ok(compiler.finish())
    }
}

impl<'a> Compiler<'a> {
    /// Returns a slot with a field of the control word, the `width` bits from bit `low` of the net `word`. The field becomes a
    /// source of its own, so that a change of another field does not evaluate its readers again. If the control word is a
    /// constant, or no source is left, the field becomes an ordinary slice.
    fn field(&mut self, word: NetId, low: u32, width: u32) -> Slot {
        let a = self.of_net[word.index()];
        if self.known_value(a).is_some() || self.next_field == Sources::BITS {
            return self.slice(word, low, width);
        }
        let (low, drop, source) = (low as u8, drop_of(width), self.next_field as u8);
        self.next_field += 1;
        let to = self.fresh(1 << source);
        let instruction = Instruction::Field { to, a, low, drop, source };
        self.push(to, &[a], instruction);
        to
    }

    /// Compiles a net and returns its slot. The nets on which the net depends within a clock must already have slots.
    fn net(&mut self, id: NetId) -> Slot {
        let design = self.design;
        let width = design.width(id);
        match &design.net(id).driver {
            Driver::Undriven | Driver::Input => self.of_net[id.index()],
            Driver::Constant(bits) => self.constant(bits & mask(width)),
            Driver::Register(register) => self.source(design.register(*register).enable),
            Driver::Rom(rom) => {
                if design.rom(*rom).synchronous {
                    return self.source(design.rom(*rom).enable);
                }
                let address = self.of_net[design.rom(*rom).address.index()];
                let words = self.roms[rom.index()];
                self.emit(&[address], |to| Instruction::Read { to, address, words })
            }
            Driver::Field(field) => {
                let word = design.rom(design.control.rom).data;
                self.field(word, self.fields[field.index()], width)
            }
            Driver::Op(op) => self.op(op, id),
        }
    }

    /// Compiles the clock edge, and orders the instructions.
    fn finish(mut self) -> CompiledDesign {
        let design = self.design;
        let reset = design.port(|role| role == Role::Reset);
        let mut written = HashSet::new();
        let mut reads = Vec::new();
        for (at, rom) in design.roms.iter().enumerate() {
            if rom.synchronous {
                let to = self.of_net[rom.data.index()];
                let address = self.stable(self.of_net[rom.address.index()], &written);
                let enable = self.enable(rom.enable, &written);
                written.insert(to);
                reads.push(ReadEdge {
                    to,
                    source: self.sources[to as usize],
                    address,
                    enable,
                    words: self.roms[at],
                });
            }
        }
        let mut registers = Vec::new();
        for register in self.readers_first() {
            let q = self.of_net[register.q.index()];
            let data = register.data.unwrap_or(register.q);
            let data = self.stable(self.of_net[data.index()], &written);
            let enable = self.enable(register.enable, &written);
            let value = register.reset.map(|bits| bits & mask(design.width(register.q)));
            written.insert(q);
            registers.push(RegisterEdge {
                q,
                source: self.sources[q as usize],
                data,
                enable,
                reset: reset.map(|port| self.of_net[port.net.index()]).zip(value),
            });
        }
        self.drop_unneeded(&reads, &registers);
        // The sources of an operand are among the sources of its result, so that their set, as a number, is not larger. A field
        // has a larger source number than its operands. The sorted order therefore remains an order of evaluation.
        self.steps.sort_by_key(|step| step.sources);
        banks::divide(&self, &reads, &registers)
    }

    /// Returns the memories with a write port.
    pub(super) fn writes(&self) -> Vec<MemoryWrite> {
        let design = self.design;
        let mut writes = Vec::new();
        for (rom, &words) in design.roms.iter().zip(&self.roms) {
            let Some(write) = &rom.write else { continue };
            writes.push(MemoryWrite {
                words,
                enable: write.enable,
                address: write.address,
                parts: write.parts.iter().map(|&part| (part, design.width(part))).collect(),
            });
        }
        writes
    }

    /// Returns each register before the registers that it reads, except in circles. A value that is read before it is overwritten
    /// need not be copied by [`Compiler::stable`].
    fn readers_first(&self) -> Vec<&'a NetlistRegister> {
        let registers = &self.design.registers;
        let mut by_slot: HashMap<Slot, usize> = HashMap::new();
        for (at, register) in registers.iter().enumerate() {
            by_slot.insert(self.of_net[register.q.index()], at);
        }
        // For each register, the other registers that it reads, and the number of its readers.
        let mut read_by: Vec<Vec<usize>> = Vec::new();
        let mut readers = vec![0; registers.len()];
        for (at, register) in registers.iter().enumerate() {
            let mut read = Vec::new();
            for net in register.data.iter().chain(&register.enable) {
                if let Some(&of) = by_slot.get(&self.of_net[net.index()])
                    && of != at
                {
                    readers[of] += 1;
                    read.push(of);
                }
            }
            read_by.push(read);
        }
        let mut ordered = Vec::with_capacity(registers.len());
        let mut placed = vec![false; registers.len()];
        let mut ready: Vec<usize> = (0..registers.len()).filter(|&at| readers[at] == 0).collect();
        while ordered.len() < registers.len() {
            // In a circle, one register is overwritten before registers that read it.
            let next = ready.pop().or_else(|| placed.iter().position(|&placed| !placed));
            let Some(at) = next else { break };
            if placed[at] {
                continue;
            }
            placed[at] = true;
            ordered.push(&registers[at]);
            for &of in &read_by[at] {
                readers[of] -= 1;
                if readers[of] == 0 {
                    ready.push(of);
                }
            }
        }
        ordered
    }

    /// Removes the instructions whose results neither the clock edge nor a named net nor a port needs. Unnamed nets may then have
    /// no slot.
    fn drop_unneeded(&mut self, reads: &[ReadEdge], registers: &[RegisterEdge]) {
        let design = self.design;
        let mut needed = vec![false; self.sources.len()];
        for edge in reads {
            needed[edge.address as usize] = true;
            if let Some(enable) = edge.enable {
                needed[enable as usize] = true;
            }
        }
        for edge in registers {
            needed[edge.data as usize] = true;
            if let Some(enable) = edge.enable {
                needed[enable as usize] = true;
            }
            if let Some((rst_n, _)) = edge.reset {
                needed[rst_n as usize] = true;
            }
        }
        for (id, net) in design.iter() {
            if net.named {
                needed[self.of_net[id.index()] as usize] = true;
            }
        }
        for port in &design.ports {
            needed[self.of_net[port.net.index()] as usize] = true;
        }
        let mut dropped = HashSet::new();
        for step in self.steps.iter().rev() {
            if needed[step.to as usize] {
                for slot in &step.operands {
                    needed[*slot as usize] = true;
                }
            } else {
                dropped.insert(step.to);
            }
        }
        self.steps.retain(|step| needed[step.to as usize]);
        for slot in &mut self.of_net {
            if dropped.contains(slot) {
                *slot = Slot::MAX;
            }
        }
    }

    /// Returns the slot of an enable, or `None` if the enable is absent or always 1. `written` has the slots that the edge has
    /// already written.
    fn enable(&mut self, enable: Option<NetId>, written: &HashSet<Slot>) -> Option<Slot> {
        let slot = self.of_net[enable?.index()];
        if self.known_value(slot) == Some(1) {
            return None;
        }
        Some(self.stable(slot, written))
    }

    /// Returns a slot with the value of `a` from before the edge: a copy if the edge has already written `a`. All registers of a
    /// design change at the same time, but the simulator writes them one after the other.
    fn stable(&mut self, a: Slot, written: &HashSet<Slot>) -> Slot {
        if written.contains(&a) { self.emit(&[a], |to| Instruction::Copy { to, a }) } else { a }
    }
}
