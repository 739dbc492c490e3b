//! Reads configurations, which are TOML files with the choices for one device, such as an operand's width.
//!
//! A device declares its keys as a [`Schema`]. [`read()`] and [`parse()`] turn a file into a checked [`Config`], or into
//! [`Problems`]. [`Problems`] lists the file's mistakes, each with a remedy and its location. [`brief`] and [`commented`] write
//! files from which a user can start, and [`sample()`] draws random valid configurations for tests.

mod audit;
mod follow;
mod json_schema;
#[macro_use]
mod keys;
mod located;
mod module_name;
mod nearest;
mod other_words;
mod parse;
mod points;
mod problems;
mod read;
mod sample;
mod schema;
mod shared;
mod source;
mod text_pattern;
mod unknown;
mod validate;
mod values;
mod write;

pub use json_schema::json_schema;
pub use keys::Setting;
pub use nearest::nearest;
pub use parse::{parse, parse_located};
pub use problems::{Problem, Problems};
pub use read::{read, read_located};
pub use sample::sample;
pub use schema::{Key, KeyKind, Schema};
pub use shared::{Shared, shared_keys};
pub use source::ConfigSource;
pub use text_pattern::TextPattern;
pub use values::{Config, TableEntries, TableEntry, Value};
pub use write::{brief, commented};

/// The keys that every device has and that a [`Config`] stores in fields of its own.
const COMMON: [(&str, &str); 3] = [
    ("device", "The device that Glint generates."),
    (
        "name",
        "The name of the Verilog module and of its files: a Verilog identifier of at most 60 characters. The \
         default is the name of this file, with _ in place of -.",
    ),
    (
        "strict",
        "Whether Glint refuses a configuration that misses the accuracy contract. If false, it only warns. \
         True or false, default false.",
    ),
];
