//! Divides the domain of a piecewise polynomial into segments, and finds the segment of an operand. Each segment has one word in
//! the table of coefficients.

/// The lengths of the segments along the domain. An octave is a block of operands with the same highest bit, counted from one end
/// of the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layout {
    /// All segments are equally long.
    Uniform,
    /// In each octave toward the low end of the domain, segments are half as long, for functions that are steep there.
    Octaves,
    /// In each octave toward the high end of the domain, segments are half as long.
    Halving,
}

impl Layout {
    /// The layouts with their names in configurations.
    pub const NAMES: [(&str, Self); 3] =
        [("uniform", Self::Uniform), ("octaves", Self::Octaves), ("halving", Self::Halving)];

    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, layout)| *layout == self).map_or("", |(name, _)| name)
    }
}

/// A division of the numbers from 0 to 2^`bits` − 1 into segments. The last segment may also contain a few numbers from 2^`bits`
/// on, the overhang.
///
/// An octave is the block of numbers with the same highest bit, such as 128 to 255. The numbers below the lowest octave form one
/// more block, which is as long as the lowest octave. All blocks have the same number of segments, 2^`prefix`. For example, `bits
/// = 8`, `octaves = 0` and `prefix = 4` give 16 segments of 16 numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segments {
    /// The number of bits of an operand's number, without the additional bit for an overhang.
    pub bits: u32,
    pub layout: Layout,
    /// The number of octaves that have segments of their own length; 0 if all segments are equally long.
    pub octaves: u32,
    /// The number of bits that select a segment within a block, which has 2^`prefix` segments.
    pub prefix: u32,
    /// The count of numbers from 2^`bits` on that belong to the last segment. The domain from 0 to 1 with both ends has an
    /// overhang of 1. Without it, the end 1 alone would double the number of segments.
    pub overhang: u64,
}

/// The segment of an operand, and its position there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SegmentOffset {
    /// The index of the segment's word in the table.
    pub word: usize,
    /// The distance from the middle of the segment, in units of 2^−[`Segments::rest`] of the segment's length. It is from −1/2 to
    /// below 1/2 of the length, and in the overhang 1/2 or more.
    pub offset: i64,
}

impl Segments {
    /// Returns the number of bits of an offset in the longest segment, without the additional bit for an overhang: 4 for 8-bit
    /// numbers in 16 uniform segments.
    pub fn rest(&self) -> u32 {
        self.bits - self.prefix - u32::from(self.octaves > 0)
    }

    /// Returns the number of bits of an operand's number, with the additional bit for an overhang.
    pub fn number_bits(&self) -> u32 {
        self.bits + self.extra_bit()
    }

    /// Returns the number of additional bits of numbers and offsets: 1 with an overhang, otherwise 0.
    pub fn extra_bit(&self) -> u32 {
        u32::from(self.overhang > 0)
    }

    /// Returns whether the last segment can contain the overhang. The longest segment must have at least four numbers, the
    /// overhang at most half as many, and the layout must not be `Halving`.
    pub fn holds_overhang(&self) -> bool {
        if self.overhang == 0 {
            return true;
        }
        let used = self.prefix + u32::from(self.octaves > 0);
        let fits = self.bits >= used + 2 && self.overhang <= 1 << (self.rest() - 1);
        fits && self.layout != Layout::Halving
    }

    /// Returns the number of bits of an offset in a segment of the block `block`. Block 0 lies below the octaves, and block k is
    /// octave k from below. 8-bit numbers with 3 octaves and a prefix of 2 bits have 3 bits in block 0 and 5 bits in block 3.
    pub fn rest_of(&self, block: u32) -> u32 {
        (self.bits + block.max(1) - 1) - self.octaves - self.prefix
    }

    /// Returns the number of words of the table: 16 for 3 octaves with a prefix of 2 bits.
    pub fn words(&self) -> usize {
        (self.octaves as usize + 1) << self.prefix
    }

