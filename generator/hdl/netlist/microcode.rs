//! Packs the values of the fields of a microinstruction into a control word, and unpacks them.

/// Packs the fields of a microinstruction into a control word, the first field in the top bits. `widths` are in bits, and each
/// value must fit. For example, widths 2 and 1 with the values 1 and 1 give `0b011`.
pub fn pack(widths: &[u32], values: &[u64]) -> u64 {
    widths.iter().zip(values).fold(0, |word, (width, value)| word << width | value)
}

/// Returns the values of the fields in a control word: `0b011` with widths 2 and 1 gives 1 and 1.
pub fn unpack(widths: &[u32], word: u64) -> Vec<u64> {
    let mut rest = word;
    let mut values: Vec<u64> = widths
        .iter()
        .rev()
        .map(|&width| {
            let value = rest & glint_base::fixed::mask(width);
            rest = rest.checked_shr(width).unwrap_or(0);
            value
        })
        .collect();
    values.reverse();
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_stand_from_the_top() {
        // The patent's word 3: V1 V2 = 01, V3 = 1, V6 = 1, V9 = 1.
        let widths = [2, 1, 1, 1, 1, 1, 1, 1];
        let values = [1, 1, 0, 0, 1, 0, 0, 1];
        assert_eq!(pack(&widths, &values), 0b0_1100_1001);
        assert_eq!(unpack(&widths, 0b0_1100_1001), values);
    }
}
