//! Tests that expressions get plans, and that the errors of the plans are as proved.

use glint_approximate::{Curve, Identity, Outside, TargetFunction, Wish};
use glint_base::fixed::{Format, Rounding};
use std::mem::discriminant;

use glint_formula::{Comparison, Enclosure, Expression, Kind, parse, parse_condition};

use super::exhaust::largest_errors;
use super::find::{DIVISIONS, enclosed_errors};
use super::node::NodeId;
use super::plan::PlanBuilder;
use super::{
    ExpressionPlan, ExpressionStatement, Operation, ProofKind, StatedOperand, StatedOverflow,
    StatedResult, StatedWidth, find, least_size,
};

/// Returns an operand whose domain is its whole format.
fn operand(name: &str, format: Format) -> StatedOperand {
    let (low, high) = format.range();
    StatedOperand {
        name: name.to_owned(),
        format,
        domain: (low as i64, high as i64),
        outside: Outside::Anything,
        doc: String::new(),
    }
}

fn result(name: &str, formula: &str, fraction: u32) -> StatedResult {
    StatedResult {
        name: name.to_owned(),
        formula: parse(formula).unwrap_or_else(|fault| panic!("{}", fault.under(formula))),
        fraction,
        error: 1.0,
        promise: None,
        width: None,
    }
}

/// Returns the comparison in a text, for example `x < y`.
fn comparison(text: &str) -> Comparison {
    let choice: Expression = parse(&format!("if({text}, 1, 0)")).expect("a comparison");
    match choice.kind {
        Kind::If(comparison, ..) => comparison,
        other => panic!("{other:?}"),
    }
}

/// The margin of the comparison: the largest error of a combination is computed in f64, and may exceed the bound by this.
const ROUNDING: f64 = 1e-9;

/// Returns the statements of the tests: formulas of x and y with operands of `bits` bits, and the conditions under which the
/// errors are promised.
fn statements(bits: i32) -> Vec<ExpressionStatement> {
    let signed = Format::signed(0, bits - 1);
    let unsigned = Format::unsigned(0, bits);
    let not_origin = Some("x^2 + y^2 > 0");
    let cases: [(&[&str], Format, Option<&str>); 17] = [
        (&["x * y"], signed, None),
        (&["sqrt(x^2 + y^2)"], signed, None),
        (&["atan2(y, x) / pi"], signed, not_origin),
        (&["atan2(y, x)"], signed, not_origin),
        (&["x / y"], unsigned, Some("x < y")),
        (&["(x - y) / (2 + x)", "max(x, -y)"], signed, None),
        (&["if(x > y, x - y, 3 * y)", "abs(x - y) / 3"], signed, None),
        (&["sin(x) * y + 0.3", "1 / sqrt(1 + x * y)"], unsigned, None),
        (&["sqrt(x^2 + y^2)", "atan2(y, x) / pi"], signed, not_origin),
        (&["-sqrt(x^2 + y^2)", "-2 / sqrt(x + y)"], unsigned, Some("x + y > 0.25")),
        (&["tanh(4 * x) * y", "1 / (1.5 + sigmoid(8 * y))"], signed, None),
        // Divisors and coordinates that are themselves rounded.
        (&["x / sqrt(y)"], unsigned, Some("x < sqrt(y)")),
        (&["x / (0.3 + sin(y))", "atan2(sin(x), 1 + exp(y))"], unsigned, Some("y > 0.375")),
        (&["(0.6 * x - 0.8 * y) / sqrt(x^2 + y^2)"], signed, not_origin),
        (&["max(0, (x / 3 + y * 0.7) / sqrt(x^2 + y^2))^3"], signed, not_origin),
        (&["x ^ y"], unsigned, Some("x > 0")),
        (&["exp(-8 * (x + y))", "ln(x + y + 1 / 64)"], unsigned, None),
    ];
    let mut statements = Vec::new();
    for (formulas, format, promise) in cases {
        let mut results = Vec::new();
        for (number, formula) in formulas.iter().enumerate() {
            let promise = promise.map(comparison);
            let result = result(&format!("r{number}"), formula, bits as u32 - 1);
            results.push(StatedResult { promise, ..result });
        }
        let operands = vec![operand("x", format), operand("y", format)];
        statements.push(ExpressionStatement { operands, results });
    }
    statements
}

