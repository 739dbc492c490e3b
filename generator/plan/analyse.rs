//! Encloses the error of the nodes of a plan for all operands in a box, which has an interval of values for each operand.
//!
//! The *ideal* of a node contains its value in real-number arithmetic, if every choice and every shift is decided as in the
//! hardware. The *error* contains the hardware's value minus the ideal value: the error that follows from the inputs, plus the
//! rounding of the operation. For example, a product a · b has the error a · εb + b · εa + εa · εb. The analysis treats each
//! possible shift of a normalised word separately, with the word limited to the values that have this shift.

use glint_base::fixed::{Format, Rounding, exp2};
use glint_formula::Enclosure;

use super::node::{
    Approximation, CaseAgreement, NodeId, Operation, PlanNode, StatedValue, ValueAccuracy, middle,
    normalising_shifts,
};
use super::plan::ExpressionPlan;

/// The largest number of integer parts that are analysed one by one.
const MOST_INTEGERS: i64 = 70;

/// If a plan has several normalised words, the branches of a word with more octaves than this end at its join ([`joins`]).
const FEW_OCTAVES: u32 = 4;

/// The limits of a node's value and of its error, for all operands within a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeError {
    /// Contains the value in real-number arithmetic.
    pub(super) ideal: Enclosure,
    /// Contains the hardware's value minus the ideal value.
    pub(super) error: Enclosure,
    /// Contains the hardware's value.
    pub(super) actual: Enclosure,
}

/// A factor that exceeds 1 by more than the roundings of a few operations in `f64`.
const ROUNDED_UP: f64 = 1.0 + 1e-12;

const NOTHING: Enclosure = Enclosure::exactly(0.0);
const ANYTHING: Enclosure = Enclosure::between(f64::NEG_INFINITY, f64::INFINITY);

/// The reason why no error can be stated for a box. The box must be divided.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Undecided {
    /// The node whose error has no limit.
    pub(super) node: NodeId,
    /// The reason, as a phrase about the node. For example, `its value has no limit`.
    pub(super) what: &'static str,
}

impl NodeError {
    fn new(ideal: Enclosure, error: Enclosure) -> Self {
        Self { ideal, error, actual: ideal + error }
    }

    fn exactly(ideal: Enclosure) -> Self {
        Self { ideal, error: NOTHING, actual: ideal }
    }

    /// The value of a node without limits. The value does not matter if a choice takes its other case.
    const UNKNOWN: Self = Self { ideal: ANYTHING, error: ANYTHING, actual: ANYTHING };

    /// Returns these limits for an ideal value that is up to `distance` from the present one, because constants of the formula
    /// were rounded before. The distance adds to the error only if `counts` is true.
    fn near(self, distance: f64, counts: bool) -> Self {
        let around = Enclosure::between(-distance, distance);
        let error = if counts { self.error + around } else { self.error };
        Self { ideal: self.ideal + around, error, actual: self.actual }
    }

    /// Returns whether the value and its error have limits.
    pub(super) fn is_limited(self) -> bool {
        self.ideal.is_finite() && self.error.is_finite()
    }

    /// Returns the hull of two values, for example of two branches of the analysis.
    fn hull(self, other: Self) -> Self {
        Self {
            ideal: self.ideal.hull(other.ideal),
            error: self.error.hull(other.error),
            actual: self.actual.hull(other.actual),
        }
    }

    /// Returns narrower limits, for a caller that knows that `limits` contain the ideal value.
    fn within(self, limits: Enclosure) -> Self {
        let low = self.ideal.low.max(limits.low);
        let high = self.ideal.high.min(limits.high);
        if low > high {
            return self;
        }
        let ideal = Enclosure::between(low, high);
        Self { ideal, ..self }.limited(ideal + self.error)
    }

    /// Returns narrower limits, for a caller that knows that `limits` contain the hardware's value.
    fn limited(self, limits: Enclosure) -> Self {
        let low = self.actual.low.max(limits.low);
        let high = self.actual.high.min(limits.high);
        // Rounding may have made the limits empty; then the earlier limits are kept.
        if low > high { self } else { Self { actual: Enclosure::between(low, high), ..self } }
    }

    /// Returns the ideal value if it has no error and is the same for the whole box; otherwise `None`.
    fn known(self) -> Option<f64> {
        let is_known = self.error == NOTHING && self.ideal.low == self.ideal.high;
        is_known.then_some(self.ideal.low)
    }
}

/// A function that takes the values of all nodes in one branch of the analysis, and the first node without limits.
type Visit<'v> = dyn FnMut(&[NodeError], Option<&Undecided>) + 'v;

/// The limits of the nodes that were analysed so far.
#[derive(Clone)]
struct Known {
    values: Vec<NodeError>,
    undecided: Option<Undecided>,
}

