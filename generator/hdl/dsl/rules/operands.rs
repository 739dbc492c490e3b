//! Checks that every operand of a description affects some output.

use std::collections::HashSet;

use crate::netlist::{Design, Driver, NetId, Role, WritePort};
use glint_base::codes;
use glint_base::cone::reached;
use glint_base::diagnostic::Diagnostic;

pub(super) fn check(design: &Design) -> Vec<Diagnostic> {
    let used = used(design);
    let mut found = Vec::new();
    for port in design.inputs().filter(|port| matches!(port.role, Role::Operand { .. })) {
        if !used.contains(&port.net) {
            let net = design.net(port.net);
            let message = format!("operand `{}` is not used: no output depends on it", net.name);
            found.push(Diagnostic::new(codes::UNUSED, message, net.location));
        }
    }
    found
}

/// Returns all nets on which outputs depend, also through registers and memories.
pub(super) fn used(design: &Design) -> HashSet<NetId> {
    reached(design.outputs().map(|port| port.net), |id| read_by(design, id))
}

/// Returns the nets on which a net depends within one clock, or the inputs of the register or ROM that drives it.
pub(in crate::dsl) fn read_by(design: &Design, id: NetId) -> Vec<NetId> {
    match design.net(id).driver {
        Driver::Register(register) => {
            let register = design.register(register);
            register.data.into_iter().chain(register.enable).collect()
        }
        Driver::Rom(rom) => {
            let rom = design.rom(rom);
            let mut read = vec![rom.address];
            read.extend(rom.enable);
            read.extend(rom.write.iter().flat_map(WritePort::nets));
            read
        }
        _ => design.combinational_inputs(id),
    }
}
