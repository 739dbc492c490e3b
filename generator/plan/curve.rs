//! Adds the nodes that compute a function of one number: a table of polynomials and, if the function has a range reduction, the
//! steps of the reduction before and after the table.
//!
//! A range reduction maps the operand to a number in a shorter domain, for which the table is made, and restores the result
//! from the polynomial's value. For example, an odd function needs polynomials for x ≥ 0 only. The nodes before the table
//! compute |x|, and the nodes after it negate the value if x is negative. [`Reduction`] defines both steps in integers, and the
//! proof of the polynomials relies on this definition.

use std::sync::Arc;

use glint_approximate::{Curve, Outside, Piecewise, Reduction, Rule, TargetFunction};
use glint_base::fixed::{Format, Rounding};

use super::node::{Approximation, NodeId, Operation};
use super::plan::{ExpressionPlan, PlanBuilder};
use super::refusal::PlanRefusal;

/// The operand in the shorter domain, and the nodes from which the result is restored. The steps of the restoring have the
/// order of the fields.
struct ReducedOperand {
    /// The operand in the shorter domain, as an integer.
    number: NodeId,
    /// A value that is added to the polynomial's value, or `None` if the step is left out.
    addend: Option<NodeId>,
    /// The number of bits by which the sum is shifted to the right, or `None` if the step is left out.
    places: Option<NodeId>,
    /// A bit that is 0 if the result must be 0, or `None` if the result needs no such bit.
    is_nonzero: Option<NodeId>,
    /// A bit and a raw value, or `None` if the step is left out. If the bit is 1, the result is the raw value minus the
    /// result of the earlier steps.
    negative: Option<(NodeId, i64)>,
}

impl ReducedOperand {
    fn new(number: NodeId) -> Self {
        Self { number, addend: None, places: None, is_nonzero: None, negative: None }
    }
}

impl ExpressionPlan {
    /// Returns the plan of a single function of the operand `x`. Its only result is the value of the function.
    ///
    /// # Errors
    /// Fails if a node has too many bits.
    pub fn of_function(
        function: &TargetFunction,
        polynomials: &Arc<Piecewise>,
    ) -> Result<Self, PlanRefusal> {
        let mut plan = PlanBuilder::default();
        let format = polynomials.operand;
        let reached = match polynomials.outside {
            Outside::Wrap => (format.min_raw() as i64, format.max_raw() as i64),
            Outside::Clamp | Outside::Anything => polynomials.domain,
        };
        let x = plan.operand(0, "x", format, reached)?;
        let result = plan.curve("result", x, function, polynomials)?;
        plan.add_result(result, result);
        plan.finish()
    }

    /// Returns the plan with the nodes of its range reductions, and the new index of each node. During the search for a plan, a
    /// function with a range reduction is a single node, because its error is proved for the whole function.
    ///
    /// # Errors
    /// Fails if a node has too many bits.
    pub(super) fn with_reductions(&self) -> Result<(Self, Vec<NodeId>), PlanRefusal> {
        let mut plan = PlanBuilder::like(self);
        let mut renumbered: Vec<NodeId> = Vec::with_capacity(self.nodes().len());
        for node in self.nodes() {
            let operation = node.operation.with_inputs(&|id: NodeId| renumbered[id.0]);
            let reduced = match &operation {
                Operation::Polynomial(x, approximation) => {
                    let found = approximation.polynomials.as_ref();
                    let found = found.filter(|found| found.reduction.is_some());
                    found.map(|found| (*x, approximation.function.clone(), found.clone()))
                }
                _ => None,
            };
            renumbered.push(match reduced {
                Some((x, function, found)) => plan.curve(&node.name, x, &function, &found)?,
                None => plan.push_copy(node, operation),
            });
        }
        for (result, proved) in self.results().iter().zip(self.proved()) {
            plan.add_result(renumbered[result.0], renumbered[proved.0]);
        }
        Ok((plan.finish()?, renumbered))
    }
}

impl PlanBuilder {
    /// Adds a function of the node `x` with known polynomials, and returns the node of its result. The format of `x` must be
    /// the operand format of the polynomials. Fails if a node has more than 64 bits.
    pub(super) fn curve(
        &mut self,
        name: &str,
        x: NodeId,
        function: &TargetFunction,
        polynomials: &Arc<Piecewise>,
    ) -> Result<NodeId, PlanRefusal> {
        let known = |function: TargetFunction, polynomials: Arc<Piecewise>| Approximation {
            function,
            polynomials: Some(polynomials),
        };
        let Some(reduction) = &polynomials.reduction else {
            let approximation = known(function.clone(), polynomials.clone());
            return self.polynomial(name, x, approximation, polynomials.result.range());
        };
        let reduced = self.reduced(x, polynomials, reduction)?;
        let behind = Arc::new(polynomials.behind_reduction());
        let short_function = TargetFunction {
            curve: Curve::Formula(reduction.formula.clone()),
            domain: behind.domain,
            operand: behind.operand,
            outside: behind.outside,
            fraction: behind.result.frac as u32,
            error: f64::INFINITY,
        };
        let number = self.scale("reduced_operand", reduced.number, -behind.operand.frac)?;
        let values = behind.result.range();
        let table = known(short_function, behind);
        let polynomial = self.polynomial("polynomial", number, table, values)?;
        let restored = self.restored(polynomial, &reduced, polynomials.result)?;
        let last = self.narrow(name, restored, polynomials.result, Rounding::Truncate)?;
        self.rename(last, name);
        Ok(last)
    }

