//! Generates the clock constraints of a module, `<top>.sdc` for Quartus and open tools, and `<top>.xdc` for Vivado.
//!
//! Only the clock is constrained. Other constraints, such as delays at ports, depend on the system around the module.

use anyhow::Result;
use glint_base::fill;

use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use crate::package::tops::Top;

pub fn files(job: &EmitJob, tops: &[Top], clock_mhz: f64, files: &mut OutputFiles) -> Result<()> {
    for top in tops {
        for (ending, reader) in [
            ("sdc", "This file is for Quartus, nextpnr, OpenSTA and other tools that read SDC."),
            ("xdc", "This file is for Vivado: read_xdc -mode out_of_context."),
        ] {
            let text = fill!("constraints.sdc" {
                top: &'a Top, regenerate: &'a str = job.regenerate(), clock_mhz: f64,
                // The period of the clock in nanoseconds.
                period: String = period(clock_mhz),
                // Who reads the file, and how.
                reader: &'a str,
            })?;
            files.add(FileKind::Constraint, format!("{}.{ending}", top.module), text);
        }
    }
    Ok(())
}

/// Returns the period in nanoseconds with three decimals, rounded down, so that the constraint is never slower than the clock.
/// For example, 130 MHz gives 7.692.
fn period(clock_mhz: f64) -> String {
    let picoseconds = libm::floor(1e6 / clock_mhz);
    format!("{:.3}", picoseconds / 1e3)
}

#[cfg(test)]
mod tests {
    use super::period;

    #[test]
    fn periods_are_never_longer_than_the_clock_allows() {
        for (clock_mhz, expected) in [
            (100.0, "10.000"),
            (130.0, "7.692"),
            (2000.0, "0.500"),
            (1.0, "1000.000"),
            (12.0, "83.333"),
        ] {
            assert_eq!(period(clock_mhz), expected, "{clock_mhz} MHz");
        }
    }
}
