//! The system of `examples/soc`: its picture is that of `glint render`, and the core is worth its place.

use std::path::Path;
use std::time::Duration;

use crate::common::tools::tool;

/// Verilator builds a processor, and simulates 135 million clocks of it: more than other tools need.
const LIMIT: Duration = Duration::from_secs(900);

#[test]
fn a_processor_renders_through_a_core() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let place = tempfile::tempdir().expect("a directory");
    let glint = format!("GLINT={}", env!("CARGO_BIN_EXE_glint"));
    let script = root.join("examples/soc/run");
    let arguments = [glint.as_ref(), script.as_os_str(), place.path().as_os_str()];
    let output = tool("env")
        .run_to_success(arguments, root, LIMIT)
        .unwrap_or_else(|error| panic!("{error:#}"));
    assert!(output.contains("the pictures are equal, 6912 bytes"), "{output}");
    // Clocks are counted in simulation, so that they are the same on every machine.
    let by_hand = output.lines().find(|line| line.starts_with("C by hand:")).expect("a count");
    let times = by_hand.split_whitespace().rev().nth(5).and_then(|word| word.parse::<f64>().ok());
    assert!(times.is_some_and(|times| times >= 6.0), "{output}");
}
