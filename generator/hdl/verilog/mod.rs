//! The text of Verilog modules. Names and expressions become strings first (`plan`, `expression`), and `writer` makes
//! modules of their lines.

pub(crate) mod bits;
pub(crate) mod delays;
pub(crate) mod expression;
pub(crate) mod header;
pub(crate) mod interface;
pub(crate) mod invariants;
pub(crate) mod module;
pub(crate) mod naming;
pub(crate) mod pipeline;
pub(crate) mod plan;
pub(crate) mod rows;
pub(crate) mod text;
pub(crate) mod top;
pub(crate) mod words;
pub(crate) mod writer;
