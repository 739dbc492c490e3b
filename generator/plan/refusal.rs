//! Defines the reason why an expression has no plan, with the part of the expression that causes it and a remedy.

use glint_base::fixed::MAX_WIDTH;
use glint_formula::TextSpan;

/// The reason why an expression has no plan, with a remedy.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanRefusal {
    /// The index of the result that the refusal concerns; `None` if it concerns the whole expression.
    pub result: Option<usize>,
    /// The location of the part of a formula that the refusal concerns. Text number 0 is the formula of the result with the index
    /// `result`; the caller of the planner numbers the other texts. `None` if the refusal concerns no part of a formula.
    pub place: Option<TextSpan>,
    /// The reason, as a message.
    pub message: String,
    /// The remedy, as a message.
    pub remedy: String,
    /// The part that `where` could limit, so that the formula has a value.
    pub limited: Option<Box<PartToLimit>>,
}

/// A part of a formula that must be above 0, or not below 0, so that the formula has a value.
#[derive(Clone, Debug, PartialEq)]
pub struct PartToLimit {
    /// The location of the part, as in [`PlanRefusal::place`]. `None` if no text has the part, because a function that is written out
    /// makes it: `normalize(n)` has the length of `n`.
    pub place: Option<TextSpan>,
    /// The part as a formula of the operands.
    pub formula: String,
    /// `>` or `>=`.
    pub sign: &'static str,
}

impl PlanRefusal {
    /// Makes a refusal that concerns the whole expression, from the reason and the remedy.
    pub fn new(message: impl Into<String>, remedy: impl Into<String>) -> Self {
        let (message, remedy) = (message.into(), remedy.into());
        Self { result: None, place: None, message, remedy, limited: None }
    }

    /// Makes the refusal of a part whose computation needs a number of `width` bits, which is more than a net can have.
    pub(super) fn too_wide(width: i32) -> Self {
        let message = format!("this needs a number of {width} bits, more than {MAX_WIDTH}");
        Self::new(message, "give the operands fewer bits, or the results fewer fraction bits")
    }

    /// Returns the refusal for result number `result`, unless it already concerns a result.
    pub(super) fn of_result(self, result: usize) -> Self {
        Self { result: self.result.or(Some(result)), ..self }
    }

    /// Returns the refusal for the location `place`, unless it already concerns a part.
    pub(super) fn at(self, place: &TextSpan) -> Self {
        Self { place: self.place.or(Some(place.clone())), ..self }
    }
}
