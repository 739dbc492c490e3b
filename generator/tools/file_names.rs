//! Tells Verilog files from memory contents by the ending of their names. Functions of this crate compile only Verilog files.

/// Returns whether tools must compile the file `name`. For example, they compile `rough.v`, but not `rough_sine.mem`, which
/// `rough.v` reads.
pub fn is_verilog(name: &str) -> bool {
    name.ends_with(".v") || name.ends_with(".sv")
}
