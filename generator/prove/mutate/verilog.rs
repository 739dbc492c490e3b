//! Plants faults in the emitted Verilog, and finds whether lint or a bench notices them.
//!
//! Each mutant has one fault in the text of the modules, as an emitter could make it. For example, `4'd9` becomes
//! `4'd8`. Lint, the shipped bench or a longer bench must notice the fault; the score counts the share of the shipped
//! bench separately.
//!
//! No fault moves a register to the other edge of the clock, because only timing analysis can tell: its input is stable
//! by then.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;

use anyhow::{Context, Result};
use rayon::prelude::*;
use regex::Regex;
use serde::{Deserialize, Serialize};

use super::formal;
use glint_core::core::{Core, TEST_SEED};
use glint_core::package::{self, EmitInputs};
use glint_tools::transient::Directory;
use glint_tools::{BuiltBench, Tool, VerilogSimulator, Waveform};

/// Results of the longer bench, which runs if the shipped one notices nothing.
const POINTS: u64 = 10_000;

/// The time limit of Yosys for the proof that a fault changes nothing. Proofs that succeed take some seconds; a machine that
/// is busy with other things does not make them fail.
const PROOF_LIMIT: Duration = Duration::from_secs(120);

/// A fault of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    /// The file, the number of the line, the kind, and a number among the faults of this kind in the line. For example,
    /// `blinn_datapath.v:127:operator:1` is the first wrong operator in line 127.
    pub id: String,
    /// The name of the fault's kind.
    pub kind: &'static str,
    file: usize,
    /// The line, from 0, and its new text.
    line: usize,
    text: String,
}

/// The verdict on a fault of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TextMutantVerdict {
    /// Icarus Verilog or Verilator refuses the text or warns of it.
    Lint,
    /// A bench fails.
    Bench,
    /// Yosys proves that the module behaves as before.
    Equivalent,
    /// Nothing notices it, and nothing proves it equivalent.
    Undecided,
}

/// The verdict of the shipped bench by itself on a fault of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShippedBench {
    /// Icarus Verilog does not build it.
    Refused,
    /// It fails.
    Noticed,
    /// It passes, and a longer one fails.
    Missed,
    /// Both pass: if the fault changes an output, then seldom.
    Silent,
}

/// The result for a fault of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextFaultResult {
    /// By all checks together.
    pub verdict: TextMutantVerdict,
    /// By the shipped bench.
    pub shipped: ShippedBench,
}

/// The tools to which faults are shown.
const TOOLS: [&str; 4] = ["iverilog", "vvp", "verilator", "yosys"];

/// Files by name, with which ones are modules of the device.
pub struct VerilogText {
    files: Vec<(String, String)>,
    /// A bench with more points, all at random, and its vectors: they take the place of the shipped ones. Golden model
    /// and built-in simulator agree on the vectors of both.
    longer: Vec<(String, String)>,
    top: String,
    modules: Vec<usize>,
}

