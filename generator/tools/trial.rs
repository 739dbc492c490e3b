//! Shows that a tool works: given something wrong, it must say so.
//!
//! A proof and a lint rest on what a tool does not say, or on its exit status alone. One that is silent and exits with 0,
//! whatever it is given, is found here.

use std::fs;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use super::Tool;
use crate::base::transient::Directory;

/// A task for a tool, with what it must say of it.
struct Trial {
    tool: &'static str,
    /// The task, for people.
    what: &'static str,
    file: (&'static str, &'static str),
    arguments: &'static [&'static str],
    /// Whether it exits with 0.
    succeeds: bool,
    says: &'static str,
}

const WRONG_SYNTAX: (&str, &str) =
    ("trial.v", "module trial (output wire y); assign y = ; endmodule\n");

const TRIALS: [Trial; 10] = [
    Trial {
        tool: "iverilog",
        what: "Verilog with a wrong syntax",
        file: WRONG_SYNTAX,
        arguments: &["-g2005", "-Wall", "-t", "null", "-s", "trial", "trial.v"],
        succeeds: false,
        says: "syntax error",
    },
    Trial {
        tool: "vvp",
        what: "a program that is none",
        file: ("trial.vvp", "none\n"),
        arguments: &["-n", "trial.vvp"],
        succeeds: false,
        says: "syntax error",
    },
    Trial {
        tool: "verilator",
        what: "Verilog with bits that are lost",
        file: (
            "trial.v",
            "module trial (input wire [3:0] x, output wire y); assign y = x; endmodule\n",
        ),
        arguments: &["--lint-only", "-Wall", "--top-module", "trial", "trial.v"],
        succeeds: false,
        says: "WIDTH",
    },
    Trial {
        tool: "yosys",
        what: "the claim that an input is 0",
        file: ("trial.v", "module trial (input wire x, output wire y); assign y = x; endmodule\n"),
        arguments: &["-q", "-p", "read_verilog trial.v; sat -verify -prove y 0 trial"],
        succeeds: false,
        says: "proof did fail",
    },
    Trial {
        tool: "yosys-smtbmc",
        what: "a property that does not hold",
        file: ("trial.smt2", include_str!("trial.smt2")),
        arguments: &["-s", "z3", "-t", "1", "trial.smt2"],
        succeeds: false,
        says: "Status: FAILED",
    },
    Trial {
        tool: "z3",
        what: "a bit that is 1",
        file: ("trial.smt2", "(declare-const x Bool)\n(assert x)\n(check-sat)\n"),
        arguments: &["trial.smt2"],
        succeeds: true,
        says: "sat",
    },
    Trial {
        tool: "z3",
        what: "a bit that is 0 and 1",
        file: ("trial.smt2", "(declare-const x Bool)\n(assert x)\n(assert (not x))\n(check-sat)\n"),
        arguments: &["trial.smt2"],
        succeeds: true,
        says: "unsat",
    },
    Trial {
        tool: "python3",
        what: "a test that fails",
        file: ("trial.py", "assert False\n"),
        arguments: &["trial.py"],
        succeeds: false,
        says: "AssertionError",
    },
    Trial {
        tool: "gappa",
        what: "a statement that holds",
        file: ("trial.g", "# True: 1 is the greatest.\n{ x in [0, 1] -> x in [0, 1] }\n"),
        arguments: &["trial.g"],
        succeeds: true,
        says: "",
    },
    Trial {
        tool: "gappa",
        what: "a statement that does not hold",
        file: ("trial.g", "# False for x = 1.\n{ x in [0, 1] -> x in [0, 0.5] }\n"),
        arguments: &["trial.g"],
        succeeds: false,
        says: "",
    },
];

impl Tool {
    /// Gives the tool what is known to be wrong, and what is known to be right where its exit status is all that it says.
    ///
    /// # Errors
    /// It does not tell them apart; it does not run.
    pub fn ensure_works(&self, limit: Duration) -> Result<()> {
        for trial in TRIALS.iter().filter(|trial| trial.tool == self.name) {
            let dir = Directory::new().context("cannot make a temporary directory")?;
            let (file, contents) = trial.file;
            fs::write(dir.path().join(file), contents)
                .context("cannot write a trial for a tool")?;
            let run = self.run(trial.arguments, dir.path(), limit)?;
            let does = match (run.status.success(), trial.succeeds) {
                (true, false) => "accepts",
                (false, true) => "refuses",
                _ if !says(&run.output, trial.says) => "says nothing of",
                _ => continue,
            };
            let said = run.output.lines().next().map_or_else(String::new, |it| format!(": {it}"));
            bail!("`{self}` {does} {}, so that it is no {self} that works{said}", trial.what);
        }
        Ok(())
    }
}

/// Whether the words are there: not at the end of another, as in `unsat`.
fn says(output: &str, words: &str) -> bool {
    let before = |at: usize| output[..at].chars().next_back();
    let mut found = output.match_indices(words);
    found.any(|(at, _)| !before(at).is_some_and(char::is_alphanumeric))
}
