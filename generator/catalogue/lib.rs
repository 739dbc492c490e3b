//! The catalogue of devices: a file for each, with its hardware description and nothing else.

pub mod blinn;
mod common;
pub mod cosine_power;
pub mod cosine_squared;
mod decay;
pub mod dot_product;
pub mod expression;
pub mod function;
pub mod gauss;
pub mod lyon;
pub mod normaliser;
pub mod piecewise;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
pub mod schlick;
pub mod shading;
pub mod threshold;
