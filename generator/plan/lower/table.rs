//! Rewrites a function of one number as a table of polynomials.

use glint_approximate::{Curve, Outside, TargetFunction};
use glint_base::fixed::{Format, exp2};
use glint_formula::{Enclosure, Expression, Kind, Operator, RBig};

use super::shape::{
    core_of, dominators, is_limit_of, is_logarithm_of_multiple, is_size_of, products_of,
};
use super::{Lowering, MANY_OCTAVES, MOST_PRODUCTS, WIDEST_OPERAND, exponential, root, shape};
use crate::memo::FormulaMemo;
use crate::node::{Approximation, NodeId};
use crate::range::LIMIT_THE_OPERANDS;
use crate::refusal::PlanRefusal;
use crate::statement::ExpressionStatement;

/// The number of parts of a domain in which the values of a function are enclosed.
const PIECES: i64 = 64;

/// A value above this number may be due to interval arithmetic alone.
const LARGE_VALUE: f64 = 1e6;

/// The most parts that are halved because interval arithmetic shows no limits of the values in them, or only large ones.
const MOST_HALVINGS: usize = 1000;

impl Lowering<'_> {
    /// Returns the part of `part` whose value a table reads: `core`, or a part that dominates it. A table over the values of `core`
    /// would be large where a part is limited, or where a root, a reciprocal or a logarithm spans octaves. For example,
    /// `sqrt(max(0, x)) + 3` gives `sqrt(max(0, x))`. Fails if a part has no finite values.
    pub(super) fn table_operand(
        &mut self,
        part: &Expression,
        core: &Expression,
    ) -> Result<Expression, PlanRefusal> {
        let mut operand = core.clone();
        let inner = dominators(part, core);
        for (at, dominator) in inner.iter().enumerate() {
            if is_limit_of(dominator, &operand) {
                operand = (*dominator).clone();
            } else if is_size_of(dominator, &operand) {
                // A root or a logarithm of an absolute value is computed octave by octave.
                let mut outer = inner[at + 1..].iter().chain([&part]);
                if outer.any(|outer| {
                    is_singular(outer, dominator) || is_logarithm_of_multiple(outer, dominator)
                }) {
                    operand = (*dominator).clone();
                }
            }
        }
        loop {
            if is_singular(part, &operand) {
                // The whole part is computed octave by octave.
                return Ok(operand);
            }
            let mut widest = None;
            for dominator in dominators(part, &operand) {
                let is_sum = products_of(dominator, &operand).is_some();
                if self.spans_octaves(dominator, &operand)?
                    || is_sum && self.spans_octaves(part, dominator)?
                {
                    widest = Some(dominator.clone());
                }
            }
            match widest {
                Some(dominator) => operand = dominator,
                None => return Ok(operand),
            }
        }
    }

    /// Returns whether `part` is singular at 0 as a function of `core`, and the values of `core` span several octaves. Fails if
    /// `core` has no finite values.
    fn spans_octaves(&self, part: &Expression, core: &Expression) -> Result<bool, PlanRefusal> {
        if !is_singular(part, core) {
            return Ok(false);
        }
        let values = self.range(core)?;
        Ok(values.low >= 0.0 && values.high >= values.low * MANY_OCTAVES)
    }

    /// Returns whether a table over the values of `core` can compute `part`. It cannot if a case of a choice has no value outside
    /// its condition, as in `if(x > 0, ln(x), -8)`, or if a remainder jumps and the core is too wide for a table. Fails if the
    /// plan cannot compute the core.
    pub(super) fn can_be_one_table(
        &mut self,
        part: &Expression,
        core: &Expression,
    ) -> Result<bool, PlanRefusal> {
        let has_choice = part.has(&|kind| matches!(kind, Kind::If(..)));
        let has_remainder = part.has(&|kind| matches!(kind, Kind::Binary(Operator::Mod, ..)));
        if !has_choice && !has_remainder {
            return Ok(true);
        }
        let node = self.part(core)?;
        let format = self.plan.node(node).format;
        if has_remainder && format.width() > WIDEST_OPERAND {
            return Ok(false);
        }
        let function = part.substitute(core, &Expression::operand("x"), &part.span);
        let domain = self.raw_domain(node, self.range(core)?, 0.0);
        Ok(self.function_range(&function, format, domain).is_some())
    }

    /// Returns the node of `part`, which is a function of the value of `core` alone, by a rewriting or by a table. Fails if the
    /// plan cannot compute a part.
    pub(super) fn function_of(
        &mut self,
        part: &Expression,
        core: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        let function = part.substitute(core, &Expression::operand("x"), &part.span);
        let is_kept = self.guards.style.keeps_functions && is_short_operand(self.statement, core);
        if !is_kept && let Some(node) = self.rewritten(part, core, &function)? {
            return Ok(node);
        }
        let node = self.part(core)?;
        let range = self.range(core)?;
        let format = self.plan.node(node).format;
        if let Kind::Binary(Operator::Div, a, b) = &part.kind
            && b.varies()
            && self.function_range(&function, format, self.raw_domain(node, range, 0.0)).is_none()
        {
            // A condition excludes the divisor 0 between the smallest and the largest divisor.
            return self.quotient(a, b, part);
        }
        let node = self.rounding(format.frac.min(self.finest), |own, frac| {
            if format.width() <= WIDEST_OPERAND {
                return Ok(node);
            }
            own.plan.shorten_for_table("operand", node, frac)
        })?;
        self.function("curve", node, &function, range)
    }

    /// Returns the node of a function of `node`, computed by polynomials. `range` must contain the values of `node` for all
    /// operands for which a result is promised. Fails if `node` has only one value, or if the function is not finite for some
    /// value.
    pub(super) fn function(
        &mut self,
        name: &str,
        node: NodeId,
        function: &Expression,
        range: Enclosure,
    ) -> Result<NodeId, PlanRefusal> {
        if range.low == range.high
            && let Some(value) = function_of_number(function, range.low)
        {
            return self.number(&value);
        }
        // The node may differ from its exact value by the roundings before it.
        let slack = if self.is_exact(node) { 0.0 } else { self.largest_error(node) };
        let (node, domain) = self.within_domain(node, function, range, slack)?;
        let (first, last) = domain;
        if last <= first {
            return Err(PlanRefusal::new(
                "this part has only one value",
                "write the value as a number",
            ));
        }
        let finest = self.finest;
        self.rounding(finest + 2, |own, frac| {
            let frac = frac.max(own.least_table_fraction(0));
            own.approximation(name, node, function, domain, frac)
        })
    }

    /// Returns the raw domain of a table for `function`, and a node whose values lie in it. The value of `node` lies in `range` in
    /// real-number arithmetic, and in hardware up to `slack` units beyond. If the function has no value beyond an end of `range`, for
    /// example below 0 for a root, this end replaces the node's values beyond it. Fails if a node has too many bits.
    fn within_domain(
        &mut self,
        node: NodeId,
        function: &Expression,
        range: Enclosure,
        slack: f64,
    ) -> Result<(NodeId, (i64, i64)), PlanRefusal> {
        let operand = self.plan.node(node).format;
        let [wide, narrow] = [slack, 0.0].map(|slack| self.raw_domain(node, range, slack));
        let mut domains = [wide, (narrow.0, wide.1), (wide.0, narrow.1)].into_iter();
        let has_values =
            |domain: &(i64, i64)| self.function_range(function, operand, *domain).is_some();
        let domain = domains.find(has_values).unwrap_or(narrow);
        let (first, last) = domain;
        let unit = exp2(-operand.frac);
        let mut within = node;
        if first > wide.0 {
            let least = self.plan.constant("least", first.into(), operand.frac)?;
            within = self.plan.maximum("not_below", within, least)?;
            // The end is a raw value, and may lie above the smallest real value.
            self.plan.state_deviation(within, excess(first as f64 * unit, range.low));
        }
        if last < wide.1 {
            let most = self.plan.constant("most", last.into(), operand.frac)?;
            within = self.plan.minimum("not_above", within, most)?;
            self.plan.state_deviation(within, excess(range.high, last as f64 * unit));
        }
        Ok((within, domain))
    }

    /// Returns the smallest number of fraction bits of a table whose value is divided by 2 to the power of `places` before it is a result.
    /// In a unit, every result from a table is rounded, so that the functions give the same bits to the adder that rounds. A table of its
    /// own may also give the result itself, with no bit to round.
    pub(super) fn least_table_fraction(&self, places: i32) -> i32 {
        match self.guards.style.shares_table {
            true => self.finest + 1 + places,
            false => i32::MIN,
        }
    }

    /// Returns what [`function_range`] returns.
    fn function_range(
        &self,
        function: &Expression,
        operand: Format,
        domain: (i64, i64),
    ) -> Option<Enclosure> {
        let compute = || function_range(function, operand, domain);
        self.memo.functions.value(function, &(operand, domain), compute)
    }

    /// Returns the first and the last raw value that `node` can have if its exact value lies within `range`, and differs from the
    /// node by at most `slack` units.
    fn raw_domain(&self, node: NodeId, range: Enclosure, slack: f64) -> (i64, i64) {
        let node = self.plan.node(node);
        let unit = exp2(node.format.frac);
        let (low, high) = node.range;
        let first = ((range.low * unit - slack).ceil() as i128).max(low);
        let last = ((range.high * unit + slack).floor() as i128).min(high);
        (first as i64, last as i64)
    }

    /// Adds a function of `node` with `frac` fraction bits, for the raw values of `node` in `domain`, and returns the new node.
    /// Fails if the function is not finite on the domain.
    pub(super) fn approximation(
        &mut self,
        name: &str,
        node: NodeId,
        function: &Expression,
        domain: (i64, i64),
        frac: i32,
    ) -> Result<NodeId, PlanRefusal> {
        let operand = self.plan.node(node).format;
        let fraction = u32::try_from(frac).unwrap_or(0);
        let target = TargetFunction {
            curve: Curve::Formula(function.clone()),
            domain,
            operand,
            outside: Outside::Anything,
            fraction,
            error: self.guards.style.table_error,
        };
        let values = self.function_range(function, operand, domain).ok_or_else(|| {
            let [from, to] = [domain.0, domain.1].map(|raw| operand.to_f64(raw.into()));
            let formula = function.python();
            let message = format!(
                "this is not finite, or has no value, for some of the operands: {formula} for x from {from} to {to}"
            );
            PlanRefusal::new(message, LIMIT_THE_OPERANDS)
        })?;
        let unit = exp2(fraction as i32);
        let values = (
            (values.low * unit - target.error).floor() as i128,
            (values.high * unit + target.error).ceil() as i128,
        );
        let polynomials = self.found.get(&target);
        let approximation = Approximation { function: target, polynomials };
        self.plan.polynomial(name, node, approximation, values)
    }
}

