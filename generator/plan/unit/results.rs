//! Adds the results of a merged plan: an adder that the results of several functions share, and the choice of 0 where a function has
//! no such result.

use glint_base::fixed::Format;

use super::merge::Merger;
use super::opcode_bits;
use super::sums::ResultSum;
use crate::node::{NodeId, Operation};
use crate::refusal::PlanRefusal;

/// Results share an adder if at least this many of them need one.
const FEWEST_ADDERS: usize = 2;

/// The nodes of a result ±v + base of one function.
struct SumParts {
    value: NodeId,
    is_negative: NodeId,
    base: NodeId,
}

impl Merger<'_> {
    /// Adds result number `number` as a word of a format. A function without such a result, and an opcode without a function, give 0.
    ///
    /// # Errors
    /// Fails if an operation has too many bits.
    pub(super) fn add_result(
        &mut self,
        number: usize,
        name: &str,
        format: Format,
    ) -> Result<(), PlanRefusal> {
        let mut sums = Vec::new();
        for function in 0..self.functions.len() {
            let own = self.own(function);
            let result = own.results().get(number);
            sums.push(result.map(|result| ResultSum::of(own, *result)));
        }
        let adders = sums.iter().flatten().filter(|sum| sum.has_adder()).count();
        let is_shared = adders >= FEWEST_ADDERS;
        let common = if is_shared { Some(self.common_sum(number, name, &sums)?) } else { None };
        let mut cases = Vec::new();
        let zero = self.plan.constant("zero", 0, 0)?;
        for function in 0..self.functions.len() {
            let Some(result) = self.own(function).results().get(number).copied() else {
                cases.push(Some(zero));
                continue;
            };
            let integer = match common {
                Some(sum) => sum,
                None => self.raw(self.nodes[function][result.0])?,
            };
            let name = match common {
                Some(_) => name.to_owned(),
                None => format!("{}_{name}", self.functions[function].name),
            };
            let signed = Format { signed: true, int: format.width() as i32 - 1, frac: 0 };
            let is_negative = self.plan.node(integer).format.signed && !format.signed;
            let word = match is_negative {
                true => self.narrow(&format!("{name}_extended"), integer, signed)?,
                false => integer,
            };
            cases.push(Some(self.narrow(&format!("{name}_word"), word, format)?));
        }
        cases.resize(1 << opcode_bits(self.functions.len()), Some(zero));
        let selected = self.selected(&format!("{name}_selected"), &cases)?;
        let result = self.narrow(&format!("{name}_result"), selected, format)?;
        let is_operand = matches!(self.plan.node(result).operation, Operation::Operand(_));
        let result = if is_operand { self.plan.copy(name, result)? } else { result };
        self.plan.add_result(result, result);
        Ok(())
    }

    /// Returns the integer part of the sum ±v + base, where the opcode selects v, the sign and the base.
    fn common_sum(
        &mut self,
        number: usize,
        name: &str,
        sums: &[Option<ResultSum>],
    ) -> Result<NodeId, PlanRefusal> {
        let mut values = vec![None; sums.len()];
        let mut signs = vec![None; sums.len()];
        let mut bases = vec![None; sums.len()];
        for (function, sum) in sums.iter().enumerate() {
            let Some(sum) = sum else { continue };
            let parts = self.sum_parts(function, number, name, sum)?;
            values[function] = Some(parts.value);
            signs[function] = Some(parts.is_negative);
            bases[function] = Some(parts.base);
        }
        let value = self.selected(&format!("{name}_value"), &values)?;
        let is_negative = self.selected(&format!("{name}_is_negative"), &signs)?;
        let base = self.selected(&format!("{name}_base"), &bases)?;
        let is_never_negative =
            matches!(self.plan.node(is_negative).operation, Operation::Constant { .. });
        let signed = match is_never_negative {
            true => value,
            false => {
                let opposite = self.plan.negate(&format!("{name}_opposite"), value)?;
                self.plan.choose(&format!("{name}_signed"), is_negative, [value, opposite])?
            }
        };
        let sum = self.plan.add(&format!("{name}_sum"), base, signed)?;
        let format = self.plan.node(sum).format;
        let whole = Format { frac: format.frac.min(0), ..format };
        self.narrow(&format!("{name}_whole"), sum, whole)
    }

    /// Returns v, its sign and the base of a result of a function, in units of the last bit of this result.
    fn sum_parts(
        &mut self,
        function: usize,
        number: usize,
        name: &str,
        sum: &ResultSum,
    ) -> Result<SumParts, PlanRefusal> {
        let own = self.own(function);
        let result_frac = own.node(own.results()[number]).format.frac;
        let below_result = own.node(sum.value).format.frac - result_frac;
        let name = format!("{}_{name}", self.functions[function].name);
        let routed = self.routed[function].filter(|_| number == 0);
        let value = routed.unwrap_or(self.nodes[function][sum.value.0]);
        let name_of_value = format!("{name}_value");
        let value = self.plan.scale(&name_of_value, value, result_frac)?;
        let kept = Format { frac: below_result.min(sum.frac), ..self.plan.node(value).format };
        let value = self.narrow(&name_of_value, value, kept)?;
        let mut conditions = Vec::new();
        for condition in &sum.conditions {
            conditions.push(self.nodes[function][condition.0]);
        }
        let is_negative = self.is_odd(&format!("{name}_is_negative"), &conditions)?;
        let name_of_base = format!("{name}_base");
        let constant = self.constant_base(&name_of_base, sum, &conditions)?;
        let Some(addend) = sum.addend else {
            return Ok(SumParts { value, is_negative, base: constant });
        };
        let addend = self.nodes[function][addend.0];
        let scaled = self.plan.scale(&format!("{name}_addend"), addend, result_frac)?;
        let whole = Format { frac: 0, ..self.plan.node(scaled).format };
        let whole = self.narrow(&format!("{name}_whole"), scaled, whole)?;
        let base = self.plan.add(&name_of_base, whole, constant)?;
        Ok(SumParts { value, is_negative, base })
    }

    /// Returns a node that is 1 if an odd number of conditions is 1.
    fn is_odd(&mut self, name: &str, conditions: &[NodeId]) -> Result<NodeId, PlanRefusal> {
        let mut conditions = conditions.iter();
        let Some(first) = conditions.next() else { return self.plan.constant("zero", 0, 0) };
        let mut odd = *first;
        for condition in conditions {
            let one = self.plan.constant("one", 1, 0)?;
            let even = self.plan.subtract(&format!("{name}_inverted"), one, odd)?;
            odd = self.plan.choose(name, *condition, [odd, even])?;
        }
        Ok(odd)
    }

    /// Returns the node of the constant part of a base, which the conditions select.
    fn constant_base(
        &mut self,
        name: &str,
        sum: &ResultSum,
        conditions: &[NodeId],
    ) -> Result<NodeId, PlanRefusal> {
        let mut row = Vec::new();
        for base in &sum.bases {
            row.push(self.plan.constant(name, *base, sum.frac)?);
        }
        for condition in conditions {
            let mut next = Vec::new();
            for pair in row.chunks(2) {
                let is_same = self.plan.node(pair[0]).is_alike(self.plan.node(pair[1]));
                next.push(match is_same {
                    true => pair[0],
                    false => self.plan.choose(name, *condition, [pair[0], pair[1]])?,
                });
            }
            row = next;
        }
        Ok(row[0])
    }
}
