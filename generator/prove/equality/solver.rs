//! Asks an SMT solver whether some one-bit terms can all be 1 at once, and reads the answer.
//!
//! Each question is a file in SMT-LIB 2 with the terms, and with the arithmetic facts of `facts`. Products and memory reads are
//! uninterpreted functions in this file. All questions of one [`Solver`] share a time limit.

use std::fmt::Write as _;
use std::fs;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use super::Open;
use super::facts;
use super::symbolic::Product;
use super::term::{ADDRESS, VectorTerm, VectorTermId, VectorTerms};
use glint_tools::transient::Directory;
use glint_tools::{LimitReached, Tool};

/// The solver's answer to the question whether some terms can all be 1.
pub enum SolverAnswer {
    Unsatisfiable,
    /// The terms are all 1 for these values of the unknowns. They may assume impossible products and memory words, because the
    /// solver treats them as uninterpreted functions.
    Satisfiable(Vec<(VectorTermId, u64)>),
    Undecided(Open),
}

/// An SMT solver with a directory for its files. All its answers must come before `end`.
pub struct Solver<'a> {
    tool: &'a Tool,
    end: Instant,
    pub dir: Directory,
    pub asked: usize,
}

impl<'a> Solver<'a> {
    /// Makes a solver. `limit` is the time limit of all answers together.
    ///
    /// # Errors
    ///
    /// Fails if no temporary directory can be made.
    pub fn new(tool: &'a Tool, limit: Duration) -> Result<Self> {
        let dir = Directory::new().context("cannot make a temporary directory")?;
        Ok(Self { tool, end: Instant::now() + limit, dir, asked: 0 })
    }

    /// Asks whether all `wanted` terms, of one bit each, can be 1 at once. The question contains arithmetic facts about the
    /// products; if `parts` is set, also the facts about their partial products. The answer is [`SolverAnswer::Undecided`] if
    /// the solver says `unknown` or the time is over.
    ///
    /// # Errors
    /// Fails if the solver cannot be run, or if its output is not `sat`, `unsat` or `unknown`.
    pub fn ask(
        &mut self,
        terms: &mut VectorTerms,
        wanted: &[VectorTermId],
        products: &[Product],
        parts: bool,
    ) -> Result<SolverAnswer> {
        self.asked += 1;
        let facts = facts::about(terms, wanted, products, parts);
        let script = script(terms, wanted, &facts);
        fs::write(self.dir.path().join("question.smt2"), script)
            .context("cannot write a question for the solver")?;
        let left = self.end.saturating_duration_since(Instant::now());
        let run = match self.tool.run(["question.smt2"], self.dir.path(), left) {
            Ok(run) => run,
            Err(error) if error.is::<LimitReached>() => {
                return Ok(SolverAnswer::Undecided(Open::Limit));
            }
            Err(error) => return Err(error),
        };
        match run.output.lines().next().map(str::trim) {
            Some("unsat") => Ok(SolverAnswer::Unsatisfiable),
            Some("sat") => Ok(SolverAnswer::Satisfiable(values(terms, &run.output))),
            Some("unknown") => Ok(SolverAnswer::Undecided(Open::Unknown)),
            _ => bail!("`{}` does not answer: {}", self.tool, run.output.trim()),
        }
    }
}

fn name(id: VectorTermId) -> String {
    format!("t{}", id.number())
}

