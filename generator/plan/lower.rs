//! Rewrites the formulas of a statement as a plan, with given numbers of fraction bits.
//!
//! A part of a formula that is a function of one number becomes a table of polynomials. The number can be the value of another
//! part: `sqrt(x^2 + y^2)` is the square root of the number `x^2 + y^2`. Sums, products, and functions that a few products
//! compute become separate operations. The folder `lower` has rewritings of other functions, such as powers and sines.

mod choice;
mod direction;
mod division;
mod divisor;
mod errors;
mod exponential;
mod nearest;
mod projected;
mod quotient;
mod rational;
mod result;
mod root;
mod shape;
mod table;
mod wave;
mod whole_line;
mod whole_root;

pub(crate) use quotient::fewest_dividends;
pub(crate) use table::has_functions_of_operands;

use std::cell::RefCell;
use std::mem;
use std::rc::Rc;
use std::sync::Arc;

use glint_approximate::{Piecewise, SharedWidths, TargetFunction};
use glint_base::fixed::{Rounding, exp2, nearest};
use glint_formula::{Comparison, Enclosure, Expression, Function, Kind, Operator};

use super::boxes::has_few_operands;
use super::constant::dyadic;
use super::facts::has_fact;
use super::guarded::GuardedFormula;
use super::memo::FormulaMemo;
use super::memory::TableMemory;
use super::node::{NodeId, Operation, PlanNode, StatedValue, ValueAccuracy};
use super::order;
use super::plan::{ExpressionPlan, PlanBuilder};
use super::projection;
use super::range::RangeMemo;
use super::refusal::PlanRefusal;
use super::statement::ExpressionStatement;
use super::uses::{PartUses, reads_under};
use errors::ErrorMemo;
use rational::{
    QuotientParts, ceiling_of, floor_of_quotient, rational_quotient, with_single_division,
};
use shape::{
    core_of, floor_of, has_no_function_of_operands, modulus_exponent, number, power_of_two,
    products_of,
};
use table::is_short_operand;
use whole_root::WholeRoot;

/// The widest operand of a table of polynomials, in bits. A wider one is shortened first.
const WIDEST_OPERAND: u32 = 20;

/// The widest factor of a product, in bits. A wider factor, which is the result of a product itself, is shortened first.
const WIDEST_FACTOR: u32 = 18;

/// The largest cost of products at which a function of one number is computed by products instead of a table.
const MOST_PRODUCTS: u32 = 3;

/// If the largest value of a part is at least this times the smallest, a root or a logarithm of the part is computed octave by
/// octave, even as a part of another function.
const MANY_OCTAVES: f64 = 16.0;

/// The widest number whose square is exact, in bits. A wider one is shortened first, because its square, or a sum of such squares,
/// would have more bits than a net.
const WIDEST_EXACT_SQUARE: u32 = 30;

/// A quotient is computed with a reciprocal if the result has no more bits than this.
const WIDEST_RATIO: i32 = 28;

/// The numbers of fraction bits and the choices with which formulas are rewritten as a plan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Guards {
    /// For each rounding operation of the plan, in order, its guard bits: the number of fraction bits that it has beyond the
    /// finest result. The number may be negative.
    pub(super) bits: Vec<i32>,
    /// The choices that apply to the whole plan.
    pub(super) style: PlanStyle,
}

/// Choices that the planner makes for a whole plan. The planner tries several choices, and takes the smallest plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlanStyle {
    /// The error that a table of polynomials may have, in units of the last bit of its result.
    pub(super) table_error: f64,
    /// Whether a shortened fraction of a normalised word is the middle of all values with the same upper bits. Otherwise the
    /// low bits are dropped.
    pub(super) centres_fractions: bool,
    /// Whether a function of an operand is a single table, which may have a range reduction. Otherwise the function is
    /// rewritten. For example, a square root is then computed from the octave of its operand.
    pub(super) keeps_functions: bool,
    /// The least number of quotients by the same divisor for which the reciprocal of the divisor is computed once.
    pub(super) fewest_dividends: usize,
    /// Whether the low bits of products in front of sums are dropped as early as other bits. Otherwise they are dropped when all other
    /// operations have their widths.
    pub(super) cuts_terms_early: bool,
    /// Whether factors that are wider than a multiplier's input give bits to other operations.
    pub(super) narrows_factors: bool,
    /// Whether the tables of the plan are pages of a table that several functions share. All normalised words then have the same
    /// bits, so that no choice is needed in front of the table.
    pub(super) shares_table: bool,
}

