//! Writes the Gappa statements for devices that compute a line of points (many points after one `start`) from a ROM with powers
//! of a cosine. At each point, the device reads a ROM word for the angle and multiplies it by a colour.
//!
//! A ROM word serves all angles of a segment. The contract follows from two kinds of statements:
//!
//! - For each word w, whose segment goes from angle a to angle b (in right angles, 0 ≤ a ≤ b ≤ 1): f(a) ≤ w + E and f(b) ≥ w − E,
//!   with the bound E of f. Because cos falls from 0 to π, f is between f(b) and f(a) at every angle of the segment.
//! - For each output: if a word w and a real f differ by at most E, then the output differs from f times the colour by at most
//!   the contract's bound.
//!
//! Gappa has no cosine, so the script uses Taylor's formula cos y = 1 − y²/2! + y⁴/4! − … ± y²ᵐ/(2m)! + ρ·y²ᵐ⁺²/(2m+2)! with
//! |ρ| ≤ 1, which holds for every real y. Gappa proves the statement for every ρ from −1 to 1, and for every number within
//! 10⁻²⁰ of π/2 in place of π/2.
//!
//! The module finds the angles of each word by bisection: it halves an interval of angles until the netlist reads the same word
//! for the whole interval, as in [`super::cases`]. The device computes each point of a line as it computes the first, but at
//! another angle; [`glint_rtl::pipeline::unroll_line`] proves this by induction. The formula's angle at a point is the value of
//! the register that adds up the angle along the line ([`AngleWalk::angle`]).

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::cases::{self, Case};
use super::hardware::{self, Hardware, NodeValue, Variables};
use super::script::{GappaScript, goal};
use super::statement::{Statement, Statements};
use super::task::Task;
use super::terms::{RealTerm, RealTerms, number};
use glint_base::fixed::exp2;
use glint_formula::{Enclosure, Expression, Function, Kind, Operator, parse};
use glint_rtl::pipeline::{Cell, Graph, NodeId, NodeOp, WalkRegister};

/// The number of words in one statement. Gappa's time grows with its square.
const WORDS: usize = 8;

/// The number m in Taylor's formula: the polynomial for the cosine ends with the term in y²ᵐ. At a right angle, the remainder
/// is below 10⁻¹⁶.
const TERMS: u32 = 10;

/// Two numbers between which π/2 lies.
const RIGHT: (&str, &str) = ("1.57079632679489661923", "1.57079632679489661924");

/// The number of fraction bits to which the statements round the bound of f down.
const PLACES: i32 = 42;

/// The name of the angle of a point in a formula. The angle is no operand, because the operand has only the first point's angle.
const POINT: &str = "angle of the point";

/// A word of the table, and the interval of the angles for which the device reads the word, in right angles.
struct WordSegment {
    value: f64,
    from: f64,
    to: f64,
}

/// Returns the statements for `task`. `walk` are the registers that change from point to point, such as the angle.
///
/// # Errors
///
/// Fails if the task has no bound, or if the contract is no highlight. Fails if the formula or the netlist lacks the expected
/// form: a table with a power of a cosine, with an angle that grows from point to point as the address.
pub fn statements(task: &Task, walk: &[WalkRegister]) -> Result<Vec<Statement>, String> {
    let bound = task
        .bound
        .ok_or("statements for the words of a table need a contract with a stated bound")?;
    if task.contract.highlight().is_none() {
        return Err(
            "for lines of points, statements can be written only about highlights".to_owned()
        );
    }
    let scale = exp2(PLACES);
    let of_f = libm::floor(task.contract.bounds().f * scale) / scale;
    let [formula] = task.formulas else {
        return Err("the formula has several values".to_owned());
    };
    let (angle, power) = lobe(formula).ok_or("the formula is not a power of a cosine")?;
    let walk = AngleWalk::new(task, walk)?;
    let angle = walk.angle(angle);
    let (colours, table, outputs) = table(task)?;
    let words = words(task, table, &walk, &angle)?;
    let name = task.graph().node(table).label.name.clone();
    let mut statements = Statements::default();
    for (at, words) in words.chunks(WORDS).enumerate() {
        statements.push(&name, vec![about_words(words, at * WORDS, power, of_f)]);
    }
    for ((output, node), colour) in outputs.iter().zip(&colours) {
        let script = about_output(task, (*node, table), colour, (of_f, bound))?;
        statements.push(output, vec![script]);
    }
    Ok(statements.list)
}

