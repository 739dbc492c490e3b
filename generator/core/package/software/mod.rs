//! Generates `software/<name>/`: what a driver's author starts from before there is hardware.
//!
//! The model in C computes what the core computes, bit for bit. It is made of the netlist, by its microprogram, and
//! knows nothing of the golden model, with which tests compare it.

mod litex;
mod model;
mod print;
mod recompute;
mod registers;
mod setup;
mod stream;

use anyhow::Result;

use super::artifact::{Artifacts, Job};
use super::tops::Top;
pub use recompute::check as check_recomputation;

/// Adds what the configuration asks for.
///
/// # Errors
/// A core that does not fit.
pub fn files(job: &Job, tops: &[Top], files: &mut Artifacts) -> Result<()> {
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
    if job.inputs.around.litex {
        litex::file(job, tops, files)?;
    }
    Ok(())
}
