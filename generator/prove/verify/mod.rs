//! Defines the checks of `glint verify`, and makes the record and the page about their results. The command line chooses the
//! checks to run, and writes the files.
//!
//! A [`Check`] asks one question about a configuration, for example whether golden model and simulation agree. [`Check::run`]
//! returns a [`CheckAnswer`] with a [`Finding`]: the verdict, the domain for which it holds, and the questions that remain open.
//! A missing tool is a verdict, not an error.

mod inside;
mod outside;
pub mod page;
mod recomputation;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use anyhow::Result;
use serde::Serialize;

use glint_base::input;
use glint_core::core::Core;
use glint_core::package::{self, FileKind, OutputFiles};
use glint_tools::{LimitReached, Tool};

/// A configuration that `glint verify` checks, with the verification's settings.
pub struct CheckSubject<'a> {
    /// The path of the configuration file on the command line.
    pub path: &'a str,
    pub core: &'a Core,
    pub effort: Effort,
    /// The directory with the records that `glint cosim --exhaustive --json` writes.
    pub proofs: &'a Path,
    files: OnceLock<OutputFiles>,
}

impl<'a> CheckSubject<'a> {
    pub fn new(path: &'a str, core: &'a Core, effort: Effort, proofs: &'a Path) -> Self {
        Self { path, core, effort, proofs, files: OnceLock::new() }
    }

    /// Returns every file that `glint generate` writes. The first call makes the files.
    fn files(&self) -> Result<&OutputFiles> {
        if let Some(files) = self.files.get() {
            return Ok(files);
        }
        let files = self.core.files(self.path, self.core.shipped_vectors()?)?;
        Ok(self.files.get_or_init(|| files))
    }

    /// Returns the files of the core that tools read for `target`, as pairs of a file name without directories and contents.
    /// `target` is the name of an FPGA family, or empty for files that suit every target.
    fn sources(&self, target: &str) -> Result<Vec<(String, String)>> {
        Ok(self.files()?.sources_for(FileKind::CORE_SOURCES, target))
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct FileDigest {
    /// The path as `generate` names it, for example `rtl_out/rsqrt/rsqrt.v`.
    pub path: String,
    /// The SHA-256 in hexadecimal.
    pub sha256: String,
}

#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Whether to do all the work, however long it takes. Otherwise long checks do a part of their work or are left out.
    pub full: bool,
    pub without_tools: bool,
    pub time_limit: Duration,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckVerdict {
    /// The checked property holds for everything in the domain.
    Proved,
    /// The checked property held in all cases that the check tried.
    Passed,
    /// The checked property does not hold.
    Failed,
    /// The check ran to its end but cannot decide. For example, the test is too weak, the solver answers that it does not know,
    /// or Glint cannot interpret the Verilog.
    Undecided,
    /// The check reached a limit of time or memory.
    LimitReached,
    /// The check could not be run: a tool is missing, or a long check's record is missing and the check needs `--full`.
    #[default]
    NotRun,
    /// The check is a second proof of a fact that an earlier check shows, and did not succeed. For example, Gappa finds no proof
    /// of the error bound.
    Unconfirmed,
    /// The check was left out on purpose, by the user or because it would take long without `--full`.
    LeftOut,
    /// The check does not apply to this configuration. For example, a sequential core has no pipeline to compare.
    NotApplicable,
}

impl CheckVerdict {
    /// Returns the verdict as a short text, for example `proved` or `not run`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Passed => "passed",
            Self::Failed => "FAILED",
            Self::Undecided => "undecided",
            Self::LimitReached => "limit reached",
            Self::NotRun => "not run",
            Self::Unconfirmed => "not confirmed",
            Self::LeftOut => "left out",
            Self::NotApplicable => "not applicable",
        }
    }

    /// Returns the conclusion of a verification with this worst verdict.
    pub fn conclusion(self) -> Conclusion {
        match self {
            Self::Failed => Conclusion::Failed,
            Self::Undecided | Self::LimitReached | Self::NotRun => Conclusion::Incomplete,
            Self::LeftOut => Conclusion::InPart,
            Self::Proved | Self::Passed | Self::Unconfirmed | Self::NotApplicable => {
                Conclusion::Verified
            }
        }
    }
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct Finding {
    pub verdict: CheckVerdict,
    /// The operands, clocks or faults for which the finding holds, in words.
    pub domain: String,
    /// The outcome in a sentence or two.
    pub words: String,
    /// The questions that the check leaves open; empty if there are no such questions.
    pub open: String,
    /// The path of a record that replaces a part of the work.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<String>,
    /// The command that would run a check that was left out or not run, or that reached its time limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub complete_with: Option<String>,
    /// The failures in words: for example, the seed, the clock and the signal of a difference, or the output of the tool that
    /// failed.
    #[serde(rename = "faults")]
    pub failures: Vec<String>,
}

impl Finding {
    fn new(verdict: CheckVerdict, domain: impl Into<String>, words: impl Into<String>) -> Self {
        Self { domain: domain.into(), ..Self::without(verdict, words) }
    }