/// Returns x and k if `formula` is cos(pi / 2 · x)ᵏ. For example, `cos(pi / 2 * x) ** 16` gives x and 16.
fn lobe(formula: &Expression) -> Option<(&Expression, u32)> {
    let Kind::Binary(Operator::Power, base, exponent) = &formula.kind else { return None };
    let Kind::Unary(Function::Cos, angle) = &base.kind else { return None };
    let Kind::Number(literal) = &exponent.kind else { return None };
    let Kind::Binary(Operator::Mul, right, angle) = &angle.kind else { return None };
    let power = literal.nearest();
    let is_whole = literal.is_exact() && (1.0..=64.0).contains(&power) && power.fract() == 0.0;
    if !is_whole || **right != parse("pi / 2").ok()? {
        return None;
    }
    Some((angle, power as u32))
}

/// The angle along a line of points, as a formula of operands.
struct AngleWalk {
    /// The operand with the first point's angle.
    start: String,
    /// The angle's formula at point number `index`, wrapped to its format. For a signed format of four right angles, it is `(a +
    /// index * d + 2) % 4 - 2`.
    wrapped: Expression,
}

impl AngleWalk {
    /// Derives the angle from the register that changes from point to point.
    ///
    /// # Errors
    ///
    /// Fails unless the angle is the only such register, begins with one operand, and grows by a second operand modulo its
    /// format.
    fn new(task: &Task, walk: &[WalkRegister]) -> Result<Self, String> {
        let graph = task.graph();
        let is_more_than_a_sum =
            "the angle of the next point is not the sum of an angle and an operand";
        let [WalkRegister { first, before, next }] = *walk else {
            return Err(is_more_than_a_sum.to_owned());
        };
        let Cell::Op(NodeOp::Add { a, b, carry: None }) = graph.node(next).cell else {
            return Err(is_more_than_a_sum.to_owned());
        };
        let step = if a == before { b } else { a };
        let start = operand_name(task, first).ok_or(is_more_than_a_sum)?;
        let added = operand_name(task, step).ok_or(is_more_than_a_sum)?;
        let format = graph.node(first).format;
        let is_one_format = [before, next, step].iter().all(|&id| graph.node(id).format == format);
        if !(is_one_format && format.signed && [a, b].contains(&before)) {
            return Err(is_more_than_a_sum.to_owned());
        }
        let turn = exp2(format.width() as i32 - format.frac);
        let half = turn / 2.0;
        let text = format!("({start} + index * {added} + {half}) % {turn} - {half}");
        let wrapped = parse(&text).map_err(|fault| fault.under(&text))?;
        Ok(Self { start: start.to_owned(), wrapped })
    }

    /// Replaces the angle of a point in `formula`, start + index·step, wrapped around, by the name [`POINT`]. By induction, the
    /// angle's register has this value.
    fn angle(&self, formula: &Expression) -> Expression {
        formula.substitute(&self.wrapped, &Expression::operand(POINT), &formula.span)
    }
}

fn operand_name<'t>(task: &'t Task, id: NodeId) -> Option<&'t str> {
    match task.graph().node(id).cell {
        Cell::Operand(at) => Some(&task.design.net(task.unrolled.operands[at]).name),
        _ => None,
    }
}

/// The names of the colour operands, the node of the table word by which all outputs are multiplied, and the outputs with
/// their nodes.
type ProductsByColour = (Vec<String>, NodeId, Vec<(String, NodeId)>);

