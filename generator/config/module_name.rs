//! Checks whether a name can be the name of a Verilog module, and explains why not.

use super::problems::quoted;
use glint_base::config_error::ConfigError;
use glint_base::keywords::is_keyword;

/// The largest length of a name in characters. Derived modules and files append endings to the name.
const LONGEST: usize = 60;

/// Returns an error unless `name` has 1 to 60 ASCII letters, digits and `_`, does not begin with a digit, and is no keyword of
/// Verilog or SystemVerilog. The remedy suggests a similar valid name.
pub(super) fn error(name: &str) -> Option<ConfigError> {
    let message = complaint(name)?;
    let remedy = format!(
        "give a Verilog identifier of at most {LONGEST} letters, digits and _, as \"{}\"",
        legalised(name)
    );
    Some(ConfigError::new("name", message, remedy))
}

fn complaint(name: &str) -> Option<String> {
    let quoted = quoted(name);
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let length = name.chars().count();
    if name.is_empty() {
        Some("the module name is empty".to_owned())
    } else if name.contains(['/', '\\']) || name.chars().all(|c| c == '.') {
        Some(format!("the module name {quoted} looks like a path"))
    } else if let Some(odd) = name.chars().find(|c| !c.is_ascii()) {
        let odd = odd.escape_debug();
        Some(format!("the module name {quoted} has a character outside ASCII, `{odd}`"))
    } else if let Some(odd) = name.chars().find(|c| !is_word(*c)) {
        let odd = odd.escape_debug();
        Some(format!("the module name {quoted} has the character `{odd}`"))
    } else if name.starts_with(|c: char| c.is_ascii_digit()) {
        Some(format!("the module name {quoted} starts with a digit"))
    } else if length > LONGEST {
        Some(format!("the module name {quoted} has {length} characters"))
    } else if is_keyword(name) {
        Some(format!("the module name {quoted} is a keyword of Verilog or SystemVerilog"))
    } else {
        None
    }
}

/// Returns a valid module name that is similar to a name or path. For example, `cores/my-core.toml` gives `my_core`, and `2fast`
/// gives `glint_2fast`. The function takes at most 54 characters between the last slash and the first dot. A single `_` replaces
/// characters that are no ASCII letters or digits. If the result is not valid, the function adds `glint_` in front, or returns
/// `glint_device` for an empty part.
fn legalised(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or("");
    let stem = file.split('.').find(|part| !part.is_empty()).unwrap_or("");
    let keep = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let kept: String = stem.chars().map(keep).collect();
    // Names with two underscores in a row are reserved for tools. Verilator refuses such a name in a module that a wrapper
    // contains.
    let words: Vec<&str> = kept.split('_').filter(|word| !word.is_empty()).collect();
    let words = words.join("_");
    let words = &words[..words.len().min(LONGEST - "glint_".len())];
    let illegal =
        words.is_empty() || words.starts_with(|c: char| c.is_ascii_digit()) || is_keyword(words);
    match (illegal, words) {
        (true, "") => "glint_device".to_owned(),
        (true, words) => format!("glint_{words}"),
        (false, words) => words.to_owned(),
    }
}
