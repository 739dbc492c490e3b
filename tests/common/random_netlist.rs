//! Makes random designs that keep the rules of a netlist, for tests of the simulator and of the emitted Verilog.

use std::panic::Location;

use glint::cosim;
use glint::fixed::{Format, mask};
use glint::hdl::netlist::{
    Design, Driver, Field, FieldId, FieldKind, Microinstruction, Net, NetId, NetlistRom, Op,
    Partition, Port, RegId, RegisterKind, Role, RomId, Sequence,
};

/// Numbers at random.
pub struct Random(cosim::Random);

impl Random {
    /// A stream of its own for each seed.
    pub fn new(seed: u64) -> Self {
        Self(cosim::Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.0.bits() % bound as u64) as usize
    }

    fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    /// Returns a pattern; often one of the ends.
    pub fn bits(&mut self, width: u32) -> u64 {
        let ends = [0, 1, mask(width), mask(width) >> 1, 1 << (width - 1)];
        if self.chance(30) {
            ends[self.below(ends.len())] & mask(width)
        } else {
            self.0.bits() & mask(width)
        }
    }
}

/// Words of the control ROM; not a power of two.
const WORDS: usize = 6;

/// How large a design is.
#[derive(Clone, Copy)]
pub struct Size {
    /// The most bits of a net that is not a product.
    pub widest: usize,
    /// Registers with feedback.
    pub registers: usize,
    /// Pairs of a select and an enable in the control word.
    pub fields: usize,
}

/// A design that the tools outside go through in an instant.
pub const SMALL: Size = Size { widest: 20, registers: 4, fields: 2 };

/// Returns the design of a seed.
pub fn design(seed: u64, size: Size) -> Design {
    let (random, partition) = (Random::new(seed), Partition::Control);
    let mut build = Build { random, size, design: skeleton(seed), partition };
    build.control();
    build.partition = Partition::Datapath;
    build.datapath();
    build.design.ports.sort_by_key(|port| !port.role.is_input());
    build.design
}

fn skeleton(seed: u64) -> Design {
    let mut design = Design::empty(&format!("random_{seed}"));
    design.about.title = "Random cells − each «meets» every other".to_owned();
    design
}

struct Build {
    random: Random,
    size: Size,
    design: Design,
    partition: Partition,
}

impl Build {
    fn net(&mut self, format: Format, driver: Driver, named: bool) -> NetId {
        let at = self.design.nets.len();
        self.design.add_net(Net {
            block: at.is_multiple_of(5).then_some(at as u16),
            doc: if at.is_multiple_of(3) { format!("net number {at}") } else { String::new() },
            named,
            partition: self.partition,
            ..Net::new(format!("n{at}"), format, driver, Location::caller())
        })
    }

    fn input(&mut self, format: Format, role: Role) -> NetId {
        let id = self.net(format, Driver::Input, true);
        self.design.ports.push(Port { net: id, role });
        id
    }

    fn output(&mut self, source: NetId, role: Role) {
        let format = self.design.net(source).format;
        let net = self.net(format, Driver::Op(Op::Relabel(source)), true);
        self.design.ports.push(Port { net, role });
    }

    fn register(&mut self, format: Format, reset: Option<u64>) -> (RegId, NetId) {
        let id = RegId(self.design.registers.len() as u32);
        let q = self.net(format, Driver::Undriven, true);
        self.design.add_register(q, RegisterKind::Architectural).reset = reset;
        (id, q)
    }

    fn rom(
        &mut self,
        name: &str,
        address: NetId,
        format: Format,
        words: Vec<u64>,
        synchronous: bool,
    ) -> NetId {
        let data = self.net(format, Driver::Undriven, true);
        let doc = vec!["a random word".to_owned()];
        let rom = NetlistRom::new(name, address, data, words, Location::caller());
        self.design.add_rom(NetlistRom { synchronous, doc, ..rom });
        data
    }

