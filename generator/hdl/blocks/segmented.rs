//! Builds a table that approximates a function of one operand by linear interpolation, in segments that become shorter toward 0.
//! For example, `rough` has such a table of sines.
//!
//! The operand u is an integer of C bits, or exactly 2^C. Range j has the values of u in [2^(C−2j−2), 2^(C−2j)). Range 0 is the
//! upper three quarters of all values, range 1 the upper three quarters of the rest. In range j, the upper k_j of the C−2j bits
//! of u select a segment. Below the last range, every value of u has its own entry.

use crate::dsl::{Designer, Signal};
use glint_base::fixed::{Format, Overflow, Rounding, exp2};

/// Divides a table's operand into ranges and segments.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// The C of the module documentation.
    pub operand_bits: u32,
    /// For each range j, the number k_j of bits that select a segment, from 2 to C−2j. A range with k_j = 6 has 48 segments:
    /// three quarters of 2^6, because the lowest quarter belongs to the next ranges.
    pub segments: Vec<u32>,
}

/// The table entries of a range, or of the values below the last range.
#[derive(Clone, Copy, Debug)]
struct EntryBlock {
    /// The number of bits of u: C−2j for range j.
    bits: u32,
    /// The number of address bits within the block, k_j for range j.
    prefix: u32,
    /// The address of the block's first entry.
    base: u32,
}

/// An entry of the table, raw values in the formats of [`SegmentedFormats`]: with 8 fraction bits, a base of 128 is 0.5.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    /// The value at the start of the segment, with S fraction bits.
    pub base: i128,
    /// The rise over the whole segment, not negative, with D fraction bits.
    pub slope: i128,
}

/// Returns the entry whose straight line approximates a concave, rising function with the smallest error over a segment. The
/// slope is the slope of the chord, and the base makes the largest errors above and below equal. A segment of one value has the
/// function's value and the slope 0. The base is rounded to S fraction bits and saturated to `u0.S`. `function` maps a value of u
/// to a result from 0 to 1.
pub fn chord(segment: Segment, shape: SegmentedFormats, function: impl Fn(f64) -> f64) -> Entry {
    let value = Format::unsigned(0, shape.fraction);
    let (from, length) = (segment.from as f64, segment.length as f64);
    if segment.length == 1 {
        return Entry { base: value.quantise(function(from)), slope: 0 };
    }
    let scale = exp2(shape.slope_fraction);
    let slope = ((function(from + length) - function(from)) * scale + 0.5).floor();
    let residual = |at: f64| slope / scale * at / length - function(from + at);
    // The residual is largest at an end of the segment, and smallest where the curve is parallel to the line.
    let last = length - 1.0;
    let most = residual(0.0).max(residual(last));
    let (mut low, mut high) = (0.0, last);
    while high - low > 2.0 {
        let third = (high - low) / 3.0;
        let (a, b) = ((low + third).floor(), (high - third).ceil());
        if residual(a) > residual(b) {
            low = a;
        } else {
            high = b;
        }
    }
    let middle = ((low + high) / 2.0).floor();
    let least = [low, middle, high].into_iter().map(residual).fold(f64::MAX, f64::min);
    let base = value.quantise(-(least + most) / 2.0);
    Entry { base, slope: slope as i128 }
}

/// Neighbouring values of u that one entry of the table serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The first value of u.
    pub from: u64,
    /// The number of values of u.
    pub length: u64,
}

/// The formats of a table.
#[derive(Clone, Copy, Debug)]
pub struct SegmentedFormats {
    /// The number S of fraction bits of a value in `u0.S`.
    pub fraction: i32,
    /// The number D of fraction bits of a slope.
    pub slope_fraction: i32,
    /// Whether the ROM is read at the rising edge.
    pub synchronous: bool,
}