impl Guards {
    /// Makes guards for this style, without bits for any operation.
    pub(super) fn new(style: PlanStyle) -> Self {
        Self { bits: Vec::new(), style }
    }

    /// Gives the rounding operation number `place` one more fraction bit. If the list has no entry for the operation, the
    /// function first appends entries of 0.
    pub(super) fn add_bit(&mut self, place: usize) {
        if place >= self.bits.len() {
            self.bits.resize(place + 1, 0);
        }
        self.bits[place] += 1;
    }
}

/// Functions of a plan with their polynomials.
#[derive(Clone, Debug, Default)]
pub(super) struct FoundPolynomials(Vec<(TargetFunction, Arc<Piecewise>)>);

impl FoundPolynomials {
    /// Adds the polynomials of a function.
    pub(super) fn insert(&mut self, function: &TargetFunction, polynomials: Arc<Piecewise>) {
        self.0.push((function.clone(), polynomials));
    }

    /// Returns the polynomials for exactly this function, with its domain and its formats, or `None`.
    fn get(&self, function: &TargetFunction) -> Option<Arc<Piecewise>> {
        let found = self.0.iter().find(|(own, _)| own == function);
        found.map(|(_, polynomials)| polynomials.clone())
    }
}

/// The polynomials of a function, or the reason why there are none.
type SearchResult = Result<Arc<Piecewise>, PlanRefusal>;

/// The results of searches for polynomials, so that each function is searched once. A search takes most of the time of a plan.
#[derive(Default)]
pub(super) struct PolynomialMemo {
    known: RefCell<Vec<(TargetFunction, SearchResult)>>,
}

impl PolynomialMemo {
    /// Returns the result of `search` for this function. Calls `search` only for a function without a known result. Fails if
    /// `search` does.
    pub(super) fn found(
        &self,
        function: &TargetFunction,
        search: impl FnOnce(&TargetFunction) -> SearchResult,
    ) -> SearchResult {
        if let Some((_, found)) = self.known.borrow().iter().find(|(own, _)| own == function) {
            return found.clone();
        }
        let found = search(function);
        self.known.borrow_mut().push((function.clone(), found.clone()));
        found
    }
}

/// A part of a formula that has a node.
struct KnownPart {
    part: Expression,
    node: NodeId,
    /// The uses for which the node has the right value.
    uses: PartUses,
    /// Whether the node has limits that follow from the conditions of these uses alone.
    is_limited: bool,
}

/// The guard bits of the roundings in an estimate.
#[derive(Clone, Copy)]
struct FixedGuard {
    /// The guard bits that each rounding has beyond the finest result.
    guard: i32,
    /// The integer bits of the estimate. A factor gets as many further fraction bits, because its relative error counts; a number
    /// that is as large as the estimate does not.
    value_bits: i32,
}

/// The state of the rewriting of formulas as a plan.
pub(super) struct Lowering<'s> {
    statement: &'s ExpressionStatement,
    ties: WidthTies,
    memo: &'s PartMemo,
    guards: &'s Guards,
    first_guard: i32,
    found: &'s FoundPolynomials,
    plan: PlanBuilder,
    /// The parts of formulas that already have a node.
    known: Vec<KnownPart>,
    /// The uses of the part that is being rewritten.
    uses: PartUses,
    /// The tables that sines and cosines of the same angle share.
    octants: Vec<wave::OctantWaves>,
    /// The divisors whose reciprocals several quotients share.
    divisors: Vec<quotient::KnownDivisor>,
    /// The number of rounding operations so far.
    sources: usize,
    /// The numbers of the rounding operations that drop low bits of products.
    terms: Vec<usize>,
    /// The guard bits of roundings within a computation whose result is corrected, so that the planner does not choose them.
    fixed_guard: Option<FixedGuard>,
    /// The largest number of fraction bits among the results.
    finest: i32,
}

