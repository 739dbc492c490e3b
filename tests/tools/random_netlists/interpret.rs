//! What a netlist means, cell by cell, on whole numbers.

use glint::fixed::mask;
use glint::hdl::netlist::{Design, Driver, NetId, Op, Role};

/// A design with its state.
pub struct Machine<'a> {
    design: &'a Design,
    order: Vec<NetId>,
    bits: Vec<u64>,
}

impl<'a> Machine<'a> {
    /// All state 0.
    pub fn new(design: &'a Design) -> Self {
        Self {
            design,
            order: design.levelise().expect("no loop"),
            bits: vec![0; design.nets.len()],
        }
    }

    /// The outputs with these inputs applied.
    pub fn outputs(&mut self, inputs: &[u64]) -> Vec<u64> {
        for (port, value) in self.design.inputs().zip(inputs) {
            self.bits[port.net.index()] = *value;
        }
        for &id in &self.order {
            let value = match &self.design.net(id).driver {
                Driver::Constant(value) => *value,
                Driver::Field(field) => {
                    let word = self.of(self.design.rom(self.design.control.rom).data);
                    word >> self.design.field_positions()[field.index()]
                }
                Driver::Rom(rom) if !self.design.rom(*rom).synchronous => self.word(*rom),
                Driver::Op(op) => self.cell(id, op),
                _ => continue,
            };
            self.bits[id.index()] = value & mask(self.design.width(id));
        }
        self.design.outputs().map(|port| self.of(port.net)).collect()
    }

    /// The rising edge.
    pub fn edge(&mut self) {
        let reset = self.design.port(|role| role == Role::Reset).expect("a reset").net;
        let reset = self.of(reset) == 0;
        let mut next = Vec::new();
        for register in &self.design.registers {
            match register.reset {
                Some(value) if reset => next.push((register.q, value)),
                _ if register.enable.is_none_or(|enable| self.of(enable) == 1) => {
                    next.push((register.q, self.of(register.data.expect("data"))));
                }
                _ => {}
            }
        }
        for (at, rom) in self.design.roms.iter().enumerate() {
            if rom.synchronous {
                next.push((rom.data, self.word(glint::hdl::netlist::RomId(at as u32))));
            }
        }
        for (net, value) in next {
            self.bits[net.index()] = value;
        }
    }

    fn of(&self, net: NetId) -> u64 {
        self.bits[net.index()]
    }

    fn raw(&self, net: NetId) -> i128 {
        self.design.net(net).format.raw(self.of(net))
    }

    fn word(&self, rom: glint::hdl::netlist::RomId) -> u64 {
        let rom = self.design.rom(rom);
        rom.words[self.of(rom.address) as usize]
    }

    fn cell(&self, id: NetId, op: &Op) -> u64 {
        let width = |net: &NetId| self.design.width(*net);
        match op {
            Op::Relabel(a) => self.of(*a),
            Op::Extend(a) => self.raw(*a) as u64,
            Op::Slice { of, low } => self.of(*of) >> low,
            Op::Concat(parts) => parts
                .iter()
                .fold(0u128, |all, part| all << width(part) | u128::from(self.of(*part)))
                as u64,
            Op::Not(a) => !self.of(*a),
            Op::And(a, b) => self.of(*a) & self.of(*b),
            Op::Or(a, b) => self.of(*a) | self.of(*b),
            Op::Xor(a, b) => self.of(*a) ^ self.of(*b),
            Op::Add { a, b, carry } => {
                let carry = carry.map_or(0, |carry| self.of(carry));
                self.of(*a).wrapping_add(self.of(*b)).wrapping_add(carry)
            }
            Op::Sub(a, b) => self.of(*a).wrapping_sub(self.of(*b)),
            Op::Mul(a, b) => {
                assert_eq!(width(a) + width(b), self.design.width(id));
                (self.raw(*a) * self.raw(*b)) as u64
            }
            Op::Equal(a, b) => u64::from(self.of(*a) == self.of(*b)),
            Op::Less(a, b) => u64::from(self.raw(*a) < self.raw(*b)),
            Op::Any(a) => u64::from(self.of(*a) != 0),
            Op::All(a) => u64::from(self.of(*a) == mask(width(a))),
            Op::Mux { select, inputs } => {
                let at = (self.of(*select) as usize).min(inputs.len() - 1);
                self.of(inputs[at])
            }
        }
    }
}
