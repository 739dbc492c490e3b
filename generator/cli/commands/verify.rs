//! `glint verify`: runs the checks of `glint_prove::verify` on configurations, such as co-simulation, proofs and lint, and
//! writes a record and a page about each.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load};
use crate::own_file::OwnFile;
use crate::report::CommandReport;
use crate::{Configs, OutputOptions, TimeLimit, progress, say, tables};
use glint_base::text::counted;
use glint_core::cosim::exhaustive::PROOFS;
use glint_core::package::Seal;
use glint_core::registry::Registry;
use glint_prove::verify::{
    CHECKS, CheckAnswer, CheckSubject, CheckTime, CheckVerdict, Conclusion, Effort,
    VerificationRecord, page,
};

/// Verify configurations with every check that Glint has, and write a page about each configuration
///
/// The command writes `DIR/<name>.html`, a page that loads nothing from the network, and `DIR/<name>.json` with the same
/// contents for scripts: what was shown, by which check, over which domain, with which tools, and what is left open. The
/// same tools always give the same two files, except for the last section of the page, which has the duration of each check;
/// `DIR/<name>.timings.json` has the durations too. The exit code is 0 only if every check that applies to the
/// configuration, and that --without-tools does not leave out, ran to its end and holds. A missing tool, a solver that
/// answers unknown or an exceeded time limit makes the verification incomplete. A proof of the accuracy contract that would
/// take more than some seconds also makes it incomplete, unless --full runs the proof or --proofs has its record. A record
/// is found by the digest of the configuration, and is checked again in part. The command plants 2048 faults in the netlist,
/// or all faults with --full.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint verify my_core.toml                       every check, in a minute or two
  glint verify my_core.toml --full                the whole proof, all faults: minutes to hours
  glint verify my_core.toml --without-tools       only checks without simulator, solver or synthesiser
  glint verify --json                             everything in configs/, for scripts

Exit codes: 0 verified, or verified without the checks that --without-tools leaves out; 1 a check fails, or could not be run to its end
(\"verified but for …\"); 2 wrong usage.")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// Run every check in full, however long it takes
    #[arg(long)]
    full: bool,
    /// Run only the checks that need no outside tool
    #[arg(long)]
    without_tools: bool,
    /// The directory for the files
    #[arg(long, value_name = "DIR", default_value = "verification")]
    out: PathBuf,
    /// The directory with records of `cosim --exhaustive --json`; a record replaces a long proof of the accuracy contract
    #[arg(long, value_name = "DIR", default_value = PROOFS)]
    proofs: PathBuf,
    #[command(flatten)]
    time_limit: TimeLimit<3600>,
}

/// The files about one configuration, such as `rough.html`, `rough.json` and `rough.timings.json`.
struct Files {
    page: OwnFile,
    record: OwnFile,
    timings: OwnFile,
}

impl Files {
    fn new(directory: &Path, name: &str) -> Result<Self> {
        let file = |suffix: &str, seal| OwnFile::new(directory, &format!("{name}{suffix}"), seal);
        Ok(Self {
            page: file(".html", Seal::Markup)?,
            record: file(".json", Seal::Json)?,
            timings: file(".timings.json", Seal::Json)?,
        })
    }

    fn write(self, record: &VerificationRecord, timings: &[CheckTime]) -> Result<[String; 3]> {
        let times = json!({ "glint": record.glint, "config": record.config, "seconds": timings });
        Ok([
            self.page.write(page::page(record, timings)?)?,
            self.record.write_json(record)?,
            self.timings.write_json(&times)?,
        ])
    }
}

/// Runs the checks. Returns whether every configuration is verified, with or without the checks that `--without-tools` leaves
/// out.
///
/// # Errors
///
/// Fails if a configuration has problems, or if a file was not written by Glint or cannot be written. A missing tool is no
/// error, but a part of the result.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    let mut files = Vec::new();
    for one in &loaded {
        files.push(Files::new(&arguments.out, &one.core.config().name)?);
    }
    let mut list = output.list();
    let mut verified = true;
    for (one, files) in loaded.iter().zip(files) {
        let (record, timings) = one_configuration(output, one, arguments)?;
        verified &= record.conclusion <= Conclusion::InPart;
        let written = files.write(&record, &timings)?;
        list.add(&Verification { one, record, written })?;
    }
    list.conclude(verified)
}

