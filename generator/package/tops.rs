//! The modules that a system can instantiate: the core, and what stands around it.

use anyhow::Result;

use super::EmitInputs;
use super::map::Map;
use super::surroundings::Bus;
use super::wrap::fields::{bits, operands, results};
use crate::hdl::netlist::Design;
use crate::hdl::verilog::text::ascii;

/// What a system sees of a module.
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
    /// What it shows.
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
    /// What it is, in a few words.
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
        let (suffix, clock, reset, reset_level, ports) = match bus {
            Bus::AxiLite => ("axil", "aclk", "aresetn", 0, axi_lite_ports(map.address_bits())),
            Bus::Wishbone => ("wb", "wb_clk_i", "wb_rst_i", 1, wishbone_ports(map.address_bits())),
        };
        tops.push(Top {
            module: format!("{name}_{suffix}"),
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
    std::iter::once(scalar("clk", true)).chain(design.ports.iter().map(port)).collect()
}

fn stream_ports(design: &Design, inputs: &EmitInputs) -> Result<Vec<TopPort>> {
    let (input, output) = (bits(&operands(design))?, bits(&results(design))?);
    let user = inputs.around.user_bits;
    // A line has its end in its length.
    let is_line = inputs.accuracy.as_ref().is_some_and(|accuracy| accuracy.length.is_some());
    let mut ports = vec![
        scalar("aclk", true),
        scalar("aresetn", true),
        vector("s_axis_tdata", true, input),
        vector("s_axis_tuser", true, user),
    ];
    if !is_line {
        ports.push(scalar("s_axis_tlast", true));
    }
    ports.extend([
        scalar("s_axis_tvalid", true),
        scalar("s_axis_tready", false),
        vector("m_axis_tdata", false, output),
        vector("m_axis_tuser", false, user),
        scalar("m_axis_tlast", false),
        scalar("m_axis_tvalid", false),
        scalar("m_axis_tready", true),
    ]);
    Ok(ports)
}

fn axi_lite_ports(address: u32) -> Vec<TopPort> {
    vec![
        scalar("aclk", true),
        scalar("aresetn", true),
        vector("s_axil_awaddr", true, address),
        vector("s_axil_awprot", true, 3),
        scalar("s_axil_awvalid", true),
        scalar("s_axil_awready", false),
        vector("s_axil_wdata", true, 32),
        vector("s_axil_wstrb", true, 4),
        scalar("s_axil_wvalid", true),
        scalar("s_axil_wready", false),
        vector("s_axil_bresp", false, 2),
        scalar("s_axil_bvalid", false),
        scalar("s_axil_bready", true),
        vector("s_axil_araddr", true, address),
        vector("s_axil_arprot", true, 3),
        scalar("s_axil_arvalid", true),
        scalar("s_axil_arready", false),
        vector("s_axil_rdata", false, 32),
        vector("s_axil_rresp", false, 2),
        scalar("s_axil_rvalid", false),
        scalar("s_axil_rready", true),
        scalar("irq", false),
    ]
}

fn wishbone_ports(address: u32) -> Vec<TopPort> {
    vec![
        scalar("wb_clk_i", true),
        scalar("wb_rst_i", true),
        scalar("wb_cyc_i", true),
        scalar("wb_stb_i", true),
        scalar("wb_we_i", true),
        vector("wb_adr_i", true, address),
        vector("wb_dat_i", true, 32),
        vector("wb_sel_i", true, 4),
        vector("wb_dat_o", false, 32),
        scalar("wb_ack_o", false),
        scalar("wb_err_o", false),
        scalar("irq", false),
    ]
}

fn scalar(name: &str, input: bool) -> TopPort {
    TopPort { name: name.to_owned(), input, width: 1, vector: false, doc: String::new() }
}

fn vector(name: &str, input: bool, width: u32) -> TopPort {
    TopPort { name: name.to_owned(), input, width, vector: true, doc: String::new() }
}
