//! `<top>.xml`: each module as a component of IP-XACT, IEEE 1685-2014.

use anyhow::Result;
use askama::Template;

use crate::hdl::netlist::Design;
use crate::hdl::verilog::text::ascii;
use crate::package::map::{Access, Bits, Map, Register};
use crate::package::surroundings::Bus;
use crate::package::tops::{Face, Top};
use crate::package::{EmitInputs, render};

#[derive(Template)]
#[template(path = "component.xml")]
struct Component<'a> {
    top: &'a Top,
    title: &'a str,
    regenerate: &'a str,
    vendor: &'a str,
    version: &'a str,
    buses: Vec<BusInterface>,
    registers: &'a [Register],
    /// Bytes that the registers take.
    range: u32,
    memories: &'a [String],
}

/// A bus interface, of a bus definition that ARM has published, or of an interrupt AMD.
struct BusInterface {
    name: &'static str,
    /// Vendor and library of the definition, as attributes.
    definition: &'static str,
    /// The name of the definition.
    bus: &'static str,
    version: &'static str,
    is_slave: bool,
    /// It leads to the registers.
    mapped: bool,
    /// Name in the definition, and port.
    ports: Vec<(String, String)>,
}

const AMBA: &str = "vendor=\"amba.com\" library=\"AMBA4\"";
const INTERRUPT: &str = "vendor=\"xilinx.com\" library=\"signal\"";

impl BusInterface {
    fn is_interrupt(&self) -> bool {
        self.definition == INTERRUPT
    }
}

impl Component<'_> {
    /// A number as IP-XACT writes it, after the `'h`.
    fn hex(&self, number: impl std::fmt::LowerHex) -> String {
        format!("{number:x}")
    }

    /// Text of XML.
    fn escaped(&self, text: &str) -> String {
        escaped(text)
    }
}

impl Bits {
    /// Returns the access of a program.
    fn ip_xact_access(&self) -> &'static str {
        match self.access {
            Access::Read => "read-only",
            Access::Write | Access::Clear => "read-write",
            Access::Trigger => "write-only",
        }
    }

    /// The hardware changes them.
    fn is_volatile(&self) -> bool {
        match self.access {
            Access::Read => self.reset == 0,
            Access::Clear => true,
            Access::Write | Access::Trigger => false,
        }
    }
}

/// A component of each module.
///
/// # Errors
/// A template that fails.
pub fn files(
    design: &Design,
    inputs: &EmitInputs,
    tops: &[Top],
    map: Option<&Map>,
    memories: &[String],
) -> Result<Vec<(String, String)>> {
    let title = escaped(&design.about.title);
    let component = |top: &Top| {
        let registers = match top.face {
            Face::Registers(_) => map.map_or(&[][..], |map| &map.registers[..]),
            Face::Core | Face::Stream => &[],
        };
        let component = Component {
            top,
            title: &title,
            regenerate: &comment(&inputs.config),
            vendor: &inputs.around.vendor,
            version: &inputs.around.version,
            buses: buses(top),
            registers,
            range: 4 * registers.len() as u32,
            memories,
        };
        Ok((format!("{}.xml", top.module), render(&component)?))
    };
    tops.iter().map(component).collect()
}

/// The interrupt, a level. IEEE 1685-2014 has none of its own, and Vivado's is known to other tools too.
fn interrupt() -> BusInterface {
    BusInterface {
        name: "irq",
        definition: INTERRUPT,
        bus: "interrupt",
        version: "1.0",
        is_slave: false,
        mapped: false,
        ports: vec![("INTERRUPT".to_owned(), "irq".to_owned())],
    }
}

/// The buses of a module. Wishbone has no definition that its makers have published.
fn buses(top: &Top) -> Vec<BusInterface> {
    let ports = |name: &str| -> Vec<(String, String)> {
        let prefix = format!("{name}_");
        let logical = |port: &str| port.strip_prefix(&prefix).map(str::to_ascii_uppercase);
        let common = [("ACLK", top.clock), ("ARESETN", top.reset.as_str())];
        let common = common.map(|(logical, port)| (logical.to_owned(), port.to_owned()));
        let own =
            top.ports.iter().filter_map(|port| Some((logical(&port.name)?, port.name.clone())));
        common.into_iter().chain(own).collect()
    };
    let stream = |name, is_slave| BusInterface {
        name,
        definition: AMBA,
        bus: "AXI4Stream",
        version: "r0p0_1",
        is_slave,
        mapped: false,
        ports: ports(name),
    };
    match top.face {
        Face::Stream => vec![stream("s_axis", true), stream("m_axis", false)],
        Face::Registers(Bus::AxiLite) => {
            let registers = BusInterface {
                name: "s_axil",
                definition: AMBA,
                bus: "AXI4-Lite",
                version: "r0p0_0",
                is_slave: true,
                mapped: true,
                ports: ports("s_axil"),
            };
            vec![registers, interrupt()]
        }
        Face::Registers(Bus::Wishbone) => vec![interrupt()],
        Face::Core => Vec::new(),
    }
}

/// Text of XML.
fn escaped(text: &str) -> String {
    ascii(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A part of a comment of XML, in which two hyphens may not stand side by side.
fn comment(text: &str) -> String {
    let mut text = text.to_owned();
    while text.contains("--") {
        text = text.replace("--", "- -");
    }
    text
}
