//! Examines the shape of a formula: the part on which it depends, the products that compute it, and constants that are exact in
//! binary.

use std::collections::{HashMap, HashSet};
use std::ptr;

use glint_formula::{Expression, Function, Kind, Operator};

use crate::constant::dyadic;

/// The cost of a product of two numbers that vary, if a product with a constant costs 1.
const PRODUCT: u32 = 2;

/// The most parts of a formula whose dominators are searched.
const MOST_PARTS: u32 = 200;

/// Returns the smallest part on which a formula depends: the formula is a function of the value of this part alone. This part
/// is the formula itself if the formula combines different parts. For example, the core of `1 / sqrt(x + y)` is `x + y`.
pub(super) fn core_of(formula: &Expression) -> &Expression {
    core_with(&mut HashMap::new(), formula)
}

/// Returns the core of a formula, as [`core_of`] does. `known` has the cores of parts that were seen before, because several
/// operations may share a part.
fn core_with<'f>(
    known: &mut HashMap<*const Expression, &'f Expression>,
    formula: &'f Expression,
) -> &'f Expression {
    let place = ptr::from_ref(formula);
    if let Some(core) = known.get(&place) {
        return core;
    }
    let mut cores = Vec::new();
    for part in formula.parts() {
        if part.varies() {
            cores.push(core_with(known, part));
        }
    }
    let core = match cores[..] {
        [first, ref rest @ ..] if rest.iter().all(|core| *core == first) => first,
        _ => formula,
    };
    known.insert(place, core);
    core
}

/// Returns the parts that dominate `core` in `formula`: the formula reads `core` only through each of these parts. The formula
/// and `core` themselves are left out, and the part nearest to `core` comes first. For example, `max(0, x)` and
/// `sqrt(max(0, x))` dominate x in `1 - sqrt(max(0, x))`. The list is empty for a formula of more than 200 parts.
pub(super) fn dominators<'f>(formula: &'f Expression, core: &Expression) -> Vec<&'f Expression> {
    if formula.size() > MOST_PARTS {
        return Vec::new();
    }
    let mut inner = Vec::new();
    add_parts(formula, core, &mut HashSet::new(), &mut inner);
    inner.retain(|part| *part != formula && is_only_read_through(formula, core, part));
    inner.sort_by_key(|part| part.size());
    inner.dedup();
    inner
}

/// Adds the parts of `formula` that contain `core`, apart from `core` itself, to `inner`. `seen` has the parts that were visited.
fn add_parts<'f>(
    formula: &'f Expression,
    core: &Expression,
    seen: &mut HashSet<*const Expression>,
    inner: &mut Vec<&'f Expression>,
) {
    if formula == core || !seen.insert(ptr::from_ref(formula)) {
        return;
    }
    if formula.count(&|part| part == core) > 0 {
        inner.push(formula);
        for part in formula.parts() {
            add_parts(part, core, seen, inner);
        }
    }
}

/// Returns whether `core` occurs in `formula` only inside `part`. For example, `x` occurs in `1 - sqrt(x)` only inside `sqrt(x)`,
/// but not in `x - sqrt(x)`.
fn is_only_read_through(formula: &Expression, core: &Expression, part: &Expression) -> bool {
    let replaced = formula.substitute(part, &number("0"), &formula.span);
    replaced.count(&|inner| inner == core) == 0
}

/// Returns whether a formula has sums, products, remainders, absolute values and choices alone, so that its value can be exact.
pub(super) fn has_no_function(formula: &Expression) -> bool {
    !formula.has(&is_function)
}

/// Returns whether a formula has no function of operands. Unlike [`has_no_function`], a constant such as `sqrt(2)` is allowed.
pub(super) fn has_no_function_of_operands(formula: &Expression) -> bool {
    formula.count(&|part| part.varies() && is_function(&part.kind)) == 0
}

/// Returns whether an operation is none of sums, products, remainders, absolute values and choices.
fn is_function(kind: &Kind) -> bool {
    match kind {
        Kind::Unary(function, _) => !matches!(function, Function::Negate | Function::Abs),
        Kind::Binary(operator, _, exponent) => match operator {
            Operator::Power => exponent.varies(),
            Operator::Div => exponent.varies(),
            Operator::Atan2 => true,
            _ => false,
        },
        _ => false,
    }
}

/// Returns whether a part is the absolute value of `core`.
pub(super) fn is_size_of(part: &Expression, core: &Expression) -> bool {
    matches!(&part.kind, Kind::Unary(Function::Abs, a) if **a == *core)
}

/// Returns whether `part` limits `core`: `part` is the minimum or the maximum of a constant and `core`, or of a constant and sums and
/// products of `core`. For example, the parts `max(0, x)` and `max(0, 1 - x)` limit x. The planner then lets a table read the
/// limited value, because a table over all values of x would be larger.
pub(super) fn is_limit_of(part: &Expression, core: &Expression) -> bool {
    let Kind::Binary(Operator::Min | Operator::Max, a, b) = &part.kind else { return false };
    let limited = match (a.varies(), b.varies()) {
        (true, false) => a,
        (false, true) => b,
        _ => return false,
    };
    products_of(limited, core).is_some()
}

/// Returns whether a formula is the logarithm of a constant times `core`.
pub(super) fn is_logarithm_of_multiple(formula: &Expression, core: &Expression) -> bool {
    let Kind::Unary(Function::Ln | Function::Log2, operand) = &formula.kind else { return false };
    let Kind::Binary(Operator::Mul | Operator::Div, a, b) = &operand.kind else { return false };
    **a == *core && !b.varies() || **b == *core && !a.varies()
}

