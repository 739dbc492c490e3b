//! Declares the configuration keys of the devices, with one file for each device, and files that several devices share. A file
//! says which keys a configuration of the device may set, and which values are valid together. For example, `cosine.fraction =
//! 20` in a configuration of `rough` gives cosines 20 fraction bits.
//!
//! The hardware description and the golden model of a device both read these keys, and the tables of polynomials and the plans
//! that this crate finds for them; they share no other code. In each file, `Keys` has the values of a configuration, and `schema`
//! returns the keys with the check of their combinations.

pub mod blinn;
pub mod common;
pub mod cosine_power;
pub mod cosine_squared;
pub mod decay;
pub mod dot_product;
pub mod expression;
pub mod function;
pub mod gauss;
pub mod images;
pub mod lyon;
pub mod normaliser;
mod port_names;
mod power_bases;
pub mod presets;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
mod samples;
pub mod schlick;
pub mod shading;
mod stated_function;
pub mod threshold;
pub mod unit;