/// Returns whether `part` is a logarithm, a root or a reciprocal of `core`, or a product of roots and reciprocals. None of these has a
/// finite slope at 0.
fn is_singular(part: &Expression, core: &Expression) -> bool {
    let function = part.substitute(core, &Expression::operand("x"), &part.span);
    root::power_of(&function).is_some_and(|power| power.is_singular())
        || exponential::factor_of_logarithm(&function).is_some()
}

/// Returns whether a part is an operand with few enough bits for a table.
pub(super) fn is_short_operand(statement: &ExpressionStatement, part: &Expression) -> bool {
    let Kind::Operand(name) = &part.kind else { return false };
    let mut operands = statement.operands.iter();
    operands.any(|operand| operand.name == *name && operand.format.width() <= WIDEST_OPERAND)
}

/// Returns whether a formula of the statement has a function of a single operand that is not computed by a few products. For
/// example, `sqrt(x) * y` has one.
pub(crate) fn has_functions_of_operands(statement: &ExpressionStatement) -> bool {
    let is_function = |part: &Expression| {
        let core = core_of(part);
        let is_by_products =
            products_of(part, core).is_some_and(|products| products <= MOST_PRODUCTS);
        is_short_operand(statement, core) && !is_by_products
    };
    statement.results.iter().any(|result| result.formula.count(&is_function) > 0)
}

