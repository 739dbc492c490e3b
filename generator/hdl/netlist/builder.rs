//! Adds nets, registers and ROMs to a design, for the description language and the pipeline builder.

use super::{
    About, Control, Design, Driver, Net, NetId, NetlistRegister, NetlistRom, Partition, RegId,
    RegisterKind, RomId, Topic,
};
use glint_base::diagnostic::SourceLocation;
use glint_base::fixed::Format;

impl Design {
    pub fn empty(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            about: About::default(),
            nets: Vec::new(),
            registers: Vec::new(),
            roms: Vec::new(),
            ports: Vec::new(),
            control: Control::none(),
            pipeline: None,
            functions: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Adds a net, whose name must be unique in the design.
    pub fn add_net(&mut self, net: Net) -> NetId {
        self.nets.push(net);
        NetId(self.nets.len() as u32 - 1)
    }

    /// Makes a new register the driver of the net `q`. The caller must connect its data input.
    pub fn add_register(&mut self, q: NetId, kind: RegisterKind) -> &mut NetlistRegister {
        let at = self.registers.len();
        self.nets[q.index()].driver = Driver::Register(RegId(at as u32));
        self.registers.push(NetlistRegister { q, data: None, enable: None, reset: None, kind });
        &mut self.registers[at]
    }

    /// Adds a ROM and makes it the driver of its data net.
    pub fn add_rom(&mut self, rom: NetlistRom) -> RomId {
        let id = RomId(self.roms.len() as u32);
        self.nets[rom.data.index()].driver = Driver::Rom(id);
        self.roms.push(rom);
        id
    }
}

impl Net {
    /// Makes a named net of the datapath whose interval is the whole range of its format.
    pub fn new(name: String, format: Format, driver: Driver, location: SourceLocation) -> Self {
        Self {
            name,
            format,
            range: format.range(),
            driver,
            block: None,
            doc: String::new(),
            doc_topic: Topic::Device,
            named: true,
            partition: Partition::Datapath,
            location,
        }
    }
}

impl NetlistRom {
    /// Makes a ROM that is read without a clock. `words` are bit patterns, from address 0.
    pub fn new(
        name: &str,
        address: NetId,
        data: NetId,
        words: Vec<u64>,
        location: SourceLocation,
    ) -> Self {
        Self {
            name: name.to_owned(),
            address,
            data,
            synchronous: false,
            enable: None,
            shares: None,
            words,
            write: None,
            doc: Vec::new(),
            comments: Vec::new(),
            block: None,
            location,
        }
    }
}
