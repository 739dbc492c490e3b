//! Reports the first difference between golden model and hardware, for people and for scripts, with a waveform file and a
//! command that reproduce the difference.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::Loaded;
use crate::destination::Destination;
use crate::failure;
use glint_base::program::Program;
use glint_core::cosim::exhaustive::{Clocks, Difference};
use glint_core::cosim::{Lockstep, Mismatch, Outcome};
use glint_rtl::sim::views;

/// The number of clocks in the waveform that ends with a difference.
const WINDOW: u64 = 64;

pub struct Reproducer {
    /// The waveform of the clocks before the difference.
    vcd: PathBuf,
    from: u64,
    command: String,
}

impl Reproducer {
    /// Simulates the stream of `mismatch` again, in which golden model and hardware of the core `one` differ. Writes a waveform
    /// that ends with the difference and begins at most 64 clocks earlier, into the file of [`waveform_of`].
    ///
    /// # Errors
    ///
    /// Fails if the run fails, or if the waveform cannot be written.
    pub fn of_run(one: &Loaded, mismatch: &Mismatch) -> Result<Self> {
        let (vcd, from) = window(one, mismatch);
        let lockstep = one.core.lockstep(mismatch.seed)?;
        let outcome = traced(one, &lockstep, Destination::open(&vcd)?, u64::MAX, from)?;
        Ok(Self {
            vcd,
            from,
            command: format!(
                "{Program} cosim {} --seed {} --points {} --vcd FILE",
                one.path,
                mismatch.seed,
                outcome.points + 1
            ),
        })
    }

    /// Simulates the combination of `difference` again, for which golden model and hardware of the core `one` differ. Writes a
    /// waveform that ends with the difference and begins at most 64 clocks earlier, into the file of [`waveform_of`].
    ///
    /// # Errors
    ///
    /// Fails if the run fails, or if the waveform cannot be written.
    pub fn of_combination(
        one: &Loaded,
        clocks: &Clocks<'_>,
        difference: &Difference,
    ) -> Result<Self> {
        let (vcd, from) = window(one, &difference.mismatch);
        write(one, Destination::open(&vcd)?, |file| clocks.trace(difference.place, from, file))?;
        Ok(Self { vcd, from, command: format!("{Program} cosim {} --exhaustive", one.path) })
    }

    /// Says in which clocks the difference is recorded, and how to record all clocks.
    pub fn text(&self, mismatch: &Mismatch) -> String {
        format!(
            "`{}` shows clocks {} to {}; to see all clocks: {}",
            self.vcd.display(),
            self.from,
            mismatch.clock,
            self.command
        )
    }

    /// Adds the waveform file as `vcd` and the command as `reproduce` to [`as_json`].
    pub fn json(&self, mismatch: &Mismatch) -> Value {
        let mut value = as_json(mismatch);
        value["vcd"] = json!(self.vcd.display().to_string());
        value["reproduce"] = json!(self.command);
        value
    }
}

/// Returns a difference as JSON. Bit patterns are text, such as `0x1f`: they may have 64 bits, and many JSON readers lose digits
/// of such numbers.
pub fn as_json(mismatch: &Mismatch) -> Value {
    json!({
        "seed": mismatch.seed,
        "clock": mismatch.clock,
        "during": mismatch.during,
        "signal": mismatch.signal,
        "golden": format!("{:#x}", mismatch.golden),
        "simulated": format!("{:#x}", mismatch.simulated),
    })
}

/// Returns the path of the waveform file, and the clock at which the waveform begins.
fn window(one: &Loaded, mismatch: &Mismatch) -> (PathBuf, u64) {
    (waveform_of(one), first_clock(mismatch.clock))
}

/// Returns the path of the waveform file in the working directory, for example `rough_mismatch.vcd`.
pub fn waveform_of(one: &Loaded) -> PathBuf {
    PathBuf::from(format!("{}_mismatch.vcd", one.core.config().name))
}

/// Returns the first clock of a waveform that ends with clock `clock`: 64 clocks earlier, but at least 0.
pub fn first_clock(clock: u64) -> u64 {
    clock.saturating_sub(WINDOW)
}

/// Runs the co-simulation again, for `points` results or up to a difference, and writes the waveform from clock `from` on. The
/// file is written under a temporary name, and renamed when it is complete.
///
/// # Errors
/// Fails if the simulation fails, or if the file cannot be written.
pub fn traced(
    one: &Loaded,
    lockstep: &Lockstep<'_>,
    destination: Destination,
    points: u64,
    from: u64,
) -> Result<Outcome> {
    write(one, destination, |file| lockstep.trace(points, from, file))
}

/// Lets `trace` write a waveform under a temporary name, and renames the file when it is complete. Also writes a view for each
/// waveform viewer, unless a view exists, which may be the user's. A view that cannot be written causes only a warning.
fn write<T>(
    one: &Loaded,
    destination: Destination,
    trace: impl FnOnce(BufWriter<File>) -> Result<T>,
) -> Result<T> {
    let outcome = trace(BufWriter::new(destination.file()?))
        .with_context(|| format!("cannot write the waveform `{}`", destination.path().display()))?;
    let path = destination.path().to_owned();
    destination.commit()?;
    if path.is_file() {
        let design = &one.core.design;
        for (ending, text) in [("gtkw", views::gtkwave(design)), ("sucl", views::surfer(design))] {
            let view = path.with_extension(ending);
            let there = fs::read_to_string(&view);
            if view.symlink_metadata().is_ok() {
                if there.is_ok_and(|there| there != text) {
                    let view = view.display();
                    failure::warn(&format!(
                        "`{view}` exists already and was not changed; to get a view of this waveform, remove \
                         the file"
                    ));
                }
            } else if let Err(error) = Destination::open(&view).and_then(|it| it.write(text)) {
                // The waveform itself is written, so this is only a warning.
                failure::warn(&format!("{error:#}"));
            }
        }
    }
    Ok(outcome)
}
