//! Runs the passes that rewrite a computation before Glint schedules it as a pipeline.
//!
//! A pass replaces operations by others that compute the same results. For example, `split` replaces a product that is too wide
//! for a multiplier by a sum of narrower products. The tests of a pass are files, `passes/<name>/*.txt`: each has a computation
//! as text, and the computation that the pass must make from it.

use super::Options;
use super::gates::gated;
use super::graph::{Cell, NodeOp};
use super::split::split;
use super::text::printed;
use super::unroll::Unrolled;
use glint_base::target::Timing;

/// The name of the computation before all passes.
const UNROLL: &str = "unroll";

/// A rewrite of a computation that keeps its results.
pub struct Pass {
    /// The name of the pass, and of the directory with its test files.
    pub name: &'static str,
    /// A sentence for `glint schedule --passes`.
    pub description: &'static str,
    /// Says whether pipelines with these options need the pass.
    pub applies: fn(&Options) -> bool,
    /// Rewrites the computation for an FPGA target.
    pub run: fn(&Unrolled, &Timing) -> Unrolled,
}

/// All passes, in the order in which they run.
pub static PASSES: [Pass; 2] = [
    Pass {
        name: "split",
        description: "splits products that are too wide for a multiplier, and shortens sums",
        applies: |_| true,
        run: split,
    },
    Pass {
        name: "gates",
        description: "replaces muxes with a constant input by gates; runs if pipeline.multipliers is \"registered\"",
        applies: |options| options.registered,
        run: |unrolled, _| gated(unrolled),
    },
];

/// A computation after a pass, or before all passes.
pub struct PassResult {
    /// The name of the pass, or `unroll`.
    pub name: &'static str,
    pub description: &'static str,
    pub computation: Unrolled,
}

impl PassResult {
    /// Returns the computation as text, a line such as `sum u6.0 = add a b` for each value.
    pub fn text(&self) -> String {
        printed(&self.computation)
    }

    /// Returns the number of operations on which the results depend, with wiring, but without operands, constants and unknown
    /// values.
    pub fn operations(&self) -> usize {
        self.count(|cell| matches!(cell, Cell::Op(_) | Cell::Read { .. }))
    }

    /// Returns the number of multiplications on which the results depend.
    pub fn products(&self) -> usize {
        self.count(|cell| matches!(cell, Cell::Op(NodeOp::Mul(..))))
    }

    fn count(&self, is_counted: impl Fn(&Cell) -> bool) -> usize {
        let Unrolled { graph, results, .. } = &self.computation;
        let nodes = graph.cone(results.iter().map(|&(_, value)| value));
        nodes.into_iter().filter(|&id| is_counted(&graph.node(id).cell)).count()
    }
}

/// Returns `unrolled`, and the computation after each pass that applies.
pub fn results(unrolled: Unrolled, options: &Options) -> Vec<PassResult> {
    let description = "executes the microprogram symbolically, one clock after another";
    let mut results = vec![PassResult { name: UNROLL, description, computation: unrolled }];
    for pass in PASSES.iter().filter(|pass| (pass.applies)(options)) {
        let before = &results[results.len() - 1].computation;
        let computation = (pass.run)(before, options.target);
        results.push(PassResult { name: pass.name, description: pass.description, computation });
    }
    results
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::super::parse_text::{computed, parsed};
    use super::{PASSES, printed};
    use glint_base::target::TIMINGS;

    /// The number of combinations of operand values that one test file may have.
    const MOST: u64 = 1 << 16;

    /// Each file has a computation and the one that the pass must return. Both computations must have the same results for
    /// every combination of operand values.
    #[test]
    fn passes_make_what_their_files_say() {
        let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipeline/passes");
        for pass in &PASSES {
            let entries = fs::read_dir(place.join(pass.name)).expect("a directory of tests");
            let mut count = 0;
            for entry in entries {
                let path = entry.expect("a file").path();
                let text = fs::read_to_string(&path).expect("a test").replace("\r\n", "\n");
                let at = path.display();
                let (heading, rest) = text.split_once('\n').expect("a heading");
                let target = heading.strip_prefix("target ").expect("a target");
                let target = TIMINGS.iter().find(|it| it.name == target).expect("a target");
                let (given, wanted) = rest.split_once("\n->\n").expect("an arrow");
                let given = parsed(given).unwrap_or_else(|wrong| panic!("{at}: {wrong}"));
                let made = (pass.run)(&given, target);
                let said = printed(&made);
                assert_eq!(said.trim(), wanted.trim(), "{at}: the pass makes\n{said}");
                let operands = computed(&given, 0).1;
                assert!(operands <= MOST, "{at}: {operands} combinations of operands are too many");
                for combination in 0..operands {
                    let (before, after) =
                        (computed(&given, combination).0, computed(&made, combination).0);
                    assert_eq!(before, after, "{at}: combination {combination}");
                }
                count += 1;
            }
            assert!(count > 0, "{} has no tests", pass.name);
        }
    }
}