/// A replacement of text, and its name. If the replacement equals the original text, there is no fault. For example,
/// the kind `constant` replaces `4'd9` by `4'd8`.
struct TextOperator {
    kind: &'static str,
    pattern: Regex,
    with: fn(&regex::Captures<'_>) -> String,
}

/// The part of a line that is code and no declaration of a port or of a memory.
static OPERATORS: LazyLock<Vec<TextOperator>> = LazyLock::new(|| {
    let operator = |kind, pattern, with| TextOperator {
        kind,
        pattern: Regex::new(pattern).expect("a pattern of ours"),
        with,
    };
    vec![
        operator("sign dropped", r"\b(wire|reg) +signed\b", |it| it[1].to_owned()),
        operator("sign dropped", r"\$signed\(", |_| "$unsigned(".to_owned()),
        operator("comparison", r" (<=|>=|<|>|==|!=) (?P<right>\S)", |it| {
            let other = match &it[1] {
                "<=" => "<",
                ">=" => ">",
                "<" => "<=",
                ">" => ">=",
                "==" => "!=",
                _ => "==",
            };
            format!(" {other} {}", &it["right"])
        }),
        operator("operator", r" ([-+&|^*]) ", |it| {
            let other = match &it[1] {
                "+" => "-",
                "-" => "+",
                "&" => "|",
                "|" => "&",
                "^" => "|",
                _ => "+",
            };
            format!(" {other} ")
        }),
        operator("operands swapped", r"([\w\[\]:]+) ([-<>]) ([\w\[\]:']+)", |it| {
            format!("{} {} {}", &it[3], &it[2], &it[1])
        }),
        operator(
            "choice swapped",
            r"\? (\{[^{}]*\}|[\w\[\]:']+) : (\{[^{}]*\}|[\w\[\]:']+)",
            |it| format!("? {} : {}", &it[2], &it[1]),
        ),
        operator("inversion dropped", r"[~!](\(|\w)", |it| it[1].to_owned()),
        operator("condition inverted", r"if \((\w+)\)", |it| format!("if (!{})", &it[1])),
        operator("part-select", r"(\w)\[(\d+)(?::(\d+))?\]", |it| {
            let high = next_number(&it[2]);
            match it.get(3) {
                Some(low) => format!("{}[{high}:{}]", &it[1], next_number(low.as_str())),
                None => format!("{}[{high}]", &it[1]),
            }
        }),
        operator("width", r"\b(wire|reg)( +signed)? +\[(\d+):0\]", |it| {
            let high = it[3].parse::<u64>().unwrap_or_default().saturating_sub(1);
            match it.get(2) {
                Some(sign) => format!("{}{} [{high}:0]", &it[1], sign.as_str()),
                None => format!("{} [{high}:0]", &it[1]),
            }
        }),
        operator("constant", r"(\d+)'(d|h|b)([0-9a-f]+)", |it| {
            let radix = match &it[2] {
                "d" => 10,
                "h" => 16,
                _ => 2,
            };
            let value = u64::from_str_radix(&it[3], radix).unwrap_or_default() ^ 1;
            match radix {
                10 => format!("{}'d{value}", &it[1]),
                16 => format!("{}'h{value:x}", &it[1]),
                _ => format!("{}'b{value:b}", &it[1]),
            }
        }),
        operator("reduction", r"\(\|", |_| "(&".to_owned()),
    ]
});

/// Returns the number after the one that a text has.
fn next_number(text: &str) -> u64 {
    text.parse::<u64>().unwrap_or_default() + 1
}

impl VerilogText {
    /// Collects the fault-free text of a configuration, with its shipped bench.
    ///
    /// # Errors
    /// Fails if a tool is missing, if golden model and simulation differ, or if the design cannot be written.
    pub fn of(core: &Core) -> Result<Self> {
        for tool in TOOLS {
            Tool::find(tool)?;
        }
        let name = &core.config.name;
        let files = core.files(&format!("{name}.toml"), core.shipped_vectors()?)?;
        let vectors = Some(core.vectors(POINTS, TEST_SEED)?);
        let longer = package::emit(&core.design, &EmitInputs { vectors, ..EmitInputs::default() })?;
        let bench = longer.into_iter().filter(|file| file.path.starts_with("testbench/"));
        let mut text = Self {
            files: Vec::new(),
            longer: package::sources(bench.collect()),
            top: format!("{name}_tb"),
            modules: Vec::new(),
        };
        // Wrappers around the core have a bench and proofs of their own.
        let core = ["", "_control", "_datapath", "_multiplier"]
            .map(|part| format!("rtl_out/{name}/{name}{part}.v"));
        for file in files {
            let plain = file.path.rsplit('/').next().unwrap_or(&file.path).to_owned();
            let module = core.contains(&file.path);
            let other = plain.ends_with(".v") && file.path.starts_with("rtl_out/") && !module;
            if other || !plain.ends_with(".v") && !plain.ends_with(".mem") {
                continue;
            }
            if module {
                text.modules.push(text.files.len());
            }
            text.files.push((plain, file.contents));
        }
        Ok(text)
    }