/// Returns the cost of the multiplications that compute a formula from its core by sums, products, squares, minima and absolute
/// values. Returns `None` if these operations do not compute the formula. For example, `3 * x * (1 - x)` costs 3: 1 for the
/// product with a constant, and 2 for the product of two numbers.
pub(super) fn products_of(formula: &Expression, core: &Expression) -> Option<u32> {
    products_with(&mut HashMap::new(), formula, core)
}

/// Returns the cost of multiplications, as [`products_of`] does. A part that was seen before costs nothing; `known` has these
/// parts.
fn products_with(
    known: &mut HashMap<*const Expression, Option<u32>>,
    formula: &Expression,
    core: &Expression,
) -> Option<u32> {
    let place = ptr::from_ref(formula);
    if let Some(cost) = known.get(&place) {
        return *cost;
    }
    let cost = new_products(known, formula, core);
    known.insert(place, cost.map(|_| 0));
    cost
}

fn new_products(
    known: &mut HashMap<*const Expression, Option<u32>>,
    formula: &Expression,
    core: &Expression,
) -> Option<u32> {
    if formula == core {
        return Some(0);
    }
    let mut products_of = |part: &Expression, core: &Expression| products_with(known, part, core);
    if !formula.varies() {
        return Some(0);
    }
    match &formula.kind {
        Kind::Unary(Function::Negate | Function::Abs, a) => products_of(a, core),
        Kind::If(comparison, yes, no) => {
            let mut total = 0;
            for part in [&comparison.left, &comparison.right, yes, no] {
                total += products_of(part, core)?;
            }
            Some(total)
        }
        Kind::Binary(Operator::Sub, a, b) if let Some(dividend) = dividend_of_floor(a, b) => {
            Some(products_of(dividend, core)? + 1)
        }
        Kind::Binary(Operator::Add | Operator::Sub | Operator::Min | Operator::Max, a, b) => {
            Some(products_of(a, core)? + products_of(b, core)?)
        }
        Kind::Binary(operator @ (Operator::Mul | Operator::Div), a, b) => {
            let is_divisor_fixed = !b.varies();
            if *operator == Operator::Div && !is_divisor_fixed {
                return None;
            }
            let both = products_of(a, core)? + products_of(b, core)?;
            let factor = if is_divisor_fixed { b } else { a };
            let is_shift = !factor.varies() && power_of_two(factor, *operator).is_some();
            match (is_shift, operator) {
                (true, _) => Some(both),
                (false, Operator::Mul) if !factor.varies() => Some(both + 1),
                (false, Operator::Mul) => Some(both + PRODUCT),
                (false, _) => None,
            }
        }
        Kind::Binary(Operator::Mod, a, b) if modulus_exponent(b).is_some() && !rounds(a) => {
            products_of(a, core)
        }
        // A remainder by another constant is a product with its reciprocal.
        Kind::Binary(Operator::Mod, a, b) if dyadic(b).is_some() && !rounds(a) => {
            Some(products_of(a, core)? + 1)
        }
        Kind::Binary(Operator::Power, a, b) if **b == number("2") => {
            Some(products_of(a, core)? + PRODUCT)
        }
        _ => None,
    }
}

/// Returns p if `a - b` is the integer part of a sum or a product of p and rational constants, such as p / 3 + 1. Returns `None` for
/// other formulas.
fn dividend_of_floor<'f>(a: &'f Expression, b: &Expression) -> Option<&'f Expression> {
    floor_of(a, b).filter(|exponent| *exponent == 0)?;
    let dividend = without_constants(a);
    (dividend != a).then_some(dividend)
}

/// Returns the part of a formula that its sums, products and quotients with rational constants read: x in `x / 3 + 1`.
fn without_constants(formula: &Expression) -> &Expression {
    use Operator::{Add, Div, Mul, Sub};
    match &formula.kind {
        Kind::Binary(Add | Sub | Mul | Div, a, c) if c.rational().is_some() => without_constants(a),
        Kind::Binary(Add | Sub | Mul, c, a) if c.rational().is_some() => without_constants(a),
        _ => formula,
    }
}

/// Returns whether a formula has a constant that is rounded. For example, `0.3 * x` has one, and `0.75 * x` has none.
fn rounds(formula: &Expression) -> bool {
    formula.count(&|part| !part.varies() && dyadic(part).is_none()) > 0
}

/// Returns k if the divisor of a remainder is the constant 2^k, and `None` for any other divisor.
pub(super) fn modulus_exponent(divisor: &Expression) -> Option<i32> {
    if divisor.varies() { None } else { power_of_two(divisor, Operator::Mul) }
}

/// Returns k if `b` is the remainder of `a` by the constant 2^k, so that a − b is the greatest multiple of 2^k that is not above
/// a. For example, `floor(x)` is x − x % 1, which gives 0.
pub(super) fn floor_of(a: &Expression, b: &Expression) -> Option<i32> {
    match &b.kind {
        Kind::Binary(Operator::Mod, of, divisor) if **of == *a => modulus_exponent(divisor),
        _ => None,
    }
}

/// Returns the formula in `text`, which must be valid.
pub(super) fn number(text: &str) -> Expression {
    glint_formula::parse(text).expect("a formula")
}

/// Returns the exponent k if a multiplication by the constant `part`, or a division by it, equals a multiplication by 2^k. For
/// example, a division by 8 gives −3. Returns `None` for any other constant.
pub(super) fn power_of_two(part: &Expression, operator: Operator) -> Option<i32> {
    let (raw, frac) = dyadic(part)?;
    let is_power = raw > 0 && raw.count_ones() == 1;
    if !is_power {
        return None;
    }
    let exponent = raw.trailing_zeros() as i32 - frac;
    Some(if operator == Operator::Div { -exponent } else { exponent })
}
