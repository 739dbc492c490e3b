//! Measures a frequency in parallel, once for each seed, and collects the results. A caller gives the function that runs the
//! tools.

use anyhow::{Context, Result};
use rayon::prelude::*;

use super::{Figures, PathPoint, SynthesisSubject};

/// Runs `route` (placement, routing and timing analysis) once for each seed from 1 to `subject.seeds`, and adds the results to
/// `figures`: frequencies in MHz, and longest paths. Calls `done` for each seed. If `figures` already has a reason why no
/// frequency can be measured, `route` is not run. Without seeds, `figures` gets such a reason.
///
/// # Errors
/// Fails if a run fails; the message has its seed, for example `seed 2`.
pub fn routed(
    mut figures: Figures,
    subject: &SynthesisSubject,
    done: &(dyn Fn() + Sync),
    route: impl Fn(u32) -> Result<(f64, Vec<PathPoint>)> + Sync,
) -> Result<Figures> {
    let possible = figures.untimed.is_none();
    if possible && subject.seeds == 0 {
        figures.untimed = Some("area alone, because --seeds is 0".to_owned());
    }
    let runs = (1..=subject.seeds).into_par_iter().filter_map(|seed| {
        let run = possible.then(|| route(seed).with_context(|| format!("seed {seed}")));
        done();
        run
    });
    let runs = runs.collect::<Result<_>>()?;
    Ok(figures.with_runs(runs))
}