    /// Counts a number from the end toward which octaves become shorter: `Halving` turns the 8-bit number 255 into 0.
    fn turned(&self, number: u64) -> u64 {
        match self.layout {
            Layout::Halving => ((1 << self.bits) - 1) - number,
            _ => number,
        }
    }

    /// Returns the segment and the offset of the operand with this number. 0x35 of 8 bits in 16 uniform segments has the word 3
    /// and the offset −3, since the middle of the segment is 0x38.
    #[inline]
    pub fn place(&self, number: u64) -> SegmentOffset {
        if self.overhang > 0 && number >> self.bits != 0 {
            let middle = (1 << self.rest()) / 2;
            let low = number & ((1 << self.rest()) - 1);
            return SegmentOffset { word: self.words() - 1, offset: (low ^ middle) as i64 };
        }
        let number = self.turned(number);
        let below = self.bits - self.octaves;
        let (block, within) = if self.octaves > 0 && number >> below != 0 {
            let top = number.ilog2();
            (top + 1 - below, number - (1 << top))
        } else {
            (0, number)
        };
        let rest = self.rest_of(block);
        let low = within & ((1 << rest) - 1);
        let word = ((block as usize) << self.prefix) + (within >> rest) as usize;
        let places = self.rest() - rest;
        let middle = (1 << self.rest()) / 2;
        SegmentOffset { word, offset: ((low << places) as i64) - middle }
    }

    /// Returns the lowest number in the segment of a word, and the count of its numbers, with the overhang for the last word.
    /// Word 3 of 16 uniform segments over 8 bits gives (48, 16).
    pub fn numbers(&self, word: usize) -> (u64, u64) {
        let block = (word >> self.prefix) as u32;
        let rest = self.rest_of(block);
        let within = (word as u64 & ((1 << self.prefix) - 1)) << rest;
        let first = if block == 0 { 0 } else { 1u64 << (self.bits - self.octaves + block - 1) };
        let is_last = word + 1 == self.words();
        let beyond = if is_last { self.overhang } else { 0 };
        let (from, count) = (first + within, (1u64 << rest) + beyond);
        (self.turned(from).min(self.turned(from + count - 1)), count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_lies_in_the_segment_of_its_word() {
        for layout in [Layout::Uniform, Layout::Octaves, Layout::Halving] {
            for octaves in if layout == Layout::Uniform { 0..=0 } else { 1..=3 } {
                for prefix in 0..=3 {
                    let cut = Segments { bits: 6, layout, octaves, prefix, overhang: 0 };
                    for number in 0..64 {
                        let SegmentOffset { word, offset } = cut.place(number);
                        let (first, count) = cut.numbers(word);
                        assert!(word < cut.words() && (first..first + count).contains(&number));
                        let half = (1i64 << cut.rest()) / 2;
                        assert!((-half..half.max(1)).contains(&offset), "{cut:?} {number}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_last_segment_contains_the_overhang() {
        for (layout, octaves) in [(Layout::Uniform, 0), (Layout::Octaves, 2)] {
            let cut = Segments { bits: 6, layout, octaves, prefix: 2, overhang: 2 };
            let last = cut.words() - 1;
            let half = (1i64 << cut.rest()) / 2;
            let (first, count) = cut.numbers(last);
            assert_eq!(first + count, 66, "{cut:?}");
            assert!(cut.holds_overhang());
            for (number, offset) in [(63, half - 1), (64, half), (65, half + 1)] {
                assert_eq!(cut.place(number), SegmentOffset { word: last, offset });
            }
            assert!(!Segments { overhang: 33, ..cut }.holds_overhang());
        }
    }

    #[test]
    fn octaves_are_shorter_toward_the_end_that_they_are_for() {
        let low = Segments { bits: 6, layout: Layout::Octaves, octaves: 2, prefix: 1, overhang: 0 };
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(|word| low.numbers(word)),
            [(0, 8), (8, 8), (16, 8), (24, 8), (32, 16), (48, 16)]
        );
        let high = Segments { layout: Layout::Halving, ..low };
        assert_eq!(high.numbers(5), (0, 16));
        assert_eq!(high.numbers(0), (56, 8));
    }
}