/// The enclosed error holds for every combination of operands, and is below the allowed error.
#[test]
fn enclosed_errors_hold_for_every_combination() {
    for bits in [5, 8] {
        for statement in statements(bits) {
            let found = find(&statement).unwrap_or_else(|refusal| panic!("{refusal:?}"));
            let enclosed =
                enclosed_errors(&statement, &found.whole_functions, DIVISIONS).expect("a proof");
            let largest = largest_errors(&statement, &found.plan).expect("values");
            for ((enclosed, largest), result) in
                enclosed.iter().zip(&largest).zip(&statement.results)
            {
                assert!(*largest <= enclosed + ROUNDING);
                assert!(*enclosed < result.error, "{statement:?}");
                // A bound of several times the actual error would be useless.
                assert!(*enclosed < 4.0 * largest + 0.1, "{enclosed} for {largest}: {statement:?}");
            }
        }
    }
}

/// Returns the statement of the rotation of a point by an angle in turns.
fn rotation(bits: i32) -> ExpressionStatement {
    let signed = Format::signed(0, bits - 1);
    let turn = Format::unsigned(0, bits);
    let fraction = bits as u32 - 1;
    ExpressionStatement {
        operands: vec![operand("x", signed), operand("y", signed), operand("turn", turn)],
        results: vec![
            result("u", "x * cos(2 * pi * turn) - y * sin(2 * pi * turn)", fraction),
            result("v", "x * sin(2 * pi * turn) + y * cos(2 * pi * turn)", fraction),
        ],
    }
}

#[test]
fn sixteen_bits_are_enclosed() {
    let mut all = statements(16);
    all.push(rotation(16));
    all.push(rotation(12));
    for statement in all {
        let found = find(&statement).unwrap_or_else(|refusal| panic!("{refusal:?}"));
        assert_eq!(found.proof, ProofKind::Enclosed);
        for (bound, result) in found.bounds.iter().zip(&statement.results) {
            assert!(*bound < result.error);
        }
    }
}

/// A wrong coefficient, a wrong shift, a wrong octant and a lost sign each exceed the proved bound.
#[test]
fn planted_faults_exceed_the_bound() {
    let statement = &statements(8)[8];
    let found = find(statement).expect("a plan");
    let mut faults = 0;
    for at in 0..found.plan.nodes().len() {
        let mut operation = found.plan.nodes()[at].operation.clone();
        match &mut operation {
            Operation::Polynomial(_, approximation) => {
                let mut wrong =
                    (**approximation.polynomials.as_ref().expect("polynomials")).clone();
                let middle = wrong.words.len() / 2;
                wrong.words[middle][0] += 1 << (wrong.guard() + 3);
                approximation.polynomials = Some(wrong.into());
            }
            Operation::Choose { cases, .. } => cases.swap(0, 1),
            Operation::Absolute(a) => operation = Operation::Narrow(*a, Rounding::Truncate),
            Operation::Places(_) => {
                operation = Operation::Constant { raw: 1, value: Enclosure::exactly(1.0) }
            }
            _ => continue,
        }
        let plan = found.plan.with_fault(NodeId(at), operation);
        faults += 1;
        let largest = largest_errors(statement, &plan).expect("values");
        let is_noticed = largest.iter().zip(&found.bounds).any(|(largest, bound)| largest > bound);
        assert!(is_noticed, "node {}", found.plan.nodes()[at].name);
    }
    assert!(faults >= 10, "{faults} faults");
}

