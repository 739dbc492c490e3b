//! Makes a mutant: a copy of a netlist with one fault. It can be simulated and emitted like any netlist.

use std::borrow::Cow;

use super::fault::{BitChange, NetlistFault, Site};
use glint_rtl::netlist::microcode;
use glint_rtl::netlist::{Design, Driver, Net, NetId, Op, RegId, RomId};

impl NetlistFault {
    /// Returns a copy of `design` with this fault. Its nets keep the intervals of the fault-free design, which their values in
    /// the copy may leave.
    pub fn planted(&self, design: &Design) -> Design {
        let mut mutant = design.clone();
        match &self.site {
            Site::Bit(net, bit, how) => plant_bit(&mut mutant, *net, *bit, *how),
            Site::Driver(net, driver) => mutant.nets[net.index()].driver = driver.clone(),
            Site::Enable(register, true) => mutant.registers[register.index()].enable = None,
            Site::Enable(register, false) => never(&mut mutant, *register),
            Site::Reset(register) => mutant.registers[register.index()].reset = None,
            Site::Words(rom, words) => plant_words(&mut mutant, *rom, words),
        }
        mutant
    }
}

/// Drops the comments on nets and ROMs, so a copy for each fault is cheap.
pub(super) fn bare(design: &Design) -> Design {
    let mut bare = design.clone();
    for rom in &mut bare.roms {
        rom.doc.clear();
        rom.comments.clear();
    }
    for net in &mut bare.nets {
        net.doc.clear();
    }
    bare
}

/// Adds a net with the format of `like` and a name with `suffix`. For example, the suffix `sound` gives `product_sound` for the
/// net `product`, and `product_sound_` if that name is taken.
fn add(design: &mut Design, like: NetId, suffix: &str, driver: Driver) -> NetId {
    let mut name = Cow::from(format!("{}_{suffix}", design.net(like).name));
    while design.find(&name).is_some() {
        name.to_mut().push('_');
    }
    let (name, doc) = (name.into_owned(), String::new());
    let like = design.net(like).clone();
    design.add_net(Net { name, driver, block: None, doc, named: false, ..like })
}

/// Returns the driver of a net with the value of `sound` and the fault `how` in bit number `bit`. For example, a bit stuck at 1
/// is an OR with a constant.
fn at_fault(design: &mut Design, sound: NetId, bit: u32, how: BitChange) -> Driver {
    let ones = match how {
        BitChange::Stuck0 => glint_base::fixed::mask(design.width(sound)) & !(1 << bit),
        BitChange::Stuck1 | BitChange::Inverted => 1 << bit,
    };
    let ones = add(design, sound, "fault", Driver::Constant(ones));
    Driver::Op(match how {
        BitChange::Stuck0 => Op::And(sound, ones),
        BitChange::Stuck1 => Op::Or(sound, ones),
        BitChange::Inverted => Op::Xor(sound, ones),
    })
}

fn plant_bit(design: &mut Design, net: NetId, bit: u32, how: BitChange) {
    match design.net(net).driver.clone() {
        // The checks compare the register's output, so the fault is in the value that the register takes.
        Driver::Register(id) => {
            if let Some(data) = design.register(id).data {
                let driver = at_fault(design, data, bit, how);
                let data = add(design, net, "taken", driver);
                let register = &mut design.registers[id.index()];
                register.data = Some(data);
                register.reset = register.reset.map(|reset| how.applied(reset, bit));
            }
        }
        // The environment drives the port, so the fault is in the value that the design reads from the port.
        Driver::Input => {
            let driver = at_fault(design, net, bit, how);
            let read = add(design, net, "read", driver);
            let skip = [read];
            redirect(design, net, read, &skip);
        }
        // For any other driver, all readers of the net read the faulty value.
        driver => {
            let sound = add(design, net, "sound", driver.clone());
            match driver {
                Driver::Rom(rom) => design.roms[rom.index()].data = sound,
                Driver::Field(field) => design.control.fields[field.index()].net = sound,
                _ => {}
            }
            let driver = at_fault(design, sound, bit, how);
            design.nets[net.index()].driver = driver;
        }
    }
}

/// Makes all readers of the net `from` read the net `to`, except the cells that drive the nets in `except`.
fn redirect(design: &mut Design, from: NetId, to: NetId, except: &[NetId]) {
    let redirect = |net: &mut NetId| {
        if *net == from {
            *net = to;
        }
    };
    for (at, net) in design.nets.iter_mut().enumerate() {
        if let Driver::Op(op) = &mut net.driver
            && !except.contains(&NetId(at as u32))
        {
            *op = op.map(|&net| if net == from { to } else { net });
        }
    }
    for register in &mut design.registers {
        register.data.as_mut().map(redirect);
        register.enable.as_mut().map(redirect);
    }
    for rom in &mut design.roms {
        redirect(&mut rom.address);
        rom.enable.as_mut().map(redirect);
        if let Some(write) = &mut rom.write {
            redirect(&mut write.enable);
            redirect(&mut write.address);
            write.parts.iter_mut().for_each(redirect);
        }
    }
}

fn never(design: &mut Design, id: RegId) {
    let register = &mut design.registers[id.index()];
    register.data = Some(register.q);
}

/// Replaces `words` of a ROM, each given with its address. For the control ROM, the microinstructions also change.
fn plant_words(design: &mut Design, id: RomId, words: &[(usize, u64)]) {
    for &(at, word) in words {
        design.roms[id.index()].words[at] = word;
    }
    if id == design.control.rom {
        let fields = design.control.fields.iter();
        let widths: Vec<u32> = fields.map(|field| design.width(field.net)).collect();
        for &(at, word) in words {
            design.control.microprogram[at].values = microcode::unpack(&widths, word);
        }
    }
}
