//! Holds the latency of a device in clocks: from `start` to `valid`, to `done` and to the next `start`.

use serde::Serialize;

/// Clocks between the events of the handshake; `None` if they depend on the data.
///
/// The clock in which `start` is taken is number 0. For example, `rough` has `valid` in clock 9 and `done` in clock 10, and may
/// take the next `start` in clock 11.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct HandshakeTiming {
    /// The number of the first clock in which `valid` is high.
    pub start_to_valid: Option<u32>,
    /// Clocks from a result to the next one of the same computation, if it has several. For example, `quad_cosine` has 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_to_valid: Option<u32>,
    /// The number of the clock in which `done` is high.
    pub start_to_done: Option<u32>,
    /// If that depends on the data: the number of the latest clock in which `done` can be high, if the microprogram has a
    /// bound. For example, `lyon` has 36.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_to_done_at_most: Option<u32>,
    /// The number of the first clock in which the next `start` is taken.
    pub start_to_start: Option<u32>,
}

impl HandshakeTiming {
    /// Returns the clocks from a point to the next without a pause. If a computation has several results, they are the clocks
    /// between two points of a line under way. Otherwise they are the clocks between computations back to back. `None` if they
    /// depend on the data. For example, `rough` gives 11.
    pub fn clocks_per_point(&self) -> Option<u32> {
        self.valid_to_valid.or(self.start_to_start)
    }
}
