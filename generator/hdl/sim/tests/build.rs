//! Builds designs net by net, and draws random numbers, for the tests of the simulator.

use std::panic::Location;

use crate::netlist::{
    Control, Design, Driver, Field, FieldId, FieldKind, Microinstruction, Net, NetId,
    NetlistRegister, NetlistRom, Op, Port, RegisterKind, Role, RomId, Sequence,
};
use glint_base::fixed::{Format, mask};

/// A design under construction, with the input port `rst_n`, number 0.
pub struct Build {
    pub design: Design,
    pub rst_n: NetId,
}

impl Build {
    pub fn new() -> Self {
        // Fields are parts of the first ROM.
        let control = Control { rom: RomId(0), ..Control::none() };
        let mut build =
            Self { design: Design { control, ..Design::empty("probe") }, rst_n: NetId(0) };
        build.rst_n = build.input("rst_n", Format::BIT);
        build.design.ports[0].role = Role::Reset;
        build
    }

    #[track_caller]
    pub fn net(&mut self, name: &str, format: Format, driver: Driver) -> NetId {
        self.design.add_net(Net::new(name.to_owned(), format, driver, Location::caller()))
    }

    pub fn input(&mut self, name: &str, format: Format) -> NetId {
        let net = self.net(name, format, Driver::Input);
        let role = Role::Strobe;
        self.design.ports.push(Port { net, role });
        net
    }

    pub fn output(&mut self, net: NetId) {
        let role = Role::Result;
        self.design.ports.push(Port { net, role });
    }

    pub fn op(&mut self, name: &str, format: Format, op: Op) -> NetId {
        self.net(name, format, Driver::Op(op))
    }

    /// The register has no data input yet.
    pub fn register(&mut self, name: &str, format: Format) -> NetId {
        let q = self.net(name, format, Driver::Undriven);
        self.design.add_register(q, RegisterKind::Architectural).q
    }

    pub fn of(&mut self, q: NetId) -> &mut NetlistRegister {
        let register = self.design.registers.iter_mut().find(|r| r.q == q);
        register.expect("a register")
    }

    pub fn rom(
        &mut self,
        name: &str,
        format: Format,
        address: NetId,
        synchronous: bool,
        words: &[u64],
    ) -> NetId {
        let data = self.net(name, format, Driver::Undriven);
        let words = words.iter().map(|word| word & mask(format.width())).collect();
        let rom = NetlistRom::new(&format!("{name}_rom"), address, data, words, Location::caller());
        self.design.add_rom(NetlistRom { synchronous, ..rom });
        data
    }

    /// Adds a field below the existing fields.
    pub fn field(&mut self, name: &str, width: u32) -> NetId {
        let id = FieldId(self.design.control.fields.len() as u32);
        let format = Format::unsigned(width as i32, 0);
        let net = self.net(name, format, Driver::Field(id));
        self.design.control.fields.push(Field {
            name: format!("{name}_field"),
            net,
            kind: FieldKind::Enable,
            lines: Vec::new(),
        });
        net
    }

    pub fn microinstruction(&mut self, name: &str) {
        self.design.control.microprogram.push(Microinstruction {
            name: name.to_owned(),
            values: Vec::new(),
            sequence: Sequence::Next,
            location: Location::caller(),
        });
    }
}

/// The algorithm is Splitmix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }

    pub fn within(&mut self, low: u32, high: u32) -> u32 {
        low + self.below((high - low + 1) as usize) as u32
    }

    /// In more than half of the cases, the pattern is a corner of the range, such as 0 or all ones.
    pub fn pattern(&mut self, width: u32) -> u64 {
        let top = 1 << (width - 1);
        let pattern = match self.below(8) {
            0 => 0,
            1 => u64::MAX,
            2 => top,
            3 => top - 1,
            4 => 1,
            _ => self.bits(),
        };
        pattern & mask(width)
    }

    pub fn format(&mut self, width: u32) -> Format {
        match self.below(2) {
            0 => Format::unsigned(width as i32, 0),
            _ => Format::signed(width as i32 - 1, 0),
        }
    }
}