/// Returns a function of x with a number in place of x. Returns `None` if the number is not finite.
fn function_of_number(function: &Expression, number: f64) -> Option<Expression> {
    let value = RBig::try_from(number).ok()?;
    let value = shape::number(&value.to_string());
    Some(function.substitute(&Expression::operand("x"), &value, &function.span))
}

/// Returns an upper limit of a − b, and 0 if a is not above b.
fn excess(a: f64, b: f64) -> f64 {
    if a > b { (a - b).next_up() } else { 0.0 }
}

/// The limits of functions of x, by the format and the raw domain of x ([`function_range`]).
pub(super) type FunctionRanges = FormulaMemo<(Format, (i64, i64)), Option<Enclosure>>;

/// Returns limits of the values of a function of x over the raw domain. Returns `None` if the limits are not finite.
///
/// A part of the domain in which interval arithmetic shows no limits, or only large ones, is halved, down to single operands:
/// `sqrt(2 * x - x^2)` has a value for 2, and none for an interval about 2.
fn function_range(function: &Expression, operand: Format, domain: (i64, i64)) -> Option<Enclosure> {
    let (first, last) = domain;
    let length = i128::from(last - first);
    let end = |at: i64| first + (length * i128::from(at) / i128::from(PIECES)) as i64;
    let mut open: Vec<(i64, i64)> = (0..PIECES).map(|at| (end(at), end(at + 1))).collect();
    let mut total: Option<Enclosure> = None;
    let mut halvings = 0;
    while let Some((from, to)) = open.pop() {
        let x = Enclosure::between(operand.to_f64(from.into()), operand.to_f64(to.into()));
        let value = function.enclose(&[("x", x)]).ok().filter(|value| value.is_finite());
        let is_large = value.is_none_or(|value| value.high.max(-value.low) > LARGE_VALUE);
        if is_large && from < to && halvings < MOST_HALVINGS {
            halvings += 1;
            let middle = from + (to - from) / 2;
            open.extend([(from, middle), (middle + 1, to)]);
            continue;
        }
        let value = value?;
        total = Some(total.map_or(value, |total| total.hull(value)));
    }
    total
}
