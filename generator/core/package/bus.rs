//! Describes the buses that registers can be on, as data: keys, ports, and the Verilog of each bus.

use anyhow::Result;
use glint_base::fill;

/// A bus on which registers are.
#[derive(Debug)]
pub struct Bus {
    /// As the key `interface.registers` names it.
    pub key: &'static str,
    /// For people.
    pub title: &'static str,
    /// The end of the name of a module on it. For example, `axil` in `threshold_levels_axil`.
    pub suffix: &'static str,
    /// The level of the reset that resets.
    pub reset_level: u8,
    /// The ports, clock and reset first: direction, name, the width of a vector, and for a port that LiteX connects its
    /// signal. `#` denotes the number of bits of an address.
    pub ports: &'static str,
    /// The interface that tools find by the names of its ports, if there is a definition of it.
    pub protocol: &'static [Protocol],
    /// The interface of LiteX.
    pub litex: &'static str,
    /// Makes the module on the bus, and its proof. Its parameters are the name of the core, the configuration that makes it,
    /// and the highest bit of an address.
    pub module: fn(&str, &str, u32) -> Result<[String; 2]>,
}

impl PartialEq for Bus {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

/// An interface of ports that tools know by its definition.
#[derive(Debug)]
pub struct Protocol {
    /// The prefix of the names of its ports.
    pub name: &'static str,
    /// The name of ARM's definition for IP-XACT.
    pub amba: &'static str,
    /// The version of the definition.
    pub version: &'static str,
    /// The type of an interface in Platform Designer.
    pub platform: &'static str,
    /// Whether the module is the receiving side of the interface.
    pub is_slave: bool,
}

/// The interfaces between two AXI4-Streams.
pub static STREAMS: [Protocol; 2] = [stream("s_axis", true), stream("m_axis", false)];

/// Returns the interface of an AXI4-Stream.
const fn stream(name: &'static str, is_slave: bool) -> Protocol {
    Protocol { name, amba: "AXI4Stream", version: "r0p0_1", platform: "axi4stream", is_slave }
}

/// All buses.
pub static BUSES: [Bus; 2] = [
    Bus {
        key: "axi-lite",
        title: "AXI4-Lite",
        suffix: "axil",
        reset_level: 0,
        ports: "in aclk, in aresetn, in s_axil_awaddr # aw.addr[:#], in s_axil_awprot 3 aw.prot, \
                in s_axil_awvalid - aw.valid, out s_axil_awready - aw.ready, in s_axil_wdata 32 w.data, \
                in s_axil_wstrb 4 w.strb, in s_axil_wvalid - w.valid, out s_axil_wready - w.ready, \
                out s_axil_bresp 2 b.resp, out s_axil_bvalid - b.valid, in s_axil_bready - b.ready, \
                in s_axil_araddr # ar.addr[:#], in s_axil_arprot 3 ar.prot, in s_axil_arvalid - ar.valid, \
                out s_axil_arready - ar.ready, out s_axil_rdata 32 r.data, out s_axil_rresp 2 r.resp, \
                out s_axil_rvalid - r.valid, in s_axil_rready - r.ready, out irq",
        protocol: &[Protocol {
            name: "s_axil",
            amba: "AXI4-Lite",
            version: "r0p0_0",
            platform: "axi4lite",
            is_slave: true,
        }],
        litex: "axi.AXILiteInterface(data_width=32, address_width=32)",
        module: |name, regenerate, address_high| {
            Ok([
                fill!("axil.v" { name: &'a str, regenerate: &'a str, address_high: u32 })?,
                fill!("axil_formal.sv" { name: &'a str, address_high: u32 })?,
            ])
        },
    },
    // Wishbone B4, classic cycles. It has no definition in IP-XACT that its makers have published.
    Bus {
        key: "wishbone",
        title: "Wishbone",
        suffix: "wb",
        reset_level: 1,
        ports: "in wb_clk_i, in wb_rst_i, in wb_cyc_i - cyc, in wb_stb_i - stb, in wb_we_i - we, \
                in wb_adr_i # adr[:#], in wb_dat_i 32 dat_w, in wb_sel_i 4 sel, out wb_dat_o 32 dat_r, \
                out wb_ack_o - ack, out wb_err_o - err, out irq",
        protocol: &[],
        litex: "wishbone.Interface(data_width=32, address_width=32, addressing=\"byte\")",
        module: |name, regenerate, address_high| {
            Ok([
                fill!("wb.v" { name: &'a str, regenerate: &'a str, address_high: u32 })?,
                fill!("wb_formal.sv" { name: &'a str, address_high: u32 })?,
            ])
        },
    },
];
