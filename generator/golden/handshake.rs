//! The sequence of microinstructions: start, busy, the counter.

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
}
