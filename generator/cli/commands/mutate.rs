//! `glint mutate`: plants faults in a configuration's hardware, one at a time, and shows which of them the tests notice.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};

use super::mismatch::{self, first_clock, traced};
use super::{Loaded, load};
use crate::destination::Destination;
use crate::own_file::OwnFile;
use crate::report::CommandReport;
use crate::{Configs, OutputOptions, TimeLimit, progress, say, tables, wrong_usage};
use glint_base::program::Program;
use glint_core::registry::Registry;
use glint_prove::mutate::{
    self, Detector, FaultResult, Faults, GOAL_MEMORY, GOAL_TEXT, MutantVerdict, Score, Share,
    SignalDifference, TOLERATED, Tally, TextFault, TextScore, VerilogText,
};

/// Plant faults one at a time, and show which faults the tests notice
///
/// The faults are stuck and inverted bits, swapped mux inputs, wrong operators, constants and enables, every bit of every
/// control word, and a sample of ROM words. The command plants each fault in the netlist, and runs the default test of
/// `cosim` on this mutant. The mutant is caught, or proved to change nothing that is compared, or undecided. The command
/// also counts the mutants that the shipped bench notices. The exit code is 0 if at most 1 % of the faults of each
/// configuration are undecided.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint mutate my_core.toml                               the score, and the undecided faults
  glint mutate my_core.toml --list                        the names of all faults
  glint mutate my_core.toml --only 'result[3]:inverted'   one fault: the first difference, and a waveform
  glint mutate my_core.toml --full                        also faults in the emitted Verilog
  glint mutate --out mutation                             a record of each configuration in configs/")]
pub struct Arguments {
    #[command(flatten)]
    configs: Configs,
    /// List the faults, and plant none
    #[arg(long, conflicts_with_all = ["only", "out"])]
    list: bool,
    /// Plant only this fault; if it is caught, write a waveform around the first difference
    #[arg(long, value_name = "ID", conflicts_with = "out")]
    only: Option<String>,
    /// Also plant faults in the emitted Verilog; needs Icarus Verilog, Verilator and Yosys
    #[arg(long, conflicts_with_all = ["list", "only"])]
    full: bool,
    /// Write the record of each configuration, `<name>.json`, into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    time_limit: TimeLimit,
}

#[derive(Serialize)]
struct Scored {
    /// The version of Glint, with which a record begins.
    glint: &'static str,
    config: String,
    device: &'static str,
    netlist: Score,
    /// The score of faults in the emitted Verilog, if the user asked for it with `--full`.
    #[serde(skip_serializing_if = "Option::is_none")]
    verilog: Option<TextScore>,
}

impl Scored {
    fn share_undecided(&self) -> f64 {
        let (mut planted, mut undecided) = (self.netlist.all.planted, self.netlist.all.undecided);
        if let Some(text) = &self.verilog {
            planted += text.planted;
            undecided += text.undecided.len();
        }
        undecided as f64 / planted.max(1) as f64
    }

    fn holds(&self) -> bool {
        self.share_undecided() <= TOLERATED
    }
}

/// Runs the command. Returns whether few enough faults are undecided.
///
/// # Errors
///
/// Fails if a configuration has problems, if the named fault does not exist, if a tool is missing, or if a record cannot be
/// written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let loaded = load(registry, &arguments.configs.paths)?;
    if let Some(id) = &arguments.only {
        return match &loaded[..] {
            [one] => only(output, one, id),
            _ => {
                wrong_usage!(
                    "--only needs exactly one configuration, and there are {}: name one configuration",
                    loaded.len()
                )
            }
        };
    }
    let faults: Vec<Faults> = loaded.iter().map(|one| Faults::of(&one.core.design)).collect();
    if arguments.list {
        return list(output, &loaded, &faults);
    }
    let mut total = 0;
    for faults in &faults {
        total += faults.len();
    }
    let mut texts: Vec<Option<(VerilogText, Vec<TextFault>)>> = Vec::new();
    for one in &loaded {
        if !arguments.full {
            texts.push(None);
            continue;
        }
        let text = VerilogText::of(&one.core).with_context(|| format!("`{}`", one.path))?;
        let text_faults = text.faults();
        total += text_faults.len();
        texts.push(Some((text, text_faults)));
    }
    let mut records: Vec<Option<OwnFile>> = Vec::new();
    for one in &loaded {
        records.push(OwnFile::record(arguments.out.as_deref(), &one.core.config().name)?);
    }
    let bar = progress::bar(output, total as u64, "faults planted");
    let mut list = output.list();
    let mut holds = true;
    for (((one, faults), text), record) in loaded.iter().zip(&faults).zip(&texts).zip(records) {
        let found = mutate::run(&one.core, faults.iter(), &|| bar.inc(1));
        let netlist = Score::of(&found.with_context(|| format!("`{}`", one.path))?);
        let verilog = match text {
            Some((text, faults)) => {
                let results = text.run(faults, arguments.time_limit.get(), &|| bar.inc(1));
                Some(TextScore::of(faults, &results.with_context(|| format!("`{}`", one.path))?))
            }
            None => None,
        };
        let scored = Scored {
            glint: env!("CARGO_PKG_VERSION"),
            config: one.path.clone(),
            device: one.core.device().name,
            netlist,
            verilog,
        };
        if let Some(record) = record {
            record.write_json(&scored)?;
        }
        bar.suspend(|| list.add(&scored))?;
        holds &= scored.holds();
    }
    bar.finish_and_clear();
    list.conclude(holds)
}

