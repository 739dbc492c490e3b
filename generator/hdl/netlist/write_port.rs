//! Defines [`WritePort`], by which the words of a memory can be replaced at run time.

use super::{Design, NetId};
use glint_base::fixed::mask;

/// The input that asks for a word to be written.
pub const TABLE_WRITE: &str = "table_write";

/// The input with the address of the word to write.
pub const TABLE_ADDRESS: &str = "table_address";

/// The output that is 1 if the memories would load a word.
pub const TABLE_READY: &str = "table_ready";

/// The net that is 1 while the memories load a word.
pub const TABLE_LOAD: &str = "table_load";

/// A port that replaces a word of a memory at a rising edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WritePort {
    /// The memory loads the word if this net, one bit, is 1.
    pub enable: NetId,
    pub address: NetId,
    /// The parts of the new word, the highest bits first; together they are as wide as the word.
    pub parts: Vec<NetId>,
}

impl WritePort {
    pub fn nets(&self) -> impl Iterator<Item = NetId> {
        [self.enable, self.address].into_iter().chain(self.parts.iter().copied())
    }

    /// Returns the bit pattern of the word at the port; `value` has the bit pattern of each net.
    pub fn word(&self, design: &Design, value: impl Fn(NetId) -> u64) -> u64 {
        joined(self.parts.iter().map(|&part| (value(part), design.width(part))))
    }
}

/// Joins bit patterns, each with its width, the highest bits first: 0b10 in 2 bits and 0b1 in 3 bits give 0b10001.
pub fn joined(parts: impl Iterator<Item = (u64, u32)>) -> u64 {
    let mut word: u64 = 0;
    for (bits, width) in parts {
        word = word.checked_shl(width).unwrap_or(0) | bits & mask(width);
    }
    word
}
