//! Tells errors: to people on standard error, to scripts as JSON, and to the shell by the exit code.

use std::fmt;
use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::interrupt::Interrupted;
use glint_config::Problems;

/// A mistake on the command line itself, which only a command can see: exit code 2.
#[derive(Debug)]
pub struct WrongUsage(pub String);

impl fmt::Display for WrongUsage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for WrongUsage {}

/// Returns from a function with [`WrongUsage`], whose words it formats.
macro_rules! wrong_usage {
    ($($text:tt)*) => { anyhow::bail!($crate::failure::WrongUsage(format!($($text)*))) };
}
pub(crate) use wrong_usage;

/// Several errors, none the cause of another: for example, the errors of several configurations.
#[derive(Debug)]
pub struct Several(pub Vec<anyhow::Error>);

impl fmt::Display for Several {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} errors", self.0.len())
    }
}

impl std::error::Error for Several {}

/// Returns the exit code for an error. For example, it is 2 for wrong usage, 130 after Ctrl-C, and 1 for a file that
/// cannot be read.
pub fn exit_code(error: &anyhow::Error) -> ExitCode {
    // Also when a context was put around it.
    if let Some(interrupted) = error.downcast_ref::<Interrupted>() {
        return ExitCode::from(interrupted.exit_code());
    }
    match error.downcast_ref::<WrongUsage>() {
        Some(_) => ExitCode::from(2),
        None => ExitCode::FAILURE,
    }
}

/// Prints an error with its causes: to standard error, or as a JSON object to standard output.
pub fn print(error: &anyhow::Error, as_json: bool) {
    if as_json {
        print_problems(problems(error));
    } else {
        print_text(error);
    }
}

/// Prints the problems as a JSON object; each problem has the keys of [`Problems::to_json`].
pub fn print_problems(problems: Vec<Value>) {
    super::tables::print_json(&json!({ "ok": false, "problems": problems }));
}

/// Returns a problem that is not in the text of a configuration. It has the same keys as a problem that is.
pub fn problem(message: &str) -> Value {
    json!({ "file": null, "line": null, "column": null, "key": null, "message": message, "remedy": null })
}

fn problems(error: &anyhow::Error) -> Vec<Value> {
    if let Some(Several(errors)) = error.downcast_ref() {
        return errors.iter().flat_map(problems).collect();
    }
    match error.downcast_ref::<Problems>().map(Problems::to_json) {
        Some(Value::Array(problems)) => problems,
        Some(other) => vec![other],
        None => vec![problem(&format!("{error:#}"))],
    }
}

fn print_text(error: &anyhow::Error) {
    if let Some(Several(errors)) = error.downcast_ref() {
        for (at, error) in errors.iter().enumerate() {
            if at > 0 {
                print_line("");
            }
            print_text(error);
        }
        return;
    }
    match error.downcast_ref::<Problems>() {
        Some(problems) => print_line(&problems.to_string()),
        None => {
            print_line(&format!("error: {error}"));
            for cause in error.chain().skip(1) {
                print_line(&format!("  caused by: {cause}"));
            }
        }
    }
}

/// Prints a warning to standard error. For example, the line may begin with `warning: my_core.toml: no waveform`.
pub fn warn(message: &str) {
    print_line(&format!("warning: {message}"));
}

/// Prints a line to standard error. When that cannot be written there is nobody left to tell.
fn print_line(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
