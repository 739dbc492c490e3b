//! Prepares a temporary directory with the Verilog of a core and of its harness, and runs Yosys and nextpnr in it.

use anyhow::{Context, Result};

use super::harness::{self, TOP};
use super::netlist::Netlist;
use super::{SynthesisSubject, Target};
use glint_tools::Tool;
use glint_tools::sources::YosysSources;
use glint_tools::synthesis::{self, Usage};

/// A directory with the Verilog of a core and of its harness.
pub struct Workspace<'a> {
    pub sources: YosysSources<'a>,
    subject: &'a SynthesisSubject<'a>,
}

/// The Verilog file with the harness. Yosys does not read it when it synthesises the core alone.
pub const HARNESS: &str = "glint_harness.v";
/// The netlist after synthesis.
pub const NETLIST: &str = "harness.json";

impl<'a> Workspace<'a> {
    /// Makes the directory and writes the files.
    ///
    /// # Errors
    ///
    /// Fails if a file cannot be written.
    pub fn new(yosys: &'a Tool, subject: &'a SynthesisSubject<'a>) -> Result<Self> {
        let sources = YosysSources::new(yosys, subject.files, subject.limit)?;
        sources.write(HARNESS, &harness::harness(subject.design)?)?;
        Ok(Self { sources, subject })
    }

    /// Runs nextpnr on the netlist in the file [`NETLIST`]. `options` are the options of the FPGA family, separated by single
    /// spaces, for example `--up5k --package sg48`.
    ///
    /// # Errors
    ///
    /// Fails if nextpnr fails or takes too long.
    pub fn nextpnr(&self, nextpnr: &Tool, seed: u32, options: &str) -> Result<()> {
        // The file names have no directory, because the WebAssembly build of nextpnr sees only the current directory.
        let arguments = format!("{options} --timing-allow-fail -q --seed {seed} --json {NETLIST}");
        nextpnr.run_to_success(arguments.split(' '), self.sources.path(), self.subject.limit)?;
        Ok(())
    }

    /// Synthesises the core alone for its area, and the core in its harness for the netlist. The netlist is also left in the file
    /// [`NETLIST`].
    ///
    /// # Errors
    ///
    /// Fails if Yosys fails or takes too long, if Yosys does not know the family of `target`. Fails if the output lacks the area
    /// or the netlist.
    pub fn synthesise(&self, target: Target) -> Result<(Usage, Netlist)> {
        let family = target.family().context("Yosys knows no such family")?;
        let top = &self.subject.design.name;
        let commands = [
            "design -save source".to_owned(),
            family.script(top),
            synthesis::statistics_commands(family).to_owned(),
            "design -load source".to_owned(),
            format!("read_verilog {HARNESS}"),
            family.script(TOP),
            format!("write_json {NETLIST}"),
        ];
        self.sources.run(&commands.join("; "))?;
        Ok((synthesis::usage(&self.sources, top, family)?, self.netlist()?))
    }

    /// Reads the netlist that `Self::synthesise` has left.
    ///
    /// # Errors
    ///
    /// Fails if the file is missing, or if it has no nets and cells of the harness.
    pub fn netlist(&self) -> Result<Netlist> {
        Netlist::new(self.subject.design, &self.sources.json(NETLIST)?)
    }
}
