//! Plans a unit: several functions behind one datapath, selected by an opcode.
//!
//! Each function has a plan of its own, with a proved error. The plans share the bit widths of their tables ([`find_set`]). The
//! module `merge` then makes one plan of all: operations of the same kind become one operation, in front of which choices by the
//! opcode select the inputs. For every opcode, the merged plan has the results of the function's own plan, which `equality` proves.

mod align;
mod equality;
mod factors;
mod merge;
mod periods;
mod results;
mod select;
mod shifts;
mod sums;
mod tables;
mod unread;

use std::sync::Arc;

use glint_approximate::{Outside, Piecewise, TargetFunction};
use glint_base::fixed::Format;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

pub use equality::UnitEquality;
use equality::{FunctionProof, MOST_COMBINATIONS, MergedFunction};

use super::find::{ProvedPlan, find_set};
use super::node::{NodeId, Operation};
use super::plan::{ExpressionPlan, PlanBuilder};
use super::refusal::PlanRefusal;
use super::statement::{ExpressionStatement, StatedOperand};

/// The most functions of a unit.
pub const MOST_FUNCTIONS: usize = 16;

/// The names of the operand ports behind the opcode, and of the results.
const OPERAND_NAMES: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];
const RESULT_NAMES: [&str; 8] = ["r", "s", "t", "u", "v", "w", "x", "y"];

/// The number of operands for which [`find_unit`] compares a function with its own plan if it does not prove them equal.
pub const COMPARED: u64 = 4096;

/// A function of a unit, as the user states it.
pub struct StatedFunction {
    pub name: String,
    pub statement: ExpressionStatement,
    /// The function and its polynomials, if its table can be written.
    pub table: Option<(TargetFunction, Arc<Piecewise>)>,
}

/// A function of a unit: its name, and its plan with the proved error.
#[derive(Clone, Debug)]
pub struct UnitFunction {
    pub name: String,
    pub planned: Arc<ProvedPlan>,
}

