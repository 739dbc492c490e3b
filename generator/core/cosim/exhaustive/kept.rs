//! Writes and reads the state of a job as the text of a file. A checksum detects a file that was cut or changed.

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use super::job::ShardState;
use crate::package::digest;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedShard {
    state: ShardState,
    /// SHA-256 of the state as JSON without blanks.
    checksum: String,
}

fn checksum(state: &ShardState) -> Result<String> {
    Ok(digest(&serde_json::to_vec(state)?))
}

/// Returns the text of a file that keeps a state.
///
/// # Errors
/// Fails if the state cannot be written as JSON.
pub fn to_text(state: &ShardState) -> Result<String> {
    let kept = SavedShard { state: state.clone(), checksum: checksum(state)? };
    Ok(serde_json::to_string_pretty(&kept)? + "\n")
}

/// Returns the state that a file keeps.
///
/// # Errors
/// Fails if the text is not the text of such a file, or was changed since it was written.
pub fn from_text(text: &str) -> Result<ShardState> {
    let kept: SavedShard =
        serde_json::from_str(text).context("not a file of this version of Glint")?;
    ensure!(kept.checksum == checksum(&kept.state)?, "the checksum is wrong: it was changed");
    Ok(kept.state)
}