/// The analysis of the errors of a plan.
///
/// The analysis has a branch for each value of an integer part, and for each shift of a normalised word. With several integer
/// parts, or several words with many shifts, the numbers of branches would multiply. The branches of one node therefore end at
/// its join ([`joins`]), so that the numbers only add up.
#[derive(Clone, Copy)]
pub(super) struct ErrorAnalysis<'p> {
    pub(super) plan: &'p ExpressionPlan,
    /// For each node, whether its value is needed. The other nodes get the value 0.
    pub(super) needed: &'p [bool],
    /// For each node, the node at which the branches of its values end ([`joins`]).
    pub(super) joins: &'p [Option<NodeId>],
    /// The only rounding operation whose error counts, by its number; `None` if all errors count.
    pub(super) only: Option<usize>,
}

/// Returns the join of each integer part: the first later node on all paths from the integer part to `result`, at which its
/// branches end. Branches need a join only if `result` depends on several integer parts; normalised words are treated alike. The
/// entry is `None` for the other nodes, and if the paths meet only in `result`. `needed` must mark the nodes on which `result`
/// depends.
pub(super) fn joins(plan: &ExpressionPlan, needed: &[bool], result: NodeId) -> Vec<Option<NodeId>> {
    let count = |is: fn(&Operation) -> bool| -> Vec<usize> {
        (0..plan.nodes().len())
            .filter(|at| needed[*at] && is(&plan.nodes()[*at].operation))
            .collect()
    };
    let integers = count(|operation| matches!(operation, Operation::IntegerPart(_)));
    let words = count(|operation| matches!(operation, Operation::Normalise { .. }));
    let mut branching = Vec::new();
    for nodes in [integers, words] {
        if nodes.len() > 1 {
            branching.extend(nodes);
        }
    }
    let mut joins = vec![None; plan.nodes().len()];
    if branching.is_empty() {
        return joins;
    }
    // For each node, the first later node that is on all paths from it to the result.
    let mut next: Vec<Option<usize>> = vec![None; plan.nodes().len()];
    let mut is_on_a_way = vec![false; plan.nodes().len()];
    is_on_a_way[result.0] = true;
    for at in (0..=result.0).rev() {
        if !is_on_a_way[at] || !needed[at] {
            continue;
        }
        let operation = &plan.nodes()[at].operation;
        // A branch of a word decides whether the word is 0.
        let branching = match operation {
            Operation::NonZero(word) => normalised_words(plan, *word),
            _ => Vec::new(),
        };
        for input in [operation.inputs(), branching].concat() {
            next[input.0] = match is_on_a_way[input.0] {
                false => Some(at),
                true => common_way(&next, next[input.0], Some(at)),
            };
            is_on_a_way[input.0] = true;
        }
    }
    // The branches of these nodes have values that later nodes must know, so that none of them joins others.
    let branches = |node: usize| {
        let operation = &plan.nodes()[node].operation;
        matches!(
            operation,
            Operation::Normalise { .. } | Operation::Places(_) | Operation::IntegerPart(_)
        )
    };
    for node in branching {
        let mut join = next[node];
        while let Some(at) = join.filter(|at| branches(*at)) {
            join = next[at];
        }
        joins[node] = join.filter(|join| *join != result.0).map(NodeId);
    }
    joins
}

fn normalised_words(plan: &ExpressionPlan, word: NodeId) -> Vec<NodeId> {
    let normalises = |node: &PlanNode| matches!(node.operation, Operation::Normalise { word: own, .. } if own == word);
    (0..plan.nodes().len()).filter(|at| normalises(&plan.nodes()[*at])).map(NodeId).collect()
}