/// Returns the question in the logic `QF_UFBV`: whether all `facts` and all `wanted` terms can be 1. The solver also prints
/// the values of the unknowns.
fn script(terms: &VectorTerms, wanted: &[VectorTermId], facts: &[VectorTermId]) -> String {
    let cone = terms.cone(wanted.iter().chain(facts).copied());
    let mut text = String::from(
        "(set-logic QF_UFBV)\n(declare-fun product ((_ BitVec 64) (_ BitVec 64)) (_ BitVec 64))\n",
    );
    let mut declared = vec![false; terms.memories.len()];
    let mut unknowns = String::new();
    for id in cone {
        let width = terms.width(id);
        if let VectorTerm::Word { memory, .. } = *terms.term(id)
            && !declared[memory]
        {
            declared[memory] = true;
            let _ = writeln!(
                text,
                "(declare-fun word{memory} ((_ BitVec {ADDRESS})) (_ BitVec {width}))"
            );
        }
        if let VectorTerm::Unknown(_) = terms.term(id) {
            let _ = writeln!(text, "(declare-const {} (_ BitVec {width}))", name(id));
            let _ = write!(unknowns, " {}", name(id));
            continue;
        }
        let said = expression(terms, id);
        let _ = writeln!(text, "(define-fun {} () (_ BitVec {width}) {said})", name(id));
        if let VectorTerm::Product(a, b) = *terms.term(id) {
            let _ = writeln!(
                text,
                "(assert (= (product {0} {1}) (product {1} {0})))",
                name(a),
                name(b)
            );
        }
    }
    for &id in facts.iter().chain(wanted) {
        let _ = writeln!(text, "(assert (= {} #b1))", name(id));
    }
    let _ = writeln!(text, "(check-sat)");
    if !unknowns.is_empty() {
        let _ = writeln!(text, "(get-value ({unknowns}))");
    }
    text
}

fn expression(terms: &VectorTerms, id: VectorTermId) -> String {
    let width = terms.width(id);
    let call = |function: &str| {
        let operands = terms.term(id).operands();
        let names: Vec<String> = operands.into_iter().map(name).collect();
        format!("({function} {})", names.join(" "))
    };
    let truth = |function: &str| format!("(ite {} #b1 #b0)", call(function));
    match *terms.term(id) {
        VectorTerm::Unknown(_) => name(id),
        VectorTerm::Constant(bits) => format!("(_ bv{bits} {width})"),
        VectorTerm::Not(_) => call("bvnot"),
        VectorTerm::And(..) => call("bvand"),
        VectorTerm::Or(..) => call("bvor"),
        VectorTerm::Xor(..) => call("bvxor"),
        VectorTerm::Add(..) => call("bvadd"),
        VectorTerm::Sub(..) => call("bvsub"),
        VectorTerm::Product(..) => call("product"),
        VectorTerm::Equal(..) => truth("="),
        VectorTerm::Less(..) => truth("bvult"),
        VectorTerm::SignedLess(..) => truth("bvslt"),
        VectorTerm::Choice(condition, a, b) => {
            format!("(ite (= {} #b1) {} {})", name(condition), name(a), name(b))
        }
        VectorTerm::Slice { of, low } => {
            format!("((_ extract {} {low}) {})", low + width - 1, name(of))
        }
        VectorTerm::Join(..) => call("concat"),
        VectorTerm::SignExtend(a) => {
            format!("((_ sign_extend {}) {})", width - terms.width(a), name(a))
        }
        VectorTerm::Word { memory, .. } => call(&format!("word{memory}")),
    }
}

/// Reads the values of the unknowns. For example, `((t1 #x0f) (t2 #b1))` gives 15 to term 1, and 1 to term 2.
fn values(terms: &VectorTerms, output: &str) -> Vec<(VectorTermId, u64)> {
    let mut words = output.split(|c: char| c.is_whitespace() || c == '(' || c == ')');
    let mut values = Vec::new();
    while let Some(word) = words.next() {
        let number = word.strip_prefix('t').and_then(|number| number.parse().ok());
        let Some(id) = number.and_then(|number| terms.numbered(number)) else { continue };
        let value = words.find(|word| !word.is_empty()).unwrap_or_default();
        let bits = match (value.strip_prefix("#x"), value.strip_prefix("#b")) {
            (Some(hex), _) => u64::from_str_radix(hex, 16),
            (_, Some(binary)) => u64::from_str_radix(binary, 2),
            _ => continue,
        };
        values.extend(bits.ok().map(|bits| (id, bits)));
    }
    values
}