/// Returns the table word on which all outputs depend, with the colours and the outputs.
///
/// # Errors
///
/// Fails if the outputs depend on several words, or on anything besides the word and colours.
fn table(task: &Task) -> Result<ProductsByColour, String> {
    let graph = task.graph();
    let outputs = task.outputs()?;
    let mut colours: Vec<String> = Vec::new();
    for operand in task.contract.operands() {
        if operand.colour {
            colours.push(operand.name.clone());
        }
    }
    let mut pending: Vec<NodeId> = outputs.iter().map(|(_, node)| *node).collect();
    let mut reads = graph.cone(pending.iter().copied());
    reads.retain(|&id| matches!(graph.node(id).cell, Cell::Read { .. }));
    let [table] = reads[..] else {
        return Err("the outputs depend on several table words".to_owned());
    };
    // After the word is read, the outputs may depend on colours only, and nothing may be selected.
    let before = graph.cone([table]);
    while let Some(id) = pending.pop() {
        if id == table {
            continue;
        }
        let node = graph.node(id);
        let selects = match &node.cell {
            Cell::Op(NodeOp::Mux { select, .. }) => is_open(graph, *select),
            Cell::Op(NodeOp::Add { carry: Some(carry), .. }) => is_open(graph, *carry),
            Cell::Operand(at) => {
                let name = &task.design.net(task.unrolled.operands[*at]).name;
                before.binary_search(&id).is_ok() || !colours.contains(name)
            }
            _ => false,
        };
        if selects {
            return Err(format!("`{}` selects a value after the table", node.label.name));
        }
        pending.extend(node.cell.operands());
    }
    if colours.len() != outputs.len() {
        return Err("the outputs are not products of a table word and a colour".to_owned());
    }
    Ok((colours, table, outputs))
}

fn is_open(graph: &Graph, id: NodeId) -> bool {
    let (low, high) = graph.node(id).range;
    low != high
}

/// Returns the words that the device reads, in the order of their addresses. Each has the interval of its angles, in right
/// angles.
///
/// # Errors
///
/// Fails if the address depends on anything but the angle, or if an angle leaves the range from 0 to 1.
fn words(
    task: &Task,
    table: NodeId,
    walk: &AngleWalk,
    angle: &Expression,
) -> Result<Vec<WordSegment>, String> {
    let graph = task.graph();
    let Cell::Read { rom, address } = graph.node(table).cell else {
        return Err("there is no table".to_owned());
    };
    let operand = task
        .operand(&walk.start)
        .ok_or("the table words do not depend on the angle of the point")?;
    for id in graph.cone([address]) {
        if id != operand && matches!(graph.node(id).cell, Cell::Operand(_)) {
            return Err(format!(
                "the table address depends on more operands than `{}`",
                walk.start
            ));
        }
    }
    let start = task.contract.operands().iter().find(|operand| operand.name == walk.start);
    let (low, high) = start.ok_or("the contract has no angle")?.domain;
    // Along lines, the register takes every angle of its format, even if the domain of the first angle is smaller.
    let format = graph.node(operand).format;
    if (i128::from(low), i128::from(high)) != format.range() {
        return Err(format!("`{}` can leave its domain along a line", walk.start));
    }
    let data = graph.node(table).format;
    let mut found: BTreeMap<i128, WordSegment> = BTreeMap::new();
    let mut pending = vec![format.range()];
    while let Some((low, high)) = pending.pop() {
        let start_angle = low as f64 * exp2(-format.frac);
        let end_angle = high as f64 * exp2(-format.frac);
        let Some(at) = decided_address(task, (operand, (low, high)), address) else {
            if low == high {
                return Err(format!(
                    "at the angle {start_angle}, it is not determined which table word is read"
                ));
            }
            let middle = (low + high).div_euclid(2);
            pending.extend([(middle + 1, high), (low, middle)]);
            continue;
        };
        let (from, to) = match enclosed(angle, (start_angle, end_angle)) {
            Some(Enclosure { low, high }) if low >= 0.0 && high <= 1.0 => (low, high),
            _ => {
                return Err(
                    "the angle of the formula is not between 0 and a right angle".to_owned()
                );
            }
        };
        let value = data.to_f64((task.view.words)(rom, at as u64));
        let segment = found.entry(at).or_insert(WordSegment { value, from, to });
        segment.from = segment.from.min(from);
        segment.to = segment.to.max(to);
    }
    Ok(found.into_values().collect())
}

/// Returns the value of the node `address` if the intervals of the nodes show that it is the same for every value of `operand` in
/// `range`. With `None`, a caller can try each half of the range. For example, the address may be the top 8 bits of the operand;
/// it is known if these bits are equal in the whole range.
fn decided_address(
    task: &Task,
    (operand, range): (NodeId, (i128, i128)),
    address: NodeId,
) -> Option<i128> {
    let mut known = cases::NodeIntervals::new();
    if !task.learn(&mut known, operand, range) {
        return None;
    }
    let (low, high) = cases::range(task.view, address, &known)?;
    if low == high { Some(low) } else { None }
}

