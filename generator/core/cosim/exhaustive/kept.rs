//! Converts the progress of an exhaustive check to the text of a file, and back.
//!
//! The file has a checksum, so that a file that was cut, or edited without a new checksum, is rejected. `glint cosim
//! --exhaustive --resume FILE` keeps its progress in such a file and continues from it, and `glint merge` reads the files of
//! all shards.

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use super::job::ShardState;
use crate::package::digest;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedShard {
    state: ShardState,
    /// The SHA-256 digest of the state as JSON without blanks, in hexadecimal.
    checksum: String,
}

fn checksum(state: &ShardState) -> Result<String> {
    Ok(digest(&serde_json::to_vec(state)?))
}

/// Returns the text of a file with the progress of a shard: JSON with a checksum.
///
/// # Errors
/// Fails if the state cannot be written as JSON.
pub fn to_text(state: &ShardState) -> Result<String> {
    let kept = SavedShard { state: state.clone(), checksum: checksum(state)? };
    Ok(serde_json::to_string_pretty(&kept)? + "\n")
}

/// Parses the text of a file with the progress of a shard, as [`to_text`] writes it.
///
/// # Errors
/// Fails if the text is no such file of this version of Glint, or if its checksum is wrong, because the file was changed.
pub fn from_text(text: &str) -> Result<ShardState> {
    let kept: SavedShard =
        serde_json::from_str(text).context("the file was not written by this version of Glint")?;
    ensure!(
        kept.checksum == checksum(&kept.state)?,
        "the checksum is wrong, so the file was changed"
    );
    Ok(kept.state)
}
