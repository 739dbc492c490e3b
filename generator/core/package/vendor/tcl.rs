//! Generates Tcl scripts for Vivado and Quartus: one builds a module alone, another describes the module as IP.

use anyhow::Result;
use glint_base::fill;

use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use crate::package::tops::{Top, TopPort};
use glint_rtl::verilog::text::ascii;

/// The FPGA of the build script, unless the user names another. This one is small and common.
const VIVADO_PART: &str = "xc7a35tcsg324-1";
const QUARTUS_FAMILY: &str = "Cyclone V";
const QUARTUS_DEVICE: &str = "5CEBA4F23C7";

struct PlatformInterface<'a> {
    name: &'static str,
    kind: &'static str,
    /// The side of the interface, as Platform Designer names it: `end` receives, `start` sends.
    side: &'static str,
    ports: Vec<(&'a TopPort, String)>,
}

impl TopPort {
    fn direction(&self) -> &'static str {
        if self.input { "Input" } else { "Output" }
    }
}

/// Adds `<name>_vivado.tcl`, which builds the module alone, and `<name>_vivado_ip.tcl`, which packages it as IP.
pub fn vivado(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    let (name, around) = (job.name(), &job.inputs.around);
    let version = around.version.as_str();
    let memories = files.local_paths(&[FileKind::Memory]);
    let build = fill!("vivado.tcl" {
        name: &'a str,
        part: &'a str = VIVADO_PART,
        regenerate: &'a str = job.regenerate(),
        tops: &'a [Top],
        memories: &'a [String] = &memories,
    })?;
    let ip = fill!("vivado_ip.tcl" {
        name: &'a str,
        part: &'a str = VIVADO_PART,
        title: String = quoted(&job.design.about.title),
        regenerate: &'a str = job.regenerate(),
        vendor: &'a str = &around.vendor,
        // Vivado accepts only two numbers.
        version: &'a str = version.rsplit_once('.').map_or(version, |(two, _)| two),
        tops: &'a [Top],
        memories: &'a [String] = &memories,
    })?;
    files.add(FileKind::VendorScript, format!("{name}_vivado.tcl"), build);
    files.add(FileKind::VendorScript, format!("{name}_vivado_ip.tcl"), ip);
    Ok(())
}

/// Adds `<name>_quartus.tcl`, which builds the module alone, and `<top>_hw.tcl`, which describes each module as IP.
pub fn quartus(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    let (name, around) = (job.name(), &job.inputs.around);
    let build = fill!("quartus.tcl" {
        name: &'a str,
        family: &'a str = QUARTUS_FAMILY,
        device: &'a str = QUARTUS_DEVICE,
        regenerate: &'a str = job.regenerate(),
        tops: &'a [Top],
    })?;
    files.add(FileKind::VendorScript, format!("{name}_quartus.tcl"), build);
    for top in tops {
        let text = fill!("hw.tcl" {
            top: &'a Top,
            title: String = quoted(&job.design.about.title),
            regenerate: &'a str = job.regenerate(),
            vendor: &'a str = &around.vendor,
            version: &'a str = &around.version,
            memories: Vec<String> = files.local_paths(&[FileKind::Memory]),
            interfaces: Vec<PlatformInterface<'a>> = interfaces(top),
        })?;
        files.add(FileKind::VendorScript, format!("{}_hw.tcl", top.module), text);
    }
    Ok(())
}

/// Returns the interfaces of a module for Platform Designer, without clock and reset.
fn interfaces(top: &Top) -> Vec<PlatformInterface<'_>> {
    if top.protocols.is_empty() {
        // A conduit is an interface without a protocol.
        let ports = top.signals().map(|port| (port, port.name.clone())).collect();
        return vec![PlatformInterface { name: "signals", kind: "conduit", side: "end", ports }];
    }
    let interfaces = top.protocols.iter().map(|protocol| PlatformInterface {
        name: protocol.name,
        kind: protocol.platform,
        side: if protocol.is_slave { "end" } else { "start" },
        ports: top.ports_of(protocol),
    });
    interfaces.collect()
}

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