/// Returns an interval, in right angles, of the formula's angle if the point's angle is from `low` to `high`. Returns `None` if
/// the formula's angle depends on anything else, or may have no value there.
fn enclosed(angle: &Expression, (low, high): (f64, f64)) -> Option<Enclosure> {
    angle.enclose(&[(POINT, Enclosure::between(low, high))]).ok()
}

/// Writes the statement that the formula is within `bound` of each word at both ends of the word's segment. `first` is the first
/// word's index, and `power` the cosine's exponent.
fn about_words(words: &[WordSegment], first: usize, power: u32, bound: f64) -> String {
    let degree = 2 * TERMS + 2;
    let mut text = format!(
        "# By Taylor the cosine of y is 1 - y^2/2! + y^4/4! - ... + rest y^{degree}/{degree}! with |rest| <= 1.\n"
    );
    let mut ends: Vec<f64> = Vec::new();
    let mut goals: Vec<String> = Vec::new();
    for (at, word) in (first..).zip(words) {
        // A word and its neighbour share the angle between them, so both use the same name for it.
        let [high, low] = [word.from, word.to].map(|angle| {
            let known = ends.iter().position(|other| *other == angle);
            let name = first + known.unwrap_or(ends.len());
            if known.is_none() {
                ends.push(angle);
                text.push_str(&cosine(&name.to_string(), angle, power));
            }
            name
        });
        let _ = writeln!(
            text,
            "# Word {at} is {}, for angles from {} to {} right angles.",
            number(word.value),
            number(word.from),
            number(word.to)
        );
        goals.push(format!("f_{high} <= {}", number(word.value + bound)));
        goals.push(format!("f_{low} >= {}", number(word.value - bound)));
    }
    let all_goals = goals.join("\n  /\\ ");
    let (low, high) = RIGHT;
    let _ =
        write!(text, "\n{{ right in [{low},{high}]\n  /\\ rest in [-1,1]\n  -> {all_goals} }}\n\n");
    text
}

/// Writes the definitions of a power of an angle's cosine, in right angles. For example, the last line for the name `x` and the
/// power 2 is `f_x = c_x_0 * c_x_0;`.
fn cosine(name: &str, angle: f64, power: u32) -> String {
    let mut text =
        format!("y_{name} = right * {};\nsquare_{name} = y_{name} * y_{name};\n", number(angle));
    let mut inner = "rest".to_owned();
    for term in (0..=TERMS).rev() {
        let divisor = (2 * term + 2) * (2 * term + 1);
        let _ = writeln!(text, "c_{name}_{term} = 1 - {inner} * square_{name} / {divisor};");
        inner = format!("c_{name}_{term}");
    }
    let factors = vec![inner; power as usize].join(" * ");
    let _ = writeln!(text, "f_{name} = {factors};");
    text
}