impl Segmentation {
    /// Returns the blocks in the order of the ranges, with the values below the last range at the end. In the ROM, larger blocks
    /// come first. Each block is then aligned to its size, so that an address consists of constant upper bits and the upper bits
    /// of u.
    fn blocks(&self) -> Vec<EntryBlock> {
        let ranges = self.segments.len() as u32;
        let rest = self.operand_bits - 2 * ranges;
        let mut blocks: Vec<EntryBlock> = Vec::new();
        for (range, &prefix) in (0u32..).zip(&self.segments) {
            blocks.push(EntryBlock { bits: self.operand_bits - 2 * range, prefix, base: 0 });
        }
        blocks.push(EntryBlock { bits: rest, prefix: rest, base: 0 });
        let mut order: Vec<usize> = (0..blocks.len()).collect();
        order.sort_by_key(|&at| std::cmp::Reverse(blocks[at].prefix));
        let mut next = 0;
        for at in order {
            blocks[at].base = next;
            next += 1 << blocks[at].prefix;
        }
        blocks
    }

    /// Returns the largest number of lower bits of u that a slope multiplies, at least 1.
    fn rest_bits(&self) -> u32 {
        self.blocks().iter().map(|block| block.bits - block.prefix).max().unwrap_or(0).max(1)
    }

    /// Returns the number of words of the table. C = 20 and the numbers k_j = 6, 8, 7, 6, 5, 4, 3, 3, 2 give the 584 words of ROM
    /// 18 (numbered by the patent) in `rough`.
    pub fn entries(&self) -> usize {
        self.blocks()
            .iter()
            .map(|block| block.base as usize + (1 << block.prefix))
            .max()
            .unwrap_or(0)
    }

    /// Returns the segment of each word by address, or `None` for a word that no value of u reads. One word serves u = 2^C alone.
    pub fn segment_of_words(&self) -> Vec<Option<Segment>> {
        let mut words = vec![None; self.entries()];
        let blocks = self.blocks();
        for (at, block) in blocks.iter().enumerate() {
            let is_rest = at + 1 == blocks.len();
            let length = 1u64 << (block.bits - block.prefix);
            let first = if is_rest { 0 } else { 1u64 << (block.prefix - 2) };
            for prefix in first..1 << block.prefix {
                words[block.base as usize + prefix as usize] =
                    Some(Segment { from: prefix * length, length });
            }
        }
        let top = blocks.first().map_or(0, |block| block.base as usize);
        words[top] = Some(Segment { from: 1 << self.operand_bits, length: 1 });
        words
    }
}

/// Makes the table and its interpolation, and returns the interpolated value in `u0.S`, truncated. `u` must be an integer from 0
/// to 2^C. `cut` divides the values of `u` into segments, and `entry` gives a segment's entry. `block` is the ROM's number in the
/// source's block diagram.
///
/// With `shape.synchronous`, the result belongs to the `u` of the clock before.
#[track_caller]
pub fn interpolate<'d>(
    d: &'d Designer,
    name: &str,
    u: Signal<'d>,
    cut: &Segmentation,
    shape: SegmentedFormats,
    entry: impl Fn(Segment) -> Entry,
    block: Option<u16>,
) -> Signal<'d> {
    let words = cut.segment_of_words();
    let entries: Vec<Entry> =
        words.iter().map(|segment| segment.map_or_else(Entry::default, &entry)).collect();
    let slope_most = entries.iter().map(|entry| entry.slope).max().unwrap_or(0).max(1);
    let slope_bits = 128 - slope_most.leading_zeros();
    let value = Format::unsigned(0, shape.fraction);
    let packed: Vec<i128> =
        entries.iter().map(|entry| entry.base << slope_bits | entry.slope).collect();

    let (address, rest) = address_and_rest(d, name, u, cut);
    let word = Format::unsigned(shape.fraction + slope_bits as i32, 0);
    let rom = d
        .rom(name, address, word, &packed, shape.synchronous)
        .doc(&format!(
            "value at the start of a segment (u0.{}), then the rise over the segment in units of 2^-{} ({} \
             bits)",
            shape.fraction, shape.slope_fraction, slope_bits
        ))
        .comments(
            words
                .iter()
                .map(|segment| match segment {
                    None => "not used".to_owned(),
                    Some(Segment { from, length: 1 }) => format!("u = {from}"),
                    Some(Segment { from, length }) => format!("u = {from} to {}", from + length - 1),
                })
                .collect(),
        );
    let rom = block.map_or(rom, |number| rom.block(number));
    let rest =
        if shape.synchronous { d.pipeline(&format!("{name}_rest_held"), rest) } else { rest };
    let base = rom.out().bits(slope_bits, value).named(&format!("{name}_base"));
    let slope = rom
        .out()
        .bits(0, Format::unsigned(slope_bits as i32 - shape.slope_fraction, shape.slope_fraction))
        .named(&format!("{name}_slope"));
    let rise = d.mul(&format!("{name}_rise"), slope, rest);
    // The rise over a part of a segment is less than the slope, which is less than 1.
    let rise =
        d.narrow(&format!("{name}_rise_cut"), rise, value, Rounding::Truncate, Overflow::Saturate);
    let sum = d.add(&format!("{name}_sum"), base, rise);
    d.narrow(&format!("{name}_value"), sum, value, Rounding::Truncate, Overflow::Saturate)
}

