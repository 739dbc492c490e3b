//! Stores the measurements of `glint synth` in the folder `.glint/` next to the configuration file, so they need not be repeated.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::destination;
use glint_base::input;
use glint_prove::synth::{Figures, Target};

/// The folder of the cache. The user may delete it at any time.
const FOLDER: &str = ".glint";

/// A cache with one file for each configuration and target, such as `.glint/rough.ecp5.json`. A file that cannot be read or
/// written is no error: the core is then measured again, or the measurement is not stored.
pub struct Cache(PathBuf);

#[derive(Serialize, Deserialize)]
struct CacheEntry {
    glint: String,
    digest: String,
    figures: Figures,
}

impl Cache {
    /// Returns the cache for the configuration `path`, or `None` if the configuration comes from standard input, which has no
    /// folder.
    pub fn beside(path: &str) -> Option<Self> {
        (path != input::STDIN)
            .then(|| Self(Path::new(path).parent().unwrap_or(Path::new("")).join(FOLDER)))
    }

    fn file(&self, name: &str, target: Target) -> PathBuf {
        self.0.join(format!("{name}.{target}.json"))
    }

    /// Returns the stored figures, or `None` without a file or if the figures have a different digest.
    pub fn find(&self, name: &str, target: Target, digest: &str) -> Option<Figures> {
        let text = fs::read_to_string(self.file(name, target)).ok()?;
        let entry: CacheEntry = serde_json::from_str(&text).ok()?;
        (entry.digest == digest).then_some(entry.figures)
    }

    /// Stores the figures. Does nothing if the folder cannot be written.
    pub fn keep(&self, name: &str, digest: &str, figures: &Figures) {
        let entry = CacheEntry {
            glint: env!("CARGO_PKG_VERSION").to_owned(),
            digest: digest.to_owned(),
            figures: figures.clone(),
        };
        let text = serde_json::to_string_pretty(&entry);
        if let (Ok(text), Ok(())) = (text, fs::create_dir_all(&self.0)) {
            let _ = destination::replace(&self.file(name, figures.target), text);
        }
    }
}
