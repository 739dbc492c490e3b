//! What is measured about devices and configurations.

pub mod advice;
pub mod chart;
pub mod comparison;
pub mod curves;
pub mod domain;
pub mod hardware;
