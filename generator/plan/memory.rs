//! Defines the kinds of memory for the tables of a plan.

/// The memory in which the planner stores tables of polynomials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableMemory {
    /// In look-up tables of the logic. A block memory is taken only if it saves many of them.
    #[default]
    Logic,
    /// In block memories, wherever that saves look-up tables. A large table has more segments and a smaller degree, which also saves
    /// multipliers.
    Block,
}
