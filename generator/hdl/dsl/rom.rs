//! Defines the handle of a read-only memory (ROM) in a hardware description.

use super::{Designer, Signal};
use crate::netlist::RomId;

/// A read-only memory, made by [`Designer::rom`](super::Designer::rom).
#[derive(Clone, Copy)]
pub struct Rom<'d> {
    pub(super) designer: &'d Designer,
    pub(super) id: RomId,
}

impl<'d> Rom<'d> {
    /// Returns the word at the current address, or in a synchronous ROM at the address of the clock before.
    pub fn out(self) -> Signal<'d> {
        let data = self.designer.with(|inner| inner.design.rom(self.id).data);
        self.designer.signal(data)
    }

    /// Sets the ROM's number in the source's block diagram. For example, comments in the Verilog then say `ROM 18` instead of
    /// the name.
    #[must_use]
    pub fn block(self, number: u16) -> Self {
        self.designer.with(|inner| inner.design.roms[self.id.index()].block = Some(number));
        self
    }

    /// Adds a line to the ROM's comment on the meaning of a word.
    #[must_use]
    pub fn doc(self, line: &str) -> Self {
        self.designer.with(|inner| inner.design.roms[self.id.index()].doc.push(line.to_owned()));
        self
    }

    /// Sets a comment for each word, from address 0, for the memory file. [`Designer::finish`](super::Designer::finish) reports
    /// a mistake unless there are as many comments as words.
    #[must_use]
    pub fn comments(self, comments: Vec<String>) -> Self {
        self.designer.with(|inner| inner.design.roms[self.id.index()].comments = comments);
        self
    }
}
