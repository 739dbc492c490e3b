//! Writes the ports by which a wrapper passes the write port of a core's table on to the system around it.

use glint_rtl::netlist::{Design, Port};
use glint_rtl::verilog::text::{literal, range};

fn ports(design: &Design) -> impl Iterator<Item = &Port> {
    design.ports.iter().filter(|port| port.role.is_of_table())
}

/// Returns declarations such as `input  wire [4:0] table_address,`; none for a core without a writable table.
pub fn declared(design: &Design) -> Vec<String> {
    let mut lines = Vec::new();
    for port in ports(design) {
        let net = design.net(port.net);
        let direction = if port.role.is_input() { "input " } else { "output" };
        let bits = range(net.format.width());
        let line = format!("{direction} wire {bits} {},", net.name);
        lines.push(line.replace("wire  ", "wire "));
    }
    lines
}

/// Returns connections for a bench that never writes the table, such as `.table_address(5'd0),`.
pub fn tied(design: &Design) -> Vec<String> {
    let mut lines = Vec::new();
    for port in ports(design) {
        let net = design.net(port.net);
        let value = match port.role.is_input() {
            true => literal(0, net.format.width()),
            false => String::new(),
        };
        lines.push(format!(".{}({value}),", net.name));
    }
    lines
}
