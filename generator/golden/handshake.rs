//! The sequence of microinstructions: start, busy, the counter.

/// What the microinstruction that executes does to the sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// The following microinstruction is next.
    Next,
    /// The same microinstruction once more.
    Again,
    /// The microinstruction at this address is next.
    To(u32),
    /// The program ends: back to microinstruction 0, idle.
    End,
    /// The program ends, and the next point runs: back to microinstruction 0.
    Restart,
}

/// The trigger `run` and the counter of microinstructions (`word_address`).
///
/// The device idles in microinstruction 0, and executes it once more in the clock after `start`: 1 and on
/// follow. A register that a microinstruction loads takes its value at the rising edge that ends it, whether
/// `rst_n` is low at that edge or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Handshake {
    /// A point is in flight. This is also the output `busy`.
    pub run: bool,
    /// The address of the microinstruction in force; 0 when idle.
    pub address: u32,
}

impl Handshake {
    /// One rising edge; `after` is what the microinstruction in force says, and matters only while running.
    pub fn clock(&mut self, rst_n: bool, start: bool, after: After) {
        if !rst_n {
            *self = Self::default();
        } else if !self.run {
            self.run = start;
        } else {
            match after {
                After::Next => self.address += 1,
                After::Again => {}
                After::To(address) => self.address = address,
                After::End => *self = Self::default(),
                After::Restart => self.address = 0,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(run: bool, address: u32) -> Handshake {
        Handshake { run, address }
    }

    #[test]
    fn a_point_runs_from_microinstruction_0_to_the_end() {
        let mut it = Handshake::default();
        // What the microinstruction says is ignored when idle.
        it.clock(true, false, After::Next);
        assert_eq!(it, state(false, 0));
        it.clock(true, true, After::Next);
        assert_eq!(it, state(true, 0));
        // Start while busy changes nothing.
        it.clock(true, true, After::Next);
        assert_eq!(it, state(true, 1));
        it.clock(true, true, After::Again);
        assert_eq!(it, state(true, 1));
        // Start in the last microinstruction is not remembered.
        it.clock(true, true, After::End);
        assert_eq!(it, state(false, 0));
        it.clock(true, true, After::Next);
        assert_eq!(it, state(true, 0));
        it.clock(true, false, After::Next);
        // Unless operands have buffers.
        it.clock(true, true, After::Restart);
        assert_eq!(it, state(true, 0));
        it.clock(true, false, After::Next);
        it.clock(false, true, After::Restart);
        assert_eq!(it, state(false, 0));
    }
}