/// A statement for which a plan is searched. The memos hold results that do not depend on the widths, so that all attempts share
/// them.
pub(super) struct PlanSearch<'s> {
    pub(super) statement: &'s ExpressionStatement,
    pub(super) tables: TableRule,
    pub(super) ties: WidthTies,
    pub(super) polynomials: Rc<PolynomialMemo>,
    pub(super) memory: TableMemory,
    memo: PartMemo,
}

/// Facts about parts of the formulas that do not depend on the widths in a plan.
#[derive(Default)]
struct PartMemo {
    ranges: RangeMemo,
    errors: ErrorMemo,
    /// The uses of a part, by the uses of the formula around it.
    uses: FormulaMemo<PartUses, PartUses>,
    /// Whether conditions state limits of a part, by its uses.
    has_fact: FormulaMemo<PartUses, bool>,
    functions: table::FunctionRanges,
}

/// The rounding operations that have the same number of guard bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum WidthTies {
    /// Each operation has guard bits of its own.
    None,
    /// Operations with the same name, apart from the number at its end, such as `exponent` and `exponent2`. An expression with many
    /// operands mostly has the same parts for each element of a list, and the search is then shorter.
    Named,
    /// Operations with the same name. The same constant is also rounded to the same width wherever it is a factor, so that the numbers of
    /// a list are computed by the same operations.
    Alike,
}

/// How the planner finds the polynomials of the functions in a plan.
#[derive(Clone, Debug)]
pub(super) enum TableRule {
    /// The polynomials with the fewest look-up tables by the estimate.
    Cheapest,
    /// Polynomials of degree 2 with these widths. A function that has no such polynomials has the cheapest.
    Shared(SharedWidths),
}

impl<'s> PlanSearch<'s> {
    /// Makes a search in which operations with the same name have the same widths if there are more than 3 operands.
    pub(super) fn new(statement: &'s ExpressionStatement, tables: TableRule) -> Self {
        let ties = match has_few_operands(statement) {
            true => WidthTies::None,
            false => WidthTies::Named,
        };
        let polynomials = Rc::default();
        let memory = TableMemory::Logic;
        Self { statement, tables, ties, polynomials, memory, memo: PartMemo::default() }
    }
}

/// A statement, rewritten as a plan.
pub(super) struct LoweredStatement {
    pub(super) plan: ExpressionPlan,
    /// The number of rounding operations.
    pub(super) sources: usize,
    /// The numbers of the rounding operations that drop low bits of products in front of a sum or a comparison. They cost nothing, and the
    /// sums become narrower.
    pub(super) terms: Vec<usize>,
}