impl CommandReport for Scored {
    fn json(&self) -> Result<Value> {
        Ok(json!(self))
    }

    fn print(&self) -> Result<()> {
        print(self);
        Ok(())
    }
}

fn list(output: OutputOptions, loaded: &[Loaded], faults: &[Faults]) -> Result<bool> {
    let mut list = output.list();
    for (one, faults) in loaded.iter().zip(faults) {
        list.add(&FaultNames { one, faults })?;
    }
    list.conclude(true)
}

struct FaultNames<'a> {
    one: &'a Loaded,
    faults: &'a Faults,
}

impl CommandReport for FaultNames<'_> {
    fn json(&self) -> Result<Value> {
        let mut faults = Vec::new();
        for fault in self.faults.iter() {
            faults.push(json!({ "id": fault.id, "kind": fault.kind }));
        }
        Ok(json!({ "config": self.one.path, "faults": faults }))
    }

    fn print(&self) -> Result<()> {
        say!("{}: {} faults", self.one.path, self.faults.len());
        for fault in self.faults.iter() {
            say!("  {}  {}", fault.id, fault.kind);
        }
        Ok(())
    }
}

/// Plants the fault `id`, and prints its verdict. If the fault is caught, also writes a waveform that ends with the first
/// difference. Returns whether the fault is decided.
fn only(output: OutputOptions, one: &Loaded, id: &str) -> Result<bool> {
    let faults = Faults::of(&one.core.design);
    let Some(fault) = faults.find(id) else {
        wrong_usage!(
            "`{}` has no fault `{id}`; `{Program} mutate {} --list` lists all faults",
            one.path,
            one.path
        );
    };
    let mut results = mutate::run(&one.core, [fault], &|| ())?;
    let found = results.pop().context("a fault without a verdict")?;
    let verdict = &found.verdict;
    let mut waveform = None;
    if let MutantVerdict::Caught(_, SignalDifference { held, mismatch }) = verdict {
        let mutant = fault.planted(&one.core.design);
        let lockstep = one.core.lockstep_of(&mutant, mismatch.seed)?.holding(held);
        let path = PathBuf::from(format!("{}_mutant.vcd", one.core.config().name));
        let from = first_clock(mismatch.clock);
        traced(one, &lockstep, Destination::open(&path)?, u64::MAX, from)?;
        waveform = Some((path, from, mismatch.clock));
    }
    output.report(&PlantedFault { one, found: &found, waveform })?;
    Ok(*verdict != MutantVerdict::Undecided)
}

struct PlantedFault<'a> {
    one: &'a Loaded,
    found: &'a FaultResult,
    /// The file with the waveform of a caught fault, and its first and last clock.
    waveform: Option<(PathBuf, u64, u64)>,
}

impl CommandReport for PlantedFault<'_> {
    fn json(&self) -> Result<Value> {
        Ok(found_as_json(self.one, self.found))
    }

    fn print(&self) -> Result<()> {
        let FaultResult { fault, verdict, shipped } = self.found;
        let said = match verdict {
            MutantVerdict::Caught(check, shown) => {
                format!("caught by {check}: {}", shown_by(shown))
            }
            MutantVerdict::Equivalent(how) => format!("equivalent, {how}"),
            MutantVerdict::Undecided => {
                "UNDECIDED: not caught, and not proved equivalent".to_owned()
            }
        };
        say!("{}: {} ({}): {said}", self.one.path, fault.id, fault.kind);
        if let Some((path, from, to)) = &self.waveform {
            say!("  `{}` shows clocks {from} to {to}", path.display());
        }
        if !matches!(verdict, MutantVerdict::Equivalent(_)) {
            let notices = if *shipped { "notices it" } else { "does not notice it" };
            say!("  the shipped bench {notices}");
        }
        Ok(())
    }
}

