//! Builds small designs from a few microinstructions, for unit tests of the DSL.

use super::{Designer, Step, end, step, valid};
use crate::netlist::Design;

/// Puts the microinstructions of `describe` between an idle one and one that raises `valid`. Panics if the description has a
/// mistake.
pub fn design(describe: impl FnOnce(&Designer) -> Vec<Step>) -> Design {
    let d = Designer::new("device");
    let mut steps = vec![step("idle", [])];
    steps.extend(describe(&d));
    steps.push(step("result", [valid(), end()]));
    d.microprogram(steps);
    d.finish().unwrap_or_else(|mistakes| panic!("{mistakes}"))
}