/// Returns the plan of a statement. Rounding operation number i gets the guard bits `guards.bits[i]`, or `first_guard` if the
/// list is shorter. Only the functions in `found` get polynomials; the errors of other tables are estimates.
///
/// # Errors
/// Fails if no rule computes a part of a formula, or if a part has too many bits or no finite values.
pub(super) fn lowered(
    search: &PlanSearch<'_>,
    guards: &Guards,
    first_guard: i32,
    found: &FoundPolynomials,
) -> Result<LoweredStatement, PlanRefusal> {
    let statement = search.statement;
    let finest = statement.results.iter().map(|result| result.fraction as i32).max();
    let mut lowering = Lowering {
        statement,
        ties: search.ties,
        memo: &search.memo,
        guards,
        first_guard,
        found,
        plan: PlanBuilder::new(search.memory),
        known: Vec::new(),
        uses: PartUses::default(),
        octants: Vec::new(),
        divisors: Vec::new(),
        sources: 0,
        terms: Vec::new(),
        fixed_guard: None,
        finest: finest.unwrap_or(0),
    };
    for (number, operand) in statement.operands.iter().enumerate() {
        let node = lowering.plan.operand(number, &operand.name, operand.format, operand.domain)?;
        let uses =
            PartUses { readers: vec![true; statement.results.len()], conditions: Vec::new() };
        let part = Expression::operand(&operand.name);
        lowering.known.push(KnownPart { part, node, uses, is_limited: false });
    }
    for number in 0..statement.results.len() {
        let of_result = |refusal: PlanRefusal| refusal.of_result(number);
        let mut readers = vec![false; statement.results.len()];
        readers[number] = true;
        lowering.uses = PartUses { readers, conditions: Vec::new() };
        let rounded = lowering.result(number).map_err(of_result)?;
        let proved = lowering.saturated(number, rounded).map_err(of_result)?;
        let node = lowering.in_stated_width(number, proved).map_err(of_result)?;
        lowering.plan.add_result(node, proved);
    }
    let plan = lowering.plan.finish()?;
    Ok(LoweredStatement { plan, sources: lowering.sources, terms: lowering.terms })
}

impl<'s> Lowering<'s> {
    /// Returns an interval that contains the values of a part, for all operands for which a result depends on it. Fails if the
    /// values have no finite limits.
    fn range(&self, part: &Expression) -> Result<Enclosure, PlanRefusal> {
        let uses = self.uses_of(part);
        let range = self.memo.ranges.range_of(self.statement, &uses, part);
        range.map_err(|error| error.refusal(self.statement, part))
    }

    /// Returns the interval of a part for the part that is being rewritten alone, while [`Self::range`] counts all readers. Fails
    /// if the values have no finite limits.
    fn range_here(&self, part: &Expression) -> Result<Enclosure, PlanRefusal> {
        let range = self.memo.ranges.range_of(self.statement, &self.uses, part);
        range.map_err(|error| error.refusal(self.statement, part))
    }

    /// Returns the uses of `part` within the part that is being rewritten. Results that read `part` in the same cases of choices
    /// count as readers, so that they can share its node. They do not count if `part` would then lose limits that the condition
    /// of the present result states.
    fn uses_of(&self, part: &Expression) -> PartUses {
        self.memo.uses.value(part, &self.uses, || self.new_uses_of(part))
    }

    fn new_uses_of(&self, part: &Expression) -> PartUses {
        let mut uses = self.uses.clone();
        for (reads, result) in uses.readers.iter_mut().zip(&self.statement.results) {
            *reads |= reads_under(&result.formula, part, &self.uses.conditions);
        }
        let has_fact = |uses: &PartUses| has_fact(self.statement, uses, part);
        if uses != self.uses && has_fact(&self.uses) && !has_fact(&uses) {
            return self.uses.clone();
        }
        uses
    }

    /// Calls `make`, which rewrites parts that matter only where the comparison has the outcome `outcome`, and returns its
    /// result.
    fn under<T>(
        &mut self,
        comparison: &Comparison,
        outcome: bool,
        make: impl FnOnce(&mut Self) -> T,
    ) -> T {
        self.uses.conditions.push((comparison.clone(), outcome));
        let made = make(self);
        self.uses.conditions.pop();
        made
    }

    /// Chooses a number of fraction bits, and returns the node that `make` adds with this number. The number is `frac` plus the
    /// guard bits of the next rounding operation. The operation is counted even if `make` rounds nothing, so that later
    /// operations keep their numbers. Fails if `make` fails.
    fn rounding(
        &mut self,
        frac: i32,
        make: impl FnOnce(&mut Self, i32) -> Result<NodeId, PlanRefusal>,
    ) -> Result<NodeId, PlanRefusal> {
        if let Some(FixedGuard { guard, value_bits }) = self.fixed_guard {
            return make(self, frac + guard + value_bits);
        }
        let source = self.sources;
        self.sources += 1;
        let guard = self.guards.bits.get(source).copied().unwrap_or(self.first_guard);
        let before = self.plan.so_far().nodes().len();
        let node = make(self, frac + guard)?;
        if node.0 >= before {
            self.plan.state_source(node, Some(source));
        }
        Ok(node)
    }