    fn without(verdict: CheckVerdict, why: impl Into<String>) -> Self {
        Self { verdict, words: why.into(), ..Self::default() }
    }

    /// Sets the failures; if there are any, the verdict becomes [`CheckVerdict::Failed`].
    fn failures(self, failures: Vec<String>) -> Self {
        let verdict = if failures.is_empty() { self.verdict } else { CheckVerdict::Failed };
        Self { verdict, failures, ..self }
    }

    fn open(self, open: impl Into<String>) -> Self {
        Self { open: open.into(), ..self }
    }
}

/// Runs a check. It gets the subject, the check's tools in the order of their names, and a function for progress. It calls this
/// function with the number of steps that it has finished since the last call.
type CheckFunction = fn(&CheckSubject<'_>, &[Tool], &(dyn Fn(u64) + Sync)) -> Result<Finding>;

pub struct Check {
    /// The name for scripts, for example `lockstep`.
    pub id: &'static str,
    /// The name for people, for example "Golden model against simulation".
    pub title: &'static str,
    /// The question, for example "Is no output further from the formula in f64 than the stated bound, for any operands?".
    pub question: &'static str,
    /// The files or structures that the check reads, in words.
    pub reads: &'static str,
    tools: &'static [&'static str],
    steps: fn(&CheckSubject<'_>) -> u64,
    run: CheckFunction,
}

/// All checks, in the order in which they run. Checks that take seconds come first. Checks that may compute every combination
/// of operands, or every fault, come last.
pub const CHECKS: [&Check; 16] = [
    &inside::DESIGN,
    &inside::LOCKSTEP,
    &inside::CLOCKS,
    &outside::LINT,
    &outside::ICARUS,
    &outside::VERILATOR,
    &outside::COCOTB,
    &outside::FORMAL,
    &outside::TEXT,
    &outside::EQUALITY,
    &outside::CERTIFICATE,
    &outside::SYNTHESIS,
    &outside::GATES,
    &inside::CONTRACT,
    &recomputation::RECOMPUTATION,
    &inside::MUTATION,
];

impl Check {
    pub fn is_outside(&self) -> bool {
        !self.tools.is_empty()
    }

    /// Returns the number of steps that [`Check::run`] will report to its `progress`.
    pub fn steps(&self, subject: &CheckSubject<'_>) -> u64 {
        (self.steps)(subject)
    }

    /// Runs the check, and calls `progress` with the number of newly finished steps. If a tool is missing, the verdict is
    /// [`CheckVerdict::NotRun`]. If the check ends with an error, the verdict is [`CheckVerdict::Failed`], or
    /// [`CheckVerdict::LimitReached`] if a tool was stopped at its time limit.
    pub fn run(&self, subject: &CheckSubject<'_>, progress: &(dyn Fn(u64) + Sync)) -> CheckAnswer {
        let begin = Instant::now();
        let (tools, finding) = self.find(subject, progress);
        self.answer(tools, finding, begin.elapsed())
    }

    /// Returns the answer of a check that is left out on purpose. `why` is the reason.
    pub fn left_out(&self, why: &str) -> CheckAnswer {
        let finding = Finding::without(CheckVerdict::LeftOut, why);
        self.answer(Vec::new(), finding, Duration::ZERO)
    }

    fn answer(&self, tools: Vec<String>, finding: Finding, took: Duration) -> CheckAnswer {
        CheckAnswer {
            check: self.id,
            title: self.title,
            question: self.question,
            reads: self.reads,
            tools,
            finding,
            timing: CheckTime { check: self.id, seconds: took.as_secs_f64() },
        }
    }

    fn find(
        &self,
        subject: &CheckSubject<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> (Vec<String>, Finding) {
        let tools: Result<Vec<Tool>> = self.tools.iter().map(|name| Tool::find(name)).collect();
        let tools = match tools {
            Ok(tools) => tools,
            Err(missing) => {
                let why = Finding::without(CheckVerdict::NotRun, format!("{missing:#}"));
                return (Vec::new(), why);
            }
        };
        // A tool that does not tell its version is no error here. Its failure shows when the check runs the tool.
        let versions = tools.iter().filter_map(|tool| tool.version().ok());
        let versions = versions.collect();
        let limit = subject.effort.time_limit;
        let finding = (tools.iter().try_for_each(|tool| tool.ensure_works(limit)))
            .and_then(|()| (self.run)(subject, &tools, progress))
            .unwrap_or_else(|error| {
                let message = format!("{error:#}");
                if error.is::<LimitReached>() {
                    // A tool that was stopped has found no failure.
                    Finding::without(CheckVerdict::LimitReached, message)
                } else {
                    Finding::default().failures(vec![message])
                }
            });
        (versions, finding)
    }
}

/// A check of `glint verify`, with its finding and the time that it took.
#[derive(Clone, Debug, Serialize)]
pub struct CheckAnswer {
    /// The value of [`Check::id`].
    pub check: &'static str,
    /// The value of [`Check::title`].
    pub title: &'static str,
    /// The value of [`Check::question`].
    pub question: &'static str,
    /// The value of [`Check::reads`].
    pub reads: &'static str,
    /// The versions of the outside tools that the check used; empty if a tool is missing.
    pub tools: Vec<String>,
    #[serde(flatten)]
    pub finding: Finding,
    /// The record leaves out the time, because it differs from run to run.
    #[serde(skip)]
    pub timing: CheckTime,
}

/// A check's time, apart from its finding, because it differs from run to run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CheckTime {
    /// The value of [`Check::id`].
    pub check: &'static str,
    pub seconds: f64,
}

/// The conclusion about a configuration. The worst verdict of its checks decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Conclusion {
    /// Every check that applies to the configuration ran, and every checked property holds. A second proof of a fact may be
    /// [`CheckVerdict::Unconfirmed`].
    Verified,
    /// Checks were left out on purpose. Every other check ran, and every checked property holds.
    InPart,
    /// Nothing failed, but a check could not be run to its end, or could not decide.
    Incomplete,
    /// A checked property does not hold.
    Failed,
}

impl Conclusion {
    /// Returns the worst conclusion, or [`Conclusion::Incomplete`] without answers.
    pub fn of(answers: &[CheckAnswer]) -> Self {
        let verdicts = answers.iter().map(|answer| answer.finding.verdict.conclusion());
        verdicts.max().unwrap_or(Self::Incomplete)
    }

