//! Everything that shows that a configuration does what it says, check by check, and a page about it.
//!
//! A [`Check`] asks one question, with the tools that it names, and gives a [`Finding`]: the answer, over
//! which domain it holds, and what it leaves open. The checks are independent of each other: none knows what
//! another found. What they found is the same whenever it is found with the same tools; how long it
//! took stands apart, in [`CheckTime`].

mod inside;
mod outside;
pub mod page;

#[cfg(test)]
mod tests;

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::Result;
use serde::Serialize;

use crate::base::input;
use crate::core::Core;
use crate::tools::Tool;

/// A configuration to be verified.
pub struct Subject<'a> {
    /// What the command line calls it.
    pub path: &'a str,
    /// The configuration and its design.
    pub core: &'a Core,
    /// How much is done.
    pub effort: Effort,
    /// Where records of `cosim --exhaustive --json` are.
    pub proofs: &'a Path,
}

/// How much a verification does.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Everything, however long it takes.
    pub full: bool,
    /// Only what needs no tool outside Glint.
    pub without_tools: bool,
    /// After which a run of an outside tool is given up.
    pub time_limit: Duration,
}

/// What a check says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds for everything in the domain.
    Proved,
    /// It held wherever it was tried.
    Passed,
    /// It does not hold.
    Failed,
    /// The check says nothing of this configuration, was left out on purpose, or is a second proof of what another
    /// check shows and did not succeed; why is said.
    NotCovered,
    /// It was run, and its test is too weak to say that it holds.
    Undecided,
    /// The check could not be run to its end: a tool is missing, it reached a limit, or it takes more than this
    /// effort allows.
    #[default]
    NotRun,
}

impl Verdict {
    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Proved => "proved",
            Self::Passed => "passed",
            Self::Failed => "FAILED",
            Self::NotCovered => "not covered",
            Self::Undecided => "undecided",
            Self::NotRun => "not run",
        }
    }
}

/// What a check found.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Finding {
    /// What it says.
    pub verdict: Verdict,
    /// For what: operands, clocks, faults.
    pub domain: String,
    /// The outcome in a sentence or two.
    pub words: String,
    /// What the check leaves undecided; may be empty.
    pub open: String,
    /// The record that stands for a part of the work, by its file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<String>,
    /// The command that completes what was not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub complete_with: Option<String>,
    /// What does not hold, each with its reproducer.
    #[serde(rename = "faults")]
    pub failures: Vec<String>,
}

impl Finding {
    /// A verdict on a domain.
    fn new(verdict: Verdict, domain: impl Into<String>, words: impl Into<String>) -> Self {
        Self { domain: domain.into(), ..Self::without(verdict, words) }
    }

    /// Of a check that says nothing here.
    fn without(verdict: Verdict, why: impl Into<String>) -> Self {
        Self { verdict, words: why.into(), ..Self::default() }
    }

    /// A verdict of failure if there are any.
    fn failures(self, failures: Vec<String>) -> Self {
        let verdict = if failures.is_empty() { self.verdict } else { Verdict::Failed };
        Self { verdict, failures, ..self }
    }

    fn open(self, open: impl Into<String>) -> Self {
        Self { open: open.into(), ..self }
    }
}

