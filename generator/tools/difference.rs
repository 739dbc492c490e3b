//! Reads the first difference that a failing test bench printed, and runs the bench again for the waveform of the clocks before
//! the difference.

use std::fs;
use std::time::Duration;

use anyhow::{Context, Result};

use super::VerilogSimulator;
use super::bench::{BuiltBench, Waveform};
use crate::window::{WINDOW_FILE, window};

/// The first difference between simulated and expected outputs that a test bench printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BenchDifference {
    /// The number of the clock in the bench, from 0.
    pub clock: u64,
    /// The microinstruction that the core executes in this clock, as ``microinstruction `result` ``. The text is empty for a
    /// pipeline.
    pub during: String,
    pub signal: String,
    /// The simulated value in hexadecimal, which may contain x and z.
    pub simulated: String,
    /// The expected value from the vectors, in hexadecimal.
    pub expected: String,
}

impl BenchDifference {
    /// Returns the first difference in a bench's transcript, or `None` for a bench without differences.
    pub fn first(transcript: &str) -> Option<Self> {
        transcript.lines().find_map(Self::of_line)
    }

    /// Parses a line such as `clock 9, microinstruction 3 (result): red_out is 1f, expected 20`. A pipeline's line is `clock 9:
    /// red_out is 1f, expected 20`.
    fn of_line(line: &str) -> Option<Self> {
        let rest = line.strip_prefix("clock ")?;
        let (clock, rest) = rest.split_at(rest.find([',', ':'])?);
        // A microinstruction's name may contain any characters.
        let (executed, rest) = rest.rsplit_once(": ")?;
        let (signal, rest) = rest.split_once(" is ")?;
        let (simulated, expected) = rest.split_once(", expected ")?;
        let name = executed.split_once('(').and_then(|(_, name)| name.strip_suffix(')'));
        Some(Self {
            clock: clock.parse().ok()?,
            during: name.map_or_else(String::new, |name| format!("microinstruction `{name}`")),
            signal: signal.to_owned(),
            simulated: simulated.to_owned(),
            expected: expected.to_owned(),
        })
    }
}

/// Builds and runs the bench `top` of `files`, and returns the waveform (VCD) of the clocks from `from` to `to`, both included. A
/// module around the bench writes the waveform, such as `rsqrt_tb_window` in `rsqrt_tb_window.v` for the bench `rsqrt_tb`.
/// Building and running may each take at most `limit`.
///
/// # Errors
///
/// Fails if the simulator is missing or rejects the sources. Fails if the bench crashes, takes too long or ends without a
/// verdict, or if it writes no waveform.
pub fn bench_waveform(
    simulator: VerilogSimulator,
    files: &[(String, String)],
    top: &str,
    (from, to): (u64, u64),
    limit: Duration,
) -> Result<Vec<u8>> {
    let name = format!("{top}_window");
    let mut files = files.to_vec();
    files.push((format!("{name}.v"), window(&name, top, from, to)?));
    let bench = BuiltBench::build(simulator, &files, &name, Waveform::Written, limit)?;
    bench.run(limit)?;
    fs::read(bench.directory().join(WINDOW_FILE))
        .with_context(|| format!("{simulator} wrote no waveform"))
}
