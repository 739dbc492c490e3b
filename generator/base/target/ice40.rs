//! Data of Lattice iCE40. The delays are estimates. `benches/tune/fit` computed the weights for the cost from 20 of the cores
//! in `records/synthesis/`, sequential and pipelined. For half of these cores, the estimate of look-up tables is within 9 % of
//! the number after synthesis. The worst is `threshold` (33 % too many). Three pipelines are no part of the fit: the estimate
//! of `lyon_up5k_pipelined` is 51 % too high, of `rough_up5k_pipelined` 10 % too high, and of `shading_pipelined` 31 % too low.

use super::{BlockMemory, Chip, Estimate, Family, Timing};

/// Puts products into DSP blocks as multipliers alone. `synth_ice40 -dsp` would move registers and adders into the blocks too.
/// No tool knows the delays of such blocks: `icetime` treats them as the end of every path.
const PURE_MULTIPLIERS: &str = "synth_ice40 -top {top} -run begin:coarse; opt; wreduce; peepopt; opt_clean; memory_dff; \
    wreduce t:$mul; techmap -map +/mul2dsp.v -map +/ice40/dsp_map.v -D DSP_A_MAXWIDTH=16 \
    -D DSP_B_MAXWIDTH=16 -D DSP_A_MINWIDTH=2 -D DSP_B_MINWIDTH=2 -D DSP_Y_MINWIDTH=11 -D DSP_NAME=$__MUL16X16; \
    select a:mul2dsp; setattr -unset mul2dsp; opt_expr -fine; wreduce; select -clear; \
    chtype -set $mul t:$__soft_mul; ";

/// The delays are for the chip UP5K.
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
    command: "synth_ice40 -run coarse:",
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
        weights: [1.24, 0.66, 0.40, 1.23, 0.30, 0.48],
        scale: 0.92,
        sign: 0,
        least_product: 11,
    },
};
