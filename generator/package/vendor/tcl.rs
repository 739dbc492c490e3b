//! Tcl for Vivado and Quartus: builds of a module alone, and descriptions of it as IP.

use anyhow::Result;
use askama::Template;

use crate::hdl::netlist::Design;
use crate::hdl::verilog::text::ascii;
use crate::package::surroundings::Bus;
use crate::package::tops::{Face, Top, TopPort};
use crate::package::{EmitInputs, render};

/// The device that a build is for, unless its user names one: small and common.
const VIVADO_PART: &str = "xc7a35tcsg324-1";
const QUARTUS_FAMILY: &str = "Cyclone V";
const QUARTUS_DEVICE: &str = "5CEBA4F23C7";

#[derive(Template)]
#[template(path = "vivado.tcl")]
struct Vivado<'a> {
    name: &'a str,
    part: &'a str,
    regenerate: &'a str,
    tops: &'a [Top],
    memories: &'a [String],
}

#[derive(Template)]
#[template(path = "vivado_ip.tcl")]
struct VivadoIp<'a> {
    name: &'a str,
    part: &'a str,
    title: &'a str,
    regenerate: &'a str,
    vendor: &'a str,
    /// Major and minor, all that Vivado takes.
    version: &'a str,
    tops: &'a [Top],
    memories: &'a [String],
}

#[derive(Template)]
#[template(path = "quartus.tcl")]
struct Quartus<'a> {
    name: &'a str,
    family: &'a str,
    device: &'a str,
    regenerate: &'a str,
    tops: &'a [Top],
}

#[derive(Template)]
#[template(path = "hw.tcl")]
struct PlatformDesigner<'a> {
    top: &'a Top,
    title: &'a str,
    regenerate: &'a str,
    vendor: &'a str,
    version: &'a str,
    memories: &'a [String],
    interfaces: Vec<Interface<'a>>,
    interrupt: bool,
}

/// An interface of Platform Designer.
struct Interface<'a> {
    name: &'static str,
    kind: &'static str,
    /// `end` takes, `start` offers.
    side: &'static str,
    /// The port and its role.
    ports: Vec<(&'a TopPort, String)>,
}

impl TopPort {
    fn direction(&self) -> &'static str {
        if self.input { "Input" } else { "Output" }
    }
}

/// `<name>_vivado.tcl` and `<name>_vivado_ip.tcl`.
///
/// # Errors
/// A template that fails.
pub fn vivado(
    design: &Design,
    inputs: &EmitInputs,
    tops: &[Top],
    memories: &[String],
) -> Result<Vec<(String, String)>> {
    let (name, regenerate) = (design.name.as_str(), inputs.config.as_str());
    let version = &inputs.around.version;
    let build = Vivado { name, part: VIVADO_PART, regenerate, tops, memories };
    let ip = VivadoIp {
        name,
        part: VIVADO_PART,
        title: &quoted(&design.about.title),
        regenerate,
        vendor: &inputs.around.vendor,
        version: version.rsplit_once('.').map_or(version, |(two, _)| two),
        tops,
        memories,
    };
    Ok(vec![
        (format!("{name}_vivado.tcl"), render(&build)?),
        (format!("{name}_vivado_ip.tcl"), render(&ip)?),
    ])
}

/// `<name>_quartus.tcl`, and `<top>_hw.tcl` of each module.
///
/// # Errors
/// A template that fails.
pub fn quartus(
    design: &Design,
    inputs: &EmitInputs,
    tops: &[Top],
    memories: &[String],
) -> Result<Vec<(String, String)>> {
    let (name, regenerate) = (design.name.as_str(), inputs.config.as_str());
    let (family, device) = (QUARTUS_FAMILY, QUARTUS_DEVICE);
    let build = Quartus { name, family, device, regenerate, tops };
    let mut files = vec![(format!("{name}_quartus.tcl"), render(&build)?)];
    for top in tops {
        let description = PlatformDesigner {
            top,
            title: &quoted(&design.about.title),
            regenerate,
            vendor: &inputs.around.vendor,
            version: &inputs.around.version,
            memories,
            interfaces: interfaces(top),
            interrupt: top.face == Face::Registers(Bus::AxiLite),
        };
        files.push((format!("{}_hw.tcl", top.module), render(&description)?));
    }
    Ok(files)
}

/// The interfaces of a module but for clock, reset and interrupt.
fn interfaces(top: &Top) -> Vec<Interface<'_>> {
    let named = |name: &'static str, kind, side| {
        let prefix = format!("{name}_");
        let role = |port: &TopPort| port.name.strip_prefix(&prefix).map(str::to_owned);
        let ports = top.signals().filter_map(|port| Some((port, role(port)?))).collect();
        Interface { name, kind, side, ports }
    };
    match top.face {
        Face::Stream => {
            vec![named("s_axis", "axi4stream", "end"), named("m_axis", "axi4stream", "start")]
        }
        Face::Registers(Bus::AxiLite) => vec![named("s_axil", "axi4lite", "end")],
        // Neither has a type of interface there.
        Face::Core | Face::Registers(Bus::Wishbone) => {
            let ports = top.signals().map(|port| (port, port.name.clone())).collect();
            vec![Interface { name: "signals", kind: "conduit", side: "end", ports }]
        }
    }
}

/// As it stands between the quotation marks of a Tcl word.
fn quoted(text: &str) -> String {
    let mut quoted = String::new();
    for c in ascii(text).chars() {
        if "\\\"$[]{}".contains(c) {
            quoted.push('\\');
        }
        quoted.push(c);
    }
    quoted
}
