//! Writes a Verilog module around a test bench. The module dumps the waveform of a range of clocks.

use anyhow::Result;
use glint_base::fill;

/// The name of the waveform file (VCD). The test bench inside the module must not write a file of this name.
pub const WINDOW_FILE: &str = "window.vcd";

/// The number of units of simulated time in a clock of the bench.
const CLOCK: u64 = 10;

/// Returns the Verilog of a module `name` around the module `bench`, which must be a bench of `glint_core::package::emit`. The
/// module writes the waveform of the clocks from `from` to `to`, both included, to [`WINDOW_FILE`], and then ends the run like a
/// failing bench. A clock takes 10 units of time. For clocks 3 to 5, the waveform begins at time 31 and has a length of 29.
///
/// # Errors
///
/// Fails if the template cannot be filled, which would be a bug.
pub fn window(name: &str, bench: &str, from: u64, to: u64) -> Result<String> {
    // The waveform begins one unit after the clock, when the bench has set its variables.
    let begin = from * CLOCK + 1;
    let length = (to + 1) * CLOCK - begin;
    fill!("window.v" {
        name: &'a str, bench: &'a str, file: &'a str = WINDOW_FILE, from: u64, to: u64, begin: u64, length: u64,
    })
}
