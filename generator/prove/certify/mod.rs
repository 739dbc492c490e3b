//! Translates the error bound of a contract to statements for the prover Gappa, and runs Gappa on them.
//!
//! [`statements`] unrolls the computation of a sequential core into a graph of values, and splits it into [`cases`] at its
//! conditions, such as a saturation. In each case, [`hardware`] writes the hardware's result as an expression with roundings, and
//! [`exact`] writes the formula as an expression without roundings. A statement says that the two expressions differ by at most
//! the bound, and the cases together cover the contract's domain. Devices that compute lines of points have statements of another
//! form (`segments`). If the formula reads a ROM, the statements do not prove the ROM's words.

pub mod cases;
pub mod exact;
mod find;
pub mod hardware;
mod points;
pub mod polynomial;
mod premises;
mod proof;
pub mod quotient;
mod script;
mod segments;
mod statement;
mod task;
pub mod terms;
mod witness;

use std::time::{Duration, Instant};

use cases::UnrolledComputation;
pub use find::bound;
use glint_formula::{Expression, Function, Kind, parse};
use glint_golden::Contract;
use glint_rtl::netlist::{Design, RomId};
use glint_rtl::pipeline::{NodeId, unroll, unroll_line};
pub use proof::{ProofOutcome, ProofSubject, prove};
pub use statement::Statement;
use statement::Statements;
use task::Task;

/// Returns the statements that together prove the error bound of a sequential design's contract. For example, an output that
/// may saturate has one statement for each of the two cases.
///
/// # Errors
/// The error is a reason in words. Fails if an operation of the hardware or of the formula has no translation, or if there are
/// too many cases. Fails if the contract states no bound or no formula. Fails if it takes longer than `limit` to write the
/// statements of a device that computes single points.
pub fn statements(
    design: &Design,
    contract: &dyn Contract,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    let bounds = contract.bounds();
    if bounds.are_stated() {
        within(design, contract, Some(bounds.governing_units()), limit)
    } else {
        Err("the contract states no bound".to_owned())
    }
}

/// Returns statements without a bound. Each asks Gappa for the largest difference between an output and the formula, in output
/// units. [`bound`] finds the answer, and [`Statement::within`] inserts it.
///
/// # Errors
///
/// Fails for the reasons of [`statements`], except that the contract needs no bound. Fails always for a device that computes a
/// line of points.
pub fn questions(
    design: &Design,
    contract: &dyn Contract,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    within(design, contract, None, limit)
}

fn within(
    design: &Design,
    contract: &dyn Contract,
    bound: Option<f64>,
    limit: Duration,
) -> Result<Vec<Statement>, String> {
    let begin = Instant::now();
    let formulas = formulas(contract)?;
    let (unrolled, walk) = if contract.length().is_some() {
        let line = unroll_line(design).map_err(|error| error.to_string())?;
        (line.unrolled, Some(line.walk))
    } else {
        (unroll(design).map_err(|error| error.to_string())?, None)
    };
    let results: Vec<NodeId> = unrolled.results.iter().map(|(_, node)| *node).collect();
    let words = |rom: RomId, address: u64| {
        let rom = design.rom(rom);
        let word = rom.words.get(address as usize).copied().unwrap_or(0);
        design.net(rom.data).format.raw(word)
    };
    let quotients = quotient::quotients(&unrolled.graph, &results);
    let view = UnrolledComputation { graph: &unrolled.graph, words: &words, quotients: &quotients };
    let tables: Vec<String> = design.roms.iter().map(|rom| rom.name.clone()).collect();
    let task = Task {
        design,
        contract,
        bound,
        unrolled: &unrolled,
        view,
        tables: &tables,
        formulas: &formulas,
    };
    if let Some(walk) = walk {
        return segments::statements(&task, &walk);
    }
    let known = task.domain()?;
    let results: Vec<NodeId> = task.outputs()?.into_iter().map(|(_, node)| node).collect();
    let mut statements = Statements::default();
    for known in task.split(&known) {
        for case in cases::cases(view, &results, &known)? {
            if begin.elapsed() > limit {
                let so_far = statements.list.len();
                let limit = limit.as_secs();
                return Err(format!(
                    "writing the statements takes more than {limit} s, and {so_far} were written"
                ));
            }
            task.state(&case, &mut statements)?;
        }
    }
    Ok(statements.list)
}

/// Returns the parsed formula of f for a highlight, and otherwise the parsed formula of each output.
fn formulas(contract: &dyn Contract) -> Result<Vec<Expression>, String> {
    let (expressions, wanted) = match contract.highlight() {
        Some(highlight) => (highlight.expressions(), 1),
        None => (contract.expressions(), contract.outputs().len()),
    };
    if expressions.len() < wanted {
        return Err("the contract does not have its formulas as text".to_owned());
    }
    let parsed = expressions.iter().map(|text| {
        let formula = parse(text).map_err(|fault| {
            let rest: String = text.chars().skip(fault.span.bytes.start).take(40).collect();
            format!("{fault}, `{rest}`")
        })?;
        // This check comes before the hardware's cases, which may be many. Only the formulas of lines may have a cosine and an
        // absolute value.
        let mut refused = None;
        formula.walk(&mut |part| match part.kind {
            Kind::Unary(Function::Negate | Function::Abs | Function::Cos, _) => {}
            Kind::Unary(function, _) => refused = Some(exact::untranslated(function)),
            _ => {}
        });
        refused.map_or(Ok(formula), Err)
    });
    parsed.collect()
}

/// Returns the SHA-256 of all scripts, in their order, in hexadecimal. Two certificates with the same digest prove the same
/// statements.
pub fn digest(statements: &[Statement]) -> String {
    let scripts = statements.iter().flat_map(|statement| &statement.scripts);
    let text: Vec<&str> = scripts.map(String::as_str).collect();
    glint_core::package::digest(text.join("\n").as_bytes())
}
