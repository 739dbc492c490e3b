//! Holds the data of the AMD 7 series. The delays are estimates. `benches/tune/fit` computed the weights for the cost from 59
//! cores, highlights and expressions. For half of these cores, the estimated number of look-up tables is within 14 % of the
//! number after synthesis. The worst is the sequential `lyon` (112 tables estimated, and 73 measured).

use super::{BlockMemory, Chip, Estimate, Family, Timing};

/// The family of the AMD 7 series, with delays for speed grade −1.
pub const XILINX7: Family = Family {
    title: "Xilinx 7",
    timing: Timing {
        name: "xilinx7",
        multiplier: (24, 17),
        row_bits: 256,
        register: 1.2,
        input: 2.0,
        logic: 0.8,
        word_bit: 0.64,
        carry: 1.0,
        carry_bit: 0.03,
        product: 3.9,
        registered: None,
        block: 2.5,
        address: 0.5,
        blocks: BlockMemory { bits: 18_432, widest: 36, most_bits_without: 8192 },
        delay_memory: None,
    },
    library: "",
    prepare: "",
    // The command omits -abc9, in which Yosys 0.23 crashes.
    commands: &["synth_xilinx -flatten"],
    least_yosys: (0, 23),
    luts: &[("LUT1", 1), ("LUT2", 1), ("LUT3", 1), ("LUT4", 1), ("LUT5", 1), ("LUT6", 1)],
    fabric_product: None,
    dsps: &[("DSP48E1", 1)],
    block_rams: &[("RAMB18E1", 1), ("RAMB36E1", 2)],
    flip_flops: &[("FDRE", 1), ("FDSE", 1)],
    chips: &[Chip { name: "XC7A35T", options: "", has: [20_800, 90, 100] }],
    estimate: Estimate {
        weights: [0.38, 0.56, 0.93, 1.11, 0.69, 5.14],
        scale: 1.0,
        sign: 1,
        least_product: 9,
        chained_sum: 1.0,
    },
};
