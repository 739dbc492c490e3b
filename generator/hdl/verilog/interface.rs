//! Finds the ports and the ROMs of the control unit and of the datapath, and the bits that nothing in a unit reads.

use super::plan::{NetForm, Plan};
use crate::netlist::{Driver, NetId, Partition, RomId};
use glint_base::fixed::mask;

/// The signals that cross the boundary of a partition.
pub struct Interface {
    /// Something in it changes on the clock.
    pub clocked: bool,
    /// Nets driven elsewhere: ports of the top module in their order, then nets of the other unit.
    pub inputs: Vec<NetId>,
    /// Nets driven here: ports of the top module in their order, then nets for the other unit.
    pub outputs: Vec<NetId>,
    /// Its ROMs.
    pub roms: Vec<RomId>,
}

impl Interface {
    /// Makes the interface of one of the units.
    pub fn new(plan: &Plan, partition: Partition) -> Self {
        let design = plan.design;
        let other = match partition {
            Partition::Control => Partition::Datapath,
            Partition::Datapath => Partition::Control,
        };
        let reads = |partition: Partition, net: NetId| plan.reads.contains_key(&(partition, net));
        let declared =
            |net: &NetId| plan.forms[net.index()] == NetForm::Declared && !plan.is_input(*net);
        let nets_read = |by: Partition, of: Partition| {
            let ids = (0..design.nets.len() as u32).map(NetId);
            ids.filter(declared).filter(move |net| plan.partition(*net) == of && reads(by, *net))
        };
        // An input that nothing reads still has to end somewhere: in its own unit.
        let inputs = design.inputs().map(|port| port.net).filter(|net| {
            reads(partition, *net) || (plan.partition(*net) == partition && !reads(other, *net))
        });
        let outputs =
            design.outputs().map(|port| port.net).filter(|net| plan.partition(*net) == partition);
        let roms = (0..design.roms.len() as u32).map(RomId);
        let roms = roms.filter(|rom| plan.partition(design.rom(*rom).data) == partition);
        let roms: Vec<RomId> = roms.collect();
        let registers = design.registers.iter().any(|it| plan.partition(it.q) == partition);
        Self {
            clocked: registers || roms.iter().any(|rom| design.rom(*rom).synchronous),
            inputs: inputs.chain(nets_read(partition, other)).collect(),
            outputs: outputs
                .chain(nets_read(other, partition).filter(|net| !plan.is_port(*net)))
                .collect(),
            roms,
        }
    }
}

/// Returns the nets and the bits of them that are there in a partition and that nothing in it needs, as ranges
/// `(net, low, width)`.
pub fn unread(plan: &Plan, partition: Partition, interface: &Interface) -> Vec<(NetId, u32, u32)> {
    let design = plan.design;
    let here = plan.live.iter().copied().filter(|net| {
        plan.partition(*net) == partition
            && plan.forms[net.index()] == NetForm::Declared
            && design.net(*net).driver != Driver::Input
            && !interface.outputs.contains(net)
    });
    let mut nets: Vec<_> = interface.inputs.iter().copied().chain(here).collect();
    nets.sort_unstable();
    let mut ranges = Vec::new();
    for net in nets {
        let width = design.width(net);
        let read = plan.reads.get(&(partition, net)).copied().unwrap_or(0);
        let mut rest = !read & mask(width);
        while rest != 0 {
            let low = rest.trailing_zeros();
            let count = (rest >> low).trailing_ones();
            ranges.push((net, low, count));
            rest &= !(mask(count) << low);
        }
    }
    ranges
}
