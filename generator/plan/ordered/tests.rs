//! Tests of lists whose results have the order of their values.

use std::sync::Arc;

use glint_approximate::Outside;
use glint_base::fixed::Format;
use glint_formula::parse;

use super::find_ordered;
use super::formulas::ordered_list;
use super::nodes::check_list;
use crate::memory::TableMemory;
use crate::node::{NodeId, Operation};
use crate::plan::PlanBuilder;
use crate::statement::{ExpressionStatement, StatedOperand, StatedResult};

/// The results of the lists in these tests.
const ALL: std::ops::Range<usize> = 0..3;

/// The operands of the lists in these tests.
const OWN: [&str; 3] = ["a", "b", "c"];

/// Returns a list of three results. `formula` is the formula of a number, with `#` for its own operand.
fn list(formula: &str, format: Format, fraction: u32, error: f64) -> ExpressionStatement {
    let operand = |name: &str| StatedOperand {
        name: name.to_owned(),
        format,
        domain: (format.min_raw() as i64, format.max_raw() as i64),
        outside: Outside::Anything,
        doc: String::new(),
    };
    let result = |own: &str| StatedResult {
        name: format!("r_{own}"),
        formula: parse(&formula.replace('#', own)).expect(formula),
        fraction,
        error,
        promise: None,
        width: None,
    };
    ExpressionStatement {
        operands: OWN.iter().map(|name| operand(name)).collect(),
        results: OWN.iter().map(|own| result(own)).collect(),
    }
}

const SOFTMAX: &str = "exp(# - max(a, max(b, c))) / (exp(a - max(a, max(b, c))) + exp(b - max(a, max(b, c))) + exp(c - max(a, max(b, c))))";

#[test]
fn ordered_results_have_the_order_of_the_operands_at_every_combination() {
    let signed = Format::signed(1, 3);
    let unsigned = Format::unsigned(0, 5);
    let mut found_lists = 0;
    // The formula, the format of the operands, fraction bits and error of the results, and whether the order is reversed.
    for (formula, format, fraction, error, is_reversed) in [
        (SOFTMAX, signed, 8, 2.0, false),
        (SOFTMAX, signed, 3, 1.0, false),
        ("# / (a + b + c + 1/8)", unsigned, 7, 1.0, false),
        ("(# - (a + b + c) / 3) / sqrt((a^2 + b^2 + c^2) / 3 + 1/16)", signed, 5, 1.0, false),
        ("1 / (# + 1/4) + a * b", unsigned, 4, 1.0, true),
        ("exp(-#) * (1 + a * b)", unsigned, 6, 1.0, true),
        ("max(#, 0) + min(a, min(b, c))", signed, 3, 0.6, false),
        ("sqrt(#) * c", unsigned, 6, 1.0, false),
        ("tanh(#) - a * b", signed, 5, 1.0, false),
    ] {
        let statement = list(formula, format, fraction, error);
        let found = match find_ordered(&statement, &[ALL], TableMemory::Logic) {
            Ok(found) => found,
            Err(refusal) if formula.contains("* c") => {
                // The own operand of the third number is a common part of the others.
                assert!(refusal.message.contains("`ordered`"), "{refusal:?}");
                continue;
            }
            Err(refusal) => panic!("{formula}: {refusal:?}"),
        };
        found_lists += 1;
        let (low, high) = (format.min_raw() as i64, format.max_raw() as i64);
        for a in low..=high {
            for b in low..=high {
                for c in low..=high {
                    let operands = [a, b, c];
                    let values = found.plan.values(&operands);
                    let results: Vec<i128> =
                        found.plan.results().iter().map(|result| values[result.0]).collect();
                    for (first, second) in [(0, 1), (0, 2), (1, 2)] {
                        let step = (operands[first] - operands[second]).signum() as i128;
                        let difference = results[first] - results[second];
                        let is_kept = match is_reversed {
                            false => step * difference >= 0,
                            true => step * difference <= 0,
                        };
                        assert!(is_kept, "{formula}: {operands:?} gives {results:?}");
                    }
                }
            }
        }
    }
    assert_eq!(found_lists, 8);
}

#[test]
fn a_table_that_falls_once_breaks_the_order() {
    let statement = list(SOFTMAX, Format::signed(1, 3), 8, 2.0);
    let mut found = find_ordered(&statement, &[ALL], TableMemory::Logic).expect("a plan");
    let ordered = ordered_list(&statement, &(0..3)).expect("alike formulas");
    assert!(check_list(&found, &ordered).is_ok());
    // Every second segment of the exponential functions has a constant that is too small.
    let mut tables = 0;
    for at in 0..found.plan.nodes().len() {
        let node = found.plan.node(NodeId(at)).clone();
        if let Operation::Polynomial(operand, mut approximation) = node.operation
            && node.name.starts_with("octave")
        {
            let table = approximation.polynomials.as_mut().expect("polynomials");
            let table = Arc::make_mut(table);
            for segment in table.words.iter_mut().skip(1).step_by(2) {
                segment[0] /= 2;
            }
            let fault = Operation::Polynomial(operand, approximation);
            found.plan = found.plan.with_fault(NodeId(at), fault);
            tables += 1;
        }
    }
    assert_eq!(tables, 3);
    let refusal = check_list(&found, &ordered).expect_err("a table that falls");
    assert!(refusal.message.contains("octave"), "{refusal:?}");
}

#[test]
fn numbers_that_are_not_computed_alike_break_the_order() {
    let statement = list("# / (a + b + c + 1/8)", Format::unsigned(0, 6), 7, 1.0);
    let mut found = find_ordered(&statement, &[ALL], TableMemory::Logic).expect("a plan");
    let ordered = ordered_list(&statement, &(0..3)).expect("alike formulas");
    // The second number is the first.
    let [first, _, third] = found.plan.results() else { panic!("three results") };
    let mut equal = PlanBuilder::of_plan(found.plan.clone());
    equal.end_at(*first);
    equal.add_result(*first, *first);
    equal.add_result(*third, *third);
    found.plan = equal.finish().expect("a consistent plan");
    let refusal = check_list(&found, &ordered).expect_err("a number of another operand");
    assert!(refusal.message.contains("order"), "{refusal:?}");
}

#[test]
fn formulas_without_an_order_are_refused_at_the_part_that_has_none() {
    let format = Format::signed(1, 4);
    for (formula, part) in [
        ("sin(3 * #) + a", "sin(3 * a)"),
        ("# * b * c", "a * b"),
        ("#^2", "a^2"),
        ("abs(#) + c", "abs(a)"),
    ] {
        let statement = list(formula, format, 4, 1.0);
        let refusal = find_ordered(&statement, &[ALL], TableMemory::Logic).expect_err(formula);
        assert!(refusal.message.starts_with("`ordered` needs"), "{refusal:?}");
        let place = refusal.place.expect("a place").bytes;
        let text = formula.replace('#', "a");
        assert_eq!(&text[place], part, "{formula}");
    }
}