/// Returns `known` with the further nodes of an analysis; their limits are the hull of all branches. `run` must visit each
/// branch. Returns `None` if `run` visits no branch.
fn joined(known: &Known, run: impl FnOnce(&mut Visit<'_>)) -> Option<Known> {
    let mut all: Option<Known> = None;
    let before = known.values.len();
    run(&mut |values, undecided| match &mut all {
        None => {
            let mut joined = known.clone();
            joined.values.extend_from_slice(&values[before..]);
            joined.undecided = undecided.cloned();
            all = Some(joined);
        }
        Some(joined) => {
            for (joined, value) in joined.values[before..].iter_mut().zip(&values[before..]) {
                *joined = joined.hull(*value);
            }
            joined.undecided = joined.undecided.take().or_else(|| undecided.cloned());
        }
    });
    all
}

/// Returns the first node at which the paths from `first` and `second` to the result meet, or `None` if they do not meet. `next`
/// has the next node on each node's path.
fn common_way(
    next: &[Option<usize>],
    mut first: Option<usize>,
    mut second: Option<usize>,
) -> Option<usize> {
    loop {
        match (first, second) {
            (Some(a), Some(b)) if a == b => return first,
            (Some(a), Some(b)) if a < b => first = next[a],
            (Some(_), Some(b)) => second = next[b],
            _ => return None,
        }
    }
}

impl ErrorAnalysis<'_> {
    /// Calls `visit` with the values of all nodes, once for each combination of shifts and integer parts that can occur.
    /// `operands` has the limits of the operands' values.
    pub(super) fn run(&self, operands: &[(&str, Enclosure)], visit: &mut Visit<'_>) {
        let values = Vec::with_capacity(self.plan.nodes().len());
        let known = Known { values, undecided: None };
        self.run_from(known, self.plan.nodes().len(), operands, visit);
    }

    /// Analyses the nodes that `known` lacks, up to the node before `end`, and calls `visit` for each branch.
    fn run_from(
        &self,
        mut known: Known,
        end: usize,
        operands: &[(&str, Enclosure)],
        visit: &mut Visit<'_>,
    ) {
        while known.values.len() < end {
            let id = NodeId(known.values.len());
            let node = self.plan.node(id);
            let inputs = node.operation.inputs();
            let is_choice = matches!(node.operation, Operation::Choose { .. });
            let is_unknown = |input: &NodeId| !known.values[input.0].is_limited();
            if !self.needed[id.0] {
                known.values.push(NodeError::exactly(NOTHING));
            } else if !node.has_stated_error() && !is_choice && inputs.iter().any(is_unknown) {
                known.values.push(NodeError::UNKNOWN);
            } else if let Operation::Normalise { word, by_pairs } = node.operation {
                let join = self.joins[id.0].filter(|join| join.0 + 1 < end);
                match join.filter(|_| self.has_many_octaves(word, &known.values)) {
                    None => return self.each_shift(word, by_pairs, &known, end, operands, visit),
                    Some(join) => {
                        let all = joined(&known, |visit| {
                            let end = join.0 + 1;
                            self.each_shift(word, by_pairs, &known, end, operands, visit);
                        });
                        let Some(all) = all else { return };
                        known = all;
                    }
                }
            } else if let Operation::IntegerPart(a) = node.operation
                && let Some(integers) = self.integers(a, &known.values)
            {
                match self.joins[id.0].filter(|join| join.0 + 1 < end) {
                    None => return self.each_integer(a, integers, &known, end, operands, visit),
                    Some(join) => {
                        let all = joined(&known, |visit| {
                            self.each_integer(a, integers, &known, join.0 + 1, operands, visit);
                        });
                        let Some(all) = all else { return };
                        known = all;
                    }
                }
            } else {
                match self.value(id, &known.values, operands) {
                    Ok(value) => known.values.push(value),
                    Err(undecided) => {
                        known.undecided.get_or_insert(undecided);
                        known.values.push(NodeError::UNKNOWN);
                    }
                }
            }
        }
        visit(&known.values, known.undecided.as_ref());
    }

    /// Continues the analysis after the node that normalises `word`, once for each shift that the word can have.
    fn each_shift(
        &self,
        word: NodeId,
        by_pairs: bool,
        known: &Known,
        end: usize,
        operands: &[(&str, Enclosure)],
        visit: &mut Visit<'_>,
    ) {
        let format = self.plan.node(word).format;
        let shifts = normalising_shifts(format.width(), by_pairs);
        let all_places: u32 = shifts.iter().sum();
        let actual = known.values[word.0].actual;
        let (low, high) = raw_limits(actual, format);
        let step = if by_pairs { 2 } else { 1 };
        if low <= 0 {
            // A word of zeros stays 0, and its shift has the largest number of bits.
            let mut branch = known.clone();
            self.limit(&mut branch.values, word, NOTHING);
            branch.values.push(NodeError::exactly(NOTHING));
            let places = Enclosure::exactly(f64::from(all_places / step));
            self.with_places(branch, places, end, operands, visit);
        }
        let mut places = 0;
        while places < format.width() {
            // The words whose top `places` bits are 0, and whose next `step` bits are not all 0.
            let above = 1i128 << (format.width() - places);
            let least = (above >> step).max(1);
            places += step;
            if high < least || low >= above {
                continue;
            }
            let shift = places - step;
            let octave = Enclosure::between(
                format.to_f64(least.max(low)),
                format.to_f64((above - 1).min(high)),
            );
            let mut branch = known.clone();
            self.limit(&mut branch.values, word, octave);
            // The bits of the word become a fraction with as many bits.
            let factor = exp2(shift as i32 + format.frac - format.width() as i32);
            let NodeError { ideal, error, actual } = branch.values[word.0];
            branch.values.push(NodeError {
                ideal: scaled(ideal, factor),
                error: scaled(error, factor),
                actual: scaled(actual, factor),
            });
            let count = Enclosure::exactly(f64::from(shift / step));
            self.with_places(branch, count, end, operands, visit);
        }
    }

    /// Returns the smallest and the largest integer part that the value of a node can have. Returns `None` if there are more
    /// than 70 such integers.
    fn integers(&self, id: NodeId, values: &[NodeError]) -> Option<(i64, i64)> {
        let actual = values[id.0].actual;
        let (first, last) = (actual.low.floor() as i64, actual.high.floor() as i64);
        (last - first < MOST_INTEGERS).then_some((first, last))
    }

    /// Continues the analysis after an integer part, once for each value that the integer part can have.
    fn each_integer(
        &self,
        id: NodeId,
        (first, last): (i64, i64),
        known: &Known,
        end: usize,
        operands: &[(&str, Enclosure)],
        visit: &mut Visit<'_>,
    ) {
        let unit = exp2(-self.plan.node(id).format.frac);
        for integer in first..=last {
            let mut branch = known.clone();
            let limits = Enclosure::between(integer as f64, integer as f64 + 1.0 - unit);
            self.limit(&mut branch.values, id, limits);
            branch.values.push(NodeError::exactly(Enclosure::exactly(integer as f64)));
            self.run_from(branch, end, operands, visit);
        }
    }

    /// Returns whether a word can have so many shifts that the branches of two words would take too long.
    fn has_many_octaves(&self, word: NodeId, values: &[NodeError]) -> bool {
        let (low, high) = raw_limits(values[word.0].actual, self.plan.node(word).format);
        high.max(1) >> FEW_OCTAVES > low.max(1)
    }

    /// Continues the analysis after a normalised word, which is the last value of `branch`. The next node is the number of bits
    /// of its shift, with the value `places`.
    fn with_places(
        &self,
        mut branch: Known,
        places: Enclosure,
        end: usize,
        operands: &[(&str, Enclosure)],
        visit: &mut Visit<'_>,
    ) {
        branch.values.push(NodeError::exactly(places));
        self.run_from(branch, end, operands, visit);
    }

    /// Narrows the limits of a node to hardware values within `limits`, which a branch assumes. Also narrows inputs where this
    /// follows: for example, the inputs of a maximum below 2 are below 2.
    fn limit(&self, values: &mut [NodeError], id: NodeId, limits: Enclosure) {
        let NodeError { ideal, error, .. } = values[id.0];
        let within = limits - error;
        let low = ideal.low.max(within.low);
        let high = ideal.high.min(within.high);
        if low > high {
            return;
        }
        let ideal = Enclosure::between(low, high);
        let before = values[id.0];
        values[id.0] = NodeError { ideal, error, actual: before.actual }.limited(limits);
        match self.plan.node(id).operation {
            Operation::Maximum(a, b) => {
                for input in [a, b] {
                    self.limit(values, input, Enclosure::between(f64::NEG_INFINITY, limits.high));
                }
            }
            Operation::Absolute(a) => {
                self.limit(values, a, Enclosure::between(-limits.high, limits.high));
            }
            Operation::Narrow(a, _)
                if self.plan.node(a).format.frac <= self.plan.node(id).format.frac =>
            {
                self.limit(values, a, limits);
            }
            _ => {}
        }
    }

    /// Returns the limits of the value and of the error of a node, computed from the limits of the nodes that the operation
    /// reads. Fails if the box is too large for limits and must be divided.
    fn value(
        &self,
        id: NodeId,
        values: &[NodeError],
        operands: &[(&str, Enclosure)],
    ) -> Result<NodeError, Undecided> {
        let node = self.plan.node(id);
        if node.has_stated_error() {
            let value = stated_value(node, operands);
            return value.ok_or(Undecided { node: id, what: "its value has no limit" });
        }
        let input = |id: NodeId| values[id.0];
        let own_errors = node.source.is_none() || self.only.is_none() || self.only == node.source;
        let value = match &node.operation {
            Operation::Operand(number) => NodeError::exactly(operands[*number].1),
            Operation::Constant { raw, value } => {
                let own = Enclosure::exactly(node.format.to_f64(*raw)) - *value;
                NodeError::new(*value, if own_errors { own } else { NOTHING })
            }
            Operation::Add(a, b) => {
                let (a, b) = (input(*a), input(*b));
                NodeError::new(a.ideal + b.ideal, a.error + b.error)
            }
            Operation::Subtract(a, b) => {
                let (a, b) = (input(*a), input(*b));
                NodeError::new(a.ideal - b.ideal, a.error - b.error)
            }
            Operation::Multiply(a, b) => product(input(*a), input(*b), a == b),
            Operation::Absolute(a) => absolute(input(*a)),
            Operation::Minimum(a, b) => minimum(input(*a), input(*b)),
            Operation::Maximum(a, b) => negated(minimum(negated(input(*a)), negated(input(*b)))),
            Operation::Less(a, b) => {
                let (a, b) = (input(*a), input(*b));
                let is_less = |a: Enclosure, b: Enclosure| bit(a.high < b.low, a.low >= b.high);
                let is_exact = a.error == NOTHING && b.error == NOTHING;
                condition(is_less(a.ideal, b.ideal), is_less(a.actual, b.actual), is_exact)
            }
            Operation::NonZero(a) => {
                let is_nonzero = |a: Enclosure| bit(a.low > 0.0 || a.high < 0.0, a == NOTHING);
                let a = input(*a);
                condition(is_nonzero(a.ideal), is_nonzero(a.actual), a.error == NOTHING)
            }
            Operation::Choose { condition, cases } => {
                let apart = self.distance_of_cases(node, *condition, values, operands);
                let value = chosen(*condition, *cases, apart, values);
                match value.is_limited() {
                    true => value,
                    false => taken_case(node, values, operands).unwrap_or(value),
                }
            }
            Operation::Scale(a) => {
                let factor = exp2(self.plan.node(*a).format.frac - node.format.frac);
                let NodeError { ideal, error, .. } = input(*a);
                NodeError::new(scaled(ideal, factor), scaled(error, factor))
            }
            Operation::Narrow(a, rounding) => {
                let places = self.plan.node(*a).format.frac - node.format.frac;
                let NodeError { ideal, error, .. } = input(*a);
                let own = if own_errors {
                    rounding_error(places, node.format, *rounding)
                } else {
                    NOTHING
                };
                NodeError::new(ideal, error + own)
            }
            Operation::Middle(a) => {
                let NodeError { ideal, error, .. } = input(*a);
                let half = exp2(-node.format.frac);
                let least = exp2(-self.plan.node(*a).format.frac);
                let own = if own_errors { Enclosure::between(least - half, half) } else { NOTHING };
                NodeError::new(ideal, error + own)
            }
            Operation::Bit(a, number) => {
                let value = match input(*a).known() {
                    Some(integer) => Enclosure::exactly(((integer as i64) >> number & 1) as f64),
                    None => bit(false, false),
                };
                return Ok(NodeError::exactly(value));
            }
            Operation::Normalise { .. } | Operation::Places(_) => {
                unreachable!("each_shift gives the values of these nodes")
            }
            Operation::IntegerPart(a) => {
                let a = input(*a);
                if a.error != NOTHING {
                    return Err(Undecided {
                        node: id,
                        what: "its integer part has too many values",
                    });
                }
                NodeError::exactly(Enclosure::between(a.ideal.low.floor(), a.ideal.high.floor()))
            }
            Operation::FractionPart(a, integer) => {
                let (a, integer) = (input(*a), input(*integer));
                if a.error == NOTHING && integer.known().is_none() {
                    // The integer part has more values than are analysed one by one.
                    let most = 1.0 - exp2(-node.format.frac);
                    return Ok(NodeError::exactly(Enclosure::between(0.0, most)));
                }
                let value = NodeError::new(a.ideal - integer.ideal, a.error);
                let most = 1.0 - exp2(-node.format.frac);
                value.limited(Enclosure::between(0.0, most)).limited(a.actual - integer.ideal)
            }
            Operation::ShiftLeft(a, places) => {
                let factor = exp2(known_places(id, input(*places))?);
                let NodeError { ideal, error, .. } = input(*a);
                NodeError::new(scaled(ideal, factor), scaled(error, factor))
            }
            Operation::ShiftRight(a, places) => {
                let places = known_places(id, input(*places))?;
                let factor = exp2(-places);
                let NodeError { ideal, error, .. } = input(*a);
                let own = rounding_error(places, node.format, Rounding::Truncate);
                let own = if own_errors { own } else { NOTHING };
                NodeError::new(scaled(ideal, factor), scaled(error, factor) + own)
            }
            Operation::Reverse(a) => {
                if input(*a).error != NOTHING {
                    let what = "its bits depend on rounding errors";
                    return Err(Undecided { node: id, what });
                }
                let (least, most) = node.format.range();
                let [least, most] = [least, most].map(|raw| node.format.to_f64(raw));
                NodeError::exactly(Enclosure::between(least, most))
            }
            Operation::Lookup { address, words } => {
                let value = |raw: &i128| Enclosure::exactly(node.format.to_f64(*raw));
                let known = input(*address).known();
                let limits = match known.and_then(|place| words.get(place as usize)) {
                    Some(word) => value(word),
                    None => words.iter().map(value).reduce(Enclosure::hull).unwrap_or(NOTHING),
                };
                NodeError::exactly(limits)
            }
            Operation::Polynomial(a, approximation) => {
                approximated(id, approximation, input(*a), own_errors)?
            }
        };
        if !value.is_limited() {
            return Err(Undecided { node: id, what: "its value has no limit" });
        }
        if matches!(node.operation, Operation::Less(..) | Operation::NonZero(_)) {
            return Ok(value);
        }
        let value = match node.deviation {
            0.0 => value,
            distance => value.near(distance, own_errors),
        };
        let value = value.within(node.limits).limited(self.actual(node, values));
        let value = value.limited(node.actual_limits);
        // The format of a result can represent all values within the allowed error, so its error shows whether the value fits.
        let drops_bits = match node.operation {
            Operation::ShiftLeft(..) => true,
            Operation::Narrow(..) | Operation::Middle(_) => !self.plan.proved().contains(&id),
            _ => false,
        };
        if drops_bits {
            check_fit(id, value, node.format)?;
        }
        Ok(value)
    }

    /// Returns limits of the difference between the cases of `choice`, for operands for which rounding makes the hardware take
    /// another case than the formula. The compared numbers then differ at most by their errors. The limits are infinite if the
    /// choice states no `CaseAgreement`.
    fn distance_of_cases(
        &self,
        choice: &PlanNode,
        condition: NodeId,
        values: &[NodeError],
        operands: &[(&str, Enclosure)],
    ) -> Enclosure {
        let Some(CaseAgreement { slope, scale }) = &choice.agreement else { return ANYTHING };
        let Operation::Less(a, b) = self.plan.node(condition).operation else { return ANYTHING };
        let off = values[a.0].error - values[b.0].error;
        let distance = off.high.max(-off.low);
        let Some(scale) = scale.values(operands).filter(|scale| scale.low > 0.0) else {
            return ANYTHING;
        };
        let most = slope * distance / scale.low * ROUNDED_UP;
        if most.is_finite() { Enclosure::between(-most, most) } else { ANYTHING }
    }

    /// Returns limits of the hardware's value of a node that follow from the hardware's values of its inputs alone.
    fn actual(&self, node: &PlanNode, values: &[NodeError]) -> Enclosure {
        let input = |id: NodeId| values[id.0].actual;
        // If the operands have single values, so has each rounding error, which may be 0 by chance. A share counts the largest
        // possible error.
        let shortened = |before: NodeId, after: Enclosure| {
            if self.only.is_none() {
                return after;
            }
            let unit = exp2(-node.format.frac);
            let [least, most] =
                [node.format.min_raw(), node.format.max_raw()].map(|raw| node.format.to_f64(raw));
            let before = input(before);
            Enclosure::between((before.low - unit).max(least), (before.high + unit).min(most))
        };
        match node.operation {
            Operation::Constant { raw, .. } => Enclosure::exactly(node.format.to_f64(raw)),
            Operation::Choose { condition, cases } => {
                let [zero, one] = cases.map(input);
                match fixed(input(condition)) {
                    Some(0.0) => zero,
                    Some(_) => one,
                    None => zero.hull(one),
                }
            }
            Operation::Add(a, b) => input(a) + input(b),
            Operation::Subtract(a, b) => input(a) - input(b),
            Operation::Multiply(a, b) if a == b => squared(input(a)),
            Operation::Multiply(a, b) => input(a) * input(b),
            Operation::Minimum(a, b) => {
                let (a, b) = (input(a), input(b));
                Enclosure::between(a.low.min(b.low), a.high.min(b.high))
            }
            Operation::Maximum(a, b) => {
                let (a, b) = (input(a), input(b));
                Enclosure::between(a.low.max(b.low), a.high.max(b.high))
            }
            Operation::Narrow(a, rounding) => {
                let before = self.plan.node(a).format;
                let places = before.frac - node.format.frac;
                if places <= 0 {
                    return input(a);
                }
                let (low, high) = raw_limits(input(a), before);
                let [low, high] = [low, high].map(|raw| rounding.shift(raw, places));
                let after = Enclosure::between(node.format.to_f64(low), node.format.to_f64(high));
                shortened(a, after)
            }
            // A shift keeps the sign.
            Operation::ShiftLeft(a, _) | Operation::ShiftRight(a, _) | Operation::Scale(a)
                if input(a).low >= 0.0 =>
            {
                Enclosure::between(0.0, f64::INFINITY)
            }
            Operation::Middle(a) => {
                let before = self.plan.node(a).format;
                let places = before.frac - node.format.frac;
                let (low, high) = raw_limits(input(a), before);
                let [low, high] = [low, high].map(|raw| node.format.to_f64(middle(raw, places)));
                shortened(a, Enclosure::between(low, high))
            }
            // The table was computed for every operand, so that its format is known. Without a sign, no value is below 0.
            Operation::Polynomial(_, ref approximation)
                if approximation.polynomials.is_some() && !node.format.signed =>
            {
                Enclosure::between(0.0, f64::INFINITY)
            }
            _ => ANYTHING,
        }
    }
}

