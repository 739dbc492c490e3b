//! Plants faults in the text of the emitted Verilog, and finds out whether lint or a test bench notices them.
//!
//! Each mutant has one fault, such as a bug in the emitter could cause. For example, `4'd9` becomes `4'd8`. If lint, the shipped
//! bench and a longer bench do not notice the fault, Yosys tries to prove that it changes nothing. No fault moves a register to
//! the falling clock edge: in simulation its input is stable by then, and only timing analysis could notice.

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
use glint_core::package::{self, EmitInputs, FileKind, OutputFile, OutputFiles};
use glint_tools::transient::Directory;
use glint_tools::{BuiltBench, Tool, VerilogSimulator, Waveform};

/// The number of results of the longer bench, which runs if the shipped bench notices nothing.
const POINTS: u64 = 10_000;

/// The time limit of Yosys for the proof that a fault changes nothing. Proofs that succeed take some seconds, so the limit is
/// enough even on a busy machine.
const PROOF_LIMIT: Duration = Duration::from_secs(120);

/// A fault in the text of the emitted Verilog. For example, `4'd9` becomes `4'd8`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    /// The file, the line number, the kind of fault, and a number among the faults of this kind in the line. For example,
    /// `blinn_datapath.v:127:operator:1` is the first wrong operator in line 127.
    pub id: String,
    /// The kind of fault, such as `operator`.
    pub kind: &'static str,
    file: usize,
    /// The number of the line, from 0, and its new text.
    line: usize,
    text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TextMutantVerdict {
    /// Icarus Verilog or Verilator refuses the text or warns of it.
    Lint,
    Bench,
    Equivalent,
    Undecided,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShippedBench {
    /// Icarus Verilog cannot build the shipped bench with the fault.
    Refused,
    /// The shipped bench fails, so it notices the fault.
    Noticed,
    Missed,
    /// The shipped bench and a longer bench pass. If the fault changes an output at all, it does so seldom.
    Silent,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextFaultResult {
    pub verdict: TextMutantVerdict,
    pub shipped: ShippedBench,
}

const TOOLS: [&str; 4] = ["iverilog", "vvp", "verilator", "yosys"];

/// The Verilog files of a configuration in which faults are planted, and the test benches and proofs that may notice the faults.
pub struct VerilogText {
    files: Vec<OutputFile>,
    /// The longer bench, with random points only, and its vectors. They replace the shipped bench and vectors.
    longer: Vec<OutputFile>,
    core: String,
    is_pipeline: bool,
    /// The indices in `files` of the files in which faults are planted.
    modules: Vec<usize>,
}

/// A kind of fault: `with` returns the text that replaces a match of `pattern`. The original text as the result means no fault.
/// For example, the kind `constant` replaces `4'd9` by `4'd8`.
struct TextOperator {
    kind: &'static str,
    pattern: Regex,
    with: fn(&regex::Captures<'_>) -> String,
}

/// The kinds of faults. [`in_line`] applies them to a line's code, but not to declarations of memories.
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
            let shift = |text: &str| (text.parse::<u64>().unwrap_or_default() + 1).to_string();
            let low = it.get(3).map_or(String::new(), |low| format!(":{}", shift(low.as_str())));
            format!("{}[{}{low}]", &it[1], shift(&it[2]))
        }),
        operator("width", r"\b(wire|reg)( +signed)? +\[(\d+):0\]", |it| {
            let high = it[3].parse::<u64>().unwrap_or_default().saturating_sub(1);
            format!("{}{} [{high}:0]", &it[1], it.get(2).map_or("", |sign| sign.as_str()))
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

impl VerilogText {
    /// Collects the Verilog files of a core, its shipped bench, and a longer bench.
    ///
    /// # Errors
    /// Fails if `iverilog`, `vvp`, `verilator` or `yosys` is missing, if golden model and simulation differ, or if the files
    /// cannot be made.
    pub fn of(core: &Core) -> Result<Self> {
        TOOLS.iter().try_for_each(|tool| Tool::find(tool).map(drop))?;
        let name = &core.config().name;
        let files = core.files(&format!("{name}.toml"), core.shipped_vectors()?)?;
        let vectors = Some(core.vectors(POINTS, TEST_SEED)?);
        let longer = package::emit(&core.design, &EmitInputs { vectors, ..EmitInputs::default() })?;
        // Wrappers around the core have a bench and proofs of their own.
        let read = [FileKind::CORE_SOURCES, FileKind::BENCH_SOURCES].concat();
        let mut text = Self::new(core, &files, &read, &[FileKind::CoreVerilog]);
        text.longer = longer.of(FileKind::BENCH_SOURCES).into_iter().cloned().collect();
        Ok(text)
    }

    /// Collects the Verilog files of the wrappers around a core, with their shipped benches and proofs.
    ///
    /// # Errors
    /// Fails if golden model and simulation differ, or if the files cannot be made.
    pub fn of_wrappers(core: &Core) -> Result<Self> {
        let name = &core.config().name;
        let files = core.files(&format!("{name}.toml"), core.shipped_vectors()?)?;
        let proofs = [FileKind::WrapperProof, FileKind::WrapperProofScript];
        let read = [FileKind::SIMULATED, &proofs].concat();
        let wrappers = FileKind::WRAPPERS;
        Ok(Self::new(core, &files, &read, wrappers))
    }

    fn new(core: &Core, files: &OutputFiles, read: &[FileKind], planted: &[FileKind]) -> Self {
        let mut text = Self {
            files: Vec::new(),
            longer: Vec::new(),
            core: core.config().name.clone(),
            is_pipeline: core.design.pipeline.is_some(),
            modules: Vec::new(),
        };
        for file in files.of(read) {
            if planted.contains(&file.kind) {
                text.modules.push(text.files.len());
            }
            text.files.push(file.clone());
        }
        text
    }

    /// Returns the fault-free files: the Verilog of the modules, their benches and vectors, and the proofs of wrappers.
    pub fn files(&self) -> &[OutputFile] {
        &self.files
    }

    /// Returns [`VerilogText::files`] with `fault` planted in one file.
    pub fn planted(&self, fault: &TextFault) -> Vec<OutputFile> {
        let mut text = String::new();
        for (number, line) in self.files[fault.file].contents.lines().enumerate() {
            text += if number == fault.line { &fault.text } else { line };
            text += "\n";
        }
        let mut files = self.files.clone();
        files[fault.file].contents = text;
        files
    }

    /// Returns the name of the bench's module, or an empty text without a bench.
    fn bench(&self) -> &str {
        let bench = self.files.iter().find(|file| file.kind == FileKind::Bench);
        bench.map_or("", OutputFile::main_module)
    }

    /// Returns the faults in the text's order.
    pub fn faults(&self) -> Vec<TextFault> {
        let mut faults = Vec::new();
        for &file in &self.modules {
            let (name, text) = self.files[file].source();
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

    /// Plants each of `faults` in turn, and returns the verdicts in the same order. `limit` is the time limit of each run of a
    /// tool. Calls `progress` after each fault.
    ///
    /// # Errors
    ///
    /// Fails if Verilator is missing, does not start, or does not end within `limit`; or if Yosys is missing. A missing Icarus
    /// Verilog is no error: the verdict of every fault is then [`TextMutantVerdict::Lint`].
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
            // Lint would refuse a text that Icarus does not build, too.
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

    /// Returns whether Verilator's lint refuses the modules or warns of them.
    fn is_linted(&self, files: &[OutputFile], verilator: &Tool, limit: Duration) -> Result<bool> {
        let dir = Directory::new().context("cannot make a temporary directory")?;
        for file in files {
            let (name, contents) = file.source();
            fs::write(dir.path().join(name), contents)
                .with_context(|| format!("cannot write `{name}`"))?;
        }
        let mut arguments = vec!["--lint-only", "-Wall", "--top-module"];
        arguments.push(&self.core);
        arguments.extend(self.modules.iter().map(|&at| files[at].name()));
        let lint = verilator.run(arguments, dir.path(), limit)?;
        Ok(!lint.status.success() || !lint.output.is_empty())
    }

    /// Returns the verdict of the benches on a mutant. If both benches pass, also returns the built shipped bench, because its
    /// directory has all files.
    fn benches(
        &self,
        mutant: &[OutputFile],
        limit: Duration,
    ) -> Result<(ShippedBench, Option<BuiltBench>)> {
        let build = |files: &[OutputFile]| {
            let sources: Vec<_> = files.iter().map(OutputFile::source).collect();
            let simulator = VerilogSimulator::Icarus;
            BuiltBench::build(simulator, &sources, self.bench(), Waveform::None, limit)
        };
        // A bench that does not end, or that ends without a verdict, counts as failed.
        let fails = |bench: &BuiltBench| !bench.run(limit).is_ok_and(|outcome| outcome.passed);
        let Ok(shipped) = build(mutant) else {
            return Ok((ShippedBench::Refused, None));
        };
        if fails(&shipped) {
            return Ok((ShippedBench::Noticed, None));
        }
        let mut longer = mutant.to_vec();
        for replacement in &self.longer {
            if let Some(file) = longer.iter_mut().find(|file| file.path == replacement.path) {
                file.contents.clone_from(&replacement.contents);
            }
        }
        Ok(if fails(&build(&longer)?) {
            (ShippedBench::Missed, None)
        } else {
            (ShippedBench::Silent, Some(shipped))
        })
    }

    /// Returns whether Yosys proves that the fault in file number `file` changes nothing. The directory `dir` must contain all
    /// files.
    fn proves(
        &self,
        mutant: &[OutputFile],
        file: usize,
        dir: &Path,
        limit: Duration,
    ) -> Result<bool> {
        let (name, fault_free) = self.files[file].source();
        fs::write(dir.join(formal::MUTANT), &mutant[file].contents)
            .and_then(|()| fs::write(dir.join(name), fault_free))
            .with_context(|| format!("cannot write `{name}`"))?;
        let proved = if self.is_pipeline {
            // The multiplier alone would have its default parameters, which no instance has.
            self.modules.clone()
        } else {
            vec![file]
        };
        let mut gold = Vec::new();
        let mut gate = Vec::new();
        for &place in &proved {
            gold.push(self.files[place].name());
            gate.push(if place == file { formal::MUTANT } else { self.files[place].name() });
        }
        let module = self.files[proved[0]].main_module();
        formal::proves(dir, module, [&gold, &gate], limit.min(PROOF_LIMIT))
    }
}

/// Adds the faults of one line to `faults`. `whole` is the line, `code` the part before a comment, `line` the line's number from
/// 0, and `file` the index of the file `name`.
fn in_line(
    name: &str,
    file: usize,
    line: usize,
    whole: &str,
    code: &str,
    faults: &mut Vec<TextFault>,
) {
    let is_memory = code.contains("_rom [") || code.contains("$readmem");
    // The `<=` of a nonblocking assignment is no comparison.
    let assignment =
        code.find(" <= ").filter(|_| !code.contains("wire") && !code.contains("assign"));
    let mut numbers = BTreeMap::<&str, usize>::new();
    for operator in OPERATORS.iter().filter(|_| !is_memory) {
        for found in operator.pattern.captures_iter(code) {
            // Two entries with the same kind share the numbering of their faults.
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
