//! Tests the video signal of `examples/video`: the pictures on the simulated screen equal the pictures of the model, and the
//! boards reach the clocks that the signal needs. `tests/kinds.toml` says which signals and boards a run
//! takes.

use crate::common::Sure;
use crate::common::files::root;
use crate::common::sample::sampled_by_name;
use crate::common::tools::{LIMIT, checkout, example, tool};

#[test]
fn cores_shade_under_the_beam() {
    let signals =
        ["icebreaker-ball", "ulx3s-ball", "ulx3s-mesh", "tangnano20k-ball", "tangnano20k-mesh"];
    for signal in sampled_by_name("signals of examples/video", signals, |it| (*it).to_owned()) {
        let dir = tempfile::tempdir().expect("a directory");
        let arguments = [dir.path().as_os_str(), "2".as_ref(), signal.as_ref()];
        let output = example("video/run", &arguments);
        let frames = [1, 2].map(|frame| {
            let equal = format!("{signal}, frame {frame}: the pictures are equal, 921600 bytes");
            assert!(output.contains(&equal), "{output}");
            let path = dir.path().join(signal).join(format!("frame{frame}.ppm"));
            std::fs::read(path).expect("a frame")
        });
        // The light of the ball moves.
        assert_eq!(frames[0] == frames[1], signal.ends_with("-mesh"), "{signal}");
        if signal == "ulx3s-ball" || signal == "tangnano20k-ball" {
            let shown = root().join("docs/images/video.png");
            let compare = root().join("examples/soc/compare.py");
            let seen = dir.path().join(signal).join("frame1.ppm");
            tool("python3")
                .run_to_success([compare, shown, seen], checkout(), LIMIT)
                .sure_of("docs/images/video.png is of another time");
        }
    }
}

#[test]
fn boards_keep_the_clocks() {
    let signals = [
        ("icebreaker", "ball"),
        ("ulx3s", "ball"),
        ("ulx3s", "mesh"),
        ("tangnano20k", "ball"),
        ("tangnano20k", "mesh"),
    ];
    let name_of = |(board, scene): &(&str, &str)| format!("{board} {scene}");
    for (board, scene) in sampled_by_name("bitstreams of examples/video", signals, name_of) {
        let dir = tempfile::tempdir().expect("a directory");
        let output =
            example("video/bitstream", &[board.as_ref(), scene.as_ref(), dir.path().as_os_str()]);
        assert!(output.contains("PASS") && !output.contains("FAIL"), "{output}");
        let file = match board {
            "icebreaker" => "icebreaker.bin",
            "ulx3s" => "ulx3s.bit",
            _ => "tangnano20k.fs",
        };
        let path = dir.path().join(format!("{board}-{scene}")).join(file);
        let bitstream = std::fs::metadata(path).expect("a bitstream");
        assert!(bitstream.len() > 10_000, "{} bytes", bitstream.len());
    }
}

#[test]
fn what_a_board_has_no_room_for_is_refused() {
    let script = root().join("examples/video/bitstream");
    let error = tool("bash")
        .run_to_success(
            [script.as_os_str(), "icebreaker".as_ref(), "mesh".as_ref()],
            checkout(),
            LIMIT,
        )
        .expect_err("it does not fit");
    assert!(format!("{error:#}").contains("take ulx3s"), "{error:#}");
}
