//! `<top>.sdc` and `<top>.xdc`: the clock, and nothing that is not known of the system around.

use anyhow::Result;
use askama::Template;

use crate::package::tops::Top;
use crate::package::{EmitInputs, render};

#[derive(Template)]
#[template(path = "constraints.sdc")]
struct Constraints<'a> {
    top: &'a Top,
    regenerate: &'a str,
    clock_mhz: f64,
    /// In nanoseconds.
    period: String,
    /// Who reads the file, and how.
    reader: &'static str,
}

/// Both files of each module.
///
/// # Errors
/// A template that fails.
pub fn files(inputs: &EmitInputs, tops: &[Top], clock_mhz: f64) -> Result<Vec<(String, String)>> {
    let mut files = Vec::new();
    for top in tops {
        for (ending, reader) in [
            ("sdc", "For Quartus, nextpnr, OpenSTA and all that read SDC."),
            ("xdc", "For Vivado: read_xdc -mode out_of_context."),
        ] {
            let constraints = Constraints {
                top,
                regenerate: &inputs.config,
                clock_mhz,
                period: period(clock_mhz),
                reader,
            };
            files.push((format!("{}.{ending}", top.module), render(&constraints)?));
        }
    }
    Ok(files)
}

/// In nanoseconds, with picoseconds. What is rounded off makes the clock faster, never slower.
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
