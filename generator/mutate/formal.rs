//! The text of a module and one with a fault, proved to behave alike by Yosys.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;

use crate::tools::Tool;

/// The file in which the module with a fault stands beside the sound one.
pub(super) const MUTANT: &str = "glint_mutant.v";

/// Whether every net of the module `name` that has a counterpart, registers and ports among them, carries
/// the same in both for all inputs: temporal induction from a state in which they agree, cells with the same
/// inputs, multipliers and ROMs among them, taken together first. The sound text is in `directory` as
/// `<name>.v`, the other as [`MUTANT`]. A proof that fails or takes more than `limit` proves nothing.
///
/// # Errors
/// Yosys is missing.
pub(super) fn proves(directory: &Path, name: &str, limit: Duration) -> Result<bool> {
    let yosys = Tool::find("yosys")?;
    let read = |file: &str, by: &str| {
        format!(
            "read_verilog {file}; prep -top {name}; opt; rename {name} {by}; design -stash {by}; "
        )
    };
    let commands = format!(
        "{}{}design -copy-from gold -as gold gold; design -copy-from gate -as gate gate; \
         equiv_make gold gate equiv; prep -top equiv; opt_clean; \
         equiv_struct -icells; equiv_simple -short; equiv_induct; equiv_status -assert",
        read(&format!("{name}.v"), "gold"),
        read(MUTANT, "gate"),
    );
    let run = yosys.run(["-q", "-p", &commands], directory, limit);
    Ok(run.is_ok_and(|run| run.status.success()))
}