/// Returns the limits of a choice.
///
/// If rounding can change the condition, the hardware may take another case than the formula. The error then includes the
/// difference between the two cases, which `most_apart` limits.
fn chosen(
    condition: NodeId,
    cases: [NodeId; 2],
    most_apart: Enclosure,
    values: &[NodeError],
) -> NodeError {
    let within = |apart: Enclosure| {
        let apart = apart.hull(NOTHING);
        Enclosure::between(apart.low.max(most_apart.low), apart.high.min(most_apart.high))
    };
    let [zero, one] = cases.map(|case| values[case.0]);
    let condition = values[condition.0];
    // If nothing was rounded before the condition, the hardware decides like the formula.
    let decides_alike = condition.error == NOTHING;
    let ideal = zero.ideal.hull(one.ideal);
    let Some(bit) = fixed(condition.actual) else {
        let mut error = zero.error.hull(one.error);
        if !decides_alike {
            let apart = zero.ideal - one.ideal;
            error = error + within(apart.hull(-apart));
        }
        return NodeError::new(ideal, error);
    };
    let (taken, other) = if bit == 0.0 { (zero, one) } else { (one, zero) };
    if decides_alike || fixed(condition.ideal) == Some(bit) {
        return taken;
    }
    NodeError::new(ideal, taken.error + within(taken.ideal - other.ideal))
}

