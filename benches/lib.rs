//! Code that the benchmarks share. `cargo bench -p glint-benches --bench paired` and `--bench generation` run the benchmarks.

use std::env;
use std::path::Path;

/// Makes the root of the repository the current directory, since the benchmarks read `configs/`.
///
/// # Panics
/// Panics if the repository is not where it was when the benchmark was compiled.
pub fn enter_repository() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    env::set_current_dir(root).expect("the repository");
}
