//! The modules that a system can instantiate: the core, and what stands around it.

use anyhow::Result;

use super::EmitInputs;
use super::map::Map;
use super::surroundings::Bus;
use super::wrap::fields::{bits, operands, results};
use crate::hdl::netlist::Design;
use crate::hdl::verilog::text::ascii;

/// The interface of a module to a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The core itself.
    Core,
    /// Two AXI4-Streams.
    Stream,
    /// Registers on a bus.
    Registers(Bus),
}

/// A port of such a module.
#[derive(Clone, Debug)]
pub struct TopPort {
    /// Its name.
    pub name: String,
    /// Or an output.
    pub input: bool,
    /// In bits.
    pub width: u32,
    /// Declared with a range.
    pub vector: bool,
    /// One line, or nothing.
    pub doc: String,
}

/// A module that a system can instantiate.
#[derive(Clone, Debug)]
pub struct Top {
    /// Its name.
    pub module: String,
    /// The interface.
    pub face: Face,
    /// The clock, the first port.
    pub clock: &'static str,
    /// The reset, synchronous.
    pub reset: String,
    /// The level of the reset that resets.
    pub reset_level: u8,
    /// All ports, as the Verilog has them.
    pub ports: Vec<TopPort>,
    /// The Verilog that it is made of, its own file first.
    pub verilog: Vec<String>,
}

impl Top {
    /// Returns a description in a few words.
    pub fn what(&self) -> &'static str {
        match self.face {
            Face::Core => "the core",
            Face::Stream => "the core between two AXI4-Streams",
            Face::Registers(Bus::AxiLite) => "the core behind registers on AXI4-Lite",
            Face::Registers(Bus::Wishbone) => "the core behind registers on Wishbone",
        }
    }

    /// The bits of a port; 0 of none.
    pub fn width(&self, name: &str) -> u32 {
        self.ports.iter().find(|port| port.name == name).map_or(0, |port| port.width)
    }

    /// The ports that carry data or a handshake: neither clock nor reset.
    pub fn signals(&self) -> impl Iterator<Item = &TopPort> {
        self.ports.iter().filter(|port| port.name != self.clock && port.name != self.reset)
    }
}

/// The modules of a configuration, the core first; `rtl` and `wrappers` are the names of their files.
///
/// # Errors
/// A stream around a core without operands or results.
pub fn tops(
    design: &Design,
    inputs: &EmitInputs,
    map: Option<(Bus, &Map)>,
    rtl: &[String],
    wrappers: &[String],
) -> Result<Vec<Top>> {
    let name = design.name.as_str();
    let mut tops = vec![Top {
        module: name.to_owned(),
        face: Face::Core,
        clock: "clk",
        reset: reset(design),
        reset_level: 0,
        ports: core_ports(design),
        verilog: rtl.to_vec(),
    }];
    let streamed = format!("{name}_axis");
    let with_core = |of_stream: bool| {
        let own = wrappers.iter().filter(|file| file.starts_with(&streamed) == of_stream);
        own.chain(rtl).cloned().collect::<Vec<String>>()
    };
    if inputs.around.stream {
        tops.push(Top {
            module: streamed.clone(),
            face: Face::Stream,
            clock: "aclk",
            reset: "aresetn".to_owned(),
            reset_level: 0,
            ports: stream_ports(design, inputs)?,
            verilog: with_core(true),
        });
    }
    if let Some((bus, map)) = map {
        let (clock, reset, reset_level, ports) = match bus {
            Bus::AxiLite => ("aclk", "aresetn", 0, axi_lite_ports(map.address_bits())),
            Bus::Wishbone => ("wb_clk_i", "wb_rst_i", 1, wishbone_ports(map.address_bits())),
        };
        tops.push(Top {
            module: format!("{name}_{}", bus.suffix()),
            face: Face::Registers(bus),
            clock,
            reset: reset.to_owned(),
            reset_level,
            ports,
            verilog: with_core(false),
        });
    }
    Ok(tops)
}

/// The name of the core's reset.
fn reset(design: &Design) -> String {
    let port = design.port(|role| role == crate::hdl::netlist::Role::Reset);
    port.map(|port| design.net(port.net).name.clone()).unwrap_or_default()
}

fn core_ports(design: &Design) -> Vec<TopPort> {
    let port = |port: &crate::hdl::netlist::Port| {
        let net = design.net(port.net);
        let width = net.format.width();
        TopPort {
            name: net.name.clone(),
            input: port.role.is_input(),
            width,
            vector: width > 1,
            doc: ascii(&net.doc),
        }
    };
    listed("in clk").into_iter().chain(design.ports.iter().map(port)).collect()
}

fn stream_ports(design: &Design, inputs: &EmitInputs) -> Result<Vec<TopPort>> {
    let (input, output) = (bits(&operands(design))?, bits(&results(design))?);
    let user = inputs.around.user_bits;
    // A line has its end in its length.
    let is_line = inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some());
    let last = if is_line { "" } else { "in s_axis_tlast, " };
    Ok(listed(&format!(
        "in aclk, in aresetn, in s_axis_tdata {input}, in s_axis_tuser {user}, {last}\
         in s_axis_tvalid, out s_axis_tready, out m_axis_tdata {output}, out m_axis_tuser {user}, \
         out m_axis_tlast, out m_axis_tvalid, in m_axis_tready"
    )))
}

fn axi_lite_ports(address: u32) -> Vec<TopPort> {
    listed(&format!(
        "in aclk, in aresetn, in s_axil_awaddr {address}, in s_axil_awprot 3, in s_axil_awvalid, \
         out s_axil_awready, in s_axil_wdata 32, in s_axil_wstrb 4, in s_axil_wvalid, \
         out s_axil_wready, out s_axil_bresp 2, out s_axil_bvalid, in s_axil_bready, \
         in s_axil_araddr {address}, in s_axil_arprot 3, in s_axil_arvalid, out s_axil_arready, \
         out s_axil_rdata 32, out s_axil_rresp 2, out s_axil_rvalid, in s_axil_rready, out irq"
    ))
}

fn wishbone_ports(address: u32) -> Vec<TopPort> {
    listed(&format!(
        "in wb_clk_i, in wb_rst_i, in wb_cyc_i, in wb_stb_i, in wb_we_i, in wb_adr_i {address}, \
         in wb_dat_i 32, in wb_sel_i 4, out wb_dat_o 32, out wb_ack_o, out wb_err_o, out irq"
    ))
}

/// Ports as text: directions and names, and the widths of vectors.
fn listed(ports: &str) -> Vec<TopPort> {
    let port = |port: &str| {
        let mut words = port.split(' ');
        let input = words.next() == Some("in");
        let name = words.next().unwrap_or_default();
        let width = words.next().and_then(|width| width.parse().ok());
        let (vector, width) = (width.is_some(), width.unwrap_or(1));
        TopPort { name: name.to_owned(), input, width, vector, doc: String::new() }
    };
    ports.split(", ").map(port).collect()
}
