//! Holds data of the supported FPGA families: delays, multipliers, Yosys commands, chips, and the weights for estimates of the
//! area. The families of Gowin share `gowin.rs`, and the families of iCE40 share `ice40.rs`. The file `generic.rs` has invented
//! delays, for a pipeline whose FPGA is not chosen yet (`pipeline.target = "generic"`).
//!
//! A delay is in nanoseconds and includes the wire to the next cell. The head of a family's file says which of its delays were
//! measured, and how.
//!
//! The heads have tables of measurements. In these tables, `any of 4` is the OR of 4 bits, and `equal 16` compares two numbers
//! of 16 bits. `words of 5 bits of address` reads a table of 32 words that is stored in look-up tables.

mod ecp5;
mod gatemate;
mod generic;
mod gowin;
mod ice40;
mod nexus;
mod xilinx7;

pub use ecp5::ECP5;
pub use gatemate::GATEMATE;
pub use gowin::{GOWIN, GOWIN_GW1N};
pub use ice40::{ICE40, ICE40_HX};
pub use nexus::NEXUS;
pub use xilinx7::XILINX7;

use generic::GENERIC;

/// A small memory of look-up tables. A pipeline keeps a value there if no stage reads the value for several stages. For example,
/// 16 words of 4 bits take six look-up tables on ECP5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DelayMemory {
    /// The number of words.
    pub words: u32,
    /// The number of bits of a word.
    pub width: u32,
    /// The number of look-up tables, including the write logic of the memory.
    pub tables: u32,
}

impl DelayMemory {
    /// Returns the number of look-up tables of the memories for `words` words of `bits` bits, without the address counter.
    pub fn tables_for(self, words: usize, bits: u32) -> u32 {
        bits.div_ceil(self.width) * (words as u32).div_ceil(self.words) * self.tables
    }

    /// Returns whether a memory of `words` words of `bits` bits takes fewer look-up tables and registers than the registers that
    /// it replaces. The memory's address counter is included. On ECP5, 3 words of 4 bits pay, and 2 words do not. A single word
    /// never pays.
    pub fn pays(self, words: usize, bits: u32) -> bool {
        let tables = self.tables_for(words, bits);
        let words = words as u32;
        let counter = words.next_power_of_two().trailing_zeros();
        words > 1 && words * bits > tables + 2 * counter
    }
}

/// The delays of a multiplier with an output register, in nanoseconds, without the delay of an ordinary register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registered {
    /// The delay from the multiplier's operands to the setup of its output register.
    pub product: f64,
    /// The delay from the rising edge to the multiplier's output.
    pub output: f64,
}

/// A target's delays in nanoseconds, and the sizes of its multipliers and memories, for the scheduler of pipelines.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The value of the configuration key `pipeline.target`.
    pub name: &'static str,
    /// The largest widths of a multiplier's unsigned operands in bits, the wider operand first. For example, (18, 18) on ECP5.
    pub multiplier: (u32, u32),
    /// The largest partial product that Glint adds up in look-up tables instead of a multiplier, as the number of bits in all
    /// rows. On ECP5, three rows of 21 bits and their sums take about 110 look-up tables, and four rows of 22 bits about 160. The
    /// limit is higher for iCE40, because its smaller chips have few multipliers.
    pub row_bits: u32,
    /// The delay from the rising edge to a register's output, plus the wire to the next register and its setup.
    pub register: f64,
    /// The part of the clock period before an operand arrives at an input port from outside the core.
    pub input: f64,
    /// The delay of one level of look-up tables, with the wire to the next level.
    pub logic: f64,
    /// The delay of a table in look-up tables for each address bit beyond the third. For example, a table of 64 words (6 bits of
    /// address) takes three times this delay.
    pub word_bit: f64,
    /// The delay of the start and the end of a carry chain together, whatever its length.
    pub carry: f64,
    /// The delay of each bit of a carry chain.
    pub carry_bit: f64,
    /// The delay of a multiplier without an output register.
    pub product: f64,
    /// The delays of a multiplier with an output register, or `None` if they were not measured.
    pub registered: Option<Registered>,
    /// The delay from the rising edge to a block memory's output, without a register's delay.
    pub block: f64,
    /// The extra delay of the wire to a block memory's address, compared with a wire to a register. Block memories occupy only a
    /// few columns of the chip.
    pub address: f64,
    /// The block memories, with the ROMs that synthesis puts into them.
    pub blocks: BlockMemory,
    /// A memory of look-up tables that is read without a clock. `None` if the target has no such memory, or if synthesis makes
    /// shift registers of look-up tables.
    pub delay_memory: Option<DelayMemory>,
}

/// The block memories of a family, and when synthesis uses them for synchronous ROMs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockMemory {
    /// The number of bits of a block.
    pub bits: u64,
    /// The width of a block's widest word in bits, such as 36 on ECP5.
    pub widest: u64,
    /// The largest number of bits per block of a ROM that synthesis still puts into look-up tables.
    pub most_bits_without: u64,
}