/// Returns the limits of a node that computes its stated formula exactly, or rounded to the nearest value. Returns `None` for a
/// node of another accuracy, or if the formula has no finite value for some operands.
fn stated_value(node: &PlanNode, operands: &[(&str, Enclosure)]) -> Option<NodeError> {
    let StatedValue { formula, accuracy } = node.stated.as_ref()?;
    let ideal = formula.values(operands).filter(|value| value.is_finite())?;
    let half = exp2(-node.format.frac) / 2.0;
    Some(match accuracy {
        ValueAccuracy::Nearest => NodeError::new(ideal, Enclosure::between(-half, half)),
        ValueAccuracy::Exact => NodeError::exactly(ideal),
        ValueAccuracy::FromInputs => return None,
    })
}

/// Returns the limits of a choice for a box in which the hardware takes a known case. The stated formula of the node gives the
/// ideal value, for a choice whose other case has no limits. Returns `None` if the node has no such formula, if the case is not
/// known, or if this case or the formula has no limits.
fn taken_case(
    node: &PlanNode,
    values: &[NodeError],
    operands: &[(&str, Enclosure)],
) -> Option<NodeError> {
    let Operation::Choose { condition, cases } = &node.operation else { return None };
    let bit = fixed(values[condition.0].actual)?;
    let taken = values[cases[bit as usize].0];
    let stated = node.stated.as_ref()?;
    let ideal = stated.formula.values(operands).filter(|value| value.is_finite())?;
    let is_known = taken.actual.is_finite();
    is_known.then(|| NodeError { ideal, error: taken.actual - ideal, actual: taken.actual })
}