    pub fn words(self) -> &'static str {
        match self {
            Self::Verified => "verified",
            Self::InPart => "verified in part",
            Self::Incomplete => "incomplete",
            Self::Failed => "FAILED",
        }
    }
}

/// The record for one configuration, written to `<name>.json`.
#[derive(Clone, Debug, Serialize)]
pub struct VerificationRecord {
    pub glint: &'static str,
    /// The path on the command line.
    pub config: String,
    pub name: String,
    pub device: &'static str,
    /// The SHA-256 of the configuration with all its keys, in hexadecimal.
    pub configuration: String,
    /// The Verilog and memory files that `generate` writes, with digests. Empty if these files cannot be made, for example
    /// because golden model and simulation disagree on the test bench.
    pub files: Vec<FileDigest>,
    pub full: bool,
    pub conclusion: Conclusion,
    /// The number of checks with each verdict, without verdicts that no check has.
    pub counts: BTreeMap<CheckVerdict, usize>,
    /// The answers in the order in which the checks ran.
    pub checks: Vec<CheckAnswer>,
}

impl VerificationRecord {
    pub fn new(subject: &CheckSubject<'_>, checks: Vec<CheckAnswer>) -> Self {
        let mut counts = BTreeMap::new();
        let mut files = Vec::new();
        if let Ok(emitted) = subject.files() {
            let checked = [FileKind::SIMULATED, &[FileKind::TargetVerilog]].concat();
            for file in emitted.of(&checked) {
                let sha256 = package::digest(file.contents.as_bytes());
                files.push(FileDigest { path: file.path.clone(), sha256 });
            }
        }
        checks.iter().for_each(|it| *counts.entry(it.finding.verdict).or_insert(0) += 1);
        Self {
            glint: env!("CARGO_PKG_VERSION"),
            config: input::label(subject.path),
            name: subject.core.config().name.clone(),
            device: subject.core.device().name,
            configuration: subject.core.digest(),
            files,
            full: subject.effort.full,
            conclusion: Conclusion::of(&checks),
            counts,
            checks,
        }
    }
}
