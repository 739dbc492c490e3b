//! `tune` from the command line.

use super::workspace::{Run, Workspace};

#[test]
fn the_file_is_one_that_generate_takes() {
    let dir = Workspace::new();
    let arguments = ["tune", "cosine-power", "--error", "0.75", "--set", "cosine.fraction=16"];
    dir.done(arguments.into_iter().chain(["--out", "small.toml", "--name", "small_core"]));
    let text = dir.read("small.toml");
    assert!(text.contains("fraction = 16") && text.contains("name = \"small_core\""), "{text}");
    dir.done(["generate", "small.toml", "--out", "build"]);
    assert!(dir.at("build/rtl_out/small_core/small_core.v").exists());
    // What is there stays.
    dir.glint(arguments.into_iter().chain(["--out", "small.toml"]))
        .refused(1, &["`small.toml` is there already"]);
    assert_eq!(dir.read("small.toml"), text);
    dir.done(arguments.into_iter().chain(["--plot", "front.svg"]));
    let svg = dir.read("front.svg");
    let drawing = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{error}: {svg}"));
    assert!(drawing.descendants().any(|it| it.has_tag_name("polyline")), "{svg}");
    let mut narrow = dir.command();
    let narrow = Run::of(narrow.args(arguments).env("COLUMNS", "80").output()).good();
    let table: Vec<&str> = narrow.out.lines().filter(|line| line.starts_with('|')).collect();
    assert!(table[0].contains("| keys ") && table.iter().all(|row| row.len() <= 80), "{narrow:?}");
    let csv = dir.done(arguments.into_iter().chain(["--csv"]));
    let first = csv.lines().next().expect("a heading");
    assert!(
        first.starts_with("error_of_f,output_units,luts") && first.contains("intensity.fraction"),
        "{csv}"
    );
    let told = dir.glint(arguments.into_iter().chain(["--json"])).json();
    // 31 ulp of f times 255, and half a unit: 15 bits keep three quarters, 14 do not.
    assert_eq!(told["best"]["keys"]["intensity.fraction"], 15, "{told}");
}
