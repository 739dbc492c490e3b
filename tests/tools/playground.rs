//! Builds the web page that runs Glint as WebAssembly, and tests it in headless Chromium.

use crate::common::tools::{checkout, ran};

#[test]
fn the_page_does_what_the_program_does() {
    ran("bash", ["tools/playground", "--build"], checkout());
    let glint = env!("CARGO_BIN_EXE_glint");
    let said = ran("python", ["bindings/playground/test.py", "target/page", glint], checkout());
    assert!(said.contains("bytes gzipped"), "{said}");
}
