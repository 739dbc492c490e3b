//! Tells Verilog files from memory contents by the ending of their names.
//!
//! The name of a file decides whether the functions of this crate compile it, or only put it into the directory.

/// Tools compile `rough.v`, for example, but not `rough_sine.mem`, which `rough.v` reads.
pub fn is_verilog(name: &str) -> bool {
    name.ends_with(".v") || name.ends_with(".sv")
}
