//! Figures about devices, for people to weigh, the seeds' claims, and pictures.

pub mod benchmark;
pub mod chart;
pub mod claims;
pub mod comparison;
pub mod curves;
pub mod datasheet;
pub mod drawing;
pub mod evidence;
pub mod figure;
pub mod hardware;
pub mod measure;
pub mod page;
pub mod plots;
pub mod render;
pub mod seed_plots;
