//! Prepares the directory in which a core is synthesised, and runs Yosys and nextpnr in it.

use anyhow::{Context, Result};

use super::harness::{self, TOP};
use super::netlist::Netlist;
use super::{SynthesisSubject, Target};
use glint_tools::Tool;
use glint_tools::sources::YosysSources;
use glint_tools::synthesis::{self, STATISTICS_COMMAND, Usage};

/// The directory of the core's sources and its harness.
pub struct Workspace<'a> {
    pub sources: YosysSources<'a>,
    subject: &'a SynthesisSubject<'a>,
}

/// The file with the harness, which is not read with the core.
pub const HARNESS: &str = "glint_harness.v";
/// The file with the netlist.
pub const NETLIST: &str = "harness.json";

impl<'a> Workspace<'a> {
    /// Writes the sources.
    ///
    /// # Errors
    /// Fails if the sources cannot be written.
    pub fn new(yosys: &'a Tool, subject: &'a SynthesisSubject<'a>) -> Result<Self> {
        let sources = YosysSources::new(yosys, subject.files, subject.limit)?;
        sources.write(HARNESS, &harness::harness(subject.design)?)?;
        Ok(Self { sources, subject })
    }

    /// Runs nextpnr on the netlist with a seed, with the `options` of its family, which a space divides. For example,
    /// the options begin with `--up5k --package sg48` for iCE40.
    ///
    /// # Errors
    /// Fails if nextpnr fails or takes too long.
    pub fn nextpnr(&self, nextpnr: &Tool, seed: u32, options: &str) -> Result<()> {
        // File names without a directory: the WebAssembly of nextpnr sees no other.
        let arguments = format!("{options} --timing-allow-fail -q --seed {seed} --json {NETLIST}");
        nextpnr.run_to_success(arguments.split(' '), self.sources.path(), self.subject.limit)?;
        Ok(())
    }

    /// Synthesises the core alone and with the registers around it; returns the area of the first, and the netlist of the second,
    /// which is left in the file [`NETLIST`].
    ///
    /// # Errors
    /// Fails if [`YosysSources::run`] fails.
    pub fn synthesise(&self, target: Target) -> Result<(Usage, Netlist)> {
        let family = target.family().context("Yosys knows no such family")?;
        let top = &self.subject.design.name;
        let commands = [
            "design -save source".to_owned(),
            family.script(top),
            STATISTICS_COMMAND.to_owned(),
            "design -load source".to_owned(),
            format!("read_verilog {HARNESS}"),
            family.script(TOP),
            format!("write_json {NETLIST}"),
        ];
        self.sources.run(&commands.join("; "))?;
        Ok((synthesis::usage(&self.sources, top, family)?, self.netlist()?))
    }

    /// Reads the netlist that Yosys has left.
    ///
    /// # Errors
    /// Fails if the file is no netlist.
    pub fn netlist(&self) -> Result<Netlist> {
        Netlist::new(self.subject.design, &self.sources.json(NETLIST)?)
    }
}