/// The plan of a unit, with its ports.
#[derive(Clone, Debug)]
pub struct UnitPlan {
    /// The functions, in the order of their opcodes.
    pub functions: Vec<UnitFunction>,
    /// The operations of all functions. Operand 0 is the opcode.
    pub plan: ExpressionPlan,
    /// The opcode, and the operands `a`, `b`, … as unsigned words. A function reads its operand in the low bits of a word.
    pub operands: Vec<StatedOperand>,
    /// The results `r`, `s`, … with the formats of their words. A signed result of a function is extended to the width of the word.
    /// A result that a function does not have is 0.
    pub results: Vec<(&'static str, Format)>,
    /// For each function, whether the merged plan is proved to have its results.
    pub equalities: Vec<UnitEquality>,
    /// For each function, its nodes in the merged plan.
    nodes: Vec<MergedFunction>,
}

/// Finds a plan for each function, merges the plans, and proves that the merged plan has their results. A failure has the number
/// of the function that it concerns.
///
/// With `shares_tables`, one table serves all functions, also if a function reads it several times. Only a sequential core can share
/// such a table: a pipeline reads the tables of several points in the same clock.
///
/// # Errors
/// Fails if a formula has no plan that keeps the allowed errors, if all functions compute the same results, or if an operation of
/// the merged plan has too many bits.
///
/// # Panics
/// Panics if there are no functions, or more than [`MOST_FUNCTIONS`].
pub fn find_unit(
    stated: &[StatedFunction],
    shares_tables: bool,
) -> Result<UnitPlan, (usize, PlanRefusal)> {
    assert!((1..=MOST_FUNCTIONS).contains(&stated.len()), "{} functions", stated.len());
    UnitPlan::of_functions(planned_functions(stated)?, shares_tables)
}

/// Finds the plans of the functions: together for fixed tables, which get common widths, and from known polynomials for a table
/// that can be written. Fails if a function has no plan.
fn planned_functions(stated: &[StatedFunction]) -> Result<Vec<UnitFunction>, (usize, PlanRefusal)> {
    let (mut numbers, mut statements) = (Vec::new(), Vec::new());
    for (number, function) in stated.iter().enumerate() {
        if function.table.is_none() {
            numbers.push(number);
            statements.push(function.statement.clone());
        }
    }
    let found = find_set(&statements).map_err(|(at, refusal)| (numbers[at], refusal))?;
    let mut found = found.into_iter();
    let mut functions = Vec::new();
    for (number, function) in stated.iter().enumerate() {
        let planned = match &function.table {
            None => found.next().expect("a plan of each function"),
            Some((target, polynomials)) => {
                ProvedPlan::of_table(function.statement.clone(), target, polynomials)
                    .map_err(|refusal| (number, refusal))?
            }
        };
        functions.push(UnitFunction { name: function.name.clone(), planned: Arc::new(planned) });
    }
    Ok(functions)
}

impl UnitPlan {
    /// Merges the plans of the functions, and proves that the merged plan has their results. Where the proof stays open, the
    /// results are compared for [`COMPARED`] operands. Fails if all functions compute the same results, if a compared result
    /// differs, or if an operation has too many bits.
    fn of_functions(
        functions: Vec<UnitFunction>,
        shares_tables: bool,
    ) -> Result<Self, (usize, PlanRefusal)> {
        let operands = operand_ports(&functions);
        let results = result_ports(&functions);
        let (plan, nodes) = merge::merged(&functions, &operands, &results, shares_tables)
            .map_err(|refusal| (0, refusal))?;
        if !reads_opcode(&plan) {
            let message = "all functions of the unit compute the same results";
            let remedy = "keep one of them, as a configuration of the device expression";
            return Err((0, PlanRefusal::new(message, remedy)));
        }
        let mut unit = Self { functions, plan, operands, results, nodes, equalities: Vec::new() };
        unit.rename_shared_nodes().map_err(|refusal| (0, refusal))?;
        let opcodes = (0..unit.functions.len()).into_par_iter();
        let proofs = opcodes.map(|opcode| unit.proved_equality(opcode, MOST_COMBINATIONS));
        unit.equalities = proofs.collect();
        for (opcode, equality) in unit.equalities.iter().enumerate() {
            if let UnitEquality::Open { .. } = equality {
                unit.compare(opcode).map_err(|refusal| (opcode, refusal))?;
            }
        }
        Ok(unit)
    }

    /// Removes the function's name from the names of nodes that several functions read: `rcp_number` becomes `number`. A name
    /// stays if nets of the hardware could then have the same name. Fails if a name is not unique.
    fn rename_shared_nodes(&mut self) -> Result<(), PlanRefusal> {
        let mut readers = vec![0; self.plan.nodes().len()];
        for (opcode, nodes) in self.nodes.iter().enumerate() {
            let is_read = FunctionProof::new(&self.plan, nodes, opcode, 0).read_nodes();
            for (count, is_read) in readers.iter_mut().zip(is_read) {
                *count += usize::from(is_read);
            }
        }
        let mut renamed = PlanBuilder::of_plan(self.plan.clone());
        for (at, readers) in readers.into_iter().enumerate() {
            let node = renamed.node(NodeId(at));
            let is_operand = matches!(node.operation, Operation::Operand(_));
            let name = node.name.clone();
            let mut functions = self.functions.iter();
            let without_function =
                functions.find_map(|it| name.strip_prefix(&it.name)?.strip_prefix('_'));
            let Some(shared) = without_function.map(without_number) else { continue };
            let mut others = renamed.so_far().nodes().iter().map(|node| node.name.as_str());
            let is_free = !others.any(|other| other != name && may_share_nets(shared, other));
            if readers > 1 && !is_operand && is_free {
                renamed.rename(NodeId(at), shared);
            }
        }
        self.plan = renamed.finish()?;
        Ok(())
    }

