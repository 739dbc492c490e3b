//! Defines diagnostics: the mistakes in a hardware description, each with a message and the line of the Rust source.

use std::fmt;
use std::panic::Location;

use crate::codes::Code;
use crate::program::Program;

/// A line of the Rust source of a hardware description.
pub type SourceLocation = &'static Location<'static>;

/// A mistake in a hardware description. The mistake prints as `error[G0203]: …`, then ` --> ` with the place in the Rust source,
/// and a line for each note.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    pub code: Code,
    /// A sentence that names the signals, for example that nets form a loop.
    pub message: String,
    /// The line of the Rust source with the mistake.
    pub location: SourceLocation,
    /// Other places that contribute to the mistake, each with a remark.
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

/// All mistakes of a description. The printed list ends with the command that explains the first mistake's code.
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
