//! Pages for people: the page of a device, its datasheet, the report.

pub mod account;
pub mod datasheet;
pub mod drawing;
pub mod figure;
mod formula;
mod markdown;
pub mod plots;
pub mod report;

pub use account::PageInputs;
pub use markdown::page;
