//! The text of Verilog modules. Names and expressions become strings first (`plan`, `expression`), and `writer` makes
//! modules of their lines.

pub mod bits;
pub mod delays;
pub mod expression;
pub mod header;
pub mod interface;
pub mod invariants;
pub mod module;
pub mod naming;
pub mod pipeline;
pub mod plan;
pub mod rows;
pub mod text;
pub mod top;
pub mod words;
pub mod writer;