    /// Returns the unit with the plan `planned` of one function, such as a plan with other words in its table.
    ///
    /// # Errors
    /// Fails if an operation of the merged plan has too many bits, or if a compared result differs.
    pub fn with_function(
        &self,
        opcode: usize,
        planned: ProvedPlan,
        shares_tables: bool,
    ) -> Result<Self, PlanRefusal> {
        let mut functions = self.functions.clone();
        functions[opcode].planned = Arc::new(planned);
        Self::of_functions(functions, shares_tables).map_err(|(_, refusal)| refusal)
    }
}

fn without_number(name: &str) -> &str {
    name.trim_end_matches(|it: char| it.is_ascii_digit())
}

/// Returns whether nets of two nodes could have the same name, because one name is the other with an ending. A net has the name of its node with
/// an ending, such as `curve_bits`.
fn may_share_nets(name: &str, other: &str) -> bool {
    let is_longer = |longer: &str, name: &str| {
        let ending = longer.strip_prefix(without_number(name));
        let after_number = ending.map(|it| it.trim_start_matches(|it: char| it.is_ascii_digit()));
        after_number.is_some_and(|it| it.starts_with('_'))
    };
    is_longer(name, other) || is_longer(other, name)
}

/// Returns whether a result depends on the opcode, which is operand 0.
fn reads_opcode(plan: &ExpressionPlan) -> bool {
    let is_read = plan.read_nodes();
    let mut nodes = plan.nodes().iter().zip(is_read).filter(|(_, is_read)| *is_read);
    nodes.any(|(node, _)| {
        let mut inputs = node.operation.hardware_inputs().into_iter();
        inputs.any(|input| matches!(plan.node(input).operation, Operation::Operand(0)))
    })
}

impl UnitPlan {
    /// Returns the raw operands of the function with this opcode, from the words at the ports `a`, `b` and so on. Each is the low
    /// bits of its word, limited to the domain if the function limits it.
    pub fn operands_of(&self, opcode: usize, words: &[i64]) -> Vec<i64> {
        let statement = &self.functions[opcode].planned.statement;
        let mut raw = Vec::with_capacity(statement.operands.len());
        for (operand, word) in statement.operands.iter().zip(words) {
            let own = operand.format.raw(*word as u64 & operand.format.bits(-1));
            raw.push(operand.computed_raw(own as i64));
        }
        raw
    }

    /// Returns the word of each result from the raw results of the function with this opcode.
    fn words_of(&self, raw: &[i128]) -> Vec<i128> {
        let mut words = Vec::with_capacity(self.results.len());
        for (number, (_, format)) in self.results.iter().enumerate() {
            let raw = raw.get(number).copied().unwrap_or(0);
            words.push(format.raw(format.bits(raw)));
        }
        words
    }

    /// Returns the raw results of the merged plan, and of the plan of the function with this opcode, as words at the ports.
    pub fn both_results(&self, opcode: usize, words: &[i64]) -> [Vec<i128>; 2] {
        let mut operands = vec![opcode as i64];
        operands.extend_from_slice(words);
        let values = self.plan.values(&operands);
        let merged = self.plan.results().iter().map(|result| values[result.0]).collect();
        let own = &self.functions[opcode].planned.plan;
        let values = own.values(&self.operands_of(opcode, words));
        let results: Vec<i128> = own.results().iter().map(|result| values[result.0]).collect();
        [merged, self.words_of(&results)]
    }

    /// Tries to prove that, for this opcode, the merged plan has the same results as the function's own plan, for all operands
    /// for which the function promises results. The proof computes a node for at most `most_combinations` combinations of its
    /// inputs. If this does not suffice, the outcome is [`UnitEquality::Open`].
    fn proved_equality(&self, opcode: usize, most_combinations: u128) -> UnitEquality {
        let statement = &self.functions[opcode].planned.statement;
        let operand = |number: usize, word: i128| {
            let operand = &statement.operands[number];
            let own = operand.format.raw(operand.format.bits(word));
            operand.computed_raw(own as i64).into()
        };
        let word = |number: usize, raw: i128| {
            let (_, format) = self.results[number];
            format.raw(format.bits(raw))
        };
        let nodes = &self.nodes[opcode];
        let proof = FunctionProof::new(&self.plan, nodes, opcode, most_combinations);
        proof.prove(&operand, &word)
    }

