//! Defines the error of a configuration key whose value Glint cannot satisfy.

use std::fmt;
use std::ops::Range;

/// An error in a configuration key's value, with a message and a remedy.
///
/// The error names the key but knows no file.
///
/// ```
/// # use glint_base::config_error::ConfigError;
/// let error = ConfigError::new("pipeline.clock_mhz", "`core` cannot run at 900 MHz", "set it to 130 or less");
/// assert_eq!(error.to_string(), "`pipeline.clock_mhz`: `core` cannot run at 900 MHz; set it to 130 or less");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ConfigError {
    /// The dotted name of the key, for example `cosine.fraction`, or empty for an error of the whole file.
    pub key: String,
    /// The range of bytes in the key's text that the error concerns, for example an operator in a formula. `None` means the whole
    /// value.
    pub place: Option<Range<usize>>,
    /// A message for the user, for example "`core` cannot run at 900 MHz".
    pub message: String,
    /// A sentence that tells the user how to remove the error, for example with a list of the accepted integers.
    pub remedy: String,
    /// The nearest valid value of the key, if it is a number and the author of the check knows it.
    pub nearest: Option<f64>,
}

impl ConfigError {
    /// Returns an error that concerns the whole value of the key, without a nearest value.
    pub fn new(
        key: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            key: key.into(),
            place: None,
            message: message.into(),
            remedy: remedy.into(),
            nearest: None,
        }
    }

    /// Narrows the error to the bytes `place` of the key's text.
    #[must_use]
    pub fn at(self, place: impl Into<Option<Range<usize>>>) -> Self {
        Self { place: place.into(), ..self }
    }

    #[must_use]
    pub fn with_nearest(self, nearest: f64) -> Self {
        Self { nearest: Some(nearest), ..self }
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}; {}", self.key, self.message, self.remedy)
    }
}

impl std::error::Error for ConfigError {}