impl BlockMemory {
    /// Returns the number of blocks for a ROM of `words` words of `width` bits. A block has twice as many words if each has half
    /// the width. For example, a block of 18 432 bits has 512 words of 36 bits, or 1024 words of 18 bits.
    pub fn count(&self, words: u64, width: u64) -> u64 {
        let mut block_width = self.widest;
        while block_width > 0 {
            if self.bits / block_width >= words {
                return width.div_ceil(block_width);
            }
            block_width /= 2;
        }
        (words * width).div_ceil(self.bits)
    }

    /// Returns whether synthesis puts a synchronous ROM of `words` words of `width` bits into blocks. On ECP5, 64 words of 33
    /// bits go into blocks, and 64 words of 32 bits into look-up tables.
    pub fn takes(&self, words: u64, width: u64) -> bool {
        words * width > self.most_bits_without * self.count(words, width)
    }
}

/// An FPGA chip and its resources.
#[derive(Debug)]
pub struct Chip {
    /// The chip's name as people write it.
    pub name: &'static str,
    /// Options with which nextpnr selects the chip and its package. The text is empty if Glint does not run nextpnr for the chip.
    pub options: &'static str,
    /// The numbers of look-up tables, DSP blocks and block RAMs, in this order.
    pub has: [u64; 3],
}

impl Chip {
    /// Returns each resource that the chip lacks: the index in `wanted`, the number that the design needs, and the number on the
    /// chip. `wanted` has the numbers of look-up tables, DSP blocks and block RAMs. For example, 6000 look-up tables and 8 DSP
    /// blocks give `(0, 6000, 5280)` on the iCE40 UP5K.
    pub fn lack(&self, wanted: [u64; 3]) -> Vec<(usize, u64, u64)> {
        let all = wanted.into_iter().zip(self.has).enumerate();
        all.filter(|(_, (wanted, has))| wanted > has)
            .map(|(at, (wanted, has))| (at, wanted, has))
            .collect()
    }
}

/// The parameters with which Glint estimates the cost of a core without synthesis.
#[derive(Debug)]
pub struct Estimate {
    /// The weight of each number in `glint_rtl::area::Features` for the number of look-up tables. One weight is the constant number of every
    /// core.
    pub weights: [f64; 6],
    /// The measured clock period divided by the period that the delays predict.
    pub scale: f64,
    /// The number of bits by which a signed operand of a DSP block may be wider than an unsigned one.
    pub sign: u32,
    /// The smallest number of result bits with which a product, or a part of a wide product, takes a DSP block. Smaller products
    /// become look-up tables.
    pub least_product: u32,
    /// The part of its own delay that a sum adds to the delay of a sum before it.
    pub chained_sum: f64,
}

/// Kinds of cells in a netlist of Yosys, each with the number of resources that one cell counts for. For example, `("CCU2C", 2)`
/// counts each carry cell of ECP5 as two look-up tables.
pub type Kinds = &'static [(&'static str, u64)];

/// The products of a family without DSP blocks.
#[derive(Clone, Copy, Debug)]
pub struct FabricProduct {
    /// The cell that multiplies, or `None` if Yosys makes sums of ordinary look-up tables.
    pub cell: Option<&'static str>,
    /// Returns the number of look-up tables of a product, from the widths of its operands in bits.
    pub luts: fn(u64, u64) -> u64,
}

/// An FPGA family: delays, Yosys commands, cell names and chips.
#[derive(Debug)]
pub struct Family {
    /// The family's name as people write it.
    pub title: &'static str,
    /// The delays for schedules of pipelines and for estimates of the clock.
    pub timing: Timing,
    /// The Yosys command that reads the models of the cells that a core may instantiate. The text is empty if no command is
    /// needed.
    pub library: &'static str,
    /// The Yosys commands before each of `commands`. The text may be empty. The name of the top module replaces `{top}`.
    pub prepare: &'static str,
    /// The Yosys commands that synthesise for the family, without the top module's name. Of several commands, the command with
    /// the fewest look-up tables gives a core's area. The first command gives netlists.
    pub commands: &'static [&'static str],
    /// The oldest version of Yosys that synthesises for the family as Glint expects. For example, (0, 23) is Yosys 0.23.
    pub least_yosys: (u32, u32),
    /// The cells that are look-up tables. A carry cell that replaces two look-up tables counts as two.
    pub luts: Kinds,
    /// The products of look-up tables, or `None` for a family with DSP blocks.
    pub fabric_product: Option<FabricProduct>,
    /// The cells that are DSP blocks. The list is empty for a family without DSP blocks.
    pub dsps: Kinds,
    /// The cells that are block RAMs, which have 4 kbit in iCE40, 20 kbit in GateMate and 18 kbit in the other families.
    pub block_rams: Kinds,
    pub flip_flops: Kinds,
    /// The chips, from a small and common one to the largest.
    pub chips: &'static [Chip],
    pub estimate: Estimate,
}

