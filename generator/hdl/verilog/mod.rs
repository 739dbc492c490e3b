//! The text of Verilog modules. Names and expressions become strings first (`plan`, `expression`), views
//! collect them, and the templates in `templates/` print views and decide nothing.

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
pub(crate) mod view;
pub(crate) mod words;
