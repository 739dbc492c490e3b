//! Checks that a name is a legal Verilog identifier and no keyword of SystemVerilog.

use crate::keywords::is_keyword;

/// Checks that `name` can be the name of a net, a ROM or a module in Verilog. The name must have an ASCII letter or `_`, then
/// ASCII letters, digits and `_`, and must be no keyword. The error says why not. For example, `wire` gives "the name is a
/// keyword".
pub fn check(name: &str) -> Result<(), &'static str> {
    let mut characters = name.chars();
    match characters.next() {
        None => return Err("the name is empty"),
        Some(first) if !(first.is_ascii_alphabetic() || first == '_') => {
            return Err("the name does not begin with a letter");
        }
        Some(_) => {}
    }
    if !characters.all(|other| other.is_ascii_alphanumeric() || other == '_') {
        return Err("the name has a character other than ASCII letters, digits and _");
    }
    if is_keyword(name) {
        return Err("the name is a keyword");
    }
    Ok(())
}
