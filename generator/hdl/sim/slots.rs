//! Stores the slots of a bank in memory, aligned for vector instructions of the processor.

use std::ops::{Deref, DerefMut};

/// The number of bytes in a cache line, and in the longest vector of the processor. A vector that lies across two lines is
/// slow.
const LINE: usize = 64;

/// The values of all slots of a bank, `LANES` values each. The first value is aligned to a cache line.
#[derive(Debug)]
pub(super) struct Slots<W, const LANES: usize> {
    words: Vec<W>,
    /// Unused values in front of the first slot, which align it.
    before: usize,
}

impl<W: Copy + Default, const LANES: usize> Slots<W, LANES> {
    pub(super) fn new(slots: impl ExactSizeIterator<Item = [W; LANES]>) -> Self {
        let room = LINE / size_of::<W>();
        let mut words: Vec<W> = Vec::with_capacity(room + slots.len() * LANES);
        let before = words.as_ptr().align_offset(LINE).min(room);
        words.resize(before, W::default());
        words.extend(slots.flatten());
        Self { words, before }
    }
}

/// The copy is aligned again, because its memory begins at another address.
impl<W: Copy + Default, const LANES: usize> Clone for Slots<W, LANES> {
    fn clone(&self) -> Self {
        Self::new(self.iter().copied())
    }
}

impl<W, const LANES: usize> Deref for Slots<W, LANES> {
    type Target = [[W; LANES]];

    #[inline]
    fn deref(&self) -> &Self::Target {
        self.words[self.before..].as_chunks().0
    }
}

impl<W, const LANES: usize> DerefMut for Slots<W, LANES> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.words[self.before..].as_chunks_mut().0
    }
}
