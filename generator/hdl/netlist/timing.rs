//! Defines the timing of a device's handshake: the numbers of clocks from `start` to `valid`, to `done` and to the next `start`.

use serde::Serialize;

/// The numbers of clocks between the events of a device's handshake, each `None` if it depends on the operands.
///
/// The clock that takes `start` is number 0. For example, `rough` has `valid` in clock 9 and `done` in clock 10, and may take the
/// next `start` in clock 11.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct HandshakeTiming {
    /// The first clock in which `valid` is high.
    pub start_to_valid: Option<u32>,
    /// The number of clocks from one result to the next of the same computation. `quad_cosine` has 1. `None` if a computation has
    /// one result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_to_valid: Option<u32>,
    /// The clock in which `done` is high.
    pub start_to_done: Option<u32>,
    /// The latest clock in which `done` can be high. `lyon` has 36. `None` if the clock of `done` does not depend on the
    /// operands, or if the microprogram has no bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_to_done_at_most: Option<u32>,
    /// The first clock that takes the next `start`.
    pub start_to_start: Option<u32>,
}

impl HandshakeTiming {
    /// Returns the number of clocks for each point without a pause: from one result to the next if a computation has several
    /// results, and otherwise from one `start` to the next. `rough` gives 11.
    pub fn clocks_per_point(&self) -> Option<u32> {
        self.valid_to_valid.or(self.start_to_start)
    }
}
