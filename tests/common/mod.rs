//! What several tests share.

pub mod tools;
