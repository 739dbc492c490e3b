//! Describes the buses on which a core's registers can be: AXI4-Lite and Wishbone.
//!
//! Each bus is a row of data: the value of the key `interface.registers`, the ports, and the templates of its Verilog.

use anyhow::Result;
use glint_base::fill;

/// A bus, such as AXI4-Lite, on which software can reach the registers of a core.
#[derive(Debug)]
pub struct Bus {
    pub key: &'static str,
    pub title: &'static str,
    /// The suffix of module names on this bus, for example `axil` in `threshold_levels_axil`.
    pub suffix: &'static str,
    /// The level of the reset port while the bus is in reset.
    pub reset_level: u8,
    /// The ports of the bus module as text, clock and reset first. Each has a direction, a name, the width of a vector and, if
    /// LiteX connects the port, the name of its LiteX signal. `#` denotes the number of bits of an address.
    pub ports: &'static str,
    /// The standard interfaces that tools recognise by the names of the ports.
    pub protocol: &'static [Protocol],
    /// The Python expression that makes this bus in LiteX.
    pub litex: &'static str,
    /// Makes the Verilog of the bus module and of its proof. The parameters are the name of the core, the command that
    /// generates the core again, and the highest bit of an address.
    pub module: fn(&str, &str, u32) -> Result<[String; 2]>,
}

impl PartialEq for Bus {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

/// A standard interface, which tools recognise by the names of its ports.
#[derive(Debug)]
pub struct Protocol {
    /// The prefix of the names of the interface's ports, such as `s_axis`.
    pub name: &'static str,
    /// The name in ARM's definitions for IP-XACT.
    pub amba: &'static str,
    /// The version of ARM's definition, for IP-XACT.
    pub version: &'static str,
    /// The type in Intel's Platform Designer.
    pub platform: &'static str,
    /// Whether the module is the receiving side of the interface.
    pub is_slave: bool,
}

pub static STREAMS: [Protocol; 2] = [stream("s_axis", true), stream("m_axis", false)];

const fn stream(name: &'static str, is_slave: bool) -> Protocol {
    Protocol { name, amba: "AXI4Stream", version: "r0p0_1", platform: "axi4stream", is_slave }
}

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
