//! Lists the modules that a system can instantiate, with their ports: the core itself, its stream wrapper, its bus wrapper and the wrapper
//! for a processor. The generators of constraints, Tcl scripts, IP-XACT, VHDL and LiteX modules read this list.

use anyhow::Result;

use super::bus::{Bus, Protocol, STREAMS};
use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use super::processor::ProcessorInterface;
use super::wrap::fields::Transfer;
use glint_rtl::netlist::{Design, Port, Role};
use glint_rtl::verilog::text::ascii;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Face {
    /// The core itself, with its own handshake.
    Core,
    /// An AXI4-Stream for operands and another for results.
    Stream,
    Registers(&'static Bus),
    /// The interface of a processor for instructions.
    Processor(&'static ProcessorInterface),
}

#[derive(Clone, Debug)]
pub struct TopPort {
    pub name: String,
    pub input: bool,
    pub width: u32,
    /// Whether the port is declared with a range, such as `[0:0]`. A port of one bit may have none.
    pub vector: bool,
    /// The signal of the LiteX bus that connects to the port, if any.
    pub signal: String,
    /// A comment of one line; may be empty.
    pub doc: String,
}

/// A module that a system can instantiate. For example, `threshold_levels` is a core, `threshold_levels_axis` the same core
/// between streams, and `threshold_levels_axil` the core behind registers on AXI4-Lite.
#[derive(Clone, Debug)]
pub struct Top {
    pub module: String,
    /// The end of the module's name behind the name of the core and `_`, for example `axis`; empty for the core itself.
    pub suffix: &'static str,
    pub face: Face,
    /// The purpose of the module in a few words.
    pub what: String,
    /// The clock, which is the first port.
    pub clock: String,
    /// The reset, which is synchronous.
    pub reset: String,
    /// The level of the reset port while the module is in reset.
    pub reset_level: u8,
    /// The ports in the order of the Verilog.
    pub ports: Vec<TopPort>,
    pub protocols: &'static [Protocol],
    /// The Verilog files of the module and of all modules below it, its own file first.
    pub verilog: Vec<String>,
}

impl Top {
    /// Returns the width of the port `name` in bits, or 0 without such a port.
    pub fn width(&self, name: &str) -> u32 {
        self.ports.iter().find(|port| port.name == name).map_or(0, |port| port.width)
    }

    pub fn signals(&self) -> impl Iterator<Item = &TopPort> {
        self.ports.iter().filter(|port| port.name != self.clock && port.name != self.reset)
    }

    /// Returns the ports of a standard interface with their names in its definition. For example, the port `s_axis_tdata` of
    /// the interface `s_axis` has the name `tdata`.
    pub fn ports_of(&self, protocol: &Protocol) -> Vec<(&TopPort, String)> {
        let prefix = format!("{}_", protocol.name);
        let mut ports = Vec::new();
        for port in self.signals() {
            if let Some(name) = port.name.strip_prefix(&prefix) {
                ports.push((port, name.to_owned()));
            }
        }
        ports
    }

    /// Returns whether the module has an interrupt output, `irq`, which is 1 while an interrupt is pending and enabled.
    pub fn interrupts(&self) -> bool {
        matches!(self.face, Face::Registers(_))
    }
}

/// Returns the core, then its wrappers for streams, a bus and a processor, if the configuration asks for them. Fails if streams are
/// asked for, and the core has no operands or no results.
pub fn tops(job: &EmitJob, files: &OutputFiles) -> Result<Vec<Top>> {
    let (name, design) = (job.name(), job.design);
    let reset = design.port(|role| role == Role::Reset);
    let mut tops = vec![Top {
        module: name.to_owned(),
        suffix: "",
        face: Face::Core,
        what: "the core".to_owned(),
        clock: "clk".to_owned(),
        reset: reset.map(|port| design.net(port.net).name.clone()).unwrap_or_default(),
        reset_level: 0,
        ports: core_ports(design),
        protocols: &[],
        verilog: files.local_paths(&[FileKind::CoreVerilog]),
    }];
    let mut add =
        |suffix: &'static str, face: Face, what: String, level: u8, ports: Vec<TopPort>| {
            let kinds: &[FileKind] = match face {
                Face::Core => &[],
                Face::Stream => &[FileKind::StreamWrapper],
                Face::Registers(_) => {
                    &[FileKind::BusWrapper, FileKind::SingleWrapper, FileKind::QueueWrapper]
                }
                Face::Processor(_) => &[FileKind::ProcessorWrapper, FileKind::SingleWrapper],
            };
            let mut verilog = files.local_paths(kinds);
            verilog.extend(files.local_paths(&[FileKind::CoreVerilog]));
            tops.push(Top {
                module: format!("{name}_{suffix}"),
                suffix,
                face,
                what: format!("the core {what}"),
                clock: ports[0].name.clone(),
                reset: ports[1].name.clone(),
                reset_level: level,
                ports,
                protocols: match face {
                    Face::Core | Face::Processor(_) => &[],
                    Face::Stream => &STREAMS,
                    Face::Registers(bus) => bus.protocol,
                },
                verilog,
            });
        };
    if job.inputs.around.stream {
        let ports = with_table(stream_ports(job)?, design);
        add("axis", Face::Stream, "between two AXI4-Streams".to_owned(), 0, ports);
    }
    if let Some((bus, map)) = &job.registers {
        let ports = listed(&bus.ports.replace('#', &map.address_bits().to_string()));
        let what = format!("behind registers on {}", bus.title);
        add(bus.suffix, Face::Registers(bus), what, bus.reset_level, ports);
    }
    if let Some((interface, _)) = &job.instructions {
        let what = format!("behind {}", interface.title);
        let ports = with_table(listed(interface.ports), design);
        add(interface.key, Face::Processor(interface), what, interface.reset_level, ports);
    }
    Ok(tops)
}

fn core_ports(design: &Design) -> Vec<TopPort> {
    let mut ports = listed("in clk");
    ports.extend(design.ports.iter().map(|port| core_port(design, port)));
    ports
}

fn core_port(design: &Design, port: &Port) -> TopPort {
    let net = design.net(port.net);
    let width = net.format.width();
    TopPort {
        name: net.name.clone(),
        input: port.role.is_input(),
        width,
        vector: width > 1,
        signal: String::new(),
        doc: ascii(&net.doc),
    }
}

/// Adds the write port of a table behind the clock and the reset.
fn with_table(mut ports: Vec<TopPort>, design: &Design) -> Vec<TopPort> {
    let of_table = design.ports.iter().filter(|port| port.role.is_of_table());
    ports.splice(2..2, of_table.map(|port| core_port(design, port)));
    ports
}

fn stream_ports(job: &EmitJob) -> Result<Vec<TopPort>> {
    let (input, output) = (Transfer::sent(job)?.bits, Transfer::received(job)?.bits);
    let keep = |port: &str, bits: u32| match job.inputs.around.keep {
        true => format!("{port}_axis_tkeep {}, ", bits / 8),
        false => String::new(),
    };
    let (in_keep, out_keep) = (keep("in s", input), keep("out m", output));
    let user = job.inputs.around.user_bits;
    // A core that computes lines needs no `tlast`, because an operand states the length of the line.
    let last = if job.is_line() { "" } else { "in s_axis_tlast, " };
    Ok(listed(&format!(
        "in aclk, in aresetn, in s_axis_tdata {input}, {in_keep}in s_axis_tuser {user}, {last}\
         in s_axis_tvalid, out s_axis_tready, out m_axis_tdata {output}, {out_keep}out m_axis_tuser {user}, \
         out m_axis_tlast, out m_axis_tvalid, in m_axis_tready"
    )))
}

/// Parses a list of ports. Each has its direction, its name, the width of a vector or `-` for one bit, and the signal of
/// LiteX. For example, `in s_axil_wdata 32 w.data, out irq` has an input of 32 bits and an output of one bit.
fn listed(ports: &str) -> Vec<TopPort> {
    let mut listed = Vec::new();
    for port in ports.split(", ") {
        let mut words = port.split(' ');
        let input = words.next() == Some("in");
        let name = words.next().unwrap_or_default().to_owned();
        let width = words.next().and_then(|width| width.parse().ok());
        let signal = words.next().unwrap_or_default().to_owned();
        let (vector, width) = (width.is_some(), width.unwrap_or(1));
        listed.push(TopPort { name, input, width, vector, signal, doc: String::new() });
    }
    listed
}
