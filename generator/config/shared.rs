//! Declares the configuration keys that every device has, including devices that a user adds, except `device`, `name` and
//! `strict`. These keys choose the hardware's architecture, its interface and the generated files, not the function that the
//! hardware computes.
//!
//! [`Config::to_toml`](super::Config::to_toml) writes a shared key only with a value other than the default, so the digests in
//! older records stay valid.

use std::sync::LazyLock;

use super::schema::{Key, Schema};
use super::text_pattern::TextPattern;
use glint_base::target::TIMING_NAMES;

/// The default of `interface.queue`, with which a configuration needs no bus registers.
pub(super) const DEFAULT_QUEUE: &str = "4";

/// Returns the shared keys in the order in which a written file shows them.
pub fn shared_keys() -> &'static [Key] {
    &KEYS
}

static KEYS: LazyLock<Vec<Key>> = LazyLock::new(Shared::keys);

/// The values of `pipeline.interval`: `auto`, or a number of clocks from 1 to 64.
static INTERVALS: [&str; 65] = [
    "auto", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16",
    "17", "18", "19", "20", "21", "22", "23", "24", "25", "26", "27", "28", "29", "30", "31", "32",
    "33", "34", "35", "36", "37", "38", "39", "40", "41", "42", "43", "44", "45", "46", "47", "48",
    "49", "50", "51", "52", "53", "54", "55", "56", "57", "58", "59", "60", "61", "62", "63", "64",
];

