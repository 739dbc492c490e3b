//! Adds locations in the configuration file to errors that are found after the configuration was read.

use glint_base::config_error::ConfigError;

use super::problems::Problems;
use super::schema::Schema;
use super::source::ConfigSource;
use super::validate::of_default;
use super::values::Config;

impl ConfigSource {
    /// Returns the problem that the device of `schema` found in a configuration from this file. If the file does not set the key
    /// of `error`, the message says that the key has its default.
    pub fn refusal(&self, schema: &Schema, config: &Config, error: ConfigError) -> Problems {
        let defaulted = schema.key(&error.key).filter(|key| !self.gives(key.name));
        let message = match defaulted {
            Some(key) => of_default(key, config, &error.message),
            None => error.message,
        };
        self.problems(ConfigError { message, ..error })
    }

    /// Locates an error of a key in this file. Fails with `error` itself if it is no [`ConfigError`].
    pub fn located(&self, error: anyhow::Error) -> Result<Problems, anyhow::Error> {
        error.downcast::<ConfigError>().map(|error| self.problems(error))
    }

    fn problems(&self, error: ConfigError) -> Problems {
        let mut problems = Problems::of_source(self.clone());
        problems.push_error(error);
        problems
    }
}
