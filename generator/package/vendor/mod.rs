//! Files for vendors' tools beside the Verilog: constraints, Tcl, IP-XACT.

mod constraints;
mod ip_xact;
mod tcl;

use anyhow::Result;

use super::EmitInputs;
use super::map::Map;
use super::tops::Top;
use crate::hdl::netlist::Design;

/// The files that the configuration asks for: pairs of a plain name and its text.
#[derive(Default)]
pub struct Vendor {
    /// Timing constraints.
    pub constraints: Vec<(String, String)>,
    /// Scripts and descriptions.
    pub scripts: Vec<(String, String)>,
}

/// The files that the configuration asks for. The map is that of the registers; `memories` are the names of the files
/// with ROM contents.
///
/// # Errors
/// A template that fails.
pub fn files(
    design: &Design,
    inputs: &EmitInputs,
    tops: &[Top],
    map: Option<&Map>,
    memories: &[String],
) -> Result<Vendor> {
    let around = &inputs.around;
    let mut made = Vendor::default();
    if let Some(clock_mhz) = around.clock_mhz {
        made.constraints = constraints::files(inputs, tops, clock_mhz)?;
    }
    if around.vivado {
        made.scripts.extend(tcl::vivado(design, inputs, tops, memories)?);
    }
    if around.quartus {
        made.scripts.extend(tcl::quartus(design, inputs, tops, memories)?);
    }
    if around.ip_xact {
        made.scripts.extend(ip_xact::files(design, inputs, tops, map, memories)?);
    }
    Ok(made)
}
