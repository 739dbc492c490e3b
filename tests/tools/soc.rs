//! The system of `examples/soc`: its pictures are those of `glint render`, and the cores are worth their place.

use std::path::Path;
use std::time::Duration;

use crate::common::tools::tool;

/// Verilator builds a processor, and simulates 132 million clocks of it: more than other tools need.
const LIMIT: Duration = Duration::from_secs(900);

#[test]
fn a_processor_renders_through_its_cores() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let place = tempfile::tempdir().expect("a directory");
    let glint = format!("GLINT={}", env!("CARGO_BIN_EXE_glint"));
    let script = root.join("examples/soc/run");
    let arguments = [glint.as_ref(), script.as_os_str(), place.path().as_os_str()];
    let output = tool("env")
        .run_to_success(arguments, root, LIMIT)
        .unwrap_or_else(|error| panic!("{error:#}"));
    for core in ["shade", "grain"] {
        let equal = format!("{core}: the pictures are equal, 6912 bytes");
        assert!(output.contains(&equal), "{output}");
    }
    // Clocks are counted in simulation, so that they are the same on every machine.
    let fewer = output.lines().filter(|line| line.trim().starts_with("span engine:"));
    let times: Vec<f64> = fewer
        .map(|line| {
            let word = line.split_whitespace().rev().nth(3).expect("a ratio");
            word.parse().expect("a number")
        })
        .collect();
    assert_eq!(times.len(), 3, "{output}");
    assert!(times.iter().all(|&times| times >= 6.0), "{output}");
}