/// The Yosys commands that make logic of each ROM whose word no register holds. Such a ROM is a table in look-up tables, which
/// the schedule of a pipeline places after the register of its address. The pass `memory_dff`, which each synthesis command runs,
/// would move the table in front of this register, into a stage without the time. It would also add a register for each bit of
/// the word.
///
/// Words that a table does not have become undefined constants. The selection `clocked` contains the memories from which a wire
/// leads to the input of a flip-flop.
const TABLES: &str = "proc; flatten; opt_expr; opt_clean; opt; memory_collect; \
    select -set flip_flops t:$dff t:$dffe t:$sdff t:$sdffe t:$sdffce; \
    select -set clocked @flip_flops %ci1:+[D] w:* %i %ci1 t:$mem_v2 %i; \
    memory_map -rom-only t:$mem_v2 @clocked %d; opt_expr -undriven; opt_clean; ";

impl Family {
    /// Returns the commands of Yosys that map the module `top` and its instances to cells of the family. For ECP5 they end with
    /// `synth_ecp5 -top rough` if `top` is `rough`.
    pub fn script(&self, top: &str) -> String {
        self.script_with(self.commands[0], top)
    }

    /// Returns the commands of [`Self::script`] with `command`, one of [`Self::commands`], for the synthesis.
    pub fn script_with(&self, command: &str, top: &str) -> String {
        format!(
            "{}hierarchy -check -top {top}; {TABLES}{}{command} -top {top}",
            self.library,
            self.prepare.replace("{top}", top)
        )
    }

    /// Returns the family's name in commands and scripts, such as `ice40`.
    pub const fn name(&self) -> &'static str {
        self.timing.name
    }
}

/// The families for which Glint can synthesise cores.
pub const FAMILIES: [Family; 8] =
    [ICE40, ICE40_HX, ECP5, XILINX7, GOWIN, GOWIN_GW1N, NEXUS, GATEMATE];

/// The families for which datasheets, `compare` and `verify` synthesise every core.
pub const COMPARED: [Family; 3] = [ICE40, ECP5, XILINX7];

/// The targets for which Glint can schedule pipelines.
pub const TIMINGS: [Timing; 9] = [
    ECP5.timing,
    ICE40.timing,
    ICE40_HX.timing,
    XILINX7.timing,
    GOWIN.timing,
    GOWIN_GW1N.timing,
    NEXUS.timing,
    GATEMATE.timing,
    GENERIC,
];

/// The values of the configuration key `pipeline.target`.
pub const TIMING_NAMES: [&str; TIMINGS.len()] = {
    let mut names = [""; TIMINGS.len()];
    let mut at = 0;
    while at < names.len() {
        names[at] = TIMINGS[at].name;
        at += 1;
    }
    names
};

impl Timing {
    /// Returns the target with this name, such as `ecp5`, or `None` for an unknown name.
    pub fn named(name: &str) -> Option<&'static Self> {
        TIMINGS.iter().find(|timing| timing.name == name)
    }

    /// Returns the family with these delays, or `None` for the target `generic`, which has no family.
    pub fn family(&self) -> Option<&'static Family> {
        FAMILIES.iter().find(|family| family.timing.name == self.name)
    }

    /// Returns the delay of an adder with `width` bits in nanoseconds. For example, 21 bits take 2.4 ns on ECP5.
    pub fn chain(&self, width: u32) -> f64 {
        self.carry + self.carry_bit * f64::from(width)
    }
}

/// The resources of a design after synthesis, before placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// The number of look-up tables.
    pub luts: u64,
    pub dsps: u64,
    pub block_rams: u64,
    pub flip_flops: u64,
}

impl Usage {
    pub fn taken(&self) -> [u64; 3] {
        [self.luts, self.dsps, self.block_rams]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Yosys 0.23 and 0.70 put these synchronous ROMs into look-up tables or into blocks.
    #[test]
    fn roms_are_where_synthesis_puts_them() {
        let in_tables = [
            ("ecp5", 64, 32),
            ("ecp5", 64, 64),
            ("ecp5", 32, 72),
            ("ecp5", 512, 4),
            ("ice40", 128, 8),
            ("ice40", 64, 36),
            ("ice40", 64, 80),
            ("xilinx7", 512, 16),
            ("gatemate", 64, 81),
            ("nexus", 256, 8),
            ("gowin", 128, 16),
        ];
        let in_blocks = [
            ("ecp5", 64, 33),
            ("ecp5", 64, 65),
            ("ecp5", 4096, 1),
            ("ice40", 128, 9),
            ("ice40", 256, 33),
            ("xilinx7", 512, 17),
            ("xilinx7", 2048, 8),
            ("gatemate", 64, 80),
            ("nexus", 64, 33),
            ("gowin", 256, 9),
        ];
        for (roms, is_block) in [(&in_tables[..], false), (&in_blocks[..], true)] {
            for &(name, words, width) in roms {
                let family = FAMILIES.iter().find(|it| it.timing.name == name).expect("a family");
                let is_taken = family.timing.blocks.takes(words, width);
                assert_eq!(is_taken, is_block, "{name}: {words} words of {width} bits");
            }
        }
    }
}
