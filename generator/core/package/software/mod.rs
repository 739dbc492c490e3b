//! Generates `software/<name>/`: a bit-exact model of the core in C, register headers and other files for the author of a driver.
//!
//! The author of a driver can start with these files before there is hardware. Glint generates the C model from the netlist
//! and its microprogram, which the golden model does not read. Tests compare both models and so find mistakes in either.

mod instructions;
mod litex;
mod model;
mod print;
mod recompute;
mod registers;
mod setup;
mod stream;
mod table;

use anyhow::Result;

use super::emit_job::EmitJob;
use super::output_files::OutputFiles;
use super::tops::Top;
pub use recompute::check as check_recomputation;
pub use table::{image_file, image_header};

/// Adds the software files that the configuration asks for.
///
/// # Errors
/// Fails if the core cannot be written in one of these forms. For example, no C function can wait for a second `start`.
pub fn files(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    if job.inputs.around.software {
        let read = model::files(job, files)?;
        if job.inputs.around.recomputation {
            recompute::file(job, &read, files)?;
        }
        setup::files(job, files)?;
    }
    if job.inputs.around.stream {
        stream::files(job, files)?;
    }
    if let Some((bus, map)) = &job.registers {
        registers::files(job, bus, map, files)?;
    }
    if let Some((_, instructions)) = &job.instructions {
        instructions::file(job, instructions, files)?;
    }
    table::files(job, files)?;
    if job.inputs.around.litex {
        litex::file(job, tops, files)?;
    }
    Ok(())
}
