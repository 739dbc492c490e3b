//! Defines diagnostics: the mistakes in a hardware description, each with a message and the line of the Rust source.

use std::fmt;
use std::panic::Location;

use crate::codes::Code;
use crate::program::Program;

/// A line of the Rust source of a hardware description. For example, the line that declares a register.
pub type SourceLocation = &'static Location<'static>;

/// A mistake in a hardware description. The printed mistake begins with `error[G0203]: …`, followed by a line with ` --> ` and
/// the place in the Rust source, and by a line for each note.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// The code of the kind of mistake, such as `G0203`.
    pub code: Code,
    /// The message, which names the signals.
    pub message: String,
    /// The line of the Rust source that contains the mistake.
    pub location: SourceLocation,
    /// Other places in the Rust source that contribute to the mistake, each with a remark.
    pub notes: Vec<(String, SourceLocation)>,
}

impl Diagnostic {
    pub fn new(code: Code, message: String, location: SourceLocation) -> Self {
        Self { code, message, location, notes: Vec::new() }
    }

    pub fn note(mut self, note: String, location: SourceLocation) -> Self {
        self.notes.push((note, location));
        self
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "error[{}]: {}\n  --> {}", self.code, self.message, self.location)?;
        for (note, location) in &self.notes {
            write!(f, "\n  note: {note}: {location}")?;
        }
        Ok(())
    }
}

/// All mistakes of a hardware description. The printed list ends with the command that explains the code of the first mistake.
#[derive(Clone, Debug)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (at, diagnostic) in self.0.iter().enumerate() {
            if at > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{diagnostic}")?;
        }
        if let Some(first) = self.0.first() {
            write!(f, "\n`{Program} explain {}` explains the mistake", first.code)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}
