//! Builds a Verilog bench once and runs it several times with changed memory files.

use std::fs;

use super::Sure;
use glint::tools::{Run, VerilogSimulator, is_verilog};
use tempfile::TempDir;

use super::cores::{Files, write};
use super::tools::{LIMIT, tool};

/// A built bench beside its memories, which it reads when it starts.
pub struct Bench {
    dir: TempDir,
    simulator: VerilogSimulator,
}

impl Bench {
    /// Builds the bench `top`.
    ///
    /// # Panics
    /// The simulator refuses it, or warns of it.
    pub fn build(simulator: VerilogSimulator, files: &Files, top: &str) -> Self {
        let (bench, output) = Self::build_with(simulator, files, top);
        if simulator == VerilogSimulator::Icarus {
            assert_eq!(output, "", "{top}: iverilog has remarks");
        }
        bench
    }

    /// Builds the bench `top` and disregards warnings: of models of cells that are not ours.
    ///
    /// # Panics
    /// The simulator refuses it.
    pub fn build_quietly(simulator: VerilogSimulator, files: &Files, top: &str) -> Self {
        Self::build_with(simulator, files, top).0
    }

    fn build_with(simulator: VerilogSimulator, files: &Files, top: &str) -> (Self, String) {
        let dir = tempfile::tempdir().expect("a directory");
        write(dir.path(), files);
        let names = files.iter().map(|(name, _)| name.as_str());
        let sources = names.filter(|name| is_verilog(name));
        let (compiler, arguments) = match simulator {
            VerilogSimulator::Icarus => ("iverilog", "-g2012 -Wall -o bench.vvp -s"),
            // It takes a warning for an error. The bench runs for an instant: optimising it takes longer.
            VerilogSimulator::Verilator => {
                ("verilator", "--binary --timing -j 1 -CFLAGS -O0 -o bench --top-module")
            }
        };
        let arguments = arguments.split(' ').chain([top]).chain(sources);
        let output = tool(compiler).run_to_success(arguments, dir.path(), LIMIT).sure_of(top);
        (Self { dir, simulator }, output)
    }

    /// Replaces a memory.
    ///
    /// # Panics
    /// It cannot be written.
    pub fn replace(&self, name: &str, contents: &str) {
        fs::write(self.dir.path().join(name), contents).expect("a memory");
    }

    /// Runs the bench.
    ///
    /// # Panics
    /// It does not start or does not end.
    pub fn run(&self) -> Run {
        let directory = self.dir.path();
        match self.simulator {
            // -n: a $stop ends the run instead of asking the terminal.
            VerilogSimulator::Icarus => tool("vvp").run(["-n", "bench.vvp"], directory, LIMIT),
            VerilogSimulator::Verilator => tool("env").run(["./obj_dir/bench"], directory, LIMIT),
        }
        .sure()
    }

    /// # Panics
    /// The bench does not pass, or does not say so in a line and by its exit code.
    pub fn assert_passes(&self) {
        let run = self.run();
        let says = run.output.lines().any(|line| line.starts_with("PASS"));
        assert!(says && run.status.success(), "{}:\n{}", self.simulator, run.output);
    }

    /// # Panics
    /// The bench does not fail, or does not say so in a line and by its exit code.
    pub fn assert_fails(&self, because: &str) {
        let run = self.run();
        let says = |word| run.output.lines().any(|line| line.starts_with(word));
        assert!(
            says("FAIL") && !says("PASS") && !run.status.success(),
            "{} does not notice {because} ({}):\n{}",
            self.simulator,
            run.status,
            run.output
        );
    }
}

/// Returns the contents of a memory with one bit of one word inverted.
///
/// # Panics
/// There is no such word or bit.
pub fn with_flipped_bit(memory: &str, word: usize, bit: u32) -> String {
    let is_word = |line: &&str| !line.trim_start().starts_with("//") && !line.trim().is_empty();
    let line = memory.lines().filter(is_word).nth(word).expect("a word");
    let code = line.split("//").next().unwrap_or(line).trim();
    // Words of digits 0 and 1 with _ between fields are binary; all others are hexadecimal.
    let bits_of_a_digit = if code.contains('_') { 1 } else { 4 };
    let mut digits: Vec<char> = code.chars().filter(|&digit| digit != '_').collect();
    let at = digits.len() - 1 - (bit / bits_of_a_digit) as usize;
    let digit = digits[at].to_digit(16).expect("a digit") ^ 1 << (bit % bits_of_a_digit);
    digits[at] = char::from_digit(digit, 16).expect("a digit");
    let flipped: String = digits.into_iter().collect();
    let mut words = 0..;
    let lines = memory.lines().map(|line| {
        if is_word(&line) && words.next() == Some(word) { flipped.as_str() } else { line }
    });
    lines.map(|line| format!("{line}\n")).collect()
}
