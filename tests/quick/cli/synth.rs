//! `synth` with a Yosys that makes its figures up.

use super::workspace::{COSINE_POWER, Run, Workspace};

fn synth(dir: &Workspace, arguments: &[&str]) -> Run {
    dir.with_own_tools(["synth", "core.toml"].iter().chain(arguments))
}

/// Xilinx 7 needs Yosys alone.
#[cfg(unix)]
#[test]
fn figures_are_kept_beside_the_configuration() {
    let dir = Workspace::with("core.toml", COSINE_POWER);
    let log = dir.at("log");
    dir.script(
        "tools/yosys",
        &format!(
            "[ \"$1\" = --version ] && echo 'Yosys 0.23 (git)' && exit
echo run >>'{}'
s=${{3#*-check -top }}
printf '{{\"modules\": {{\"\\\\\\\\%s\": {{\"num_cells_by_type\": {{\"LUT6\": 40, \"DSP48E1\": 3, \"FDRE\": 99}}}}}}}}' \"${{s%%;*}}\" >statistics.json",
            log.display()
        ),
    );
    let run = |arguments: &[&str]| synth(&dir, &[&["--json"], arguments].concat());
    let first = run(&["--target", "xilinx7"]).good();
    let told = first.json();
    let figures = &told["synthesis"][0]["targets"][0];
    assert_eq!(figures["area"]["luts"], 40, "{told}");
    assert_eq!(figures["area"]["flip_flops"], 99, "{told}");
    assert_eq!(figures["tools"][0], "Yosys 0.23", "{told}");
    // cosine-power takes 8 clocks with m = 16: load, four squarings, and the handshake.
    assert_eq!(told["synthesis"][0]["clocks_per_point"], 8.0, "{told}");
    let runs = || dir.read("log").lines().count();
    assert_eq!(runs(), 1);
    let again = run(&["--target", "xilinx7"]);
    assert_eq!((again.out.as_str(), runs()), (first.out.as_str(), 1));
    run(&["--target", "xilinx7", "--no-cache"]);
    assert_eq!(runs(), 2);
    // Another core is measured, whatever its name.
    dir.write("core.toml", format!("{COSINE_POWER}power = 2\n"));
    run(&["--target", "xilinx7"]);
    assert_eq!(runs(), 3);
    // What is there and no cache is measured over.
    dir.write(".glint/core.xilinx7.json", "{}");
    run(&["--target", "xilinx7"]);
    assert_eq!(runs(), 4);
    // Without the other tools, the others are left out with a note.
    let all = run(&[]);
    let notes = all.json()["notes"].as_array().expect("notes").len();
    assert_eq!((all.code, notes), (0, 3), "{all:?}");
    // A record is of all targets, or of those that are asked for.
    let refused = run(&["--out", "record"]);
    assert!(
        refused.code == 1 && refused.out.contains("`nextpnr-ice40` is not on PATH"),
        "{refused:?}"
    );
    assert!(!dir.at("record/cosine_power.json").exists());
}
