//! Defines the arithmetic on the values in the simulator's memory.
//!
//! The memory has slots of 32 bits and slots of 64 bits, and a slot has one value for each lane. These slots are places in the
//! memory, not the slots of a pipeline.

use std::ops::{BitAnd, BitOr, BitXor, Shl, Shr};

/// The value of a slot in one lane, an unsigned integer of 32 or 64 bits.
pub(super) trait LaneWord:
    Copy
    + Default
    + Ord
    + From<bool>
    + Into<u64>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Shl<u8, Output = Self>
    + Shr<u8, Output = Self>
{
    const ZERO: Self;
    /// Returns the low bits of `bits`, as many as the type has.
    fn low(bits: u64) -> Self;
    fn wrapping_add(self, other: Self) -> Self;
    fn wrapping_sub(self, other: Self) -> Self;
    fn wrapping_mul(self, other: Self) -> Self;
}

macro_rules! word {
    ($word:ident) => {
        impl LaneWord for $word {
            const ZERO: Self = 0;

            #[inline(always)]
            fn low(bits: u64) -> Self {
                bits as Self
            }

            #[inline(always)]
            fn wrapping_add(self, other: Self) -> Self {
                $word::wrapping_add(self, other)
            }

            #[inline(always)]
            fn wrapping_sub(self, other: Self) -> Self {
                $word::wrapping_sub(self, other)
            }

            #[inline(always)]
            fn wrapping_mul(self, other: Self) -> Self {
                $word::wrapping_mul(self, other)
            }
        }
    };
}

word!(u32);
word!(u64);
