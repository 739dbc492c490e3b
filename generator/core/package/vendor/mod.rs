//! Generates files for the tools of FPGA vendors: constraints, Tcl scripts and IP-XACT descriptions.

mod constraints;
mod ip_xact;
mod tcl;

use anyhow::Result;

use super::emit_job::EmitJob;
use super::output_files::OutputFiles;
use super::tops::Top;

pub fn files(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    let around = &job.inputs.around;
    if let Some(clock_mhz) = around.clock_mhz {
        constraints::files(job, tops, clock_mhz, files)?;
    }
    if around.vivado {
        tcl::vivado(job, tops, files)?;
    }
    if around.quartus {
        tcl::quartus(job, tops, files)?;
    }
    if around.ip_xact {
        ip_xact::files(job, tops, files)?;
    }
    Ok(())
}
