//! What several tests share.

pub mod bench;
pub mod tools;
pub mod units;
