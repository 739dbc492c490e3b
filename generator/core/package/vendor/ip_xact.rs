//! Generates `<top>.xml`: the description of a module as a component of IP-XACT, IEEE 1685-2014.

use anyhow::Result;

use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::map::{Access, BusRegister, RegisterBits};
use crate::package::output_files::OutputFiles;
use crate::package::tops::{Face, Top};
use glint_base::template::render;
use glint_rtl::verilog::text::ascii;

#[glint_base::template::template("component.xml")]
struct IpXactComponent<'a> {
    top: &'a Top,
    title: String,
    regenerate: String,
    vendor: &'a str,
    version: &'a str,
    buses: Vec<BusInterface>,
    registers: &'a [BusRegister],
    /// The number of bytes that the registers occupy.
    range: usize,
    memories: Vec<String>,
}

/// A bus interface. ARM published the definitions of the buses, and AMD the definition of an interrupt.
struct BusInterface {
    name: &'static str,
    /// The attributes for vendor and library of the definition.
    definition: &'static str,
    bus: &'static str,
    version: &'static str,
    is_slave: bool,
    /// Whether the interface gives access to the registers.
    mapped: bool,
    /// Pairs of the name in the definition and the name of the port.
    ports: Vec<(String, String)>,
}

const AMBA: &str = "vendor=\"amba.com\" library=\"AMBA4\"";
const INTERRUPT: &str = "vendor=\"xilinx.com\" library=\"signal\"";

impl BusInterface {
    fn is_interrupt(&self) -> bool {
        self.definition == INTERRUPT
    }
}

impl IpXactComponent<'_> {
    /// Returns the hexadecimal digits that IP-XACT has behind `'h`: 255 gives `ff`.
    fn hex(&self, number: impl std::fmt::LowerHex) -> String {
        format!("{number:x}")
    }

    fn escaped(&self, text: &str) -> String {
        escaped(text)
    }
}

impl RegisterBits {
    fn ip_xact_access(&self) -> &'static str {
        match self.access {
            Access::Read => "read-only",
            Access::Write | Access::Clear => "read-write",
            Access::Trigger => "write-only",
        }
    }

    /// Returns whether the hardware may change the bits, so that software must not cache them. A read-only field with a reset
    /// value other than 0 counts as constant, because only constants, such as the version of Glint, have one.
    fn is_volatile(&self) -> bool {
        match self.access {
            Access::Read => self.reset == 0,
            Access::Clear => true,
            Access::Write | Access::Trigger => false,
        }
    }
}

pub fn files(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    for top in tops {
        let registers: &[BusRegister] = match (top.face, &job.registers) {
            (Face::Registers(_), Some((_, map))) => &map.registers,
            _ => &[],
        };
        let component = IpXactComponent {
            top,
            title: escaped(&job.design.about.title),
            regenerate: comment(job.regenerate()),
            vendor: &job.inputs.around.vendor,
            version: &job.inputs.around.version,
            buses: buses(top),
            registers,
            range: 4 * registers.len(),
            memories: files.local_paths(&[FileKind::Memory]),
        };
        let text = render(&component)?;
        files.add(FileKind::VendorScript, format!("{}.xml", top.module), text);
    }
    Ok(())
}

/// Returns the bus interfaces of a module, and the interface of its interrupt output. IEEE 1685-2014 defines no interrupt, so
/// the interrupt has Vivado's definition, which other tools know too.
fn buses(top: &Top) -> Vec<BusInterface> {
    let mut buses = Vec::new();
    for protocol in top.protocols {
        let mut ports =
            vec![("ACLK".to_owned(), top.clock.clone()), ("ARESETN".to_owned(), top.reset.clone())];
        for (port, name) in top.ports_of(protocol) {
            ports.push((name.to_ascii_uppercase(), port.name.clone()));
        }
        buses.push(BusInterface {
            name: protocol.name,
            definition: AMBA,
            bus: protocol.amba,
            version: protocol.version,
            is_slave: protocol.is_slave,
            mapped: top.interrupts(),
            ports,
        });
    }
    buses.extend(top.interrupts().then(|| BusInterface {
        name: "irq",
        definition: INTERRUPT,
        bus: "interrupt",
        version: "1.0",
        is_slave: false,
        mapped: false,
        ports: vec![("INTERRUPT".to_owned(), "irq".to_owned())],
    }));
    buses
}

fn escaped(text: &str) -> String {
    ascii(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// XML forbids two adjacent hyphens in a comment; a space separates them here.
fn comment(text: &str) -> String {
    let mut apart = text.to_owned();
    while apart.contains("--") {
        apart = apart.replace("--", "- -");
    }
    apart
}
