//! Declares the configuration keys of the devices of the seeds, a file each: what a configuration can say of a device,
//! and which combinations make one. Description and golden model both read them; they are the specification of both.

pub mod blinn;
pub mod common;
pub mod cosine_power;
pub mod cosine_squared;
pub mod decay;
pub mod dot_product;
pub mod function;
pub mod gauss;
pub mod lyon;
pub mod normaliser;
pub mod presets;
pub mod quad_cosine;
pub mod quadratic;
pub mod rough;
pub mod schlick;
pub mod shading;
pub mod threshold;
