//! The catalogue of devices: a hardware description for each device, and modules that several devices share. A description
//! builds the netlist of the device with [`glint_rtl::dsl`]. The keys, the golden model and the accuracy contract of the
//! device are in other crates.
//!
//! # Symbols
//! c = cos γ, where γ is the angle between the surface normal and the half vector. n is the specular exponent. f is the
//! reflectance, the factor by which a highlight multiplies colours or an amplitude.
//!
//! Seeds 000 to 002 are the documents from which the devices come. Seed 000 is the patent of `quad-cosine`, and seed 001 the
//! patent UA 60139 of `rough`. Seed 002 is the paper "A model for reproducing the specular component of colour in computer
//! graphics" (in Ukrainian).

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
mod shared_table;
pub mod threshold;
pub mod unit;