    /// Collects the fault-free text of the wrappers around a core, with their shipped benches and proofs.
    ///
    /// # Errors
    /// Fails if golden model and simulation differ, or if the design cannot be written.
    pub fn of_wrappers(core: &Core) -> Result<Self> {
        let name = &core.config.name;
        let mut text =
            Self { files: Vec::new(), longer: Vec::new(), top: name.clone(), modules: Vec::new() };
        for file in core.files(&format!("{name}.toml"), core.shipped_vectors()?)? {
            let read = [".v", ".mem", ".sv", ".ys"].iter().any(|it| file.path.ends_with(it));
            let wrapper = ["_axis.", "_axis_buffer.", "_registers.", "_axil.", "_wb."]
                .iter()
                .any(|part| file.path == format!("rtl_out/{name}/{name}{part}v"));
            if wrapper {
                text.modules.push(text.files.len());
            }
            let own = file.path.split('/').count() == 3 && !file.path.starts_with("software/");
            if read && own {
                text.files.push((file.name().to_owned(), file.contents));
            }
        }
        Ok(text)
    }

    /// Returns all files, each with its plain name.
    pub fn files(&self) -> &[(String, String)] {
        &self.files
    }

    /// Returns all files, with a fault.
    pub fn planted(&self, fault: &TextFault) -> Vec<(String, String)> {
        let mut files = self.files.clone();
        let mut text = String::new();
        for (at, line) in files[fault.file].1.lines().enumerate() {
            text += if at == fault.line { &fault.text } else { line };
            text.push('\n');
        }
        files[fault.file].1 = text;
        files
    }

    /// Returns every fault, in the order of the text.
    pub fn faults(&self) -> Vec<TextFault> {
        let mut faults = Vec::new();
        for &file in &self.modules {
            let (name, text) = &self.files[file];
            let mut inside = false;
            let mut formal = false;
            for (line, whole) in text.lines().enumerate() {
                let code = whole.split("//").next().unwrap_or(whole);
                formal |= code.starts_with("`ifdef FORMAL");
                let counts = inside && !formal && !code.contains("wire unused");
                if counts {
                    in_line(name, file, line, whole, code, &mut faults);
                }
                formal &= !code.starts_with("`endif");
                inside = (inside || code.starts_with(");")) && !code.starts_with("endmodule");
            }
        }
        faults
    }