    /// Compares the merged plan with the plan of a function, for operands that are spread over its domain. Fails if they differ.
    fn compare(&self, opcode: usize) -> Result<(), PlanRefusal> {
        let statement = &self.functions[opcode].planned.statement;
        for raw in statement.spread_operands(COMPARED) {
            let mut words = vec![0; self.operands.len() - 1];
            for ((word, operand), raw) in words.iter_mut().zip(&statement.operands).zip(raw) {
                *word = operand.format.bits(raw.into()) as i64;
            }
            let [merged, own] = self.both_results(opcode, &words);
            let limits: Vec<(i64, i64)> =
                self.operands_of(opcode, &words).into_iter().map(|raw| (raw, raw)).collect();
            let enclosed = statement.enclosed_operands(&limits);
            for (result, stated) in statement.results.iter().enumerate() {
                let is_promised = stated.is_promised(&enclosed) != Some(false);
                if is_promised && merged[result] != own[result] {
                    let message = format!(
                        "the unit and the function alone differ for {}",
                        statement.place(&limits, &statement.operands_of(result))
                    );
                    let remedy = "this is a fault of Glint: please report the configuration";
                    return Err(PlanRefusal::new(message, remedy));
                }
            }
        }
        Ok(())
    }
}

/// Returns the port of the opcode, and a port for each operand, as wide as the widest operand of a function at this place.
fn operand_ports(functions: &[UnitFunction]) -> Vec<StatedOperand> {
    let bits = opcode_bits(functions.len());
    let mut ports = vec![port("opcode", bits)];
    for (number, name) in OPERAND_NAMES.into_iter().enumerate() {
        let mut width = 0;
        for function in functions {
            let operand = function.planned.statement.operands.get(number);
            width = width.max(operand.map_or(0, |operand| operand.format.width()));
        }
        if width > 0 {
            ports.push(port(name, width));
        }
    }
    ports
}

/// Returns the number of bits of an opcode for this number of functions.
pub(super) fn opcode_bits(functions: usize) -> u32 {
    (usize::BITS - (functions - 1).leading_zeros()).max(1)
}

fn port(name: &str, width: u32) -> StatedOperand {
    let format = Format::unsigned(width as i32, 0);
    let domain = (0, format.max_raw() as i64);
    let doc = match name {
        "opcode" => "the function".to_owned(),
        _ => String::new(),
    };
    StatedOperand { name: name.to_owned(), format, domain, outside: Outside::Anything, doc }
}

/// Returns a word for each result, as wide as the widest result of a function at this place. The word is signed if the results of
/// all functions at this place are signed.
fn result_ports(functions: &[UnitFunction]) -> Vec<(&'static str, Format)> {
    let mut ports = Vec::new();
    for (number, name) in RESULT_NAMES.into_iter().enumerate() {
        let mut formats = Vec::new();
        for function in functions {
            let plan = &function.planned.plan;
            formats.extend(plan.results().get(number).map(|result| plan.node(*result).format));
        }
        let Some(width) = formats.iter().map(|format| format.width()).max() else { break };
        let is_signed = formats.iter().all(|format| format.signed);
        let int = width as i32 - i32::from(is_signed);
        ports.push((name, Format { signed: is_signed, int, frac: 0 }));
    }
    ports
}

#[cfg(test)]
mod tests {
    use glint_formula::{parse, parse_condition};

    use super::*;
    use crate::statement::StatedResult;

    fn operand(name: &str, format: Format, domain: (i64, i64)) -> StatedOperand {
        let outside = Outside::Anything;
        StatedOperand { name: name.to_owned(), format, domain, outside, doc: String::new() }
    }

