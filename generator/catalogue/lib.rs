//! The catalogue of devices: one file for each device, with its hardware description, and files that several devices share. A
//! description builds the netlist of the device with [`glint_rtl::dsl`]. The keys, the golden model and the accuracy contract
//! of the device are in other crates.

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
mod mirror;
pub mod normaliser;
pub mod piecewise;
mod plan;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
pub mod schlick;
pub mod shading;
pub mod threshold;
