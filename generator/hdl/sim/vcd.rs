//! Writes the waveform of a circuit to a VCD file during the simulation. rust_hdl formats the waveform.

use std::io::{self, Write};
use std::mem;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, Result};
use rust_hdl::core::block::Block;
use rust_hdl::core::logic::Logic;
use rust_hdl::core::probe::Probe;
use rust_hdl::core::vcd_probe::{VCDProbe, write_vcd_change, write_vcd_dump, write_vcd_header};

/// Writes the waveform of a circuit step by step. Times are in picoseconds.
///
/// rust_hdl panics if a write fails. The writer therefore gives rust_hdl a buffer in memory, and copies the buffer to the file
/// after each step. All methods fail if the file cannot be written.
pub struct VcdWriter<W: Write> {
    /// `None` only while rust_hdl writes.
    probe: Option<VCDProbe<Page>>,
    page: Page,
    file: W,
}

impl<W: Write> VcdWriter<W> {
    /// Writes the header, in which the outermost scope is called `name`, and all values at `time`.
    pub fn new(file: W, name: &str, time: u64, circuit: &dyn Block) -> Result<Self> {
        let page = Page::default();
        let mut probe = write_vcd_header(page.clone(), &Named { name, circuit });
        probe.timestamp(time)?;
        let mut writer = Self { probe: Some(write_vcd_dump(probe, circuit)), page, file };
        // rust_hdl declares a text as a wire of 0 bits. Viewers refuse such a wire, or show no value.
        let header = String::from_utf8_lossy(&writer.page.take()).replacen(WIRE, STRING, 1);
        writer.page.write_all(header.as_bytes())?;
        writer.write_out()?;
        Ok(writer)
    }

    /// Writes the values that have changed since the last step.
    pub fn step(&mut self, time: u64, circuit: &dyn Block) -> Result<()> {
        if let Some(mut probe) = self.probe.take() {
            probe.timestamp(time)?;
            self.probe = Some(write_vcd_change(probe, circuit));
        }
        self.write_out()
    }

    /// Ends the waveform at `time`, flushes the file and returns it.
    pub fn finish(mut self, time: u64) -> Result<W> {
        if let Some(probe) = &mut self.probe {
            probe.timestamp(time)?;
        }
        self.write_out()?;
        self.file.flush().context(CANNOT_WRITE)?;
        Ok(self.file)
    }

    fn write_out(&mut self) -> Result<()> {
        self.file.write_all(&self.page.take()).context(CANNOT_WRITE)
    }
}

const WIRE: &str = "$var wire 0 ";
const STRING: &str = "$var string 1 ";

const CANNOT_WRITE: &str = "cannot write the waveform";

/// Text that is not yet in the file. Copies share the text.
#[derive(Clone, Default)]
struct Page(Arc<Mutex<Vec<u8>>>);

impl Page {
    fn take(&self) -> Vec<u8> {
        mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Page {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let mut page = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        page.extend_from_slice(text);
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Names the scope, which rust_hdl would otherwise call `uut`.
struct Named<'a> {
    name: &'a str,
    circuit: &'a dyn Block,
}

impl Logic for Named<'_> {
    fn update(&mut self) {}
}

impl Block for Named<'_> {
    fn connect_all(&mut self) {}

    fn update_all(&mut self) {}

    fn has_changed(&self) -> bool {
        self.circuit.has_changed()
    }

    fn accept(&self, _name: &str, probe: &mut dyn Probe) {
        self.circuit.accept(self.name, probe);
    }
}