    /// Returns the node of a part of a formula. Adds the node and all nodes that it reads if the part has no node. Fails if the
    /// plan cannot compute a part. The refusal has the location of the part.
    fn part(&mut self, part: &Expression) -> Result<NodeId, PlanRefusal> {
        let uses = self.uses_of(part);
        let has_fact = || has_fact(self.statement, &uses, part);
        let is_limited = self.memo.has_fact.value(part, &uses, has_fact)
            || order::has_limits(part, &self.whole_domain());
        let same = self.known_part(part, is_limited).or_else(|| self.known_part(part, false));
        if let Some(known) = same
            && known.is_limited == is_limited
        {
            return Ok(known.node);
        }
        let unlimited = same.map(|known| known.node);
        let outer = mem::replace(&mut self.uses, uses);
        let node = match unlimited {
            Some(node) => Ok(node),
            None => self.new_part(part),
        };
        let node = node.and_then(|node| match is_limited {
            true => self.limited_by_facts(part, node),
            false => Ok(node),
        });
        let uses = mem::replace(&mut self.uses, outer);
        let node = node.map_err(|refusal| refusal.at(&part.span))?;
        self.known.push(KnownPart { part: part.clone(), node, uses, is_limited });
        Ok(node)
    }

    /// Returns the known node of `part` that has the right value for the present uses. With `is_limited`, it must have limits
    /// from conditions, and the present uses must give no narrower limits; otherwise it has no such limits.
    fn known_part(&self, part: &Expression, is_limited: bool) -> Option<&KnownPart> {
        self.known.iter().find(|known| {
            known.is_limited == is_limited
                && known.part == *part
                && known.uses.contain(&self.uses)
                && (!is_limited || self.has_same_range(known))
        })
    }

    /// Returns whether the interval of a known part is the same for its uses and for the present uses, or one of these is not
    /// known.
    fn has_same_range(&self, known: &KnownPart) -> bool {
        if known.uses.conditions == self.uses.conditions {
            return true;
        }
        let known_range = self.memo.ranges.range_of(self.statement, &known.uses, &known.part);
        match (known_range, self.range(&known.part)) {
            (Ok(known_range), Ok(range)) => known_range == range,
            _ => true,
        }
    }

    /// Returns the operands with the limits of their domains.
    fn whole_domain(&self) -> Vec<(&str, Enclosure)> {
        self.statement.enclosed_operands(&self.statement.domain())
    }

    /// Returns a node for `part` with the value of `node` and narrower limits. They follow from the conditions of the uses of
    /// `part`, or from a maximum in it. Copies `node` if it is rounded. Fails if the part has no finite values.
    fn limited_by_facts(&mut self, part: &Expression, node: NodeId) -> Result<NodeId, PlanRefusal> {
        if !self.is_exact(node) {
            let limits = order::limits(part, &self.whole_domain());
            if !limits.low.is_finite() && !limits.high.is_finite() {
                return Ok(node);
            }
            // A table for the node covers the values of the whole domain, which can have narrower limits than the maximum states.
            let range = self.range(part)?;
            let limits = Enclosure::between(limits.low.max(range.low), limits.high.min(range.high));
            // The rounded value can lie beyond the limits, so that only the exact value has them.
            let own = self.plan.node(node).clone();
            let copy = PlanNode { limits, source: None, stated: None, deviation: 0.0, ..own };
            return Ok(self.plan.push_copy(&copy, Operation::Scale(node)));
        }
        let limits = self.range(part)?;
        if self.is_promised_alone() && !self.plan.is_narrower(node, limits) {
            self.plan.state_limits(node, limits);
            return Ok(node);
        }
        let name = format!("{}_guarded", self.plan.node(node).name);
        self.plan.limited(&name, node, limits)
    }

