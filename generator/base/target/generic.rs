//! Delays of a generic device, for a pipeline whose FPGA is unknown.

use super::{BlockMemory, Timing};

/// The generic target, whose delays belong to no real chip. A level of logic takes one nanosecond.
pub const GENERIC: Timing = Timing {
    name: "generic",
    multiplier: (18, 18),
    row_bits: 256,
    register: 1.5,
    input: 2.0,
    logic: 1.0,
    word_bit: 0.8,
    carry: 1.5,
    carry_bit: 0.05,
    product: 6.0,
    registered: None,
    block: 4.0,
    address: 0.8,
    blocks: BlockMemory { bits: 18_432, widest: 36, most_bits_without: 4095 },
    delay_memory: None,
};
