//! Tests the command line with random arguments: the program ends with the exit code 0, 1 or 2 and writes nothing outside its
//! directory. A failure prints a message; with `--json`, a failure with code 1 prints JSON.

use std::time::{Duration, Instant};

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

use crate::workspace::{Run, Workspace};

/// A run that takes so long hangs: none of the arguments asks for much.
const HANGS: Duration = Duration::from_secs(120);

/// The working directory, one level below a directory in which nothing must appear.
const INNER: &str = "inner";

/// Few enough points, and a file for each purpose.
const NARROW: &str = include_str!("../../../configs/reduced/cosine_squared.toml");

/// The commands, some of them.
const COMMANDS: &str = "generate cosim merge eval setup list new describe compare render check";

/// The other pieces of a command line, and some that are none.
const PIECES: &str = "
    help --help -h --version --json -q --quiet --out --check --force --points --seed --simulator
    --exhaustive --resume --shard --vcd --time-limit --through --size --compare --mesh --exponent
    --gamma core.toml core.toml core.toml bad.toml gone.toml evil.toml state.json part.json
    wave.vcd out out/deep picture.png empty core.toml/x . - -- --- -é é 🔆 a=b = length=3
    length=#3 length=nan length=-1 length=1e400 amplitude=#99999999999999999999 zeta_start=0.5
    0 1 5 -1 +1 0x10 1e3 nan inf 18446744073709551616 1/1 1/2 3/2 0/0 1/18446744073709551615
    rust-hdl icarus verilator golden lyon rough quad-cosine quad_cosine
    --points=3 --seed=7 --json=1";

fn arguments() -> impl Strategy<Value = Vec<String>> {
    let commands = || COMMANDS.split_whitespace();
    let pieces = commands().chain(PIECES.split_whitespace()).chain(["", " "]);
    let piece = prop_oneof![
        20 => select(pieces.collect::<Vec<_>>()).prop_map(str::to_owned),
        1 => "[^\\x00./\\\\]{0,8}",
    ];
    let command = select(commands().collect::<Vec<_>>()).prop_map(str::to_owned);
    (prop::option::weighted(0.8, command), vec(piece, 0..7))
        .prop_map(|(command, pieces)| command.into_iter().chain(pieces).collect())
}

/// Runs the program, which must end; without outside tools, and on one thread.
fn run(dir: &Workspace, arguments: &[String]) -> Run {
    let begin = Instant::now();
    let mut command = dir.command();
    command.current_dir(dir.at(INNER));
    command.env("PATH", "").env("RAYON_NUM_THREADS", "1");
    let run = Run::of(command.args(arguments).output());
    assert!(begin.elapsed() < HANGS, "{arguments:?} hangs");
    run
}

/// Returns a directory with what the pieces speak of.
fn dir() -> Workspace {
    let dir = Workspace::new();
    let inner = |name: &str| format!("{INNER}/{name}");
    dir.write(&inner("core.toml"), NARROW);
    dir.write(&inner("bad.toml"), "device = \"rough\"\ncosine.fraction = 99\n[[");
    let evil = NARROW.replace("cosine_squared_reduced", "../../evil");
    assert_ne!(evil, NARROW);
    dir.write(&inner("evil.toml"), evil);
    dir.write(&inner("part.json"), "{}");
    dir.write(&inner("empty"), "");
    dir
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: crate::common::cases(400),
        failure_persistence: None,
        rng_seed: crate::common::sample::fuzz_seed(),
        max_shrink_iters: 200,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_arguments(arguments in arguments()) {
        let dir = dir();
        let run = run(&dir, &arguments);
        prop_assert!((0..=2).contains(&run.code), "{arguments:?}: {run:?}");
        // A failure says something.
        prop_assert!(run.code == 0 || !run.err.is_empty() || !run.out.is_empty(), "{arguments:?}");
        for name in dir.files().keys() {
            prop_assert!(name.starts_with("inner/"), "{arguments:?} wrote {name}");
            prop_assert!(!name.contains(".glint-"), "{arguments:?} left {name}");
        }
        // After `--` there are no options.
        let options = arguments.split(|argument| argument == "--").next().unwrap_or_default();
        if run.code == 1 && options.iter().any(|argument| argument == "--json") {
            let json = serde_json::from_str::<serde_json::Value>(&run.out);
            prop_assert!(json.is_ok(), "{arguments:?}: {run:?}");
        }
    }
}
