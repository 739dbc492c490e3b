//! Defines diagnostics: mistakes in a description, each with its message and the line of the Rust source.

use std::fmt;
use std::panic::Location;

use crate::codes::Code;
use crate::program::Program;

/// Where a description says something.
pub type SourceLocation = &'static Location<'static>;

/// A mistake in a description. For example, it prints as `error[G0203]: …`, with `  --> ` and the place in the Rust source on
/// the next line.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// The kind of the mistake.
    pub code: Code,
    /// The message, with the names of the signals.
    pub message: String,
    /// Where in the Rust source.
    pub location: SourceLocation,
    /// Other source locations that take part.
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

/// All mistakes of a description.
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
            write!(f, "\n`{Program} explain {}` says more", first.code)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}