#[test]
fn refusals_name_the_part_and_a_remedy() {
    let byte = Format::signed(0, 7);
    for (formula, promise, message, remedy) in [
        ("1 + x / y", None, "this is not finite", "where"),
        ("z + x", None, "there is no operand `z`", "name an operand"),
        ("x % exp(y)", None, "only of values that are not rounded", "divide operands"),
        ("if(sin(x + 2) > cos(y), x, y)", None, "cannot be proved below", "where"),
        ("x * y", Some("x > 7"), "no operands in the domains satisfy", "where"),
        ("sqrt(x + y)", None, "this is not finite, or has no value", "where"),
        ("atan2(y, x)", None, "not finite, or has no value", "where"),
    ] {
        let promise: Option<&str> = promise;
        let result = StatedResult { promise: promise.map(comparison), ..result("r", formula, 8) };
        let operands = vec![operand("x", byte), operand("y", byte)];
        let refusal =
            find(&ExpressionStatement { operands, results: vec![result] }).expect_err(formula);
        assert!(refusal.message.contains(message), "{formula}: {refusal:?}");
        assert!(refusal.remedy.contains(remedy), "{formula}: {refusal:?}");
        assert_eq!(refusal.result, Some(0));
        if let Some(place) = refusal.place {
            assert!(
                place.bytes.end <= formula.len() && !place.bytes.is_empty(),
                "{formula}: {place:?}"
            );
        }
    }
}

/// Formulas with rounded parts have plans. The square of a rounded value is not below 0, and the larger of two rounded values
/// has a small error. A divisor can be negative, and directions of rounded coordinates need bits in several operations.
#[test]
fn formulas_with_rounded_parts_are_proved() {
    for formula in [
        "hypot(x - y, tanh(x) * 1.7)",
        "if(sin(x) < y, sin(x), y)",
        "(y / 2.3) / (-2 / sqrt(1.3 + x))",
        "atan2(log2(1 + abs(y)), 3 + x)",
        "atan2(sin(x + 2), sin(y + 2))",
        "x",
    ] {
        let mut operands = Vec::new();
        for name in ["x", "y"] {
            if formula.contains(name) {
                operands.push(operand(name, Format::signed(0, 4)));
            }
        }
        let statement = ExpressionStatement { operands, results: vec![result("r", formula, 8)] };
        let found = find(&statement).unwrap_or_else(|refusal| panic!("{formula}: {refusal:?}"));
        assert!(found.bounds[0] < 1.0, "{formula}");
        assert_eq!(found.proof, ProofKind::EveryCombination);
    }
}

/// Results that need no rounding equal the formulas, computed in integers.
#[test]
fn exact_plans_have_exact_values() {
    let statement = ExpressionStatement {
        operands: vec![operand("x", Format::signed(7, 0)), operand("y", Format::signed(7, 0))],
        results: vec![
            result("p", "x * y - 3 * x", 0),
            result("m", "max(abs(x), y / 4)", 2),
            result("c", "if(x >= y, x + 1, -y)", 0),
        ],
    };
    let found = find(&statement).expect("a plan");
    for (x, y) in [(0i64, 0i64), (-128, 127), (5, 5), (100, -3), (-1, 2)] {
        let values = found.plan.values(&[x, y]);
        let results: Vec<i128> = found.plan.results().iter().map(|node| values[node.0]).collect();
        let larger = (4 * x.abs()).max(y);
        let chosen = if x >= y { x + 1 } else { -y };
        assert_eq!(results, [x * y - 3 * x, larger, chosen].map(i128::from), "x = {x}, y = {y}");
    }
    assert!(found.bounds.iter().all(|bound| *bound == 0.0), "{:?}", found.bounds);
}