    /// Adds the nodes that map the operand `x` to the shorter domain of the table, and returns them. Fails if a node has more
    /// than 64 bits.
    fn reduced(
        &mut self,
        x: NodeId,
        polynomials: &Piecewise,
        reduction: &Reduction,
    ) -> Result<ReducedOperand, PlanRefusal> {
        let integer = self.scale("whole", x, polynomials.operand.frac)?;
        match &reduction.rule {
            Rule::Size(centre) => self.size(integer, reduction.bits, *centre),
            Rule::Quadrants(ahead) => self.angle_in_quadrant(integer, reduction.bits, *ahead),
            Rule::Octaves { pairs, restores, .. } => {
                let starts_at_0 = polynomials.domain.0 == 0;
                let frac = polynomials.sums[0].frac;
                self.word_in_octave(integer, *pairs, restores, frac, starts_at_0)
            }
            Rule::Exponent { scale, whole, falls } => {
                let (first, last) = polynomials.domain;
                let most_places = reduction.places(first).max(reduction.places(last));
                let exponent = self.exponent_of_two(integer, *scale)?;
                self.fraction_of_exponent(exponent, reduction.bits, (*whole, *falls), most_places)
            }
        }
    }

    /// Adds the nodes of [`Rule::Size`], and returns them: |x|, limited to `bits` bits. `centre` is the raw value from which
    /// the result of a negative operand is subtracted, or `None` for an even function. Fails if a node has too many bits.
    fn size(
        &mut self,
        x: NodeId,
        bits: u32,
        centre: Option<i64>,
    ) -> Result<ReducedOperand, PlanRefusal> {
        let zero = self.constant("zero", 0, 0)?;
        let is_negative = self.less("negative", x, zero)?;
        let size = self.absolute("size", x)?;
        let number = self.limited_to_bits("number", size, bits)?;
        let negative = centre.map(|centre| (is_negative, centre));
        Ok(ReducedOperand { negative, ..ReducedOperand::new(number) })
    }

    /// Adds the nodes of [`Rule::Quadrants`], and returns them: the distance from the nearest zero of the sine. A quarter turn
    /// has 2^`bits` steps. `ahead` is the number of quarter turns that are added to the angle. Fails if a node has too many
    /// bits.
    fn angle_in_quadrant(
        &mut self,
        x: NodeId,
        bits: u32,
        ahead: u32,
    ) -> Result<ReducedOperand, PlanRefusal> {
        let quarters = self.scale("quarters", x, -(bits as i32))?;
        let [quadrant, way] = self.split("angle", quarters)?;
        let ahead = self.constant("ahead", ahead.into(), 0)?;
        let quadrant = self.add("quadrant", quadrant, ahead)?;
        let is_odd = self.bit("is_odd_quadrant", quadrant, 0)?;
        let is_negative = self.bit("negative", quadrant, 1)?;
        let one = self.constant("whole_quadrant", 1, 0)?;
        let back = self.subtract("angle_back", one, way)?;
        let angle = self.choose("angle_in_quadrant", is_odd, [way, back])?;
        let angle = self.scale("angle_number", angle, bits as i32)?;
        let number = self.limited_to_bits("number", angle, bits)?;
        Ok(ReducedOperand { negative: Some((is_negative, 0)), ..ReducedOperand::new(number) })
    }

    /// Returns the node of the integer `number`, limited to `bits` bits. The integer must be from 0 to 2^`bits`; the value
    /// 2^`bits` becomes 2^`bits` − 1. Fails if a node has too many bits.
    fn limited_to_bits(
        &mut self,
        name: &str,
        number: NodeId,
        bits: u32,
    ) -> Result<NodeId, PlanRefusal> {
        let format = Format::unsigned(bits as i32, 0);
        let mut limited = number;
        if self.node(number).range.1 > format.max_raw() {
            let is_beyond = self.bit(&format!("{name}_is_beyond"), number, bits)?;
            let most = self.constant("most", format.max_raw(), 0)?;
            let low = self.narrow(&format!("{name}_low"), number, format, Rounding::Truncate)?;
            limited = self.choose(name, is_beyond, [low, most])?;
        }
        self.narrow(name, limited, format, Rounding::Truncate)
    }