    /// An address that counts through the words for ever; two selects and two enables.
    fn control(&mut self) {
        self.input(Format::BIT, Role::Reset);
        self.input(Format::BIT, Role::Start);
        let wide = Format::unsigned(3, 0);
        let (address, q) = self.register(wide, Some(0));
        let (run, running) = self.register(Format::BIT, Some(1));
        let last = self.net(wide, Driver::Constant(WORDS as u64 - 1), false);
        let zero = self.net(wide, Driver::Constant(0), false);
        let one = self.net(wide, Driver::Constant(1), false);
        let at_last = self.net(Format::BIT, Driver::Op(Op::Equal(q, last)), false);
        let sum = Op::Add { a: q, b: one, carry: None };
        let following = self.net(wide, Driver::Op(sum), false);
        let around = Op::Mux { select: at_last, inputs: vec![following, zero] };
        let next = self.net(wide, Driver::Op(around), true);
        self.design.registers[address.index()].data = Some(next);
        self.design.registers[run.index()].data = Some(running);

        let choices = || FieldKind::Select(["a", "b", "c·c", "d"].map(str::to_owned).to_vec());
        let kinds = (0..self.size.fields).flat_map(|_| [(2, choices()), (1, FieldKind::Enable)]);
        let width = 3 * self.size.fields as i32;
        for (at, (width, kind)) in kinds.enumerate() {
            let id = FieldId(at as u32);
            let net = self.net(Format::unsigned(width, 0), Driver::Field(id), true);
            self.design.control.fields.push(Field {
                name: format!("field{at}"),
                net,
                kind,
                lines: Vec::new(),
            });
        }
        let words: Vec<u64> = (0..WORDS).map(|_| self.random.bits(width as u32)).collect();
        let rom = RomId(self.design.roms.len() as u32);
        self.rom("control", q, Format::unsigned(width, 0), words, false);
        let word = |at: usize| Microinstruction {
            name: format!("word {at}"),
            values: Vec::new(),
            sequence: Sequence::Next,
            location: Location::caller(),
        };
        self.design.control.microprogram = (0..WORDS).map(word).collect();
        self.design.control.rom = rom;
        self.design.control.address = address;
        self.design.control.run = run;
    }

    fn datapath(&mut self) {
        for _ in 0..4 {
            let format = self.format(self.size.widest);
            let strobe = self.input(Format::BIT, Role::Strobe);
            self.input(format, Role::Operand { strobe });
        }
        // With feedback: data is chosen when all is there.
        let loops: Vec<_> = (0..self.size.registers)
            .map(|_| {
                let format = self.format(16);
                let reset = self.random.bits(format.width());
                self.register(format, Some(reset))
            })
            .collect();
        for at in 0..40 {
            self.partition =
                if self.random.chance(90) { Partition::Datapath } else { Partition::Control };
            match at {
                10 | 20 => self.memory(at == 20),
                15 | 25 | 35 => {
                    let data = self.any();
                    let format = self.design.net(data).format;
                    let (id, _) = self.register(format, None);
                    self.design.registers[id.index()].data = Some(data);
                }
                _ => self.cell(),
            }
        }
        self.partition = Partition::Datapath;
        for (id, q) in loops {
            let width = self.design.width(q);
            let data = self.of_width(width, None);
            let enable = self.of_width(1, None);
            let register = &mut self.design.registers[id.index()];
            register.data = Some(data);
            register.enable = Some(enable);
        }
        for _ in 0..6 {
            let source = self.any();
            self.output(source, Role::Result);
        }
        let last = NetId(self.design.nets.len() as u32 - 20);
        self.output(last, Role::Result);
    }

    fn format(&mut self, widest: usize) -> Format {
        let width = 1 + self.random.below(widest) as i32;
        let frac = self.random.below(30) as i32 - 10;
        if self.random.chance(50) {
            Format::signed(width - 1 - frac, frac)
        } else {
            Format::unsigned(width - frac, frac)
        }
    }

    /// Some net that is not known beforehand: linters refuse, rightly, to compare with such.
    fn any(&mut self) -> NetId {
        loop {
            // Late nets are chosen more often, so that expressions nest.
            let count = self.design.nets.len();
            let from = if self.random.chance(60) { count.saturating_sub(12) } else { 0 };
            let id = NetId((from + self.random.below(count - from)) as u32);
            if !self.is_constant(id) {
                return id;
            }
        }
    }

    fn is_constant(&self, id: NetId) -> bool {
        match &self.design.net(id).driver {
            Driver::Constant(_) => true,
            Driver::Op(op) => op.operands().iter().all(|operand| self.is_constant(*operand)),
            _ => false,
        }
    }

    /// Returns whether a slice of the net may be known beforehand.
    fn is_partly_constant(&self, id: NetId) -> bool {
        let net = self.design.net(id);
        match &net.driver {
            Driver::Constant(_) => true,
            Driver::Op(Op::Extend(of)) => {
                !self.design.net(*of).format.signed || self.is_partly_constant(*of)
            }
            Driver::Op(op @ (Op::Relabel(_) | Op::Slice { .. } | Op::Concat(_))) => {
                op.operands().iter().any(|operand| self.is_partly_constant(*operand))
            }
            _ => false,
        }
    }