struct Verification<'a> {
    one: &'a Loaded,
    record: VerificationRecord,
    written: [String; 3],
}

impl CommandReport for Verification<'_> {
    fn json(&self) -> Result<Value> {
        Ok(json!({ "written": self.written, "record": self.record }))
    }

    fn print(&self) -> Result<()> {
        print_conclusion(self.one, &self.record);
        say!("  written: {}", self.written.join(", "));
        Ok(())
    }
}

fn one_configuration(
    output: OutputOptions,
    one: &Loaded,
    arguments: &Arguments,
) -> Result<(VerificationRecord, Vec<CheckTime>)> {
    one.contract()?;
    let effort = Effort {
        full: arguments.full,
        without_tools: arguments.without_tools,
        time_limit: arguments.time_limit.get(),
    };
    let subject = CheckSubject::new(&one.path, &one.core, effort, &arguments.proofs);
    let mut answers: Vec<CheckAnswer> = Vec::new();
    for check in CHECKS {
        if check.is_outside() && arguments.without_tools {
            answers.push(check.left_out("--without-tools leaves this check out."));
            continue;
        }
        let bar = progress::bar(output, check.steps(&subject), check.title);
        let answer = check.run(&subject, &|steps| bar.inc(steps));
        bar.finish_and_clear();
        if output.is_for_people() {
            print(one, &answer);
        }
        answers.push(answer);
    }
    let timings = answers.iter().map(|answer| answer.timing).collect();
    Ok((VerificationRecord::new(&subject, answers), timings))
}

/// Prints the conclusion, the titles of all checks that neither hold nor fail, and the commands that complete the verification.
fn print_conclusion(one: &Loaded, record: &VerificationRecord) {
    let mut counts: Vec<String> = Vec::new();
    for (verdict, count) in &record.counts {
        counts.push(format!("{count} {}", verdict.words()));
    }
    let mut open = 0;
    let mut commands = BTreeSet::new();
    for check in &record.checks {
        if check.finding.verdict.conclusion() == Conclusion::Incomplete {
            open += 1;
        }
        commands.extend(&check.finding.complete_with);
    }
    let words = match record.conclusion {
        Conclusion::Incomplete => format!("verified but for {}", counted(open, "check")),
        other => other.words().to_owned(),
    };
    tables::print_line(&format!("{}: {words}: {}", one.path, counts.join(", ")));
    for &verdict in record.counts.keys() {
        if matches!(verdict, CheckVerdict::Proved | CheckVerdict::Passed | CheckVerdict::Failed) {
            continue;
        }
        let with_verdict = record.checks.iter().filter(|it| it.finding.verdict == verdict);
        let titles: Vec<&str> = with_verdict.map(|answer| answer.title).collect();
        tables::print_line(&format!("  {}: {}", verdict.words(), titles.join(", ")));
    }
    for command in commands {
        say!("  to complete the verification: {}", command.replacen(&record.config, &one.path, 1));
    }
}

/// Prints the answer of a check that has just ended.
fn print(one: &Loaded, answer: &CheckAnswer) {
    let finding = &answer.finding;
    let domain =
        if finding.domain.is_empty() { String::new() } else { format!(" [{}]", finding.domain) };
    say!(
        "{}: {}: {} ({:.1} s){domain}",
        one.path,
        answer.title,
        finding.verdict.words(),
        answer.timing.seconds
    );
    if !finding.words.is_empty() && finding.verdict != CheckVerdict::Failed {
        say!("  {}", finding.words);
    }
    for failure in &finding.failures {
        say!("  FAILS: {failure}");
    }
    if !finding.open.is_empty() {
        say!("  not covered: {}", finding.open);
    }
}
