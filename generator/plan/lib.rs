//! Plans an expression of several operands as integer operations, and proves the error of its results.
//!
//! An [`ExpressionStatement`] has operands, formulas, and the error that each result may have. [`find()`] rewrites the formulas
//! as an [`ExpressionPlan`], a list of operations on raw values. [`find()`] chooses the widths so that the errors are kept, and
//! proves them. The hardware description, the golden model and the proof all read the same plan.
//!
//! ```
//! use glint_approximate::Outside;
//! use glint_base::fixed::Format;
//! use glint_formula::parse;
//! use glint_plan::{StatedOperand, StatedResult, ExpressionStatement, find};
//!
//! let byte = Format::unsigned(0, 8);
//! let operand = |name: &str| StatedOperand {
//!     name: name.to_owned(),
//!     format: byte,
//!     domain: (0, 255),
//!     outside: Outside::Anything,
//!     doc: String::new(),
//! };
//! let length = StatedResult {
//!     name: "length".to_owned(),
//!     formula: parse("sqrt(x^2 + y^2)").unwrap(),
//!     fraction: 8,
//!     error: 1.0,
//!     promise: None,
//!     width: None,
//! };
//! let statement = ExpressionStatement { operands: vec![operand("x"), operand("y")], results: vec![length] };
//! let found = find(&statement).unwrap();
//! assert!(found.bounds[0] < 1.0);
//! // 3/16 and 4/16 have the length 5/16, within a unit of 1/256.
//! let values = found.plan.values(&[48, 64]);
//! let length = values[found.plan.results()[0].0];
//! assert!((79..=81).contains(&length));
//! ```

mod allocate;
mod analyse;
mod boxes;
mod constant;
mod cost;
mod curve;
mod depth;
mod describe;
mod dispatch;
mod evaluate;
mod exhaust;
mod facts;
mod find;
mod frontier;
mod guarded;
mod hold;
mod lower;
mod memo;
mod memory;
mod mirror;
mod node;
mod order;
mod ordered;
mod placement;
mod plan;
mod polynomial;
mod projection;
mod range;
mod refusal;
mod schedule;
mod statement;
mod unit;
mod uses;
mod written;

pub use find::{ProofKind, ProvedPlan, find};
pub use memory::TableMemory;
pub use mirror::{Mirror, MirrorChain};
pub use node::{Approximation, NodeId, Operation, PlanNode};
pub use ordered::find_ordered;
pub use placement::{PlanSchedule, PlanStep, StepWork};
pub use plan::ExpressionPlan;
pub use range::least_size;
pub use refusal::{PartToLimit, PlanRefusal};
pub use schedule::SMALLEST_BLOCK;
pub use statement::{
    ExpressionStatement, StatedOperand, StatedOverflow, StatedResult, StatedWidth,
};
pub use unit::{
    COMPARED, MOST_FUNCTIONS, StatedFunction, UnitEquality, UnitFunction, UnitPlan, find_unit,
};
pub use written::target_function;

#[cfg(test)]
mod tests;
