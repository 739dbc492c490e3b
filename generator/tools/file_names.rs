//! Tells Verilog from memory contents by the names of files. Outside tools read files as pairs of a plain name and contents:
//! emitted files, netlists, and files of the user. Only the name says what such a file is, as it does for the tools.

/// Returns whether tools compile the file of this name as Verilog or SystemVerilog. For example, they compile `rough.v`, and
/// `rough.v` reads `rough_sine.mem`.
pub fn is_verilog(name: &str) -> bool {
    name.ends_with(".v") || name.ends_with(".sv")
}
