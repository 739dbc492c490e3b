//! Reports errors: as text on standard error, as JSON for scripts on standard output, and to the shell by the exit code.

use std::fmt;
use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};

use super::interrupt::Interrupted;
use glint_config::Problems;

/// An error with an exit code or a form of printing of its own. Any other error is printed as text with its causes, and has exit
/// code 1.
#[derive(Debug)]
pub enum Failure {
    /// A mistake on the command line that only the command can find, and not clap: exit code 2.
    WrongUsage(String),
    /// A signal arrived, and the command has saved its work.
    Interrupted(Interrupted),
    Problems(Problems),
    /// Independent errors, for example of several configurations.
    Several(Vec<anyhow::Error>),
}

impl Failure {
    /// Returns the failure in `error`, even if context was added.
    fn of_error(error: &anyhow::Error) -> Option<&Self> {
        error.downcast_ref()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WrongUsage(message) => f.write_str(message),
            Self::Interrupted(interrupted) => interrupted.fmt(f),
            Self::Problems(problems) => problems.fmt(f),
            Self::Several(errors) => write!(f, "{} errors", errors.len()),
        }
    }
}

impl std::error::Error for Failure {}

/// Returns from a function with [`Failure::WrongUsage`]. The macro formats its arguments to the message.
macro_rules! wrong_usage {
    ($($text:tt)*) => { anyhow::bail!($crate::failure::Failure::WrongUsage(format!($($text)*))) };
}
pub(crate) use wrong_usage;

/// Returns the exit code: 2 for wrong usage, 130 after Ctrl-C, and 1 for most other errors, such as a file that cannot be read.
pub fn exit_code(error: &anyhow::Error) -> ExitCode {
    match Failure::of_error(error) {
        Some(Failure::WrongUsage(_)) => ExitCode::from(2),
        Some(Failure::Interrupted(interrupted)) => ExitCode::from(interrupted.exit_code()),
        Some(Failure::Problems(_) | Failure::Several(_)) | None => ExitCode::FAILURE,
    }
}

/// Prints an error with its causes: as text to standard error, or with `as_json` as a JSON object to standard output.
pub fn print(error: &anyhow::Error, as_json: bool) {
    if as_json {
        print_problems(problems(error));
    } else {
        print_text(error);
    }
}

/// Prints a JSON object with the keys `ok`, which is false, and `problems`. Each problem must have the keys of
/// [`Problems::to_json`].
pub fn print_problems(problems: Vec<Value>) {
    super::tables::print_json(&json!({ "ok": false, "problems": problems }));
}

/// Returns a problem without a location in a configuration file. It has the keys of a problem with a location, but all except
/// `message` are null.
pub fn problem(message: &str) -> Value {
    json!({ "file": null, "line": null, "column": null, "key": null, "message": message, "remedy": null })
}

fn problems(error: &anyhow::Error) -> Vec<Value> {
    match Failure::of_error(error) {
        Some(Failure::Several(errors)) => errors.iter().flat_map(problems).collect(),
        Some(Failure::Problems(problems)) => match problems.to_json() {
            Value::Array(problems) => problems,
            other => vec![other],
        },
        Some(Failure::WrongUsage(_) | Failure::Interrupted(_)) | None => {
            vec![problem(&format!("{error:#}"))]
        }
    }
}

/// Prints an error as text. Problems of a configuration have snippets of the file.
fn print_text(error: &anyhow::Error) {
    match Failure::of_error(error) {
        Some(Failure::Several(errors)) => {
            for (at, error) in errors.iter().enumerate() {
                if at > 0 {
                    print_line("");
                }
                print_text(error);
            }
        }
        Some(Failure::Problems(problems)) => print_line(&problems.to_string()),
        Some(Failure::WrongUsage(_) | Failure::Interrupted(_)) | None => {
            print_line(&format!("error: {error}"));
            for cause in error.chain().skip(1) {
                print_line(&format!("  caused by: {cause}"));
            }
        }
    }
}

/// Prints a warning to standard error, such as `warning: my_core.toml: no waveform`.
pub fn warn(message: &str) {
    print_line(&format!("warning: {message}"));
}

/// Prints a line. A failure to write is ignored, because it could not be reported anywhere.
fn print_line(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