/// A rounded value just below an integer can become the integer, and 0 to the power of 0 is 1. Such formulas are refused, or their
/// bound holds.
#[test]
fn integer_parts_and_powers_of_0_keep_their_bounds() {
    let mut proved = Vec::new();
    for formula in [
        "floor(x * 0.3)",
        "floor(sqrt(x))",
        "(x * 0.3) % 1",
        "floor(x / 3)",
        "floor(y / (x + 1))",
        "round(exp(-x) * 8)",
        "ceil(sqrt(x + y))",
        "(x / y) % 2",
        "x ^ y",
        "(x / 16) ^ (y - 2)",
        "sqrt(x) ^ y",
        "sqrt(x) ^ (y + 1/16)",
    ] {
        let format = Format::unsigned(4, 2);
        let mut operands = vec![operand("x", format)];
        if formula.contains('y') {
            operands.push(operand("y", format));
        }
        let statement = ExpressionStatement { operands, results: vec![result("r", formula, 2)] };
        let Ok(found) = find(&statement) else { continue };
        let enclosed = enclosed_errors(&statement, &found.whole_functions, DIVISIONS);
        let largest = largest_errors(&statement, &found.plan).expect("values");
        if let Ok(enclosed) = enclosed {
            assert!(largest[0] <= enclosed[0] + ROUNDING, "{formula}: {largest:?} {enclosed:?}");
        }
        assert!(largest[0] < 1.0, "{formula}: {largest:?}");
        proved.push(formula);
    }
    // Without proofs, the test would check nothing.
    assert!(proved.len() >= 6, "only these are proved: {proved:?}");
}

/// The integer part of a number with an irrational factor is refused if it has so many bits that its constants are not known well enough.
#[test]
fn integer_parts_of_many_bits_are_refused() {
    for factor in ["pi * 1000000", "pi * 1e12", "1e30 / pi"] {
        let operands = vec![operand("x", Format::unsigned(26, 0))];
        let results = vec![result("r", &format!("floor(x * ({factor}))"), 0)];
        let refusal = find(&ExpressionStatement { operands, results }).expect_err("too many bits");
        let reasons = ["integer part", "bits, more than 64"];
        let is_known = reasons.iter().any(|reason| refusal.message.contains(reason));
        assert!(is_known, "{factor}: {refusal:?}");
    }
}

/// A root that is rounded down, up or to the nearest integer is exact, also beside squares of integers, where an estimate alone could
/// take the wrong integer. The expected integers come from integer arithmetic.
#[test]
fn whole_roots_are_exact() {
    let format = Format::unsigned(26, 0);
    let exact_results =
        ["floor(sqrt(x))", "ceil(sqrt(x))", "round(sqrt(x))", "floor(4 * sqrt(x) / 3)"];
    let results = exact_results.map(|formula| result("r", formula, 0)).to_vec();
    let nearest = StatedResult { error: 0.5, ..result("nearest", "sqrt(0.3 * x)", 2) };
    let results = [results, vec![nearest]].concat();
    let statement = ExpressionStatement { operands: vec![operand("x", format)], results };
    let found = find(&statement).expect("a plan");
    assert_eq!(found.bounds[..4], [0.0; 4]);
    assert!(found.bounds[4] <= 0.5 + ROUNDING, "{:?}", found.bounds);
    let mut operands = Vec::new();
    for root in [0i64, 1, 2, 3, 100, 1447, 4095, 4096, 5792, 8191] {
        for square in [root * root, root * (root + 1), root * root * 9 / 16] {
            operands.extend([square - 1, square, square + 1]);
        }
    }
    operands.retain(|x| (0..1 << 26).contains(x));
    assert!(operands.len() > 80, "{operands:?}");
    for x in operands {
        let values = found.plan.values(&[x]);
        let given: Vec<i128> = found.plan.results().iter().map(|node| values[node.0]).collect();
        let x = x as u64;
        let down = x.isqrt();
        let up = if down * down == x { down } else { down + 1 };
        // round(√x) is the floor of (√(4 · x) + 1) / 2.
        let near = ((4 * x).isqrt() + 1) >> 1;
        let scaled = (16 * x / 9).isqrt();
        // With two fraction bits, √(0.3 · x) is a quarter of √(4.8 · x) = √(24 · x / 5).
        let nearest = ((4 * 24 * x / 5).isqrt() + 1) >> 1;
        let expected = [down, up, near, scaled, nearest].map(i128::from);
        assert_eq!(given, expected, "x = {x}");
    }
}