    /// Returns the result for each of the faults.
    ///
    /// # Errors
    /// Fails if a linter is missing, or does not end within `limit`.
    pub fn run(
        &self,
        faults: &[TextFault],
        limit: Duration,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Vec<TextFaultResult>> {
        let verilator = Tool::find("verilator")?;
        let run = |fault: &TextFault| {
            let found = self.found(fault, &verilator, limit);
            progress();
            found.with_context(|| format!("the mutant `{}`", fault.id))
        };
        faults.par_iter().map(run).collect()
    }

    fn found(
        &self,
        fault: &TextFault,
        verilator: &Tool,
        limit: Duration,
    ) -> Result<TextFaultResult> {
        let files = self.planted(fault);
        let is_linted = self.is_linted(&files, verilator, limit)?;
        let (shipped, bench) = self.benches(&files, limit)?;
        let verdict = match (shipped, bench) {
            _ if is_linted => TextMutantVerdict::Lint,
            // A text that Icarus does not build is noticed in the same way as by lint.
            (ShippedBench::Refused, _) => TextMutantVerdict::Lint,
            (ShippedBench::Silent, Some(bench)) => {
                if self.proves(&files, fault.file, bench.directory(), limit)? {
                    TextMutantVerdict::Equivalent
                } else {
                    TextMutantVerdict::Undecided
                }
            }
            _ => TextMutantVerdict::Bench,
        };
        Ok(TextFaultResult { verdict, shipped })
    }

    /// Returns whether lint refuses the modules or warns of them.
    fn is_linted(
        &self,
        files: &[(String, String)],
        verilator: &Tool,
        limit: Duration,
    ) -> Result<bool> {
        let dir = Directory::new().context("cannot make a temporary directory")?;
        for (name, contents) in files {
            fs::write(dir.path().join(name), contents)
                .with_context(|| format!("cannot write `{name}`"))?;
        }
        let mut arguments = vec!["--lint-only", "-Wall", "--top-module"];
        arguments.push(self.top.trim_end_matches("_tb"));
        arguments.extend(self.modules.iter().map(|&at| files[at].0.as_str()));
        let lint = verilator.run(arguments, dir.path(), limit)?;
        Ok(!lint.status.success() || !lint.output.is_empty())
    }

    /// Returns the shipped bench's verdict on a mutant, and the bench as it was built.
    fn benches(
        &self,
        mutant: &[(String, String)],
        limit: Duration,
    ) -> Result<(ShippedBench, Option<BuiltBench>)> {
        let Ok(shipped) = self.build(mutant, limit) else {
            return Ok((ShippedBench::Refused, None));
        };
        if fails(&shipped, limit) {
            return Ok((ShippedBench::Noticed, None));
        }
        let mut longer = mutant.to_vec();
        for (name, contents) in &self.longer {
            if let Some(file) = longer.iter_mut().find(|(other, _)| other == name) {
                file.1.clone_from(contents);
            }
        }
        Ok(if fails(&self.build(&longer, limit)?, limit) {
            (ShippedBench::Missed, None)
        } else {
            (ShippedBench::Silent, Some(shipped))
        })
    }

    fn build(&self, files: &[(String, String)], limit: Duration) -> Result<BuiltBench> {
        BuiltBench::build(VerilogSimulator::Icarus, files, &self.top, Waveform::None, limit)
    }

    /// Returns whether the module in a file is proved to behave as without the fault, in a directory that holds all files; of
    /// a pipeline with its multiplier, the pipeline.
    fn proves(
        &self,
        mutant: &[(String, String)],
        file: usize,
        dir: &Path,
        limit: Duration,
    ) -> Result<bool> {
        let (name, fault_free) = &self.files[file];
        fs::write(dir.join(formal::MUTANT), &mutant[file].1)
            .and_then(|()| fs::write(dir.join(name), fault_free))
            .with_context(|| format!("cannot write `{name}`"))?;
        let top = self.top.trim_end_matches("_tb");
        let multiplier = format!("{top}_multiplier.v");
        let gold: Vec<&str> = if self.files.iter().any(|(name, _)| *name == multiplier) {
            // By itself, the multiplier has its default parameters, which no instance has.
            self.modules.iter().map(|&at| self.files[at].0.as_str()).collect()
        } else {
            vec![name]
        };
        let mut gate = gold.clone();
        for file in &mut gate {
            if file == name {
                *file = formal::MUTANT;
            }
        }
        let module = gold[0].trim_end_matches(".v");
        formal::proves(dir, module, [&gold, &gate], limit.min(PROOF_LIMIT))
    }
}

/// Returns whether a bench fails. A bench that does not end, or ends without a verdict, does not pass either.
fn fails(bench: &BuiltBench, limit: Duration) -> bool {
    match bench.run(limit) {
        Ok(outcome) => !outcome.passed,
        Err(_) => true,
    }
}

/// Adds the faults of one line.
fn in_line(
    name: &str,
    file: usize,
    line: usize,
    whole: &str,
    code: &str,
    faults: &mut Vec<TextFault>,
) {
    if code.contains("_rom [") || code.contains("$readmem") {
        return;
    }
    // An assignment on a clock is no comparison.
    let is_on_clock = !code.contains("wire") && !code.contains("assign");
    let assignment = if is_on_clock { code.find(" <= ") } else { None };
    let mut numbers = BTreeMap::<&str, usize>::new();
    for operator in OPERATORS.iter() {
        for found in operator.pattern.captures_iter(code) {
            // Two operators of a kind number their faults on.
            let number = numbers.entry(operator.kind).or_default();
            *number += 1;
            let Some(all) = found.get(0) else { continue };
            let by = (operator.with)(&found);
            let taken = assignment == Some(all.start());
            if by == all.as_str() || taken && operator.kind == "comparison" {
                continue;
            }
            let text = format!("{}{by}{}", &whole[..all.start()], &whole[all.end()..]);
            faults.push(TextFault {
                id: format!("{name}:{}:{}:{number}", line + 1, operator.kind.replace(' ', "-"),),
                kind: operator.kind,
                file,
                line,
                text,
            });
        }
    }
}
