//! Analyses devices and configurations for pages: their errors against formulas, and the hardware that they take.

pub mod advice;
pub mod chart;
pub mod comparison;
pub mod curves;
pub mod domain;
pub mod hardware;