/// For operands outside their domains, every node still has a value of its format, like a net of the hardware.
#[test]
fn values_outside_the_domain_are_of_the_formats() {
    for statement in statements(5) {
        let mut narrow = statement.clone();
        for operand in &mut narrow.operands {
            operand.domain = (9, 14);
        }
        let found = match find(&narrow) {
            Ok(found) => found,
            Err(refusal) if refusal.message.starts_with("no operands") => continue,
            Err(refusal) => panic!("{refusal:?}"),
        };
        let (low, high) = statement.operands[0].domain;
        for x in low..=high {
            for y in low..=high {
                let values = found.plan.values(&[x, y]);
                for (node, value) in found.plan.nodes().iter().zip(values) {
                    assert!(node.format.holds(value), "{} = {value}", node.name);
                }
            }
        }
    }
}

/// A value beyond the stated width is refused, limited, or right modulo the range of the format.
#[test]
fn stated_widths_refuse_saturate_or_wrap() {
    let nibble = Format::signed(0, 3);
    let statement = |width: Option<StatedWidth>| ExpressionStatement {
        operands: vec![operand("x", nibble), operand("y", nibble)],
        results: vec![StatedResult { width, ..result("r", "x + y", 3) }],
    };
    let narrow = |overflow: StatedOverflow| Some(StatedWidth { format: nibble, overflow });
    let refusal =
        find(&statement(narrow(StatedOverflow::Refuse))).expect_err("values from -2 to 1.75");
    assert!(
        refusal.message.contains("`r` has 4 bits (s0.3), and intervals show only"),
        "{refusal:?}"
    );
    assert!(refusal.remedy.contains("wrap"), "{refusal:?}");
    let found = find(&statement(narrow(StatedOverflow::Wrap))).expect("a plan");
    assert_eq!(found.bounds, [0.0]);
    // 7/8 + 2/8 is 9/8, which is −7/8 modulo 2.
    assert_eq!(found.plan.values(&[7, 2])[found.plan.results()[0].0], -7);
    let limited = parse("min(max(x + y, -1), 7/8)").expect("a formula");
    let found = find(&statement(narrow(StatedOverflow::Saturate(limited)))).expect("a plan");
    let sum = |x: i64, y: i64| found.plan.values(&[x, y])[found.plan.results()[0].0];
    assert_eq!([sum(7, 2), sum(-8, -1), sum(3, 2)], [7, -8, 5]);
    let wide = Some(StatedWidth { format: Format::signed(4, 3), overflow: StatedOverflow::Refuse });
    let found = find(&statement(wide)).expect("a plan");
    assert_eq!(found.plan.node(found.plan.results()[0]).format, Format::signed(4, 3));
}

/// The rounding of a result has a share of at most half a unit, an exact operation has none, and a table has some.
#[test]
fn shares_are_of_the_parts_that_round() {
    for statement in statements(6) {
        let Ok(found) = find(&statement) else { continue };
        for (result, shares) in found.shares.iter().enumerate() {
            let mut largest_table: f64 = 0.0;
            let needed = found.plan.needed_for(result);
            let has_table = found.plan.nodes().iter().zip(&needed).any(|(node, needed)| {
                *needed && matches!(node.operation, Operation::Polynomial(..))
            });
            for (node, share) in found.plan.nodes().iter().zip(shares) {
                match node.operation {
                    Operation::Polynomial(..) => largest_table = largest_table.max(*share),
                    Operation::Narrow(..) => {}
                    _ if node.source.is_none() => assert_eq!(*share, 0.0, "{}", node.name),
                    _ => {}
                }
            }
            let proved = found.plan.proved()[result];
            let is_rounded = matches!(found.plan.node(proved).operation, Operation::Narrow(..));
            assert!(!is_rounded || shares[proved.0] <= 0.5 + ROUNDING);
            assert_eq!(has_table, largest_table > 0.0, "{}", statement.results[result].name);
        }
    }
}

