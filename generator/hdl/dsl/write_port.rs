//! Adds the write port of memories whose words can be replaced at run time, such as the table of a polynomial.
//!
//! The environment writes one address at a time, in all memories of the port. The environment raises `table_write` with an
//! address and the words, and the memories load them in the first clock in which `table_ready` is 1. The core is ready only
//! while it does not compute, so that a computation never reads a mixture of old and new words.

use std::panic::Location;

use super::{Designer, Rom};
use crate::netlist::{
    Driver, NetId, Op, Role, TABLE_ADDRESS, TABLE_LOAD, TABLE_READY, TABLE_WRITE, WritePort,
};
use glint_base::codes;
use glint_base::fixed::Format;

impl Designer {
    /// Lets the words of `memories` be replaced at run time. Each memory states the parts of its word, the highest bits first,
    /// as names and formats: a part `c0` gets the input `table_c0`. The interval of a memory's word becomes the whole range of
    /// its format.
    ///
    /// Reports a mistake if the description already has a write port, or if the parts are not as wide as the word.
    #[track_caller]
    pub fn write_port(&self, memories: &[(Rom<'_>, Vec<(String, Format)>)]) {
        if self.with(|inner| inner.table_ready.is_some()) {
            self.error(
                codes::MEMORY,
                "a core has at most one write port for its memories".to_owned(),
            );
            return;
        }
        let words =
            memories.iter().map(|(rom, _)| self.with(|it| it.design.rom(rom.id).words.len()));
        let most = words.max().unwrap_or(1).max(2);
        let address_bits = usize::BITS - (most - 1).leading_zeros();
        let input = |name: &str, format: Format, role: Role, doc: &str| {
            let net = self.add_named(name, format, Driver::Input);
            self.set_doc(net, doc);
            self.port(net, role);
            net
        };
        let write =
            input(TABLE_WRITE, Format::BIT, Role::TableWrite, "writes the table at table_address");
        let address = Format::unsigned(address_bits as i32, 0);
        let address =
            input(TABLE_ADDRESS, address, Role::TableAddress, "the word of the table to write");
        let ready = self.add_named(TABLE_READY, Format::BIT, Driver::Undriven);
        self.set_doc(ready, "no computation runs, and the table loads a word that is written");
        let enable = self.add_named(TABLE_LOAD, Format::BIT, Driver::Op(Op::And(write, ready)));
        self.set_doc(enable, "the table loads a word");
        for (rom, parts) in memories {
            let mut nets: Vec<NetId> = Vec::new();
            for (name, format) in parts {
                let doc = format!("the part {name} of the new word");
                nets.push(input(&format!("table_{name}"), *format, Role::TableWord, &doc));
            }
            let widths = parts.iter().map(|(_, format)| format.width());
            let word = self.with(|inner| inner.design.rom(rom.id).data);
            if widths.sum::<u32>() != self.net(word).format.width() {
                self.error_at(
                    codes::WIDTH,
                    "the parts of a written word are not as wide as the word".to_owned(),
                    [("the memory is here", Location::caller())],
                );
            }
            self.with(|inner| {
                let written = &mut inner.design.roms[rom.id.index()];
                written.write = Some(WritePort { enable, address, parts: nets });
                let data = &mut inner.design.nets[written.data.index()];
                data.range = data.format.range();
            });
        }
        self.port(ready, Role::TableReady);
        self.with(|inner| inner.table_ready = Some(ready));
    }

    /// Connects `table_ready`, if the description has a write port: it is 1 while no computation runs. A word that is written together
    /// with a start is stored before the computation reads the memory.
    pub(super) fn connect_write_port(&self, busy: NetId) {
        if let Some(ready) = self.with(|inner| inner.table_ready) {
            let driver = Driver::Op(Op::Not(busy));
            self.with(|inner| inner.design.nets[ready.index()].driver = driver);
        }
    }
}
