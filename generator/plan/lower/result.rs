//! Rewrites the formula of a result, and rounds it to its stated width.

use glint_base::fixed::{Format, Rounding, exp2, shifted_left};
use glint_formula::{Kind, Operator};

use super::{Lowering, WIDEST_RATIO};
use crate::node::{NodeId, Operation};
use crate::refusal::PlanRefusal;
use crate::statement::{HALF_A_UNIT, StatedOverflow, StatedResult, StatedWidth};

impl Lowering<'_> {
    /// Returns the node of the result with the index `number`, rounded to the result's fraction bits. Fails if the plan cannot
    /// compute a part.
    pub(super) fn result(&mut self, number: usize) -> Result<NodeId, PlanRefusal> {
        let result = &self.statement.results[number];
        let node = match self.nearest_where_needed(result)? {
            Some(node) => node,
            None => self.part(&result.formula)?,
        };
        let values = self.range(&result.formula)?;
        let frac = result.fraction as i32;
        let unit = exp2(frac);
        let places = self.plan.node(node).format.frac - frac;
        let range = self.plan.node(node).range;
        let rounded = |raw: i128| match places {
            1.. => Rounding::Nearest.shift(raw, places),
            _ => shifted_left(raw, -places).unwrap_or(if raw < 0 { i128::MIN } else { i128::MAX }),
        };
        // Neither the formula with its allowed error nor the node has values beyond these.
        let low = ((values.low * unit - result.error).ceil() as i128).max(rounded(range.0));
        let high = ((values.high * unit + result.error).floor() as i128).min(rounded(range.1));
        let format = Format::holding(low.min(high), high.max(low), frac);
        let name = format!("{}_rounded", result.name);
        let node = self.plan.narrow(&name, node, format, Rounding::Nearest)?;
        match self.plan.node(node).operation {
            Operation::Operand(_) => self.plan.copy(&name, node),
            _ => Ok(node),
        }
    }

    /// Returns the node of the nearest value of a result, if no larger error is allowed, or if the result is a quotient with too
    /// many bits for a product with a reciprocal. Returns `None` for another result, and for a formula that is no quotient and no
    /// root of exact numbers. Fails if a part has too many bits or no finite values.
    fn nearest_where_needed(
        &mut self,
        result: &StatedResult,
    ) -> Result<Option<NodeId>, PlanRefusal> {
        let is_nearest =
            result.error <= HALF_A_UNIT || self.is_wide_quotient(result).unwrap_or(false);
        match is_nearest {
            true => {
                let node = self.nearest(&result.formula, result.fraction as i32);
                node.map_err(|refusal| refusal.at(&result.formula.span))
            }
            false => Ok(None),
        }
    }

    /// Returns whether a result is a quotient with more bits than a product with a reciprocal should have. Fails if the formula has no
    /// finite values.
    fn is_wide_quotient(&self, result: &StatedResult) -> Result<bool, PlanRefusal> {
        if !matches!(result.formula.kind, Kind::Binary(Operator::Div, ..)) {
            return Ok(false);
        }
        let values = self.range(&result.formula)?;
        let largest = values.low.abs().max(values.high.abs());
        Ok(largest * exp2(result.fraction as i32) >= exp2(WIDEST_RATIO))
    }

    /// Returns the node of the result with the index `number` in its stated width, or `node` itself if no width is stated.
    /// Fails if the values of `node` exceed the width and the statement refuses such values.
    pub(super) fn in_stated_width(
        &mut self,
        number: usize,
        node: NodeId,
    ) -> Result<NodeId, PlanRefusal> {
        let StatedResult { name, width, .. } = &self.statement.results[number];
        let Some(StatedWidth { format, overflow }) = width else { return Ok(node) };
        let own = self.plan.node(node).format;
        let (low, high) = own.range();
        let is_refused = matches!(overflow, StatedOverflow::Refuse);
        if is_refused && !(format.holds(low) && format.holds(high)) {
            let [low, high] = [low, high].map(|raw| own.to_f64(raw));
            let message = format!(
                "`{name}` has {} bits ({format}), and intervals show only that its values are from {low} to {high}, \
                 which need {own}",
                format.width()
            );
            let remedy = "give the result more bits, or set overflow = \"saturate\" if the values always fit or may \
                          be limited, or \"wrap\"";
            return Err(PlanRefusal::new(message, remedy));
        }
        self.plan.narrow(&format!("{name}_in_width"), node, *format, Rounding::Truncate)
    }

    /// Returns the node of the result with the index `number`, limited to its stated format if the result saturates. For any
    /// other result, returns `node` itself. Fails if a node has too many bits.
    pub(super) fn saturated(&mut self, number: usize, node: NodeId) -> Result<NodeId, PlanRefusal> {
        let StatedResult { name, width, .. } = &self.statement.results[number];
        let Some(StatedWidth { format, overflow: StatedOverflow::Saturate(_) }) = width else {
            return Ok(node);
        };
        let (low, high) = format.range();
        let range = self.plan.node(node).range;
        let mut limited = node;
        if range.0 < low {
            let least = self.plan.constant(&format!("{name}_least"), low, format.frac)?;
            limited = self.plan.maximum(&format!("{name}_not_below"), limited, least)?;
        }
        if range.1 > high {
            let most = self.plan.constant(&format!("{name}_most"), high, format.frac)?;
            limited = self.plan.minimum(&format!("{name}_limited"), limited, most)?;
        }
        Ok(limited)
    }
}
