//! Declares the configuration keys that every device has, including devices that a user adds. These keys choose the architecture
//! of the hardware, its interface and the generated files, not the function that the hardware computes. For example,
//! `architecture = "pipelined"` asks for a pipeline.
//!
//! [`Schema::key`] finds these keys like the keys of a device. A shared key that has its default is not written to a file, so
//! that the digests in older records stay valid.

use std::sync::LazyLock;

use super::schema::{Key, Schema};
use super::text_pattern::TextPattern;
use glint_base::target::TIMING_NAMES;

/// Returns the shared keys in the order in which a written file shows them. A file shows them after the keys of the device.
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
    /// The values of the shared keys in a configuration.
    pub struct Shared {
        architecture: String = Key::choice("architecture", "sequential", &["sequential", "pipelined"],
            "A microprogram on one set of arithmetic, or the same unrolled: a point every clock."),
        target: String = Key::choice("pipeline.target", "ecp5", &TIMING_NAMES,
            "Whose delays and multipliers decide what a stage of the pipeline does.")
            .only_when("architecture", "pipelined"),
        pipeline_clock_mhz: f64 = Key::number("pipeline.clock_mhz", 130.0, 1.0..=2000.0,
            "The clock that every stage must reach; the schedule has the fewest registers for it.")
            .only_when("architecture", "pipelined"),
        stages: u32 = Key::integer("pipeline.stages", 0, 0..=1000,
            "The number of stages, in place of a clock; as fast as they allow. 0: pipeline.clock_mhz decides.")
            .only_when("architecture", "pipelined"),
        interval: String = Key::choice("pipeline.interval", "1", &INTERVALS,
            "Clocks from a point to the next: a multiplier serves as many products. From 1 to the clocks of the sequential core, \
             or as pipeline.rate or pipeline.max_multipliers asks for.")
            .only_when("architecture", "pipelined"),
        rate: f64 = Key::number_or_zero("pipeline.rate", 0.001..=2000.0,
            "Million points a second at least, at pipeline.clock_mhz: the interval is the longest that has them.")
            .only_when("pipeline.interval", "auto"),
        max_multipliers: u32 = Key::integer("pipeline.max_multipliers", 0, 0..=1000,
            "The most multipliers: the interval is the shortest that has no more. 0: pipeline.rate decides.")
            .only_when("pipeline.interval", "auto"),
        multipliers: String = Key::choice("pipeline.multipliers", "inferred", &["inferred", "registered"],
            "Products as the synthesiser finds them, or in instances of <name>_multiplier, whose output register is that of \
             the DSP block: faster, and every product takes a block.")
            .only_when("pipeline.target", "ecp5"),
        stall: String = Key::choice("pipeline.stall", "ready", &["ready", "none"],
            "Whether out_ready can hold the results back; without it every register moves in every clock.")
            .only_when("architecture", "pipelined"),
        delays: String = Key::choice("pipeline.delays", "memory", &["memory", "registers"],
            "What holds values that no stage reads for some time: memory in look-up tables, where the target has such, \
             or a register a stage.").only_when("architecture", "pipelined"),
        side: u32 = Key::integer("pipeline.side", 0, 0..=64,
            "Bits of side_in and side_out, which travel with a point: a pixel's address, say.")
            .only_when("architecture", "pipelined"),
        output_registered: bool = Key::flag("output.registered", false,
            "Registers behind results that are logic: a multiplier and a rounding adder for a colour. They are valid a clock later.")
            .only_when("architecture", "sequential"),
        operands_buffered: bool = Key::flag("operands.buffered", false,
            "Buffers that take operands while a point is computed. The next one then begins in the clock after the last of this one.")
            .only_when("architecture", "sequential"),
        operands_logic: String = Key::choice("operands.logic", "registered", &["registered", "combinational"],
            "Logic of operands alone: with registers in it where there is a clock to spare, or without.")
            .only_when("architecture", "sequential"),
        stream: bool = Key::flag("interface.stream", false,
            "Write an AXI4-Stream wrapper of the core, <name>_axis.v."),
        user_bits: u32 = Key::integer("interface.user_bits", 1, 1..=1024,
            "Bits of tuser, the side channel that travels with a point.")
            .only_when("interface.stream", "true"),
        data_width: String = Key::choice("interface.data_width", "bytes", &["bytes", "power-of-two"],
            "Bytes of a transfer: as many as its numbers take, or a power of two, as DMA engines have it.")
            .only_when("interface.stream", "true"),
        keep: bool = Key::flag("interface.keep", false,
            "Both streams have tkeep: all ones on m_axis, and not looked at on s_axis.")
            .only_when("interface.stream", "true"),
        registers: String = Key::choice("interface.registers", "none", &["none", "axi-lite", "wishbone"],
            "Write registers around the core: <name>_axil.v on AXI4-Lite, <name>_wb.v on Wishbone.")
            .only_when("architecture", "sequential"),
        software: bool = Key::flag("package.software", false,
            "Write software/<name>/: a bit-accurate model of the core in C."),
        recomputation: bool = Key::flag("package.recomputation", false,
            "Write software/<name>/<name>_recompute.c: a program with MPFR that computes every combination of operands from formulas and \
             memories, and prints the largest errors. For the devices function and expression, and up to 2^32 combinations.")
            .only_when("package.software", "true"),
        memories: String = Key::choice("package.memories", "files", &["files", "inline", "case"],
            "Whether ROM contents are .mem files, or stand in the Verilog, for flows that do not find files: as initial values, or as \
             the choices of a case, for flows that drop those."),
        rom_style: String = Key::choice("package.rom_style", "auto", &["auto", "block", "distributed"],
            "Where ROMs that are read on the clock are to be, as their attribute rom_style says: block memory, look-up tables, or \
             as the synthesiser finds."),
        initial_values: bool = Key::flag("package.initial_values", false,
            "Registers of the core are 0 before the first clock, but for those that ROMs are read into. Without it a simulation has unknown \
             values until the first reset and the first writes; wrappers need their reset all the same.")
            .only_when("architecture", "sequential"),
        litex: bool = Key::flag("package.litex", false,
            "Write software/<name>/<name>_litex.py: the core as a module of LiteX.")
            .only_when("package.memories", "inline"),
        constraints: bool = Key::flag("package.constraints", false,
            "Write the clock as constraints: <top>.sdc and <top>.xdc."),
        clock_mhz: f64 = Key::number_or_zero("package.clock_mhz", 1.0..=2000.0,
            "The frequency of the clock in constraints and vendors' projects. 0 for that of the pipeline, \
             or 100 for a sequential core.")
            .only_when("package.constraints", "true"),
        vivado: bool = Key::flag("package.vivado", false,
            "Write Tcl for Vivado: <name>_vivado.tcl builds, <name>_vivado_ip.tcl packages IP.")
            .only_when("package.constraints", "true"),
        quartus: bool = Key::flag("package.quartus", false,
            "Write Tcl for Quartus: <name>_quartus.tcl builds, <top>_hw.tcl is for Platform Designer.")
            .only_when("package.constraints", "true"),
        ip_xact: bool = Key::flag("package.ip_xact", false,
            "Write IP-XACT components (IEEE 1685-2014): <top>.xml."),
        vhdl: bool = Key::flag("package.vhdl", false,
            "Write <name>.vhd: each module as a component of VHDL, and the core as an entity with ports of ieee.fixed_pkg."),
        systemverilog: bool = Key::flag("package.systemverilog", false,
            "Write <name>_pkg.sv: the numbers as types of SystemVerilog, with conversions from and to real."),
        vendor: String = Key::text("package.vendor", "glint", TextPattern::Name,
            "The vendor for FuseSoC, IP-XACT, Vivado and Platform Designer; a domain name, as a rule."),
        version: String = Key::text("package.version", "0.1.0", TextPattern::Version,
            "The version of the core for FuseSoC, IP-XACT, Vivado and Platform Designer."),
        licence: String = Key::text("package.licence", "LicenseRef-belongs-to-its-user", TextPattern::Licence,
            "The licence of the files for FuseSoC, of which only the characters are checked. What Glint generates belongs to its user."),
    }
}

impl Schema {
    /// Returns the key with this name, one of the device's own keys or of [`shared_keys`]. Returns `None` for an unknown name.
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.all_keys().find(|key| key.name == name)
    }

    /// Returns the keys of the device, then the keys that every device shares.
    pub fn all_keys(&self) -> impl Iterator<Item = &Key> {
        self.keys.iter().chain(shared_keys())
    }
}
