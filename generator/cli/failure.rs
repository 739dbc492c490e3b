//! How errors are told.

use serde_json::json;

use crate::config::Problems;

/// Prints an error with its causes: to standard error, or as a JSON object to standard output.
pub fn print(error: &anyhow::Error, as_json: bool) {
    if as_json {
        let problems = error.downcast_ref::<Problems>().map(Problems::to_json);
        let causes: Vec<String> = error.chain().map(ToString::to_string).collect();
        let value = match problems {
            Some(problems) => json!({ "ok": false, "problems": problems }),
            None => json!({ "ok": false, "error": causes.join(": ") }),
        };
        super::tables::print_json(&value);
        return;
    }
    match error.downcast_ref::<Problems>() {
        Some(problems) => eprintln!("{problems}"),
        None => {
            eprintln!("error: {error}");
            for cause in error.chain().skip(1) {
                eprintln!("  caused by: {cause}");
            }
        }
    }
}

/// Prints a warning to standard error.
pub fn warn(message: &str) {
    eprintln!("warning: {message}");
}