/// What a check does, with its tools; it tells the steps that are done.
type Run = fn(&Subject<'_>, &[Tool], &(dyn Fn(u64) + Sync)) -> Result<Finding>;

/// One question about a configuration.
pub struct Check {
    /// For scripts.
    pub id: &'static str,
    /// For people.
    pub title: &'static str,
    /// What it compares with what.
    pub question: &'static str,
    /// The tools outside Glint that it runs.
    tools: &'static [&'static str],
    /// How many steps its progress has.
    steps: fn(&Subject<'_>) -> u64,
    run: Run,
}

/// All checks: first those that need nothing but Glint.
pub const CHECKS: [&Check; 14] = [
    &inside::DESIGN,
    &inside::LOCKSTEP,
    &inside::CLOCKS,
    &inside::CONTRACT,
    &inside::MUTATION,
    &outside::CERTIFICATE,
    &outside::EQUALITY,
    &outside::LINT,
    &outside::ICARUS,
    &outside::VERILATOR,
    &outside::COCOTB,
    &outside::FORMAL,
    &outside::SYNTHESIS,
    &outside::GATES,
];

impl Check {
    /// Whether it needs a tool outside Glint.
    pub fn is_outside(&self) -> bool {
        !self.tools.is_empty()
    }

    /// The steps that its progress will have.
    pub fn steps(&self, subject: &Subject<'_>) -> u64 {
        (self.steps)(subject)
    }

    /// Runs it. A tool that is missing, or that does not do its work, is a finding too.
    pub fn run(&self, subject: &Subject<'_>, progress: &(dyn Fn(u64) + Sync)) -> Answer {
        let begin = Instant::now();
        let (tools, finding) = self.find(subject, progress);
        self.answer(tools, finding, begin.elapsed())
    }

    /// What is said of it where it is not run on purpose.
    pub fn left_out(&self, why: &str) -> Answer {
        let finding = Finding::without(Verdict::NotCovered, why);
        self.answer(Vec::new(), finding, Duration::ZERO)
    }

    fn answer(&self, tools: Vec<String>, finding: Finding, took: Duration) -> Answer {
        Answer {
            check: self.id,
            title: self.title,
            question: self.question,
            tools,
            finding,
            timing: CheckTime { check: self.id, seconds: took.as_secs_f64() },
        }
    }

    fn find(
        &self,
        subject: &Subject<'_>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> (Vec<String>, Finding) {
        let tools: Result<Vec<Tool>> = self.tools.iter().map(|name| Tool::find(name)).collect();
        let tools = match tools {
            Ok(tools) => tools,
            Err(missing) => {
                let why = Finding::without(Verdict::NotRun, format!("{missing:#}"));
                return (Vec::new(), why);
            }
        };
        // A tool that does not tell its version will say more about it when it is run.
        let versions = tools.iter().filter_map(|tool| tool.version().ok());
        let versions = versions.collect();
        let finding = (self.run)(subject, &tools, progress)
            .unwrap_or_else(|error| Finding::default().failures(vec![format!("{error:#}")]));
        (versions, finding)
    }
}

/// A check and what it found.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// [`Check::id`].
    pub check: &'static str,
    /// [`Check::title`].
    pub title: &'static str,
    /// [`Check::question`].
    pub question: &'static str,
    /// Versions of the tools outside Glint.
    pub tools: Vec<String>,
    /// What was found.
    #[serde(flatten)]
    pub finding: Finding,
    /// How long it took: not among what is the same every time.
    #[serde(skip)]
    pub timing: CheckTime,
}

/// How long a check took.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CheckTime {
    /// [`Check::id`].
    pub check: &'static str,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// What all checks say together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Conclusion {
    /// Every check that covers the configuration was run, and all of them hold.
    Verified,
    /// Nothing failed, but a check could not be run, or decides nothing.
    Incomplete,
    /// Something does not hold.
    Failed,
}

impl Conclusion {
    /// Of some answers.
    pub fn of(answers: &[Answer]) -> Self {
        let any = |verdict| answers.iter().any(|it| it.finding.verdict == verdict);
        match (any(Verdict::Failed), any(Verdict::NotRun) || any(Verdict::Undecided)) {
            (true, _) => Self::Failed,
            (false, true) => Self::Incomplete,
            (false, false) => Self::Verified,
        }
    }

    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Verified => "verified",
            Self::Incomplete => "incomplete",
            Self::Failed => "FAILED",
        }
    }
}

/// What was found of one configuration; `<name>.json` is this.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// The version of Glint.
    pub glint: &'static str,
    /// What the command line calls the configuration.
    pub config: String,
    /// The top module.
    pub name: String,
    /// The device.
    pub device: &'static str,
    /// SHA-256 of the configuration with all its keys.
    pub configuration: String,
    /// Whether everything was done, however long it takes.
    pub full: bool,
    /// What all checks say together.
    pub conclusion: Conclusion,
    /// In the order in which they were run.
    pub checks: Vec<Answer>,
}

impl Record {
    /// Of the answers of all checks.
    pub fn new(subject: &Subject<'_>, checks: Vec<Answer>) -> Self {
        Self {
            glint: env!("CARGO_PKG_VERSION"),
            config: input::label(subject.path),
            name: subject.core.config.name.clone(),
            device: subject.core.device.name,
            configuration: subject.core.digest(),
            full: subject.effort.full,
            conclusion: Conclusion::of(&checks),
            checks,
        }
    }
}
