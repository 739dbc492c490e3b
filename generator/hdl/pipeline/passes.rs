//! Runs the passes that rewrite an unrolled computation before it is scheduled. A pass replaces operations by others that compute
//! the same values. For example, one splits a product that is too wide for a multiplier.
//!
//! The tests of a pass are files, `passes/<name>/*.txt`: a computation as text, and the computation that the pass
//! must make of it.

use super::Options;
use super::gates::gated;
use super::split::split;
use super::unroll::Unrolled;
use glint_base::target::Timing;

/// A pass: a rewriting of a computation before Glint schedules it as a pipeline. For example, it splits wide products. Results stay
/// the same.
pub struct Pass {
    /// The name of the pass, and of the directory with the files that test it. For example, `split`.
    pub name: &'static str,
    /// Returns whether a pipeline with these options uses the pass.
    pub applies: fn(&Options) -> bool,
    /// Returns the computation as the pass rewrites it for an FPGA target.
    pub run: fn(&Unrolled, &Timing) -> Unrolled,
}

/// All passes that may rewrite a computation before Glint schedules it, in the order in which they run.
pub static PASSES: [Pass; 2] = [
    // Products no wider than the multipliers of the target, and sums as short as they can be.
    Pass { name: "split", applies: |_| true, run: split },
    // Gates in place of muxes with constants, where products have registers of their own.
    Pass { name: "gates", applies: |options| options.registered, run: |it, _| gated(it) },
];

/// Runs the passes that apply to a pipeline with these options, and returns the rewritten computation.
pub fn applied(unrolled: Unrolled, options: &Options) -> Unrolled {
    let passes = PASSES.iter().filter(|pass| (pass.applies)(options));
    passes.fold(unrolled, |unrolled, pass| (pass.run)(&unrolled, options.target))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::super::text::{computed, parsed, printed};
    use super::PASSES;
    use glint_base::target::TIMINGS;

    /// Combinations of operands that are computed of a test.
    const MOST: u64 = 1 << 16;

    /// In every file: the pass makes the computation behind the arrow, and the results are the same for every
    /// operand.
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