/// Describes the difference that a fault causes. For example, the phrase begins with `seed 3, with exponent=#5, after clock 120`.
fn shown_by(SignalDifference { held, mismatch }: &SignalDifference) -> String {
    let mut holding = String::new();
    for (name, raw) in held {
        if holding.is_empty() {
            holding += ", with";
        }
        holding += &format!(" {name}=#{raw}");
    }
    format!("seed {}{holding}, after clock {}, {mismatch}", mismatch.seed, mismatch.clock)
}

fn found_as_json(one: &Loaded, found: &FaultResult) -> Value {
    let FaultResult { fault, verdict, shipped } = found;
    let (caught, equivalent) = match verdict {
        MutantVerdict::Caught(check, SignalDifference { held, mismatch }) => {
            let mut caught = mismatch::as_json(mismatch);
            caught["by"] = json!(check);
            caught["held"] = json!(held.iter().cloned().collect::<BTreeMap<_, _>>());
            (Some(caught), None)
        }
        MutantVerdict::Equivalent(how) => (None, Some(how)),
        MutantVerdict::Undecided => (None, None),
    };
    json!({
        "ok": *verdict != MutantVerdict::Undecided,
        "config": one.path,
        "id": fault.id,
        "kind": fault.kind,
        "caught": caught,
        "equivalent": equivalent,
        "shipped": shipped,
    })
}

fn print(scored: &Scored) {
    let score = &scored.netlist;
    say!("{}:", scored.config);
    let mut rows = Vec::new();
    for (kind, tally) in &score.kinds {
        rows.push(row(kind.to_string(), tally));
    }
    rows.push(row("all".to_owned(), &score.all));
    tables::print(
        "fault | planted: | caught: | directed:1 | equivalent: | undecided: | bench:",
        rows,
    );
    print_undecided(&score.undecided);
    print_shipped("faults in the netlist", score.all.of_shipped(), None);
    if let Some(memory) = score.of_memory() {
        print_shipped("upper bits of words in ROMs", memory, Some(GOAL_MEMORY));
    }
    if let Some(verilog) = &scored.verilog {
        say!(
            "  Verilog: {} faults, {} noticed by lint, {} by a bench, {} equivalent, {} undecided",
            verilog.planted,
            verilog.lint,
            verilog.bench,
            verilog.equivalent,
            verilog.undecided.len(),
        );
        print_undecided(&verilog.undecided);
        print_shipped(
            "faults in the Verilog that show at the outputs",
            verilog.shipped,
            Some(GOAL_TEXT),
        );
    }
    say!(
        "  {:.2} % undecided: {}",
        100.0 * scored.share_undecided(),
        if scored.holds() { "holds" } else { "FAILS, at most 1 % may be undecided" }
    );
}

fn row(name: String, tally: &Tally) -> Vec<String> {
    let caught_by = |check| tally.caught.get(&check).copied().unwrap_or(0).to_string();
    vec![
        name,
        tally.planted.to_string(),
        caught_by(Detector::Cosim),
        caught_by(Detector::Directed),
        tally.all_equivalent().to_string(),
        tally.undecided.to_string(),
        tally.shipped.to_string(),
    ]
}

fn print_undecided(ids: &[String]) {
    for id in ids {
        say!("  undecided: {id}");
    }
}

/// Prints the share of faults that the shipped bench notices, among the faults that any test notices, and whether this share
/// reaches the goal.
fn print_shipped(faults: &str, share: Share, goal: Option<f64>) {
    let verdict = match goal {
        Some(goal) => {
            let reached = if share.value() >= goal { "reached" } else { "missed" };
            format!(", goal of {:.0} % {reached}", 100.0 * goal)
        }
        None => String::new(),
    };
    let Share { noticed, of } = share;
    let percent = 100.0 * share.value();
    say!("  shipped bench: {noticed} of {of} {faults} ({percent:.1} %{verdict})");
}