    /// Returns whether all results have the same condition, and no choice limits the present uses. The value of every node then
    /// matters only for operands that satisfy this condition.
    fn is_promised_alone(&self) -> bool {
        let mut promises = self.statement.results.iter().map(|result| &result.promise);
        let first = promises.next();
        self.uses.conditions.is_empty() && promises.all(|promise| Some(promise) == first)
    }

    /// Returns the stated value of a node that computes `part` for `uses` alone.
    fn stated(&self, part: &Expression, uses: &PartUses, accuracy: ValueAccuracy) -> StatedValue {
        let formula = Arc::new(GuardedFormula::new(self.statement, uses, part));
        StatedValue { formula, accuracy }
    }

    fn new_part(&mut self, part: &Expression) -> Result<NodeId, PlanRefusal> {
        if !part.varies() {
            return self.number(part);
        }
        if let Some(quotient) = projection::multiplied_quotient(&part.kind) {
            return self.part(&quotient);
        }
        if let Some(node) = self.projection_with_rounded_constants(part)? {
            return Ok(node);
        }
        if let Some(single) = with_single_division(part)
            && let Ok(node) = self.part(&single)
        {
            return Ok(node);
        }
        if let Some(rewritten) = whole_line::with_remainder(part) {
            return self.part(&rewritten);
        }
        if has_no_function_of_operands(part) && part.count(&whole_line::is_irrational_division) > 0
        {
            return self.operation(part);
        }
        let core = core_of(part);
        if products_of(part, core).is_some_and(|products| products <= MOST_PRODUCTS) || core == part
        {
            return self.operation(part);
        }
        let has_remainder = part.has(&|kind| matches!(kind, Kind::Binary(Operator::Mod, ..)));
        let has_whole_root = has_remainder && part.count(&whole_root::is_whole_root) > 0;
        let is_kept = self.guards.style.keeps_functions
            && is_short_operand(self.statement, core)
            && !has_whole_root;
        let core = match has_remainder || is_kept {
            true => core.clone(),
            false => self.table_operand(part, core)?,
        };
        if products_of(part, &core).is_some_and(|products| products <= MOST_PRODUCTS) {
            return self.operation(part);
        }
        if has_remainder && rational_quotient(&core).is_some_and(|it| Self::is_exact_quotient(&it))
        {
            // The integer part of a quotient is exact; a table would read a rounded quotient.
            return self.operation(part);
        }
        if !has_whole_root && self.can_be_one_table(part, &core)? {
            return self.function_of(part, &core);
        }
        match &part.kind {
            Kind::Unary(Function::Negate | Function::Abs, _) => self.operation(part),
            Kind::Unary(_, argument) => self.function_of(part, argument),
            _ => self.operation(part),
        }
    }

    /// Returns the node of a function for which a rewriting exists: a scaled direction, a power, a sine or a cosine, a logarithm,
    /// or an exponential function. `function` is the part `part` in which `x` replaces `core`. Returns `None` for any other
    /// function. Fails if the plan cannot compute a part.
    fn rewritten(
        &mut self,
        part: &Expression,
        core: &Expression,
        function: &Expression,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        if let Some(node) = self.scaled_direction(core, function)? {
            return Ok(Some(node));
        }
        if let Some(power) = root::power_of(function)
            && let Some(node) = self.power(part, core, function, power)?
        {
            return Ok(Some(node));
        }
        if let Some(node) = self.wave(core, function)? {
            return Ok(Some(node));
        }
        if let Some(node) = self.logarithm(core, function)? {
            return Ok(Some(node));
        }
        self.exponential(core, function)
    }