/// Writes the statement that the output `out` is within `bound`, in output units, of `colour` times f, for every f within
/// `of_f` of the table word.
fn about_output(
    task: &Task,
    (out, table): (NodeId, NodeId),
    colour: &str,
    (of_f, bound): (f64, f64),
) -> Result<String, String> {
    let graph = task.graph();
    let ranges = graph.nodes.iter().map(|node| node.range).collect();
    let case = Case { known: cases::NodeIntervals::new(), ranges, parabolas: BTreeMap::new() };
    let mut placed = Variables::new();
    for &port in &task.unrolled.operands {
        let net = task.design.net(port);
        placed.push((net.name.clone(), net.format.frac));
    }
    let mut hardware = Hardware::new(task.view, &case, placed, task.tables);
    let mut terms = RealTerms::default();
    let out_value = hardware.value(&mut terms, out)?;
    let (unscaled, out_scale) = hardware::placed(&mut terms, out_value, 0);
    let real_out = hardware::scaled(&mut terms, unscaled, out_scale, "out");
    let NodeValue::Term { id: word, scale } = hardware.value(&mut terms, table)? else {
        return Err("the table has only one word".to_owned());
    };
    if scale != graph.node(table).format.frac {
        return Err("the binary point of the table words has moved".to_owned());
    }
    let mut presupposed = hardware.facts.clone();
    let found = task.contract.operands().iter().find(|operand| operand.name == *colour);
    let operand = found.ok_or("the contract lacks a colour")?;
    let (low, high) = operand.domain;
    let unit = exp2(-operand.format.frac);
    let factor = terms.insert(RealTerm::Variable(colour.to_owned()), colour);
    presupposed.insert(factor, (low as f64 * unit, high as f64 * unit));
    let f = terms.insert(RealTerm::Variable("f".to_owned()), "f");
    let apart = terms.insert(RealTerm::Sub(word, f), "apart");
    presupposed.insert(apart, (-of_f, of_f));
    let unrounded = terms.unrounded(real_out, &mut std::collections::HashMap::new());
    let hardware_terms = terms.count();
    let exact = terms.insert(RealTerm::Mul(f, factor), "exact");
    let difference = terms.insert(RealTerm::Sub(real_out, exact), "difference");
    let hint = format!(
        "{} - {} -> {} * ({} - {});",
        terms.name(unrounded),
        terms.name(exact),
        terms.name(factor),
        terms.name(word),
        terms.name(f)
    );
    let script = GappaScript {
        terms: &terms,
        hardware_terms,
        placed: &hardware.variables,
        presupposed: &presupposed,
        ways: &[],
    };
    let goal = goal(&terms.name(difference), Some(bound));
    Ok(script.statement(terms.clone(), difference, &goal, &[hint]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_of_a_point_is_that_of_the_walk_alone() {
        let real = |text: &str| parse(text).expect("a formula");
        let walk =
            AngleWalk { start: "a".to_owned(), wrapped: real("(a + index * d + 2) % 4 - 2") };
        let range = |text: &str, range| {
            enclosed(&walk.angle(&real(text)), range).map(|it| (it.low, it.high))
        };
        let folded = "min(abs(((a + index * d + 2) % 4 - 2)), 1)";
        assert_eq!(range(folded, (0.25, 0.5)), Some((0.25, 0.5)));
        assert_eq!(range(folded, (-0.5, -0.25)), Some((0.25, 0.5)));
        assert_eq!(range(folded, (-0.5, 0.25)), Some((0.0, 0.5)));
        assert_eq!(range(folded, (-3.0, -0.75)), Some((0.75, 1.0)));
        // These formulas have the first point's angle, another turn, no wrapping, and another step.
        for other in [
            "min(abs(a), 1)",
            "min(abs(((a + index * d + 4) % 8 - 4)), 1)",
            "min(abs(a + index * d), 1)",
            "min(abs(((a + index * a + 2) % 4 - 2)), 1)",
        ] {
            assert_eq!(range(other, (0.25, 0.5)), None, "{other}");
        }
    }

    #[test]
    fn a_power_of_a_cosine_is_recognised() {
        let power = |text: &str| lobe(&parse(text).expect("a formula")).map(|(_, power)| power);
        assert_eq!(power("cos(pi / 2 * x) ** 2"), Some(2));
        assert_eq!(power("cos(pi / 2 * x) ** 16"), Some(16));
        for other in ["cos(pi / 3 * x) ** 2", "cos(pi / 2 * x) ** 2.5", "cos(x) ** 2", "x ** 2"] {
            assert_eq!(power(other), None, "{other}");
        }
    }

    /// cos 60° is 1/2. The definitions must give this value in f64.
    #[test]
    fn the_definitions_are_those_of_a_cosine() {
        let square = (std::f64::consts::FRAC_PI_2 * 2.0 / 3.0).powi(2);
        let text = cosine("x", 0.5, 2);
        let lines = text.lines().filter(|line| line.starts_with("c_"));
        // Each line is `c = 1 - inner * square / divisor;`. The first one has the remainder, which is taken as 0.
        let value = lines.fold(0.0, |inner, line| {
            let divisor = line.rsplit(' ').next().expect("a divisor").trim_end_matches(';');
            1.0 - inner * square / divisor.parse::<f64>().expect("a number")
        });
        assert!((value - 0.5).abs() < 1e-15, "{value}");
        assert!(text.ends_with("f_x = c_x_0 * c_x_0;\n"), "{text}");
    }
}
