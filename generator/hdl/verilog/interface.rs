//! Finds the ports and the ROMs of the two modules, control unit and datapath, and the bits that no logic in a module reads.

use super::plan::{NetForm, Plan};
use crate::netlist::{Driver, NetId, Partition, RomId};
use glint_base::fixed::mask;

/// The ports and ROMs of the control unit's or the datapath's module. All nets of a pipeline belong to the datapath.
pub struct Interface {
    /// Whether a register or a synchronous ROM needs the input `clk`.
    pub clocked: bool,
    /// Ports of the top module in their order, followed by nets from the other module.
    pub inputs: Vec<NetId>,
    /// Ports of the top module in their order, followed by nets for the other module.
    pub outputs: Vec<NetId>,
    pub roms: Vec<RomId>,
}

impl Interface {
    pub fn new(plan: &Plan, partition: Partition) -> Self {
        let design = plan.design;
        let other = match partition {
            Partition::Control => Partition::Datapath,
            Partition::Datapath => Partition::Control,
        };
        let mut inputs = Vec::new();
        for port in design.inputs() {
            // An input that no module reads still must be connected, to the module to which it belongs.
            let ends_here =
                plan.partition(port.net) == partition && !is_read(plan, other, port.net);
            if is_read(plan, partition, port.net) || ends_here {
                inputs.push(port.net);
            }
        }
        inputs.extend(crossing(plan, other, partition));
        let mut outputs = Vec::new();
        for port in design.outputs() {
            if plan.partition(port.net) == partition {
                outputs.push(port.net);
            }
        }
        for net in crossing(plan, partition, other) {
            if !plan.is_port(net) {
                outputs.push(net);
            }
        }
        let mut clocked = design.registers.iter().any(|it| plan.partition(it.q) == partition);
        let mut roms = Vec::new();
        for (id, rom) in (0..).map(RomId).zip(&design.roms) {
            if plan.partition(rom.data) == partition {
                clocked |= rom.synchronous || rom.write.is_some();
                roms.push(id);
            }
        }
        Self { clocked, inputs, outputs, roms }
    }
}

fn is_read(plan: &Plan, partition: Partition, net: NetId) -> bool {
    plan.reads.contains_key(&(partition, net))
}

/// Returns the nets that the module `from` declares and the module `to` reads, in the order of the design, without input ports.
fn crossing(plan: &Plan, from: Partition, to: Partition) -> Vec<NetId> {
    let mut crossing = Vec::new();
    for net in (0..plan.design.nets.len() as u32).map(NetId) {
        let is_declared = plan.forms[net.index()] == NetForm::Declared && !plan.is_input(net);
        if is_declared && plan.partition(net) == from && is_read(plan, to, net) {
            crossing.push(net);
        }
    }
    crossing
}

/// Returns the bits that no logic in the module reads, as ranges: `(net, 0, 3)` means the bits 0 to 2. The Verilog connects
/// them to one net, which linters accept as unread.
pub fn unread(plan: &Plan, partition: Partition, interface: &Interface) -> Vec<(NetId, u32, u32)> {
    let design = plan.design;
    let mut nets = interface.inputs.clone();
    for &net in &plan.live {
        if plan.partition(net) == partition
            && plan.forms[net.index()] == NetForm::Declared
            && design.net(net).driver != Driver::Input
            && !interface.outputs.contains(&net)
        {
            nets.push(net);
        }
    }
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