    fn add(&mut self, format: Format, op: Op) -> NetId {
        let named = self.random.chance(25);
        self.net(format, Driver::Op(op), named)
    }

    /// Some net as one of the given width (and signedness), by wiring or a constant.
    fn of_width(&mut self, width: u32, signed: Option<bool>) -> NetId {
        let mut source = self.any();
        while self.design.width(source) > width && self.is_partly_constant(source) {
            source = self.any();
        }
        let from = self.design.net(source).format;
        let signed = signed.unwrap_or(from.signed);
        let format = if signed {
            Format::signed(width as i32 - 1, 0)
        } else {
            Format::unsigned(width as i32, 0)
        };
        if self.random.chance(12) {
            let value = self.random.bits(width);
            let named = self.random.chance(30);
            return self.net(format, Driver::Constant(value), named);
        }
        let resized = match from.width().cmp(&width) {
            std::cmp::Ordering::Less => {
                let extended = if from.signed {
                    Format::signed(width as i32 - 1, 0)
                } else {
                    Format::unsigned(width as i32, 0)
                };
                self.add(extended, Op::Extend(source))
            }
            std::cmp::Ordering::Equal => source,
            std::cmp::Ordering::Greater => {
                let low = self.random.below((from.width() - width) as usize + 1) as u32;
                self.add(Format::unsigned(width as i32, 0), Op::Slice { of: source, low })
            }
        };
        if self.design.net(resized).format.signed == signed {
            resized
        } else {
            self.add(format, Op::Relabel(resized))
        }
    }

    fn cell(&mut self) {
        let format = self.format(self.size.widest);
        let width = format.width();
        let bit = Format::BIT;
        let pair = |build: &mut Self, signed| {
            (build.of_width(width, signed), build.of_width(width, signed))
        };
        match self.random.below(15) {
            0 => {
                let a = self.of_width(width, None);
                self.add(format, Op::Not(a));
            }
            1..=3 => {
                let (a, b) = pair(self, None);
                let op = [Op::And(a, b), Op::Or(a, b), Op::Xor(a, b)][self.random.below(3)].clone();
                self.add(format, op);
            }
            4 | 5 => {
                let (a, b) = pair(self, None);
                let carry = self.random.chance(40).then(|| self.of_width(1, Some(false)));
                self.add(format, Op::Add { a, b, carry });
            }
            6 => {
                let (a, b) = pair(self, None);
                self.add(format, Op::Sub(a, b));
            }
            7 | 8 if width < 64 => {
                let signed = self.random.chance(50);
                let other = 1 + self.random.below((64 - width as usize).min(20)) as u32;
                let a = self.of_width(width, Some(signed));
                let b = self.of_width(other, Some(signed));
                let total = (width + other) as i32;
                let product =
                    if signed { Format::signed(total - 1, 0) } else { Format::unsigned(total, 0) };
                self.add(product, Op::Mul(a, b));
            }
            9 => {
                let (a, b) = pair(self, None);
                self.add(bit, Op::Equal(a, b));
            }
            10 => {
                let signed = Some(self.random.chance(50));
                let (a, b) = pair(self, signed);
                self.add(bit, Op::Less(a, b));
            }
            11 => {
                let a = self.any();
                let op = if self.random.chance(50) { Op::Any(a) } else { Op::All(a) };
                self.add(bit, op);
            }
            12 => {
                let first = 1 + self.random.below(10) as u32;
                let second = 1 + self.random.below(10) as u32;
                let parts = vec![self.of_width(first, None), self.of_width(second, None)];
                self.add(Format::unsigned((first + second) as i32, 0), Op::Concat(parts));
            }
            _ => {
                let count = 2 + self.random.below(3);
                let inputs = (0..count).map(|_| self.of_width(width, None)).collect();
                let select = match (count, self.random.chance(70)) {
                    (2, _) => self.of_width(1, None),
                    (_, true) => {
                        self.design.control.fields[self.random.below(self.size.fields) * 2].net
                    }
                    (_, false) => self.of_width(2, Some(false)),
                };
                self.add(format, Op::Mux { select, inputs });
            }
        }
    }

    fn memory(&mut self, synchronous: bool) {
        let bits = 1 + self.random.below(6) as u32;
        let address = self.of_width(bits, Some(false));
        let format = self.format(40);
        let words = (0..1usize << bits).map(|_| self.random.bits(format.width())).collect();
        let name = if synchronous { "blocks" } else { "logic" };
        self.rom(name, address, format, words, synchronous);
    }
}