/// Returns the interval of a bit: 1 if `is_one`, 0 if `is_zero`, and 0 to 1 if the box decides neither.
fn bit(is_one: bool, is_zero: bool) -> Enclosure {
    let low = if is_one { 1.0 } else { 0.0 };
    let high = if is_zero { 0.0 } else { 1.0 };
    Enclosure::between(low, high)
}

/// Returns the limits of a condition, from the limits of the bit in the formula and of the bit in the hardware. `is_exact` must
/// be true if nothing was rounded before the condition, so that these bits are equal.
fn condition(ideal: Enclosure, actual: Enclosure, is_exact: bool) -> NodeError {
    let error = if is_exact { NOTHING } else { actual - ideal };
    NodeError { ideal, error, actual }
}

/// Returns the value if the limits contain only one value; otherwise `None`.
fn fixed(limits: Enclosure) -> Option<f64> {
    (limits.low == limits.high).then_some(limits.low)
}

fn product(a: NodeError, b: NodeError, is_square: bool) -> NodeError {
    let ideal = if is_square { squared(a.ideal) } else { a.ideal * b.ideal };
    let error = a.ideal * b.error + b.ideal * a.error + a.error * b.error;
    NodeError::new(ideal, error)
}

/// Returns limits of the square of a value, which are never below 0.
fn squared(a: Enclosure) -> Enclosure {
    let square = a * a;
    let holds_zero = a.low <= 0.0 && a.high >= 0.0;
    let least = if holds_zero { 0.0 } else { square.low };
    Enclosure::between(least.max(0.0), square.high)
}

