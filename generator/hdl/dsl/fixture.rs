//! Builds designs from a few microinstructions, for unit tests.

use super::{Designer, Step, end, step, valid};
use crate::netlist::Design;

/// Returns the design of a description that gives the microinstructions between the one that idles and the one with the result.
pub fn design(describe: impl FnOnce(&Designer) -> Vec<Step>) -> Design {
    let d = Designer::new("device");
    let mut steps = vec![step("idle", [])];
    steps.extend(describe(&d));
    steps.push(step("result", [valid(), end()]));
    d.microprogram(steps);
    d.finish().unwrap_or_else(|mistakes| panic!("{mistakes}"))
}