keys! {
    /// The values of the shared keys.
    pub struct Shared {
        architecture: String = Key::choice("architecture", "sequential", &["sequential", "pipelined"],
            "sequential: a microprogram on shared arithmetic, which takes several clocks for each point. \
             pipelined: the unrolled microprogram, which accepts a point every clock."),
        target: String = Key::choice("pipeline.target", "ecp5", &TIMING_NAMES,
            "The FPGA family whose delays and multipliers determine the stages of the pipeline.")
            .only_when("architecture", "pipelined"),
        pipeline_clock_mhz: f64 = Key::number("pipeline.clock_mhz", 130.0, 1.0..=2000.0,
            "The clock frequency in MHz that every stage must reach. The schedule has the fewest registers for \
             it.")
            .only_when("architecture", "pipelined"),
        stages: u32 = Key::integer("pipeline.stages", 0, 0..=1000,
            "The number of stages, in place of a clock frequency. The schedule is then as fast as this number \
             allows. With 0, pipeline.clock_mhz decides.")
            .only_when("architecture", "pipelined"),
        interval: String = Key::choice("pipeline.interval", "1", &INTERVALS,
            "The number of clocks from one point to the next. One multiplier computes up to this many products \
             of a point. The limit is the number of clocks of the sequential core. With auto, pipeline.rate or \
             pipeline.max_multipliers decides.")
            .only_when("architecture", "pipelined"),
        rate: f64 = Key::number_or_zero("pipeline.rate", 0.001..=2000.0,
            "The least number of million points per second, at pipeline.clock_mhz. Glint chooses the longest \
             interval that reaches it.")
            .only_when("pipeline.interval", "auto"),
        max_multipliers: u32 = Key::integer("pipeline.max_multipliers", 0, 0..=1000,
            "The largest number of multipliers. Glint chooses the shortest interval that needs no more. With \
             0, pipeline.rate decides.")
            .only_when("pipeline.interval", "auto"),
        multipliers: String = Key::choice("pipeline.multipliers", "inferred", &["inferred", "registered"],
            "inferred: the synthesiser chooses DSP blocks for products. registered: each product is an \
             instance of <name>_multiplier, which uses the output register of a DSP block. This is faster, but \
             every product takes a DSP block.")
            .only_when("pipeline.target", "ecp5"),
        stall: String = Key::choice("pipeline.stall", "ready", &["ready", "none"],
            "ready: the pipeline stalls while out_ready is low. none: there is no out_ready, and all points \
             advance in every clock.")
            .only_when("architecture", "pipelined"),
        delays: String = Key::choice("pipeline.delays", "memory", &["memory", "registers", "auto"],
            "How the pipeline delays values that no logic reads for several stages. memory: small memories in \
             look-up tables, if the target has them. registers: one register per stage. auto: registers, which are \
             beside the look-up tables of the logic, and memories for values beyond them.").only_when("architecture", "pipelined"),
        side: u32 = Key::integer("pipeline.side", 0, 0..=64,
            "The width of side_in and side_out, which carry data of a point past the pipeline. For example, \
             the address of a pixel. 0 leaves the ports out.")
            .only_when("architecture", "pipelined"),
        output_registered: bool = Key::flag("output.registered", false,
            "Adds output registers behind results that are logic, such as a multiplier and a rounding adder \
             for a colour. The results are then valid one clock later.")
            .only_when("architecture", "sequential"),
        operands_buffered: bool = Key::flag("operands.buffered", false,
            "Adds buffers for operands, which can be written while the core computes. The next computation can \
             then start in the clock after the last clock of this one.")
            .only_when("architecture", "sequential"),
        operands_logic: String = Key::choice("operands.logic", "registered", &["registered", "combinational"],
            "registered: logic that depends only on operands has registers where a clock is free for them. \
             combinational: such logic has no registers.")
            .only_when("architecture", "sequential"),
        stream: bool = Key::flag("interface.stream", false,
            "Writes an AXI4-Stream wrapper of the core, <name>_axis.v."),
        user_bits: u32 = Key::integer("interface.user_bits", 1, 1..=1024,
            "The width of tuser, which carries data of a point past the core.")
            .only_when("interface.stream", "true"),
        data_width: String = Key::choice("interface.data_width", "bytes", &["bytes", "power-of-two"],
            "The number of bytes of a transfer. bytes: as many as the numbers need. power-of-two: the next \
             power of two, which DMA engines need.")
            .only_when("interface.stream", "true"),
        keep: bool = Key::flag("interface.keep", false,
            "Adds tkeep to both streams. It is all ones on m_axis, and the core ignores it on s_axis.")
            .only_when("interface.stream", "true"),
        registers: String = Key::choice("interface.registers", "none", &["none", "axi-lite", "wishbone"],
            "Writes a wrapper with bus registers: <name>_axil.v for AXI4-Lite, or <name>_wb.v for Wishbone."),
        queue: String = Key::choice("interface.queue", DEFAULT_QUEUE, &["1", "2", "4", "8", "16", "32", "64"],
            "How many points software can start in a pipeline before it reads the first results. With 1, the \
             results stay on their registers until the next computation ends.")
            .only_when("architecture", "pipelined")
            .joined_later(),
        processor: String = Key::choice("interface.processor", "none", &["none", "cfu", "pcpi"],
            "Writes a wrapper by which a RISC-V processor computes with one instruction: <name>_cfu.v for CFU \
             Playground and VexRiscv, or <name>_pcpi.v for PicoRV32, and software/<name>/<name>_instructions.h, \
             a function in C for each instruction."),
        software: bool = Key::flag("package.software", false,
            "Writes software/<name>/, a bit-exact model of the core in C."),
        recomputation: bool = Key::flag("package.recomputation", false,
            "Writes software/<name>/<name>_recompute.c. This program computes every combination of operands \
             with the memories of the core, compares it with the formulas by MPFR, and prints the largest \
             errors. It is for the devices function and expression, and for at most 2^32 combinations.")
            .only_when("package.software", "true"),
        memories: String = Key::choice("package.memories", "files", &["files", "inline", "case"],
            "Where the contents of ROMs are. files: in .mem files. inline: in the Verilog as initial values, \
             for flows that cannot find files. case: in the Verilog as a case statement, for flows that drop \
             initial values."),
        rom_style: String = Key::choice("package.rom_style", "auto", &["auto", "block", "distributed"],
            "The attribute rom_style of synchronous ROMs. block: block memory. distributed: look-up tables. \
             auto: the synthesiser decides."),
        initial_values: bool = Key::flag("package.initial_values", false,
            "Gives the registers of the core the initial value 0, except the output registers of ROMs. Without \
             initial values, a simulation has unknown values until the first reset and the first writes. \
             Wrappers need their reset in any case.")
            .only_when("architecture", "sequential"),
        litex: bool = Key::flag("package.litex", false,
            "Writes software/<name>/<name>_litex.py, the core as a LiteX module.")
            .only_when("package.memories", "inline"),
        constraints: bool = Key::flag("package.constraints", false,
            "Writes the clock constraints <top>.sdc and <top>.xdc."),
        clock_mhz: f64 = Key::number_or_zero("package.clock_mhz", 1.0..=2000.0,
            "The clock frequency in MHz in constraints and vendor projects. 0 means the frequency of the \
             pipeline, or 100 for a sequential core.")
            .only_when("package.constraints", "true"),
        vivado: bool = Key::flag("package.vivado", false,
            "Writes Tcl scripts for Vivado: <name>_vivado.tcl builds, and <name>_vivado_ip.tcl packages IP.")
            .only_when("package.constraints", "true"),
        quartus: bool = Key::flag("package.quartus", false,
            "Writes Tcl scripts for Quartus: <name>_quartus.tcl builds, and <top>_hw.tcl is for Platform \
             Designer.")
            .only_when("package.constraints", "true"),
        ip_xact: bool = Key::flag("package.ip_xact", false,
            "Writes IP-XACT components (IEEE 1685-2014): <top>.xml."),
        vhdl: bool = Key::flag("package.vhdl", false,
            "Writes <name>.vhd: a VHDL component for each module, and an entity of the core with ports of \
             ieee.fixed_pkg."),
        systemverilog: bool = Key::flag("package.systemverilog", false,
            "Writes <name>_pkg.sv: the number formats as SystemVerilog types, with conversions from and to \
             real."),
        vendor: String = Key::text("package.vendor", "glint", TextPattern::Name,
            "The vendor name for FuseSoC, IP-XACT, Vivado and Platform Designer, usually a domain name."),
        version: String = Key::text("package.version", "0.1.0", TextPattern::Version,
            "The version of the core for FuseSoC, IP-XACT, Vivado and Platform Designer."),
        licence: String = Key::text("package.licence", "LicenseRef-belongs-to-its-user", TextPattern::Licence,
            "The licence of the files for FuseSoC. Glint checks only the characters of this text. The \
             generated files belong to their user."),
    }
}

impl Schema {
    /// Returns the key `name`, one of the device's own or a shared one.
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.all_keys().find(|key| key.name == name)
    }

    /// Returns the device's keys, then the shared ones.
    pub fn all_keys(&self) -> impl Iterator<Item = &Key> {
        self.keys.iter().chain(shared_keys())
    }
}