/// The values of x / y with x and y from 1/2 to 1 − 2⁻¹² are at least 2048/4095. The values of x − y include 0.
#[test]
fn least_sizes_by_hand() {
    let half = StatedOperand { domain: (2048, 4095), ..operand("x", Format::unsigned(0, 12)) };
    let operands = vec![half.clone(), StatedOperand { name: "y".to_owned(), ..half }];
    let results = ["x / y", "-x / y", "x - y"].map(|formula| result("r", formula, 14)).to_vec();
    let statement = ExpressionStatement { operands, results };
    let sizes = [0, 1, 2].map(|number| least_size(&statement, number).expect("finite values"));
    let exact = 2048.0 / 4095.0;
    assert!(sizes[0] <= exact && sizes[0] > exact - 1e-9, "{sizes:?}");
    assert!(sizes[1] <= exact && sizes[1] > exact - 1e-9, "{sizes:?}");
    assert_eq!(sizes[2], 0.0);
}

/// The coordinates of a unit vector have one table of the reciprocal length, also with a condition.
#[test]
fn quotients_with_the_same_divisor_share_its_reciprocal() {
    let operands = ["x", "y", "z"].map(|name| operand(name, Format::signed(0, 9))).to_vec();
    let mut results = Vec::new();
    for formula in
        ["x / sqrt(x^2 + y^2 + z^2)", "y / sqrt(x^2 + y^2 + z^2)", "z / sqrt(x^2 + y^2 + z^2)"]
    {
        let promise = Some(comparison("x^2 + y^2 + z^2 > 1/16"));
        results.push(StatedResult { promise, ..result("r", formula, 8) });
    }
    let found = find(&ExpressionStatement { operands, results }).expect("a plan");
    assert_eq!(found.plan.approximations().len(), 1);
}

