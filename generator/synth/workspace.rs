//! The directory in which a core is synthesised.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use super::Subject;
use super::harness::{self, TOP};
use super::netlist::Netlist;
use crate::base::transient::Directory;
use crate::tools::Tool;
use crate::tools::synthesis::{self, Family, Usage};

/// Where the core's sources and its harness stand.
pub struct Workspace<'a> {
    directory: Directory,
    subject: &'a Subject<'a>,
}

/// The file with the harness.
pub const HARNESS: &str = "glint_harness.v";
/// The file with the netlist.
pub const NETLIST: &str = "harness.json";
const STATISTICS: &str = "area.json";

impl<'a> Workspace<'a> {
    /// Writes the sources.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn new(subject: &'a Subject<'a>) -> Result<Self> {
        let directory = Directory::new().context("cannot make a directory for synthesis")?;
        let harness = (HARNESS.to_owned(), harness::harness(subject.design)?);
        for (name, contents) in subject.files.iter().chain([&harness]) {
            fs::write(directory.path().join(name), contents)
                .with_context(|| format!("cannot write `{name}` for synthesis"))?;
        }
        Ok(Self { directory, subject })
    }

    pub fn path(&self) -> &Path {
        self.directory.path()
    }

    /// The command of Yosys that reads the core.
    pub fn read_core(&self) -> String {
        let names = self.subject.files.iter().map(|(name, _)| name.as_str());
        let sources: Vec<&str> = names.filter(|name| name.ends_with(".v")).collect();
        format!("read_verilog {}", sources.join(" "))
    }

    /// Runs commands of Yosys.
    ///
    /// # Errors
    /// It fails, or takes too long.
    pub fn yosys(&self, yosys: &Tool, commands: &str) -> Result<()> {
        yosys.run_to_success(["-q", "-p", commands], self.path(), self.subject.limit)?;
        Ok(())
    }

    /// Runs nextpnr on the netlist with a seed, with the `options` of its family, which a space divides.
    ///
    /// # Errors
    /// It fails, or takes too long.
    pub fn nextpnr(&self, nextpnr: &Tool, seed: u32, options: &str) -> Result<()> {
        // File names without a directory: the WebAssembly of nextpnr sees no other.
        let arguments = format!("{options} --timing-allow-fail -q --seed {seed} --json {NETLIST}");
        nextpnr.run_to_success(arguments.split(' '), self.path(), self.subject.limit)?;
        Ok(())
    }

    /// Synthesises the core alone, and returns its area.
    ///
    /// # Errors
    /// As of [`Workspace::yosys`].
    pub fn area(&self, yosys: &Tool, family: &Family) -> Result<Usage> {
        let top = &self.subject.design.name;
        let (read, script) = (self.read_core(), family.script(top));
        self.yosys(yosys, &format!("{read}; {script}; tee -q -o {STATISTICS} stat -json"))?;
        synthesis::usage(&self.path().join(STATISTICS), top, family)
    }

    /// Synthesises the core alone and with the registers around it; returns the area of the first, and the netlist of the second,
    /// which is left in the file [`NETLIST`].
    ///
    /// # Errors
    /// As of [`Workspace::yosys`].
    pub fn synthesise(&self, yosys: &Tool, family: &Family) -> Result<(Usage, Netlist)> {
        let top = &self.subject.design.name;
        let commands = [
            self.read_core(),
            "design -save source".to_owned(),
            family.script(top),
            format!("tee -q -o {STATISTICS} stat -json"),
            "design -load source".to_owned(),
            format!("read_verilog {HARNESS}"),
            family.script(TOP),
            format!("write_json {NETLIST}"),
        ];
        self.yosys(yosys, &commands.join("; "))?;
        let usage = synthesis::usage(&self.path().join(STATISTICS), top, family)?;
        Ok((usage, self.netlist()?))
    }

    /// Reads the netlist that Yosys has left.
    ///
    /// # Errors
    /// It is none.
    pub fn netlist(&self) -> Result<Netlist> {
        Netlist::new(self.subject.design, &self.json(NETLIST)?)
    }

    /// Reads a JSON file that a tool has left.
    ///
    /// # Errors
    /// It is not there, or no JSON.
    pub fn json(&self, name: &str) -> Result<Value> {
        let text = fs::read_to_string(self.path().join(name))
            .with_context(|| format!("a tool wrote no `{name}`"))?;
        ensure!(!text.is_empty(), "a tool left `{name}` empty");
        serde_json::from_str(&text).with_context(|| format!("`{name}` of a tool is no JSON"))
    }
}
