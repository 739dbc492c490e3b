//! Tells Verilog files from memory contents by the ending of their names.
//!
//! The functions of this crate take files as pairs of a name and contents. The functions must know which files to compile and
//! which only to put into the directory. For example, `rough.v` is compiled, and `rough_sine.mem` is not.

/// Returns whether tools compile the file of this name as Verilog or SystemVerilog, which is so if the name ends in `.v` or
/// `.sv`. For example, `rough.v` is compiled; `rough_sine.mem`, which it reads, is not.
pub fn is_verilog(name: &str) -> bool {
    name.ends_with(".v") || name.ends_with(".sv")
}
