//! Defines the error of a configuration key whose value Glint cannot satisfy.

use std::fmt;

/// An error in the value of a configuration key, with a message and a remedy.
///
/// The error names the key but knows no file. A caller that knows the file can add the line of the key.
///
/// ```
/// # use glint_base::key_error::KeyError;
/// let error = KeyError::new("pipeline.clock_mhz", "`core` cannot run at 900 MHz", "set it to 130 or less");
/// assert_eq!(error.to_string(), "`pipeline.clock_mhz`: `core` cannot run at 900 MHz; set it to 130 or less");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct KeyError {
    /// The dotted name of the key, for example `cosine.fraction`. The name is empty if the error concerns the whole file.
    pub key: String,
    /// The description of the error, for the user. For example, "`core` cannot run at 900 MHz".
    pub message: String,
    /// The sentence that tells the user how to remove the error. For example, it lists the integers that the key accepts.
    pub remedy: String,
    /// The nearest valid value of the key, if the value is a number and the author of the check knows it; otherwise `None`.
    pub nearest: Option<f64>,
}

impl KeyError {
    /// Makes an error without a nearest value.
    pub fn new(
        key: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { key: key.into(), message: message.into(), remedy: remedy.into(), nearest: None }
    }

    /// Adds the nearest valid value of the key.
    #[must_use]
    pub fn with_nearest(self, nearest: f64) -> Self {
        Self { nearest: Some(nearest), ..self }
    }
}

impl fmt::Display for KeyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}; {}", self.key, self.message, self.remedy)
    }
}

impl std::error::Error for KeyError {}