    /// Adds the nodes of [`Rule::Octaves`], and returns them: the bits below the leading 1 of `x`. If `has_pairs`, one more bit
    /// above them distinguishes the two octaves of a pair. `restores` has the shift and the addend for each number of leading
    /// zeros. The addends have `frac` fraction bits. If `starts_at_0`, the operand may be 0. Fails if a node has too many bits.
    fn word_in_octave(
        &mut self,
        x: NodeId,
        has_pairs: bool,
        restores: &[(u32, i64)],
        frac: i32,
        starts_at_0: bool,
    ) -> Result<ReducedOperand, PlanRefusal> {
        let width = self.node(x).format.width() as i32;
        let [word, zeros] = self.normalise("octave", x, false)?;
        let word = self.scale("octave_word", word, width)?;
        let behind_leading_bit = Format::unsigned(width - 1, 0);
        let mut number = self.narrow("rest", word, behind_leading_bit, Rounding::Truncate)?;
        if has_pairs {
            let is_even = self.bit("is_even", zeros, 0)?;
            let is_second = if width % 2 == 1 {
                is_even
            } else {
                let [zero, one] = [self.constant("zero", 0, 0)?, self.constant("one", 1, 0)?];
                self.choose("is_second", is_even, [one, zero])?
            };
            let upper = self.scale("second", is_second, width - 1)?;
            number = self.add("number", upper, number)?;
        }
        let shifts: Vec<i128> = restores.iter().map(|it| it.0.into()).collect();
        let addends: Vec<i128> = restores.iter().map(|it| it.1.into()).collect();
        let mut reduced = ReducedOperand::new(number);
        if addends.iter().any(|addend| *addend != 0) {
            reduced.addend = Some(self.lookup("addends", zeros, addends, frac)?);
        }
        if shifts.iter().any(|shift| *shift != 0) {
            reduced.places = Some(self.lookup("places", zeros, shifts, 0)?);
        }
        if starts_at_0 {
            reduced.is_nonzero = Some(self.bit("leading_bit", word, width as u32 - 1)?);
        }
        Ok(reduced)
    }

    /// Adds the product that changes the base of an exponent to 2, and returns its node: e^x is 2^(x · log2 e). `scale` has the
    /// factor and the number of low bits that the product drops. Returns `x` itself if `scale` is `None`. Fails if a node has too
    /// many bits.
    fn exponent_of_two(
        &mut self,
        x: NodeId,
        scale: Option<(i64, u32)>,
    ) -> Result<NodeId, PlanRefusal> {
        let Some((factor, cut)) = scale else { return Ok(x) };
        let factor = self.constant("scale", factor.into(), 0)?;
        let product = self.multiply("scaled", x, factor)?;
        let product = self.scale("scaled_product", product, -(cut as i32))?;
        self.shorten("exponent", product, 0, Rounding::Truncate)
    }

    /// Adds the nodes of [`Rule::Exponent`], and returns them: the fraction of an exponent, and the number of bits of the
    /// shift. This number is the distance of the exponent's integer part from `whole`, and at most `most_places`. `exponent` is
    /// in units of 2^−`bits`. Fails if a node has too many bits.
    fn fraction_of_exponent(
        &mut self,
        exponent: NodeId,
        bits: u32,
        (whole, falls): (i64, bool),
        most_places: u32,
    ) -> Result<ReducedOperand, PlanRefusal> {
        let fraction = Format::unsigned(bits as i32, 0);
        let number = self.narrow("number", exponent, fraction, Rounding::Truncate)?;
        let mut reduced = ReducedOperand::new(number);
        if most_places > 0 {
            let exponent = self.scale("exponent_value", exponent, -(bits as i32))?;
            let integer = self.integer_part("exponent_integer", exponent)?;
            let whole = self.constant("whole_exponent", whole.into(), 0)?;
            let places = match falls {
                true => self.subtract("integers_away", integer, whole)?,
                false => self.subtract("integers_away", whole, integer)?,
            };
            let format = Format::holding(0, most_places.into(), 0);
            reduced.places = Some(self.narrow("places", places, format, Rounding::Truncate)?);
        }
        Ok(reduced)
    }

    /// Adds the nodes that restore the result from the table's value `polynomial`, and returns the node of the result. The
    /// result is rounded to the nearest value with the fraction bits of `format`. Fails if a node has too many bits.
    fn restored(
        &mut self,
        polynomial: NodeId,
        reduced: &ReducedOperand,
        format: Format,
    ) -> Result<NodeId, PlanRefusal> {
        let mut value = polynomial;
        if let Some(addend) = reduced.addend {
            value = self.add("with_octave", value, addend)?;
        }
        if let Some(places) = reduced.places {
            // The first bit that is shifted out decides the rounding, so it is kept.
            let own = self.node(value).format;
            let finer = Format { frac: own.frac + 1, ..own };
            let longer = self.narrow("longer", value, finer, Rounding::Truncate)?;
            value = self.shift_right("shifted", longer, places)?;
        }
        value = self.shorten("rounded", value, format.frac, Rounding::Nearest)?;
        if let Some(is_nonzero) = reduced.is_nonzero {
            let zero = self.constant("no_result", 0, format.frac)?;
            value = self.choose("unless_zero", is_nonzero, [zero, value])?;
        }
        if let Some((is_negative, centre)) = reduced.negative {
            let centre = self.constant("centre", centre.into(), format.frac)?;
            let other = self.subtract("taken_off", centre, value)?;
            value = self.choose("with_sign", is_negative, [value, other])?;
        }
        Ok(value)
    }
}
