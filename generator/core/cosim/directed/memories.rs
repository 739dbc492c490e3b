//! Gives each lane of the built-in simulator its own copy of a design's ROMs, except the control ROM.
//!
//! The search for test computations inverts bits of ROM words, to find out whether the results of a computation change. With a
//! copy for each lane, one simulation tries a different inverted bit in every lane.

use glint_base::fixed::Format;
use glint_rtl::netlist::{Design, Driver, Net, NetId, Op, Port, Role};
use glint_rtl::sim::Machine;

/// The ROMs of a design after each lane got its own copy of them, with the position of each word in the copy of each lane.
pub struct Memories {
    /// Selects the copy that a lane reads. The caller must drive this input with the number of the lane.
    pub lane: NetId,
    /// Each ROM has the number of its first word in the original design and in the design with copies. The third number is the
    /// distance in words from one lane's copy to the next.
    roms: Vec<(u32, usize, usize)>,
}

impl Memories {
    /// Changes a design so that each of `lanes` lanes reads its own copy of the datapath's ROMs. `lanes` must be a power of
    /// two. The lanes share the control ROM.
    pub fn copied(design: &mut Design, lanes: usize) -> Self {
        let lane_bits = lanes.ilog2();
        let lane = add(design, "lane", lane_bits, Driver::Input);
        design.ports.push(Port { net: lane, role: Role::Strobe });
        let mut roms = Vec::new();
        let (mut first, mut first_here) = (0, 0);
        let control: Vec<bool> =
            design.roms.iter().map(|rom| design.is_control_memory(rom)).collect();
        for (at, is_control) in control.into_iter().enumerate() {
            let count = design.roms[at].words.len();
            let mut apart = 0;
            if !is_control {
                let address = design.roms[at].address;
                let bits = design.width(address);
                apart = 1 << bits;
                let both = Driver::Op(Op::Concat(vec![lane, address]));
                let address = add(design, "word_of_lane", bits + lane_bits, both);
                let rom = &mut design.roms[at];
                rom.address = address;
                rom.comments.clear();
                rom.words.resize(apart, 0);
                rom.words = rom.words.repeat(lanes);
            }
            roms.push((first, first_here, apart));
            first += count as u32;
            first_here += design.roms[at].words.len();
        }
        Self { lane, roms }
    }

    /// Inverts the bits in the mask `bits` of one ROM word in the copy of lane `lane`. A second call restores the word. `word`
    /// is the number of the word through all ROMs of the original design.
    pub fn invert<const LANES: usize>(
        &self,
        machine: &mut Machine<LANES>,
        lane: usize,
        word: u32,
        bits: u64,
    ) {
        let after = self.roms.partition_point(|(first, ..)| *first <= word);
        let (first, first_here, apart) = self.roms[after - 1];
        machine.invert(first_here + lane * apart + (word - first) as usize, bits);
    }
}

fn add(design: &mut Design, name: &str, bits: u32, driver: Driver) -> NetId {
    let like = design.net(design.roms[design.control.rom.index()].address);
    let (name, format) =
        (format!("{name}_{}", design.nets.len()), Format::unsigned(bits as i32, 0));
    let net = Net::new(name, format, driver, like.location);
    design.add_net(Net { named: false, ..net })
}