/// Returns the address of the word for `u`, and the position of `u` within its segment, a fraction below 1.
#[track_caller]
fn address_and_rest<'d>(
    d: &'d Designer,
    name: &str,
    u: Signal<'d>,
    cut: &Segmentation,
) -> (Signal<'d>, Signal<'d>) {
    let blocks = cut.blocks();
    let rest_bits = cut.rest_bits();
    let address_bits = usize::BITS - (cut.entries() - 1).leading_zeros();
    let address = Format::unsigned(address_bits as i32, 0);
    let rest = Format::unsigned(0, rest_bits as i32);
    // Each block gives an address from a constant and the upper bits of u, and a position from the lower bits of u and zeros.
    let arm = |block: &EntryBlock| {
        let base = d.raw_constant(&format!("{name}_base_word"), i128::from(block.base), address);
        let left = block.bits - block.prefix;
        // Below the last range, 0 may be the only value.
        let word = if block.prefix == 0 {
            base
        } else {
            let prefix = u.bits(left, Format::unsigned(block.prefix as i32, 0));
            d.beside(base, prefix, address)
        };
        let remainder = if left == 0 {
            d.raw_constant(&format!("{name}_no_rest"), 0, rest)
        } else {
            u.bits(0, Format::unsigned(0, left as i32)).with_fraction(rest_bits as i32)
        };
        (word, remainder)
    };
    let arms: Vec<_> = blocks.iter().map(arm).collect();
    let in_range = |at: usize| {
        let low = blocks[at].bits - 2;
        let top = u.format().width() - low;
        d.any(&format!("{name}_in_range{at}"), u.bits(low, Format::unsigned(top as i32, 0)))
            .doc(&format!("1 if u is in range {at} or above"))
    };
    let picker = Picker { d, name, arms: &arms, in_range: &in_range };
    picker.pick(0, arms.len())
}

/// The address of a word, and the position within its segment.
type Arm<'d> = (Signal<'d>, Signal<'d>);

/// Selects among the blocks by a tree of two-input muxes.
struct Picker<'a, 'd> {
    d: &'d Designer,
    name: &'a str,
    arms: &'a [Arm<'d>],
    /// Returns a signal that is 1 if u is in the range with the given number or in a higher range (with a smaller number).
    in_range: &'a dyn Fn(usize) -> Signal<'d>,
}

impl<'d> Picker<'_, 'd> {
    /// Selects among the blocks from `from` to `to` − 1.
    #[track_caller]
    fn pick(&self, from: usize, to: usize) -> Arm<'d> {
        if to - from == 1 {
            return self.arms[from];
        }
        let middle = (from + to) / 2;
        let at = middle - 1;
        let (upper, lower) = (self.pick(from, middle), self.pick(middle, to));
        let here = (self.in_range)(at);
        let (d, name) = (self.d, self.name);
        let word = d.choose(&format!("{name}_word{at}"), here, [lower.0, upper.0]);
        let no_rest = lower.1.range() == (0, 0) && upper.1.range() == (0, 0);
        let rest = if no_rest {
            upper.1
        } else {
            d.choose(&format!("{name}_rest{at}"), here, [lower.1, upper.1])
        };
        (word, rest)
    }
}