    fn result(name: &str, formula: &str, fraction: u32, promise: &str) -> StatedResult {
        let promise = (!promise.is_empty()).then(|| parse_condition(promise).unwrap());
        let formula = parse(formula).unwrap();
        let name = name.to_owned();
        StatedResult { name, formula, fraction, error: 1.0, promise, width: None }
    }

    /// Returns the functions of a small graphics processor, with operands of `bits` bits.
    fn functions(bits: i32) -> (Vec<String>, Vec<ExpressionStatement>) {
        let unsigned = Format::unsigned(0, bits);
        let wide = Format::unsigned(bits / 2, bits - bits / 2);
        let signed = Format::signed(0, bits - 1);
        let all = |format: Format| (format.min_raw() as i64, format.max_raw() as i64);
        let above_0 = |format: Format| (1, format.max_raw() as i64);
        let fraction = bits as u32 - 1;
        let one = |format: Format, domain: (i64, i64), formula: &str, fraction: u32| {
            ExpressionStatement {
                operands: vec![operand("x", format, domain)],
                results: vec![result("r", formula, fraction, "")],
            }
        };
        let two = |format: Format, results: Vec<StatedResult>| ExpressionStatement {
            operands: ["x", "y"].map(|name| operand(name, format, all(format))).to_vec(),
            results,
        };
        let few = (bits / 2) as u32;
        let statements = vec![
            ("rcp", one(wide, above_0(wide), "1 / x", few)),
            ("rsqrt", one(wide, above_0(wide), "1 / sqrt(x)", few)),
            ("sqrt", one(wide, all(wide), "sqrt(x)", few)),
            ("exp2", one(signed, all(signed), "2^(8*x)", few)),
            ("log2", one(wide, above_0(wide), "log2(x)", few)),
            ("divide", two(unsigned, vec![result("q", "x / y", fraction, "x < y")])),
            (
                "atan2",
                two(signed, vec![result("a", "atan2(y, x) / pi", fraction, "x^2 + y^2 > 0")]),
            ),
        ];
        statements.into_iter().map(|(name, statement)| (name.to_owned(), statement)).unzip()
    }

    fn stated(names: &[String], statements: &[ExpressionStatement]) -> Vec<StatedFunction> {
        let functions = names.iter().zip(statements);
        functions
            .map(|(name, statement)| StatedFunction {
                name: name.clone(),
                statement: statement.clone(),
                table: None,
            })
            .collect()
    }