    /// Returns the node of a constant. A constant with few bits is exact, and any other constant is rounded. Fails if the
    /// constant is not a finite number.
    fn number(&mut self, part: &Expression) -> Result<NodeId, PlanRefusal> {
        if let Some((raw, frac)) = dyadic(part) {
            return self.plan.constant("constant", raw, frac);
        }
        let fault =
            |message: String| PlanRefusal::new(message, "write a finite number").at(&part.span);
        let finest = self.finest;
        self.rounding(finest + 2, |own, frac| {
            let value = part.enclose(&[]).map_err(|it| fault(it.message))?;
            let raw = nearest(value.middle() * exp2(frac)) as i128;
            own.plan.rounded_constant("constant", raw, frac, value)
        })
    }

    /// Returns the node of an operation whose inputs are parts of the formula. Fails if the plan cannot compute a part.
    fn operation(&mut self, part: &Expression) -> Result<NodeId, PlanRefusal> {
        match &part.kind {
            Kind::Operand(name) => Err(PlanRefusal::new(
                format!("there is no operand `{name}`"),
                "name an operand, or a part of [let]",
            )),
            Kind::Unary(Function::Negate, a) => {
                let a = self.part(a)?;
                self.plan.negate("negated", a)
            }
            Kind::Unary(Function::Abs, a) => {
                let a = self.part(a)?;
                self.plan.absolute("size", a)
            }
            Kind::Binary(operator, a, b) => self.binary(*operator, a, b, part),
            Kind::If(comparison, yes, no) => self.choice(comparison, yes, no),
            _ => Err(PlanRefusal::new(
                "Glint cannot compute this function of several operands",
                "write the function with one argument, which can be a sum, a product or a quotient",
            )),
        }
    }

    fn binary(
        &mut self,
        operator: Operator,
        a: &Arc<Expression>,
        b: &Arc<Expression>,
        part: &Expression,
    ) -> Result<NodeId, PlanRefusal> {
        match operator {
            Operator::Div if b.varies() => self.quotient(a, b, part),
            Operator::Atan2 => self.direction(a, b, &direction::Scaling::none()),
            Operator::Power if **b == number("2") => {
                let node = self.part(a)?;
                let is_wide = self.plan.node(node).format.width() > WIDEST_EXACT_SQUARE;
                let root = if is_wide { self.factor(a)? } else { node };
                self.plan.multiply("square", root, root)
            }
            Operator::Power => {
                self.range(part)?;
                let power = exponential::written_with_logarithm(a, b, &part.span);
                if self.range(a)?.low != 0.0 || self.range(b)?.low < 0.0 {
                    return self.part(&power);
                }
                // The logarithm of 0 has no value. The power of 0 is 0 for an exponent above 0, and 1 for the exponent 0.
                let is_positive = |part: &Expression| Comparison {
                    left: Arc::new(part.clone()),
                    right: Arc::new(number("0")),
                    or_equal: false,
                };
                let powers = [number("0"), number("1")].map(Arc::new);
                let [zero, one] = powers;
                let kind = Kind::If(is_positive(b), zero, one);
                let of_zero = Expression::new(kind, part.span.clone());
                self.choice(&is_positive(a), &power, &of_zero)
            }
            Operator::Mod
                if !b.varies()
                    && let Some(quotient) = rational_quotient(a)
                    && Self::is_exact_quotient(&quotient) =>
            {
                self.remainder_of_quotient(&quotient, b, part)
            }
            Operator::Mod if modulus_exponent(b).is_some() => {
                let [_, fraction] = self.division(a, modulus_exponent(b).unwrap_or(0))?;
                Ok(fraction)
            }
            Operator::Mod => {
                if whole_line::is_irrational_remainder(part)
                    && let Some(node) = self.remainder_of_line(a, b, part)?
                {
                    return Ok(node);
                }
                let [_, remainder] = self.whole_quotient(a, b, &part.span)?;
                Ok(remainder)
            }
            Operator::Mul | Operator::Div => {
                let factor = [a, b].into_iter().find(|it| !it.varies());
                let exponent = factor.and_then(|factor| power_of_two(factor, operator));
                if let (Some(exponent), Some(factor)) = (exponent, factor) {
                    let other = if std::ptr::eq(factor, a) { b } else { a };
                    let other = self.part(other)?;
                    return self.plan.scale("scaled", other, exponent);
                }
                let b = match operator {
                    Operator::Div => reciprocal_of(b),
                    _ => (**b).clone(),
                };
                let a = self.factor(a)?;
                let b = self.factor(&b)?;
                self.plan.multiply("product", a, b)
            }
            Operator::Add if let Some(QuotientParts { dividend, divisor }) = ceiling_of(a, b) => {
                // The ceiling of x is minus the floor of −x.
                let [whole, _] = self.whole_quotient(&dividend, &divisor, &part.span)?;
                self.plan.negate("ceiling", whole)
            }
            Operator::Add => {
                let (a, b) = (self.term(a)?, self.term(b)?);
                self.plan.add("sum", a, b)
            }
            Operator::Sub
                if let Some(QuotientParts { dividend, divisor }) = floor_of_quotient(a, b) =>
            {
                let [whole, _] = self.whole_quotient(&dividend, &divisor, &part.span)?;
                Ok(whole)
            }
            Operator::Sub if let Some(exponent) = floor_of(a, b) => {
                if let Some(root) = WholeRoot::of_difference(a, b)
                    && let Some(node) = self.whole_root(&root, part)?
                {
                    return Ok(node);
                }
                if whole_line::is_irrational_division(part)
                    && let Some(node) = self.whole_of_line(a, part)?
                {
                    return Ok(node);
                }
                let [whole, _] = self.division(a, exponent)?;
                Ok(whole)
            }
            Operator::Sub => {
                let (a, b) = (self.term(a)?, self.term(b)?);
                self.plan.subtract("difference", a, b)
            }
            Operator::Max | Operator::Min
                if let Some(node) = self.limited_quotient(operator, a, b)? =>
            {
                Ok(node)
            }
            Operator::Min => {
                let (a, b) = (self.term(a)?, self.term(b)?);
                self.plan.minimum("smaller", a, b)
            }
            Operator::Max => {
                let (a, b) = (self.term(a)?, self.term(b)?);
                self.plan.maximum("larger", a, b)
            }
        }
    }

