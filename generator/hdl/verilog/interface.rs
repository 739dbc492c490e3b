//! The ports of the two units.

use super::plan::{Form, Plan};
use crate::base::fixed::mask;
use crate::hdl::netlist::{Driver, NetId, RomId, Unit};

/// What crosses the boundary of a unit.
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
    /// Of one of the units.
    pub fn new(plan: &Plan, unit: Unit) -> Self {
        let design = plan.design;
        let other = match unit {
            Unit::Control => Unit::Datapath,
            Unit::Datapath => Unit::Control,
        };
        let reads = |unit: Unit, net: NetId| plan.reads.contains_key(&(unit, net));
        let declared =
            |net: &NetId| plan.forms[net.index()] == Form::Declared && !plan.is_input(*net);
        let nets_read = |by: Unit, of: Unit| {
            let ids = (0..design.nets.len() as u32).map(NetId);
            ids.filter(declared).filter(move |net| plan.unit(*net) == of && reads(by, *net))
        };
        // An input that nothing reads still has to end somewhere: in its own unit.
        let inputs = design
            .inputs()
            .map(|port| port.net)
            .filter(|net| reads(unit, *net) || (plan.unit(*net) == unit && !reads(other, *net)));
        let outputs = design.outputs().map(|port| port.net).filter(|net| plan.unit(*net) == unit);
        let roms: Vec<_> = (0..design.roms.len() as u32)
            .map(RomId)
            .filter(|rom| plan.unit(design.rom(*rom).data) == unit)
            .collect();
        let registers = design.registers.iter().any(|register| plan.unit(register.q) == unit);
        Self {
            clocked: registers || roms.iter().any(|rom| design.rom(*rom).synchronous),
            inputs: inputs.chain(nets_read(unit, other)).collect(),
            outputs: outputs
                .chain(nets_read(other, unit).filter(|net| !plan.is_port(*net)))
                .collect(),
            roms,
        }
    }
}

/// The nets and the bits of them that are there in a unit and that nothing in it needs, as ranges
/// `(net, low, width)`.
pub fn unread(plan: &Plan, unit: Unit, interface: &Interface) -> Vec<(NetId, u32, u32)> {
    let design = plan.design;
    let here = plan.live.iter().copied().filter(|net| {
        plan.unit(*net) == unit
            && plan.forms[net.index()] == Form::Declared
            && design.net(*net).driver != Driver::Input
            && !interface.outputs.contains(net)
    });
    let mut nets: Vec<_> = interface.inputs.iter().copied().chain(here).collect();
    nets.sort_unstable();
    let mut ranges = Vec::new();
    for net in nets {
        let width = design.width(net);
        let read = plan.reads.get(&(unit, net)).copied().unwrap_or(0);
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