/// A function with a range reduction: the formula, the raw domain, the numbers of fraction bits of the operand and of the
/// result, and the identity.
type ReducedFunction = (&'static str, (i64, i64), i32, u32, Identity);

const REDUCED: [ReducedFunction; 16] = [
    ("2^x", (-2048, 2047), 8, 8, Identity::Exponent),
    ("2^-x", (-700, 1301), 8, 7, Identity::Exponent),
    ("exp(x)", (-1024, 1023), 7, 6, Identity::Exponent),
    ("log2(x)", (1, 4095), 4, 10, Identity::Octaves),
    ("ln(x)", (3, 2047), 5, 9, Identity::Octaves),
    ("1 / x", (1, 4095), 6, 6, Identity::Octaves),
    ("1 / sqrt(x)", (1, 4095), 6, 9, Identity::Octaves),
    ("1 / sqrt(x)", (1, 8191), 6, 9, Identity::Octaves),
    ("sqrt(x)", (0, 4095), 6, 9, Identity::Octaves),
    ("sin(2 * pi * x)", (0, 4095), 12, 11, Identity::Quadrants),
    ("cos(2 * pi * x)", (-2048, 2047), 12, 11, Identity::Quadrants),
    ("-sin(2 * pi * x)", (0, 1023), 10, 11, Identity::Quadrants),
    ("sigmoid(x)", (-1024, 1023), 8, 12, Identity::Odd),
    ("tanh(x)", (-1000, 700), 8, 12, Identity::Odd),
    ("atan(x)", (-300, 2047), 8, 12, Identity::Odd),
    ("exp(-x^2)", (-512, 511), 8, 12, Identity::Even),
];

/// The proof of a range reduction relies on its definition in `glint_approximate`. The hardware and the golden model rely on
/// the plan.
#[test]
fn plans_of_reduced_functions_compute_the_proved_results() {
    for (formula, domain, frac, fraction, identity) in REDUCED {
        let function = TargetFunction {
            curve: Curve::Formula(parse(formula).expect("a formula")),
            domain,
            operand: Format::holding(domain.0.into(), domain.1.into(), frac),
            outside: Outside::Anything,
            fraction,
            error: 1.0,
        };
        let wish = Wish { identity, ..Wish::default() };
        let polynomials = glint_approximate::find(&function, wish)
            .unwrap_or_else(|refusal| panic!("{formula}: {refusal:?}"));
        let plan = ExpressionPlan::of_function(&function, &polynomials).expect("a plan");
        for raw in domain.0..=domain.1 {
            let result = plan.values(&[raw])[plan.results()[0].0];
            assert_eq!(result, polynomials.result(raw).into(), "{formula} at {raw}");
        }
    }
}

/// A function that is odd about a point needs polynomials for one side of this point only. The hardware mirrors the operand and
/// the result.
#[test]
fn an_odd_function_has_a_table_for_one_side() {
    let x = Format::signed(3, 12);
    let statement = ExpressionStatement {
        operands: vec![operand("x", x)],
        results: vec![result("r", "atan(x)", 14)],
    };
    let found = find(&statement).expect("a plan");
    assert_eq!(found.proof, ProofKind::EveryCombination);
    let has_size = |node: &super::PlanNode| matches!(node.operation, Operation::Absolute(_));
    assert!(found.plan.nodes().iter().any(has_size), "{:?}", found.plan);
    let [approximation] = found.plan.approximations()[..] else { panic!("{:?}", found.plan) };
    assert_eq!(approximation.function.domain.0, 0, "{approximation:?}");
}

/// The condition of a choice excludes operands for which the chosen case would have no value.
#[test]
fn choices_guard_their_cases() {
    let byte = Format::signed(3, 4);
    for formula in [
        "if(x > 0, ln(x), -8) + y",
        "if(y > 0, x / y, 0)",
        "if(y >= 1/16, x / y, x)",
        "if(y < 0, x / y, x)",
        "if(x > 0, if(y > 0, sqrt(x * y) / y, 1), 0)",
        "if(x > 0, 1 / x, 0) + if(x > 0, 1 / x, 0) * y",
        "x <= 0 ? y : y * log2(x)",
        "if(y > 100, 1 / (y - y), x + y)",
        "if(y == 0, 0, x / y)",
        "max(x, 0) ^ (abs(y) / 8 + 1/8)",
        "exp(if(x > 0, ln(x), -8) / 2)",
        "sqrt(if(x > 0, 1 / x, x^2))",
        "cos(if(x > 0, sqrt(x), 0)) * x + y",
    ] {
        let mut operands = Vec::new();
        for name in ["x", "y"] {
            if formula.contains(name) {
                operands.push(operand(name, byte));
            }
        }
        let statement = ExpressionStatement { operands, results: vec![result("r", formula, 4)] };
        let found = find(&statement).unwrap_or_else(|refusal| panic!("{formula}: {refusal:?}"));
        assert!(found.bounds[0] < 1.0, "{formula}");
        let largest = largest_errors(&statement, &found.plan).expect("values");
        assert!(largest[0] < 1.0, "{formula}: {largest:?}");
    }
}

/// A quotient by a root needs no table of the root, and two quotients by it need no second table of the reciprocal.
#[test]
fn quotients_by_a_root_read_one_table_of_its_reciprocal() {
    let format = Format::signed(0, 11);
    let length = "sqrt(x^2 + y^2)";
    let coordinate = |name: &str| StatedResult {
        promise: Some(parse_condition("x^2 + y^2 >= 1/16").expect("a condition")),
        ..result(name, &format!("{name} / {length}"), 10)
    };
    let operands = vec![operand("x", format), operand("y", format)];
    let alone = ExpressionStatement { operands: operands.clone(), results: vec![coordinate("x")] };
    let both = ExpressionStatement { operands, results: vec![coordinate("x"), coordinate("y")] };
    let [alone, both] = [alone, both].map(|statement| find(&statement).expect("a plan").plan);
    assert_eq!(alone.approximations().len(), 1);
    assert_eq!(both.approximations().len(), 1);
}

/// Conditions limit the lengths of two points. As complex numbers, they have a product whose angle has a value then.
#[test]
fn the_angle_between_two_points_follows_from_their_lengths() {
    let format = Format::signed(0, 3);
    let condition = "u^2 + v^2 > 0.1 and x^2 + y^2 > 0.1";
    let angle = StatedResult {
        promise: Some(parse_condition(condition).expect("a condition")),
        ..result("angle", "atan2(v * x - u * y, u * x + v * y) / pi", 5)
    };
    let operands = ["u", "v", "x", "y"].map(|name| operand(name, format)).to_vec();
    let found = find(&ExpressionStatement { operands, results: vec![angle] }).expect("a plan");
    // The errors of all combinations were computed, and none is above the bound of the proof by intervals.
    assert_eq!(found.proof, ProofKind::EveryCombination);
    assert!(found.enclosed[0] < 1.0);
}

/// Each way in which a plan can contradict itself is refused, with the name of the node.
#[test]
fn a_plan_that_contradicts_itself_is_refused() {
    let zero = Operation::Constant { raw: 0, value: Enclosure::exactly(0.0) };
    let rebuilt = |plan: ExpressionPlan| PlanBuilder::of_plan(plan).finish();
    let statement = &statements(8)[8];
    let plan = find(statement).expect("a plan").plan;
    assert!(rebuilt(plan.clone()).is_ok());
    let mut refused = Vec::new();
    for (at, node) in plan.nodes().iter().enumerate() {
        let (fault, reason) = match &node.operation {
            Operation::Absolute(_) => (Operation::Absolute(NodeId(at)), "precede"),
            Operation::Places(_) => (zero.clone(), "belong"),
            Operation::Normalise { .. } => (zero.clone(), "belong"),
            Operation::Choose { cases, .. } => {
                (Operation::Choose { condition: cases[0], cases: *cases }, "belong")
            }
            _ => continue,
        };
        let refusal = rebuilt(plan.with_fault(NodeId(at), fault)).expect_err(&node.name);
        assert!(refusal.message.contains(reason), "{refusal:?}");
        refused.push(discriminant(&node.operation));
    }
    let mut kinds = refused.clone();
    kinds.dedup();
    assert!(kinds.len() >= 4, "{} faults", refused.len());
}

/// Two nodes with the same name would be the same net, and a node with empty limits would have no error.
#[test]
fn a_name_that_is_not_unique_and_empty_limits_are_refused() {
    let mut same_names = PlanBuilder::default();
    let a = same_names.operand(0, "a", Format::unsigned(0, 4), (0, 15)).expect("an operand");
    let mut empty_limits = same_names.clone();
    let b = same_names.operand(1, "a", Format::unsigned(0, 4), (0, 15)).expect("an operand");
    same_names.add_result(b, b);
    let refusal = same_names.finish().expect_err("two operands with the same name");
    assert_eq!(refusal.message, "the node `a` has the name of another node");
    empty_limits.state_limits(a, Enclosure::between(1.0, 0.0));
    empty_limits.add_result(a, a);
    let refusal = empty_limits.finish().expect_err("empty limits");
    assert_eq!(refusal.message, "the node `a` has limits that contain no value");
}

/// A rounded difference can be a little above 1, where the inverse cosine has no value. The hardware then takes its value at 1.
#[test]
fn functions_of_rounded_differences_end_where_they_have_values() {
    const BITS: i32 = 6;
    let format = Format::unsigned(0, BITS);
    for formula in ["acos(cos(x) - y * 0.3) / 2", "acos(cos(y) - x / 7) / 3"] {
        let statement = ExpressionStatement {
            operands: vec![operand("x", format), operand("y", format)],
            results: vec![result("r", formula, BITS as u32)],
        };
        let found = find(&statement).unwrap_or_else(|refusal| panic!("{formula}: {refusal:?}"));
        let names: Vec<&str> = found.plan.nodes().iter().map(|node| node.name.as_str()).collect();
        let end = ["not_below", "not_above"];
        assert!(names.iter().any(|name| end.contains(name)), "{formula}: {names:?}");
        let largest = largest_errors(&statement, &found.plan).expect("values");
        assert!(largest[0] <= found.bounds[0] + ROUNDING, "{formula}: {largest:?}");
    }
}
