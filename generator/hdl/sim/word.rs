//! Defines the arithmetic on the slots of 32 and of 64 bits in the simulator's memory (not the slots of a pipeline).

use std::ops::{BitAnd, BitOr, BitXor, Shl, Shr};

/// The value of a slot in one lane.
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
    /// Keeps the low bits, as many as the type has.
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