fn negated(a: NodeError) -> NodeError {
    NodeError::new(-a.ideal, -a.error)
}

fn absolute(a: NodeError) -> NodeError {
    let actual = a.actual;
    if actual.low >= 0.0 && a.ideal.low >= 0.0 {
        return a;
    }
    let other = negated(a);
    if actual.high <= 0.0 && a.ideal.high <= 0.0 {
        return other;
    }
    let largest = a.ideal.high.max(-a.ideal.low);
    NodeError::new(Enclosure::between(0.0, largest), a.error.hull(other.error))
}

/// Returns the limits of the smaller of two values. Its error lies between the errors of the two values, so the hull of these
/// errors contains it.
fn minimum(a: NodeError, b: NodeError) -> NodeError {
    let ideal = Enclosure::between(a.ideal.low.min(b.ideal.low), a.ideal.high.min(b.ideal.high));
    NodeError::new(ideal, a.error.hull(b.error))
}

/// Returns the enclosure times a power of two, without rounding.
fn scaled(a: Enclosure, factor: f64) -> Enclosure {
    Enclosure::between(a.low * factor, a.high * factor)
}

/// Returns limits of the error, as a real value, of removing the lowest `places` bits. `format` is the format after the rounding.
fn rounding_error(places: i32, format: Format, rounding: Rounding) -> Enclosure {
    if places <= 0 {
        return NOTHING;
    }
    let unit = exp2(-format.frac);
    match rounding {
        Rounding::Truncate => Enclosure::between(unit * (exp2(-places) - 1.0), 0.0),
        Rounding::Nearest => Enclosure::between(unit * (exp2(-places) - 0.5), unit / 2.0),
    }
}

