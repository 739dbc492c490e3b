//! Converts the progress of an exhaustive check to the text of a file, and back.
//!
//! A checksum reveals a file that was cut or edited. `glint cosim --exhaustive --resume FILE` continues from such a file, and
//! `glint merge` reads the files of all shards.

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

/// Returns the text of a file with the state and a checksum. Fails if the state cannot be written as JSON.
pub fn to_text(state: &ShardState) -> Result<String> {
    let kept = SavedShard { state: state.clone(), checksum: checksum(state)? };
    Ok(serde_json::to_string_pretty(&kept)? + "\n")
}

/// Reads the state from the text of a file. Fails if this version of Glint did not write the text, or if the checksum is wrong.
pub fn from_text(text: &str) -> Result<ShardState> {
    let kept: SavedShard =
        serde_json::from_str(text).context("the file was not written by this version of Glint")?;
    ensure!(
        kept.checksum == checksum(&kept.state)?,
        "the checksum is wrong, so the file was changed"
    );
    Ok(kept.state)
}
