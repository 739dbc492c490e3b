//! Tests that the shipped bench of a core fails for faults that are easily overlooked.
//!
//! A user who ports a core, edits a memory or uses another tool relies on this bench. The test plants the faults in the
//! committed files, one at a time. The records in `records/mutation/` have the share of all faults that the benches notice.

use std::path::Path;

use rayon::prelude::*;

use crate::common::cores::Files;
use crate::common::files::{paths, read};
use crate::common::tools::{assert_bench_passes, benched};
use crate::faults::{Fault, faults};
use glint::tools::VerilogSimulator;

/// Returns the committed Verilog and memories of a core and of its bench.
fn shipped(core: &str) -> Files {
    let mut files = Files::new();
    for directory in ["rtl_out", "testbench"] {
        for path in paths(Path::new(directory).join(core), "") {
            let name = path.rsplit('/').next().expect("a name").to_owned();
            if [".v", ".mem"].iter().any(|ending| name.ends_with(ending)) {
                files.push((name, read(path)));
            }
        }
    }
    files
}

#[test]
fn faults_in_the_datapath_make_it_fail() {
    faults("shipped benches").par_iter().for_each(|Fault { of: core, right, wrong }| {
        let mut files = shipped(core);
        let datapath = format!("{core}_datapath.v");
        let (_, text) = files.iter_mut().find(|(name, _)| *name == datapath).expect("a datapath");
        assert_eq!(text.matches(right).count(), 1, "{core}: `{right}`");
        *text = text.replace(right, wrong);
        let outcome = benched(VerilogSimulator::Icarus, &files, &format!("{core}_tb"));
        assert!(!outcome.passed, "{core}: `{wrong}` for `{right}` passes");
    });
}

#[test]
fn without_a_fault_it_passes() {
    for core in ["quad_cosine", "cosine_squared", "lyon", "rough", "quadratic", "blinn"] {
        assert_bench_passes(VerilogSimulator::Icarus, &shipped(core), &format!("{core}_tb"));
    }
}
