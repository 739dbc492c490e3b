//! Defines the error of a configuration key whose value Glint cannot satisfy.

use std::fmt;
use std::ops::Range;

/// An error in the value of a configuration key, with a message and a remedy.
///
/// The error names the key but knows no file. A caller that knows the file can add the line of the key.
///
/// ```
/// # use glint_base::config_error::ConfigError;
/// let error = ConfigError::new("pipeline.clock_mhz", "`core` cannot run at 900 MHz", "set it to 130 or less");
/// assert_eq!(error.to_string(), "`pipeline.clock_mhz`: `core` cannot run at 900 MHz; set it to 130 or less");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ConfigError {
    /// The dotted name of the key, for example `cosine.fraction`. The name is empty if the error concerns the whole file.
    pub key: String,
    /// The range of bytes in the key's text that the error concerns, for example an operator in a formula. `None` if the error
    /// concerns the whole value.
    pub place: Option<Range<usize>>,
    /// The description of the error, for the user. For example, "`core` cannot run at 900 MHz".
    pub message: String,
    /// The sentence that tells the user how to remove the error. For example, it lists the integers that the key accepts.
    pub remedy: String,
    /// The nearest valid value of the key, if the value is a number and the author of the check knows it; otherwise `None`.
    pub nearest: Option<f64>,
}

impl ConfigError {
    /// Makes an error that concerns the whole value of the key, without a nearest value.
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

    /// Returns the error for the bytes `place` of the key's text; for the whole value if `place` is `None`.
    #[must_use]
    pub fn at(self, place: impl Into<Option<Range<usize>>>) -> Self {
        Self { place: place.into(), ..self }
    }

    /// Adds the nearest valid value of the key.
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
