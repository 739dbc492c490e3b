//! The bench that is shipped with a core fails for faults that are easily overlooked.
//!
//! Whoever ports a core, edits a memory or takes another tool relies on it. The faults are planted in the committed
//! files, one at a time; the share of all faults that the benches notice is in the records in `mutation/`.

use std::fs;
use std::path::Path;

use rayon::prelude::*;

use crate::common::cores::Files;
use crate::common::tools::{LIMIT, assert_bench_passes};
use glint::tools::{Simulator, run_bench};

/// A fault: the core, what stands once in its datapath, and what takes its place.
type Planted = (&'static str, &'static str, &'static str);

const FAULTS: [Planted; 26] = [
    // Operators, enables and the magnitude of the devices that walk lines.
    ("quad_cosine", "cosine_word * amplitude_reg", "cosine_word + amplitude_reg"),
    ("quad_cosine", "angle_magnitude * root_word", "angle_magnitude + root_word"),
    ("quad_cosine", "if (amplitude_load)", "if (!amplitude_load)"),
    ("quad_cosine", "if (delta_zeta_load)", "if (!delta_zeta_load)"),
    ("quad_cosine", "if (exponent_load)", "if (!exponent_load)"),
    ("quad_cosine", "angle_negative ? angle_complement : angle_leading", "angle_leading"),
    ("quad_cosine", "exponent_reg > SECOND_EXPONENT", "exponent_reg >= SECOND_EXPONENT"),
    ("quad_cosine", "exponent_reg < HIGH_EXPONENTS", "exponent_reg <= HIGH_EXPONENTS"),
    ("quad_cosine", "(|scaled_angle[33:31])", "(&scaled_angle[33:31])"),
    ("cosine_squared", "cosine_word * amplitude_reg", "cosine_word + amplitude_reg"),
    ("cosine_squared", "if (amplitude_load)", "if (!amplitude_load)"),
    ("cosine_squared", "if (zeta_start_load)", "if (!zeta_start_load)"),
    ("cosine_squared", "angle_negative ? angle_complement : angle_leading", "angle_leading"),
    ("cosine_squared", "= &angle_upper;", "= |angle_upper;"),
    // Constants at a limit. With 17'h0ffff, say, nothing would change: what is between is 0 anyway.
    ("lyon", "ONE = 17'h10000", "ONE = 17'h10001"),
    ("lyon", "ONE = 17'h10000", "ONE = 17'h08000"),
    ("lyon", "shift_register[26] ? 27'h7ffffff", "shift_register[26] ? 27'h0000000"),
    // Arms of muxes.
    (
        "rough",
        "sine_in_range6 ? sine_rest5 : sine_rest7",
        "sine_in_range6 ? sine_rest7 : sine_rest5",
    ),
    ("rough", "sine_in_range6 ? sine_rest5 : sine_rest7", "sine_rest5"),
    ("rough", "sine_in_range6 ? sine_rest5 : sine_rest7", "sine_rest7"),
    ("rough", "sine_in_range4 ? sine_rest1 : sine_rest6", "sine_rest1"),
    // Reductions.
    ("rough", "= |complement[20:10];", "= &complement[20:10];"),
    ("quadratic", "(|adder2[34:27])", "(&adder2[34:27])"),
    ("quadratic", "(|adder2[34:27])", "(|adder2[34:28])"),
    ("blinn", "(|product[33:24])", "(&product[33:24])"),
    ("blinn", "(|product[33:31])", "(&product[33:31])"),
];

/// The committed Verilog and memories of a core and of its bench.
fn shipped(core: &str) -> Files {
    let mut files = Files::new();
    for directory in ["rtl_out", "testbench"] {
        let place = Path::new(directory).join(core);
        let entries = fs::read_dir(&place).unwrap_or_else(|error| panic!("{place:?}: {error}"));
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
    FAULTS.par_iter().for_each(|&(core, fault_free, fault)| {
        let mut files = shipped(core);
        let datapath = format!("{core}_datapath.v");
        let (_, text) = files.iter_mut().find(|(name, _)| *name == datapath).expect("a datapath");
        assert_eq!(text.matches(fault_free).count(), 1, "{core}: `{fault_free}`");
        *text = text.replace(fault_free, fault);
        let outcome = run_bench(Simulator::Icarus, &files, &format!("{core}_tb"), LIMIT)
            .unwrap_or_else(|error| panic!("{core}: `{fault}`: {error:#}"));
        assert!(!outcome.passed, "{core}: `{fault}` for `{fault_free}` passes");
    });
}

#[test]
fn without_a_fault_it_passes() {
    for core in ["quad_cosine", "cosine_squared", "lyon", "rough", "quadratic", "blinn"] {
        assert_bench_passes(Simulator::Icarus, &shipped(core), &format!("{core}_tb"));
    }
}
