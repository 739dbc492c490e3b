//! Generates a core's harness: a Verilog module that contains the core, with registers at all ports except the clock.
//!
//! With the registers, timing analysis covers the paths at the ports, and the FPGA's pins do not limit the frequency. One shift
//! register feeds the inputs, and a second shift register captures the outputs and shifts them out.

use anyhow::Result;
use glint_base::fill;

use glint_rtl::netlist::{Design, Port};

/// The name of the harness module.
pub const TOP: &str = "glint_harness";
/// The name of the core's instance in the harness module.
pub const CORE: &str = "core";

/// The bits `low` to `high` of a shift register that belong to a port. For example, ports of 1, 8 and 12 bits have bit 0, bits 1
/// to 8 and bits 9 to 20.
struct Slice<'a> {
    port: &'a str,
    high: u32,
    low: u32,
}

pub fn harness(design: &Design) -> Result<String> {
    let (inputs, fed) = slices(design, design.inputs());
    let (outputs, captured) = slices(design, design.outputs());
    fill!("harness.v" {
        top: &'a str = TOP,
        core: &'a str = CORE,
        name: &'a str = &design.name,
        inputs: Vec<Slice<'a>>,
        outputs: Vec<Slice<'a>>,
        fed: u32,
        captured: u32,
    })
}

/// Returns the bits of each port in a shift register, in the order of `ports`, and the total number of bits.
fn slices<'a>(design: &'a Design, ports: impl Iterator<Item = &'a Port>) -> (Vec<Slice<'a>>, u32) {
    let mut low = 0;
    let slices = ports.map(|port| {
        let net = design.net(port.net);
        let slice = Slice { port: &net.name, high: low + net.format.width() - 1, low };
        low += net.format.width();
        slice
    });
    let slices = slices.collect();
    (slices, low)
}
