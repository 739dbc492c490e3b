//! The video signal of `examples/video`: what a screen would show is the picture of the model, and boards keep its clocks.

use std::path::Path;
use std::time::Duration;

use crate::common::sample::sampled;
use crate::common::tools::tool;

/// Verilator's C++ has to be compiled, which takes minutes where the machine is loaded.
const LIMIT: Duration = Duration::from_secs(900);

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What a script of the example prints.
fn script(name: &str, arguments: &[&str], place: &Path) -> String {
    let glint = format!("GLINT={}", env!("CARGO_BIN_EXE_glint"));
    let script = root().join("examples/video").join(name);
    let mut all = vec![glint.as_ref(), script.as_os_str()];
    all.extend(arguments.iter().map(|argument| argument.as_ref() as &std::ffi::OsStr));
    all.push(place.as_os_str());
    tool("env").run_to_success(all, root(), LIMIT).unwrap_or_else(|error| panic!("{error:#}"))
}

#[test]
fn a_core_shades_under_the_beam() {
    let place = tempfile::tempdir().expect("a directory");
    let output = script("run", &[], place.path());
    for board in ["icebreaker", "ulx3s"] {
        let frames = [1, 2].map(|frame| {
            let equal = format!("{board}, frame {frame}: the pictures are equal, 921600 bytes");
            assert!(output.contains(&equal), "{output}");
            place.path().join(board).join(format!("frame{frame}.ppm"))
        });
        let [first, second] = frames.each_ref().map(|path| std::fs::read(path).expect("a frame"));
        assert_ne!(first, second, "{board}: nothing moves");
    }
    // The picture that the README shows.
    let shown = root().join("docs/images/video.png");
    let compare = root().join("examples/soc/compare.py");
    tool("python3")
        .run_to_success([&compare, &shown, &place.path().join("ulx3s/frame1.ppm")], root(), LIMIT)
        .unwrap_or_else(|error| panic!("docs/images/video.png is of another time: {error:#}"));
}

#[test]
fn a_board_keeps_the_clocks() {
    for board in sampled("boards of examples/video", ["icebreaker", "ulx3s"], 1) {
        let place = tempfile::tempdir().expect("a directory");
        let output = script("bitstream", &[board], place.path());
        assert!(output.contains("PASS"), "{output}");
        assert!(!output.contains("FAIL"), "{output}");
        let file = if board == "icebreaker" { "icebreaker.bin" } else { "ulx3s.bit" };
        let bitstream =
            std::fs::metadata(place.path().join(board).join(file)).expect("a bitstream");
        assert!(bitstream.len() > 10_000, "{} bytes", bitstream.len());
    }
}
