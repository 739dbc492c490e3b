//! Proves with Yosys that a Verilog module and the same module with a fault have the same values in all ports and registers.
//! Such a fault is equivalent, and no test has to notice it.
//!
//! A failed proof does not mean that the fault changes anything.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use regex::Regex;

use glint_tools::Tool;

/// The file with the faulty module, in the same directory as the fault-free file.
pub(super) const MUTANT: &str = "glint_mutant.v";

/// The file with the nets that may differ, one in each line, and the file with Yosys's final answer.
const FREE: &str = "glint_free.txt";
const STATUS: &str = "glint_status.txt";

/// The number of attempts; each attempt lets more nets differ.
const ROUNDS: usize = 4;

/// A line of Yosys's answer about a net for which the equality is not proved.
static DIFFERS: LazyLock<Regex> = LazyLock::new(|| pattern(r"^  Unproven .*: \\(\w+)_gold\b"));

/// The declarations of ports and registers, which must not differ.
static KEPT: LazyLock<Regex> =
    LazyLock::new(|| pattern(r"(?m)^ *(?:input|output|reg)\b[^;,/]*?(\w+)(?:,|;| *(?://.*)?$)"));

fn pattern(text: &str) -> Regex {
    Regex::new(text).expect("a pattern of ours")
}

/// Returns whether Yosys proves that every port and register of the module `name` is equal in the fault-free module and in the
/// mutant, for all inputs. Wires may differ. Returns false if the proof takes more than `limit`.
///
/// The proof is temporal induction from a state in which both modules agree. The first attempt proves all nets with the same name
/// equal, which makes the proof short. The next attempt leaves out nets that differ. `gold` are the fault-free files in
/// `directory`; in `gate` one file is [`MUTANT`].
///
/// # Errors
///
/// Fails if Yosys is missing, or if a file cannot be read or written.
pub(super) fn proves(
    directory: &Path,
    name: &str,
    [gold, gate]: [&[&str]; 2],
    limit: Duration,
) -> Result<bool> {
    let yosys = Tool::find("yosys")?;
    let end = Instant::now() + limit;
    let mut text = String::new();
    for file in gold {
        let path = directory.join(file);
        text += &fs::read_to_string(&path)
            .with_context(|| format!("cannot read `{}`", path.display()))?;
    }
    let kept: BTreeSet<&str> =
        KEPT.captures_iter(&text).filter_map(|it| Some(it.get(1)?.as_str())).collect();
    let mut free = BTreeSet::new();
    for _ in 0..ROUNDS {
        let names: Vec<&str> = free.iter().map(String::as_str).collect();
        fs::write(directory.join(FREE), names.join("\n"))
            .with_context(|| format!("cannot write `{FREE}`"))?;
        let commands = commands(name, [gold, gate], !free.is_empty());
        let left = end.saturating_duration_since(Instant::now());
        let run = yosys.run(["-q", "-p", &commands], directory, left);
        if !run.is_ok_and(|run| run.status.success()) {
            return Ok(false);
        }
        let status = fs::read_to_string(directory.join(STATUS))
            .with_context(|| format!("cannot read `{STATUS}`"))?;
        if status.contains("Equivalence successfully proven!") {
            return Ok(true);
        }
        let differing = status.lines().filter(|line| line.starts_with("  Unproven"));
        let differing: Option<BTreeSet<String>> =
            differing.map(|line| Some(DIFFERS.captures(line)?[1].to_owned())).collect();
        match differing {
            Some(nets) if nets.iter().all(|net| !kept.contains(net.as_str())) => free.extend(nets),
            _ => return Ok(false),
        }
    }
    Ok(false)
}

fn commands(name: &str, [gold, gate]: [&[&str]; 2], is_free: bool) -> String {
    let read = |files: &[&str], by: &str| {
        let flatten = if files.len() > 1 { " -flatten" } else { "" };
        let files = files.join(" ");
        format!(
            "read_verilog {files}; prep{flatten} -top {name}; opt; rename {name} {by}; design -stash {by}; "
        )
    };
    // With free nets, only the forward direction is right. Going backward would compare the inputs of cells with equal results,
    // including inputs that are free.
    let (make, join) = if is_free {
        (format!("equiv_make -blacklist {FREE}"), "equiv_struct -fwonly -icells")
    } else {
        ("equiv_make".to_owned(), "equiv_struct -icells")
    };
    format!(
        "{}{}design -copy-from gold -as gold gold; design -copy-from gate -as gate gate; \
         {make} gold gate equiv; prep -top equiv; opt_clean; \
         {join}; equiv_simple -short; equiv_induct; tee -o {STATUS} equiv_status",
        read(gold, "gold"),
        read(gate, "gate"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_and_registers_are_kept_and_wires_are_not() {
        let text = "    input  wire signed [27:0] delta,  // s1.26\n    output wire        [7:0]  red_out\n);\n    \
                    reg         [11:0] intervals;       // register 5\n    wire above_2 = delta > TWO;\n    \
                    assign red_out = above_2;\n    always @(posedge clk) intervals <= delta;\n";
        let kept: Vec<&str> =
            KEPT.captures_iter(text).filter_map(|it| Some(it.get(1)?.as_str())).collect();
        assert_eq!(kept, ["delta", "red_out", "intervals"]);
        let line = r"  Unproven $equiv $auto$equiv_make.cc:274:find_same_wires$341: \above_2_gold [0] \above_2_gate [0]";
        assert_eq!(&DIFFERS.captures(line).unwrap()[1], "above_2");
    }
}
