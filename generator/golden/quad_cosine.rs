//! The golden model and the accuracy contract of the device `quad-cosine`, which computes f = cosᵏ(√(n/k)·δ) for a scan line's
//! points.
//!
//! δ is the angle at a point of the line. The specular exponent n decides whether k is 1, 2, 4 or 16. f approximates cosⁿδ: for
//! example, n = 4 gives k = 4 and exactly cos⁴δ. f is 0 if |δ| or |√(n/k)·δ| exceeds a right angle. The source is [seed
//! 000](crate#symbols).

mod contract;
#[cfg(test)]
mod tests;

pub use contract::contract;

use super::Model;
use super::frame::Frame;
use super::highlight::Products;
use super::line::{self, CosineTable, magnitude};
use glint_base::fixed::Format;
use glint_config::Config;
use glint_keys::quad_cosine::Keys;

/// Returns the number of the table for the exponent n, by the ranges of n in seed 000. For example, n = 5 gives 2, the table of
/// cos⁴.
#[inline]
fn range_of(n: i64) -> usize {
    match n {
        1 => 0,
        2 => 1,
        3..=6 => 2,
        _ => 3,
    }
}

/// The power k of each table, indexed by the number from [`range_of`].
const POWERS: [i64; 4] = [1, 2, 4, 16];

struct QuadCosineArithmetic {
    keys: Keys,
    /// The words of ROM 9, one for each n: the factor √(n/k).
    roots: Vec<i64>,
    /// The tables of cosᵏ in ROM 12, one for each k.
    tables: [CosineTable; 4],
}

impl QuadCosineArithmetic {
    fn new(keys: Keys) -> Self {
        let f = keys.fraction;
        Self {
            roots: (0..1 << keys.exponent_bits)
                .map(|n| root(n, POWERS[range_of(n)], keys.root_fraction))
                .collect(),
            tables: POWERS.map(|power| CosineTable::new(power as u32, keys.table_address, f)),
            keys,
        }
    }

    /// Returns the operand of multiplier 11: the leading bits of the magnitude of `angle`, which is in register 8. Returns `None`
    /// if the surface faces away.
    #[inline]
    fn magnitude(&self, angle: i64) -> Option<i64> {
        magnitude(angle, self.keys.angle_fraction, self.keys.angle_multiplied)
    }

    /// Returns the word of ROM 12, which is f, for the exponent n. `magnitude` is the operand of multiplier 11, or `None` if the
    /// surface faces away, and `root` the word of ROM 9.
    #[inline]
    fn cosine_of(&self, n: i64, magnitude: Option<i64>, root: i64) -> i64 {
        let scaled = magnitude.map_or(i64::MAX, |magnitude| magnitude * root);
        self.tables[range_of(n)].words[self.step_of(scaled)]
    }

    /// Returns the address of a table of ROM 12 for `scaled`, the product of multiplier 11.
    #[inline]
    fn step_of(&self, scaled: i64) -> usize {
        let fraction = self.keys.angle_multiplied + self.keys.root_fraction;
        CosineTable::address(scaled, fraction, self.keys.table_address)
    }

    #[inline]
    fn root(&self, n: i64) -> i64 {
        self.roots[n as usize]
    }
}

/// Returns `√(n/k)` rounded to the nearest raw value with G = `fraction` fraction bits, by integer arithmetic. It is 0 for n =
/// 0, and otherwise the r with (r − ½)² ≤ n·2^2G/k < (r + ½)². For example, √(2/2) with 14 fraction bits is 16 384.
fn root(n: i64, k: i64, fraction: u32) -> i64 {
    let square = n << (2 * fraction);
    let floor = (square / k).isqrt();
    // (2·floor + 1)²·k ≤ 4·square.
    let middle = i128::from(2 * floor + 1);
    floor + i64::from(middle * middle * i128::from(k) <= 4 * i128::from(square))
}

fn products(keys: &Keys) -> Products {
    Products::amplitude(keys.f_format(), keys.colour_bits, keys.output_rounding)
        .at_edges(keys.stages > 2)
}

pub fn model(config: &Config) -> Box<dyn Model> {
    let keys = Keys::of(config);
    let mut frame = Frame::default();
    let Keys { length_bits, stages, exponent_bits, .. } = keys;
    let (angle, program) = line::walker(&mut frame, keys.angle_format(), length_bits, stages);
    let exponent = frame.operand("exponent", Format::unsigned(exponent_bits as i32, 0));
    // The words that ROM 9 and ROM 12 read at the latest edge.
    let (root, cosine) = (frame.hidden(), frame.hidden());
    let products = products(&keys);
    let it = QuadCosineArithmetic::new(keys);
    if stages == 2 {
        products.slots(&mut frame, cosine);
        frame.every_edge(move |s| {
            s[cosine] = it.cosine_of(s[exponent], it.magnitude(s[angle]), s[root]);
            s[root] = it.root(s[exponent]);
        });
        return Box::new(frame.model(program));
    }
    // The longer pipeline's registers: the angle's magnitude, whether the surface faces the viewer, and the word of ROM 9. Then
    // the product of magnitude and root, and again whether the surface faces the viewer.
    let [magnitude, within, held_root, scaled, scaled_within] = [(); 5].map(|()| frame.hidden());
    // The address of ROM 12: the range of n, and the step. Then its word.
    let [range, step, held] = [(); 3].map(|()| frame.hidden());
    products.slots(&mut frame, held);
    // From the output back to the angle: each slot takes the value that the slot before it in the pipeline held.
    frame.every_edge(move |s| {
        s[held] = s[cosine];
        s[cosine] = it.tables[s[range] as usize].words[s[step] as usize];
        s[step] = it.step_of(if s[scaled_within] == 1 { s[scaled] } else { i64::MAX }) as i64;
        s[range] = range_of(s[exponent]) as i64;
        s[scaled] = s[magnitude] * s[held_root];
        s[scaled_within] = s[within];
        s[held_root] = s[root];
        let taken = it.magnitude(s[angle]);
        s[magnitude] = taken.unwrap_or_default();
        s[within] = taken.is_some().into();
        s[root] = it.root(s[exponent]);
    });
    Box::new(frame.model(program))
}