/// Returns the smallest and the largest raw value of a format for real values within the limits `value`.
fn raw_limits(value: Enclosure, format: Format) -> (i128, i128) {
    let unit = exp2(format.frac);
    let (least, most) = format.range();
    let (low, high) = (value.low * unit, value.high * unit);
    // A raw value is an integer.
    let (first, last) = (low.ceil(), high.floor());
    let (first, last) = if first <= last { (first, last) } else { (low.floor(), high.ceil()) };
    // The ends of a wide format are no f64, so that integers are compared.
    ((first as i128).max(least), (last as i128).min(most))
}

/// Checks that the bits that a node drops at the top are copies of the sign. Fails if the value may exceed the format.
fn check_fit(node: NodeId, value: NodeError, format: Format) -> Result<(), Undecided> {
    let unit = exp2(format.frac);
    let actual = value.actual;
    let (low, high) = format.range();
    // A raw value is an integer, so a limit that is less than one unit beyond the format allows no raw value beyond it.
    let is_below = actual.low * unit <= low as f64 - 1.0;
    let is_above = actual.high * unit >= high as f64 + 1.0;
    if is_below || is_above {
        return Err(Undecided { node, what: "its value may not fit its format" });
    }
    Ok(())
}

fn known_places(node: NodeId, places: NodeError) -> Result<i32, Undecided> {
    match places.known() {
        Some(places) => Ok(places as i32),
        None => Err(Undecided { node, what: "the distance of its shift is not known" }),
    }
}

/// Returns the limits of the value and of the error of a function of one number. The error is the effect of the operand's error,
/// plus, with `own_errors`, the error of the polynomials. Fails if the operand may leave the domain, or if the function has no
/// value for it.
fn approximated(
    id: NodeId,
    approximation: &Approximation,
    operand: NodeError,
    own_errors: bool,
) -> Result<NodeError, Undecided> {
    let function = &approximation.function;
    let actual = operand.actual;
    let (first, last) = function.domain;
    let domain = Enclosure::between(
        function.operand.to_f64(first.into()),
        function.operand.to_f64(last.into()),
    );
    // No raw operand lies between the end of the domain and one unit beyond it.
    let unit = exp2(-function.operand.frac);
    if actual.low <= domain.low - unit || actual.high >= domain.high + unit {
        return Err(Undecided {
            node: id,
            what: "its operand can leave the domain of the function",
        });
    }
    let undecided = Undecided { node: id, what: "the function has no value, or no slope" };
    let glint_approximate::Curve::Formula(formula) = &function.curve else {
        return Err(undecided);
    };
    let inside = |value: Enclosure| {
        Enclosure::between(
            value.low.clamp(domain.low, domain.high),
            value.high.clamp(domain.low, domain.high),
        )
    };
    let is_exact = operand.error == NOTHING;
    let ideal_operand = if is_exact { inside(operand.ideal) } else { operand.ideal };
    let ideal = formula.enclose(&[("x", ideal_operand)]).map_err(|_| undecided.clone())?;
    let mut error = NOTHING;
    if !is_exact {
        let whole = operand.ideal.hull(inside(actual));
        // The value at the hardware's operand, minus the value at the ideal operand.
        let at_actual = formula.enclose(&[("x", inside(actual))]).map_err(|_| undecided)?;
        error = at_actual - ideal;
        if let Ok((_, slope)) = formula.slope("x", whole) {
            let by_slope = slope * operand.error;
            let low = error.low.max(by_slope.low);
            let high = error.high.min(by_slope.high);
            if low <= high {
                error = Enclosure::between(low, high);
            }
        }
    }
    if own_errors {
        let own = approximation.error();
        error = error + Enclosure::between(-own, own);
    }
    Ok(NodeError::new(ideal, error))
}
