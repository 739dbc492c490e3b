//! The bench that is shipped with a core fails for faults that are easily overlooked.
//!
//! Whoever ports a core, edits a memory or takes another tool relies on it. The faults are planted in the committed
//! files, one at a time; the share of all faults that the benches notice is in the records in `mutation/`.

use std::fs;
use std::path::Path;

use rayon::prelude::*;

use crate::common::cores::Files;
use crate::common::tools::{LIMIT, assert_bench_passes};
use crate::faults::{Fault, faults};
use glint::tools::{Simulator, run_bench};

/// Returns the committed Verilog and memories of a core and of its bench.
fn shipped(core: &str) -> Files {
    let mut files = Files::new();
    for directory in ["rtl_out", "testbench"] {
        let dir = Path::new(directory).join(core);
        let entries = fs::read_dir(&dir).unwrap_or_else(|error| panic!("{dir:?}: {error}"));
        for entry in entries {
            let path = entry.expect("an entry").path();
            let is_read = path.extension().is_some_and(|it| it == "v" || it == "mem");
            if let Some(name) = path.file_name().filter(|_| is_read) {
                let text = fs::read_to_string(&path).expect("a text");
                files.push((name.to_string_lossy().into_owned(), text));
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
        let outcome = run_bench(Simulator::Icarus, &files, &format!("{core}_tb"), LIMIT)
            .unwrap_or_else(|error| panic!("{core}: `{wrong}`: {error:#}"));
        assert!(!outcome.passed, "{core}: `{wrong}` for `{right}` passes");
    });
}

#[test]
fn without_a_fault_it_passes() {
    for core in ["quad_cosine", "cosine_squared", "lyon", "rough", "quadratic", "blinn"] {
        assert_bench_passes(Simulator::Icarus, &shipped(core), &format!("{core}_tb"));
    }
}
