//! Computes many points (sets of operands) at once with the emitted Verilog of a core, under Icarus Verilog or Verilator.
//!
//! The test bench reads the points from a file and writes the results to a second file.

use std::fmt::Write as _;
use std::fs;
use std::time::Duration;

use anyhow::{Context, Result, ensure};

use glint_base::fixed::Format;
use glint_core::cosim::batch::{Engine, Points};
use glint_core::package::{POINTS_FILE, RESULTS_FILE, points_bench};
use glint_golden::Contract;
use glint_rtl::netlist::Design;
use glint_tools::{BuiltBench, VerilogSimulator, Waveform};

/// The most clocks that a computation may take; with more, the bench fails.
const LIMIT: u32 = 1 << 16;

/// An [`Engine`] that runs the emitted Verilog in an outside simulator, with a bench that reads points from a file. A line of the
/// file has a point's operands as hexadecimal bit patterns. For example, the raw values 5 and −1 in 8 bits are `5 ff`.
pub struct Verilog {
    bench: BuiltBench,
    limit: Duration,
    /// For each operand in a line of the points file: its index in the contract, and its format.
    operands: Vec<(usize, Format)>,
    /// For each output of the contract: its index in a line of the results file, and its format.
    results: Vec<(usize, Format)>,
}

impl Verilog {
    /// Builds the test bench from the emitted `files`, pairs of a file name and contents. `limit` is the time limit of the build,
    /// and of each simulation.
    ///
    /// # Errors
    ///
    /// Fails if the simulator cannot build the bench. Fails if the design has an operand that the contract lacks, or if the
    /// contract has an output that the design lacks.
    pub fn new(
        simulator: VerilogSimulator,
        design: &Design,
        contract: &dyn Contract,
        mut files: Vec<(String, String)>,
        limit: Duration,
    ) -> Result<Self> {
        let bench = points_bench(design, LIMIT)?;
        let format = |name: &str| design.find(name).map(|net| design.net(net).format);
        let operands = bench
            .operands
            .iter()
            .map(|name| {
                let mut known = contract.operands().iter();
                let at = known.position(|operand| operand.name == *name);
                let at = at.with_context(|| format!("the contract has no operand `{name}`"))?;
                Ok((at, contract.operands()[at].format))
            })
            .collect::<Result<_>>()?;
        let results = contract
            .outputs()
            .iter()
            .map(|output| {
                let name = &output.name;
                let at = bench.results.iter().position(|result| result == name);
                at.zip(format(name))
                    .with_context(|| format!("`{}` has no result `{name}`", design.name))
            })
            .collect::<Result<_>>()?;
        files.push((format!("{}.v", bench.name), bench.text));
        Ok(Self {
            bench: BuiltBench::build(simulator, &files, &bench.name, Waveform::None, limit)?,
            limit,
            operands,
            results,
        })
    }
}

impl Engine for Verilog {
    fn compute(&mut self, points: &Points) -> Result<Vec<i64>> {
        let mut list = String::new();
        for at in 0..points.len() {
            let values = points.operands(at);
            for (column, &(operand, format)) in self.operands.iter().enumerate() {
                let gap = if column == 0 { "" } else { " " };
                let bits = format.bits(i128::from(values[operand]));
                let _ = write!(list, "{gap}{bits:x}");
            }
            list.push('\n');
        }
        let dir = self.bench.directory();
        fs::write(dir.join(POINTS_FILE), list).context("cannot write the list of points")?;
        let run = self.bench.run(self.limit)?;
        ensure!(run.passed, "the bench fails:\n{}", run.transcript.trim());
        let text =
            fs::read_to_string(dir.join(RESULTS_FILE)).context("the bench wrote no results")?;
        let mut out = Vec::with_capacity(points.result_count() * self.results.len());
        let (mut at, mut shown) = (0, 0);
        for line in text.lines() {
            ensure!(at < points.len(), "the bench wrote too many results");
            if line == "." {
                let wanted = points.results(at);
                ensure!(
                    shown == wanted,
                    "the bench wrote {shown} results for a point, not {wanted}"
                );
                (at, shown) = (at + 1, 0);
                continue;
            }
            shown += 1;
            let words: Vec<&str> = line.split(' ').collect();
            for &(column, format) in &self.results {
                let word = words.get(column).copied().unwrap_or_default();
                let bits = u64::from_str_radix(word, 16)
                    .with_context(|| format!("`{line}` is not a line of results"))?;
                out.push(format.raw(bits) as i64);
            }
        }
        ensure!(
            at == points.len(),
            "the bench wrote the results of {at} points, not {}",
            points.len()
        );
        Ok(out)
    }
}
