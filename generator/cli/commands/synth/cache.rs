//! Keeps the measurements of `glint synth` in the folder `.glint/` next to the configuration file, so that they are not repeated.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::destination;
use glint_base::input;
use glint_core::core::Core;
use glint_prove::synth::{Figures, Target};

/// The folder beside configurations, which may be deleted at any time.
const FOLDER: &str = ".glint";

/// A folder with one file for each configuration and target. A file that is not readable is measured again, and a
/// measurement that cannot be kept is not kept. For example, `.glint/rough.ecp5.json`.
pub struct Cache(PathBuf);

#[derive(Serialize, Deserialize)]
struct CacheEntry {
    glint: String,
    digest: String,
    figures: Figures,
}

impl Cache {
    /// Returns the cache beside the configuration `path`; none beside standard input.
    pub fn beside(path: &str) -> Option<Self> {
        (path != input::STDIN)
            .then(|| Self(Path::new(path).parent().unwrap_or(Path::new("")).join(FOLDER)))
    }

    fn file(&self, core: &Core, target: Target) -> PathBuf {
        self.0.join(format!("{}.{target}.json", core.config.name))
    }

    /// Returns the figures of a measurement with this digest.
    pub fn find(&self, core: &Core, target: Target, digest: &str) -> Option<Figures> {
        let text = fs::read_to_string(self.file(core, target)).ok()?;
        let entry: CacheEntry = serde_json::from_str(&text).ok()?;
        (entry.digest == digest).then_some(entry.figures)
    }

    /// Keeps figures, if the folder can be written: a cache that cannot be kept is no error.
    pub fn keep(&self, core: &Core, digest: &str, figures: &Figures) {
        let entry = CacheEntry {
            glint: env!("CARGO_PKG_VERSION").to_owned(),
            digest: digest.to_owned(),
            figures: figures.clone(),
        };
        let text = serde_json::to_string_pretty(&entry);
        if let (Ok(text), Ok(())) = (text, fs::create_dir_all(&self.0)) {
            let _ = destination::replace(&self.file(core, figures.target), text);
        }
    }
}
