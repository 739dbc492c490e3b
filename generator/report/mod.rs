//! Figures about devices, for people to weigh.

pub mod comparison;