    /// Returns the node of a term of a sum, or of a number that is compared. If the term is a product of rounded numbers, its low
    /// bits are dropped: they would make the sum and all that follows wider. Fails if the plan cannot compute a part.
    fn term(&mut self, part: &Expression) -> Result<NodeId, PlanRefusal> {
        let node = self.part(part)?;
        self.short_term(node)
    }

    /// Returns the node of a term without the low bits that [`Self::term`] drops. Fails if a node has too many bits.
    fn short_term(&mut self, node: NodeId) -> Result<NodeId, PlanRefusal> {
        let product = match self.plan.node(node).operation {
            Operation::Scale(product) => product,
            _ => node,
        };
        let is_product = matches!(self.plan.node(product).operation, Operation::Multiply(..));
        if !is_product || self.is_exact(node) || self.fixed_guard.is_some() {
            return Ok(node);
        }
        self.terms.push(self.sources);
        self.rounding(self.finest, |own, frac| {
            own.plan.shorten("term", node, frac, Rounding::Truncate)
        })
    }

    /// Returns the node of a factor of a product, shortened if it has more bits than a multiplier takes. Fails if the plan cannot
    /// compute a part.
    fn factor(&mut self, part: &Expression) -> Result<NodeId, PlanRefusal> {
        let node = self.part(part)?;
        let format = self.plan.node(node).format;
        self.rounding(self.finest, |own, frac| {
            let is_constant = own.ties == WidthTies::Alike && !part.varies();
            if format.width() <= WIDEST_FACTOR || is_constant {
                return Ok(node);
            }
            own.plan.shorten("factor", node, frac, Rounding::Nearest)
        })
    }
}

fn reciprocal_of(divisor: &Expression) -> Expression {
    let one = Arc::new(number("1"));
    let kind = Kind::Binary(Operator::Div, one, Arc::new(divisor.clone()));
    Expression::new(kind, divisor.span.clone())
}
