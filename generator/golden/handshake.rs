//! What all devices share: start, busy, the word counter, and operand registers.

use crate::base::fixed::{Format, mask};

/// What the word that executes does to the sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// The following word is next.
    Next,
    /// The same word once more.
    Again,
    /// The word of this number is next.
    To(u32),
    /// The program ends: back to word 0, idle.
    End,
}

/// The trigger `run` and the counter of control words (`word_address`).
///
/// The device idles in word 0, and executes it once more in the clock after `start`: words 1 and on
/// follow. A register that a word loads takes its value at the rising edge that ends the word, whether
/// `rst_n` is low at that edge or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Handshake {
    /// A point is in flight. This is also the output `busy`.
    pub run: bool,
    /// The control word in force; 0 when idle.
    pub word: u32,
}

impl Handshake {
    /// One rising edge; `after` is what the word in force says, and matters only while running.
    pub fn clock(&mut self, rst_n: bool, start: bool, after: After) {
        if !rst_n {
            *self = Self::default();
        } else if !self.run {
            self.run = start;
        } else {
            match after {
                After::Next => self.word += 1,
                After::Again => {}
                After::To(word) => self.word = word,
                After::End => *self = Self::default(),
            }
        }
    }
}

/// An operand register with its write strobe. It ignores writes while a point is in flight, and does
/// not know the reset.
#[derive(Clone, Copy, Debug)]
pub struct OperandRegister {
    format: Format,
    min: i64,
    max: i64,
    /// The raw value held.
    pub value: i64,
}

impl OperandRegister {
    /// A register that holds whatever `format` can denote.
    pub fn new(format: Format) -> Self {
        Self::clamped(format, format.min_raw() as i64, format.max_raw() as i64)
    }

    /// A register that moves what it loads into `min ..= max`.
    pub fn clamped(format: Format, min: i64, max: i64) -> Self {
        Self { format, min, max, value: 0 }
    }

    /// What the register takes when `raw` is offered.
    #[inline]
    pub fn taken(&self, raw: i64) -> i64 {
        raw.clamp(self.min, self.max)
    }

    /// One rising edge: `data` is a bit pattern, `run` the state before the edge.
    #[inline]
    pub fn clock(&mut self, run: bool, strobe: u64, data: u64) {
        if strobe & 1 == 1 && !run {
            self.value = self.taken(self.format.raw(data) as i64);
        }
    }
}

/// The bit pattern of a raw value on a wire of `width` bits.
#[inline]
pub fn bits(raw: i64, width: u32) -> u64 {
    raw as u64 & mask(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(run: bool, word: u32) -> Handshake {
        Handshake { run, word }
    }

    #[test]
    fn a_point_runs_from_word_0_to_the_end() {
        let mut it = Handshake::default();
        // What the word says is ignored when idle.
        it.clock(true, false, After::Next);
        assert_eq!(it, state(false, 0));
        it.clock(true, true, After::Next);
        assert_eq!(it, state(true, 0));
        // Start while busy changes nothing.
        it.clock(true, true, After::Next);
        assert_eq!(it, state(true, 1));
        it.clock(true, true, After::Again);
        assert_eq!(it, state(true, 1));
        // Start in the last word is not remembered.
        it.clock(true, true, After::End);
        assert_eq!(it, state(false, 0));
        it.clock(true, true, After::Next);
        assert_eq!(it, state(true, 0));
        it.clock(true, false, After::Next);
        it.clock(false, true, After::Next);
        assert_eq!(it, state(false, 0));
    }

    #[test]
    fn an_operand_register_clamps_and_ignores_writes_while_busy() {
        // s1.2 clamped to 0 … 1.0, that is 0 … 4.
        let mut it = OperandRegister::clamped(Format::signed(1, 2), 0, 4);
        it.clock(false, 1, 3);
        assert_eq!(it.value, 3);
        it.clock(false, 0, 1);
        assert_eq!(it.value, 3);
        it.clock(true, 1, 1);
        assert_eq!(it.value, 3);
        it.clock(false, 1, 7);
        assert_eq!(it.value, 4);
        // 1111 is −1/4.
        it.clock(false, 1, 15);
        assert_eq!(it.value, 0);
        assert_eq!(bits(-1, 3), 7);
    }
}
