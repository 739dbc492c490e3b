//! Declares the configuration keys of the seed devices, one file for each device. A file says which keys a configuration may
//! set and which combinations of values are valid. The hardware description and the golden model both read these keys, which
//! are the specification of both.

pub mod blinn;
pub mod common;
pub mod cosine_power;
pub mod cosine_squared;
pub mod decay;
pub mod dot_product;
pub mod expression;
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
