//! Figures about devices, for people to weigh, and pictures through them.

pub mod comparison;
pub mod render;