    #[test]
    fn a_unit_computes_what_its_functions_compute_alone() {
        let (names, statements) = functions(8);
        let unit = find_unit(&stated(&names, &statements), true).unwrap();
        let mut compared = 0;
        for (opcode, name) in names.iter().enumerate() {
            let statement = &unit.functions[opcode].planned.statement;
            let has_second = statement.operands.len() > 1;
            for a in 0..256 {
                for b in 0..if has_second { 256 } else { 1 } {
                    let limits: Vec<(i64, i64)> = unit
                        .operands_of(opcode, &[a, b])
                        .into_iter()
                        .map(|raw| (raw, raw))
                        .collect();
                    let domain = statement.domain();
                    let is_inside = |(at, (raw, _)): (usize, &(i64, i64))| {
                        (domain[at].0..=domain[at].1).contains(raw)
                    };
                    let enclosed = statement.enclosed_operands(&limits);
                    if !limits.iter().enumerate().all(is_inside)
                        || statement.results[0].is_promised(&enclosed) == Some(false)
                    {
                        continue;
                    }
                    let [merged, own] = unit.both_results(opcode, &[a, b]);
                    assert_eq!(merged, own, "{name} of {a} and {b}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 90_000, "{compared}");
    }

    #[test]
    fn a_unit_is_proved_equal_to_its_functions() {
        for bits in [8, 12, 16] {
            let (names, statements) = functions(bits);
            for shares_tables in [true, false] {
                let unit = find_unit(&stated(&names, &statements), shares_tables).unwrap();
                for (name, equality) in names.iter().zip(&unit.equalities) {
                    let is_proved = matches!(equality, UnitEquality::Proved { .. });
                    assert!(is_proved, "{name} of {bits} bits: {equality:?}");
                }
            }
        }
    }

    /// Returns plans that differ from the plan of a unit in one operation: another constant, another word of a table, or the cases of a choice
    /// the other way round.
    fn wrong_plans(plan: &ExpressionPlan) -> Vec<ExpressionPlan> {
        let mut wrong = Vec::new();
        let is_read = plan.read_nodes();
        for at in (0..plan.nodes().len()).filter(|at| is_read[*at]) {
            let mut others = Vec::new();
            match plan.nodes()[at].operation.clone() {
                Operation::Constant { raw, value } => {
                    others.push(Operation::Constant { raw: raw + 1, value });
                }
                Operation::Choose { condition, cases: [zero, one] } => {
                    others.push(Operation::Choose { condition, cases: [one, zero] });
                }
                Operation::Lookup { address, words } => {
                    for place in 0..words.len() {
                        let mut words = words.clone();
                        words[place] ^= 1;
                        others.push(Operation::Lookup { address, words });
                    }
                }
                _ => {}
            }
            for operation in others {
                wrong.push(plan.with_fault(NodeId(at), operation));
            }
        }
        wrong
    }

    /// Returns whether the unit has the results of its function, for each combination of operands for which it promises them.
    fn has_results(unit: &UnitPlan, opcode: usize, bits: u32) -> bool {
        let statement = &unit.functions[opcode].planned.statement;
        let has_second = statement.operands.len() > 1;
        (0..1 << bits).all(|a| {
            (0..if has_second { 1 << bits } else { 1 }).all(|b| {
                let raw = unit.operands_of(opcode, &[a, b]);
                let limits: Vec<(i64, i64)> = raw.iter().map(|raw| (*raw, *raw)).collect();
                let domain = statement.domain();
                let mut inside = domain.iter().zip(&raw);
                let is_inside = inside.all(|((first, last), raw)| (first..=last).contains(&raw));
                let enclosed = statement.enclosed_operands(&limits);
                let is_promised = statement.results[0].is_promised(&enclosed) != Some(false);
                let [merged, own] = unit.both_results(opcode, &[a, b]);
                !is_inside || !is_promised || merged == own
            })
        })
    }

    #[test]
    fn a_wrong_unit_is_not_proved() {
        const BITS: u32 = 6;
        let (names, statements) = functions(BITS as i32);
        let unit = find_unit(&stated(&names, &statements), true).unwrap();
        let mut wrong = 0;
        for plan in wrong_plans(&unit.plan) {
            let unit = UnitPlan { plan, ..unit.clone() };
            for (opcode, name) in names.iter().enumerate() {
                if !has_results(&unit, opcode, BITS) {
                    wrong += 1;
                    // With few combinations, the proof takes two periods of long inputs.
                    for most_combinations in [MOST_COMBINATIONS, 1 << 11, 1 << 9, 1 << 7] {
                        let equality = unit.proved_equality(opcode, most_combinations);
                        let is_open = matches!(equality, UnitEquality::Open { .. });
                        assert!(is_open, "{name}: {equality:?} with {most_combinations}");
                    }
                }
            }
        }
        assert!(wrong > 100, "{wrong}");
    }

    #[test]
    fn functions_of_a_unit_share_its_operations() {
        let (names, statements) = functions(12);
        let unit = find_unit(&stated(&names, &statements), false).unwrap();
        let separate: f64 =
            unit.functions.iter().map(|function| function.planned.plan.total_cells()).sum();
        let merged = unit.plan.total_cells();
        assert!(merged < 0.85 * separate, "{merged} of {separate}");
    }
}
