//! Analyses devices and configurations for pages: errors against their formulas, and the hardware that they take.

pub mod advice;
pub mod chart;
pub mod comparison;
pub mod curves;
pub mod domain;
pub mod hardware;
