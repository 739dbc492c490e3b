//! Tests `glint render`: the pixels of its pictures, the agreement of its engines, and the messages about unusable meshes and
//! height maps.
//!
//! `tests/kinds.toml` says which scenes and configurations a run takes for the comparison of engines. Among other things the file
//! repeats the commands of `docs/images/README.md` and compares the pictures with the files of the repository.

use std::fs;
use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Encoder};
use serde_json::Value;

use crate::common::Sure;
use crate::common::cores::all_configurations;
use crate::common::files::{read, root};
use crate::common::json::Json;
use crate::common::sample::sampled_by_name;
use crate::workspace::{COSINE_POWER, Run, Workspace};

/// Every line of the documentation's list of pictures that is a command.
const PICTURES: &str = "docs/images/README.md";

const SMALL: [&str; 5] = ["--size", "48x36", "--out", "out.png", "--force"];

fn render<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    let command = ["render"].into_iter().chain(SMALL);
    command.chain(arguments.iter().copied()).collect()
}

/// Width, height, and red, green and blue of each pixel.
pub fn pixels(png: &[u8]) -> (u32, u32, Vec<[u8; 3]>) {
    let mut reader = Decoder::new(Cursor::new(png)).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("pixels");
    assert_eq!(info.color_type, ColorType::Rgb);
    let (pixels, []) = bytes.as_chunks() else {
        panic!("whole pixels");
    };
    (info.width, info.height, pixels.to_vec())
}

/// Returns the picture that was drawn last.
fn picture(dir: &Workspace) -> Vec<u8> {
    fs::read(dir.at("out.png")).expect("a picture")
}

fn png(colour: ColorType, bits: BitDepth, width: u32, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let row = width as usize * colour.samples() * if bits == BitDepth::Sixteen { 2 } else { 1 };
    let mut encoder = Encoder::new(&mut file, width, (bytes.len() / row) as u32);
    encoder.set_color(colour);
    encoder.set_depth(bits);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(bytes).expect("pixels");
    writer.finish().expect("an end");
    file
}

#[track_caller]
fn number(told: &Value, key: &str) -> f64 {
    told[key].as_f64().unwrap_or_else(|| panic!("no number `{key}` in {told}"))
}

/// The formula's error that a comparison tells is within the bound.
#[track_caller]
fn assert_within_bound(told: &Value) {
    let units = number(told, "largest_error_of_the_formula_in_units");
    assert!(units <= number(told, "bound_in_units"), "{told}");
}

/// Returns a map with bumps, 16 × 16.
fn bumps() -> Vec<u8> {
    let heights: Vec<u8> = (0..256).map(|at| (at % 16 * 37 + at / 16 * 91) as u8).collect();
    png(ColorType::Grayscale, BitDepth::Eight, 16, &heights)
}

#[test]
fn every_engine_draws_the_same_pixels() {
    let dir = Workspace::with("power.toml", COSINE_POWER);
    dir.write("rough.toml", "device = \"rough\"\n");
    dir.write("bumps.png", bumps());
    dir.write("quad.toml", "device = \"quad-cosine\"\n");
    dir.write("squared.toml", "device = \"cosine-squared\"\n");
    dir.write("shading.toml", "device = \"shading\"\n");
    let scenes = [
        ("power.toml", &["--height", "bumps.png"][..]),
        ("rough.toml", &["--height", "bumps.png"]),
        ("quad.toml", &["--shape", "torus"]),
        ("squared.toml", &[]),
        ("shading.toml", &["--shape", "torus", "--height", "bumps.png"]),
    ];
    for (config, more) in sampled_by_name("scenes", scenes, |(config, _)| (*config).to_owned()) {
        let mut pictures = Vec::new();
        let all = ["golden", "rust-hdl", "verilator"];
        let there = if cfg!(feature = "outside-tools") { &all[..] } else { &all[..2] };
        for through in there {
            let arguments = [&[config, "--through", through], more].concat();
            let out = dir.done(render(&arguments));
            assert!(out.contains(&format!("through {through}")), "{out}");
            pictures.push(picture(&dir));
        }
        for (through, picture) in there.iter().zip(&pictures) {
            assert!(pictures[0] == *picture, "{config}: golden, {through}");
        }
    }
    dir.assert_no_staging();
}

/// Every configuration that comes with Glint is understood, and stays within its bound in a picture.
#[test]
fn every_configuration_draws() {
    let dir = Workspace::new();
    let mut drawn = 0;
    // A function is no highlight.
    let highlights = all_configurations().into_iter();
    let highlights = highlights.filter(|(_, core)| core.contract.highlight().is_some());
    let taken = sampled_by_name("drawn configurations", highlights, |(path, _)| path.clone());
    for (path, _) in taken {
        let path = root().join(path).display().to_string();
        let mut pictures = Vec::new();
        for through in ["golden", "rust-hdl"] {
            let run = dir.glint(render(&[&path, "--through", through, "--compare", "--json"]));
            assert_eq!(run.code, 0, "{path}: {run:?}");
            assert_within_bound(&run.json()["compare"]);
            pictures.push(picture(&dir));
        }
        assert!(pictures.iter().all(|it| *it == pictures[0]), "{path}: golden, rust_hdl");
        drawn += 1;
    }
    assert!(drawn > 0, "no configuration");
}

/// The pictures of the documentation are what the commands beside them give.
#[test]
fn the_pictures_of_the_documentation_are_todays() {
    let text = read(PICTURES);
    let commands: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("    glint ")).collect();
    assert!(!commands.is_empty(), "no command in {PICTURES}");
    let dir = Workspace::new();
    for command in commands {
        let (command, file) = command.split_once(" --out ").expect("an --out at the end");
        // Where the tests run, which has what is drawn.
        let mut glint = dir.command();
        glint.current_dir(root()).args(command.split_whitespace());
        let run = glint.arg("--out").arg(dir.at("out.png")).arg("--force").output();
        Run::of(run).good();
        let committed = fs::read(file).sure_of(file);
        let made = picture(&dir);
        assert!(pixels(&made) == pixels(&committed), "{file}: other pixels");
        assert!(made == committed, "{file}: the same pixels in other bytes");
    }
}

/// A sphere that fills the picture, lit from the eye: the highlight is in the middle, as bright as it can
/// be, and the corners are the background.
#[test]
fn a_highlight_is_where_it_should_be() {
    let dir = Workspace::with("power.toml", COSINE_POWER);
    let eye = ["--camera", "0,0,10", "--fov", "12.5", "--light", "0,0,1"];
    let plain = ["--diffuse", "0", "--ambient", "0", "--specular", "1"];
    let more = ["power.toml", "--samples", "1", "--background", "0,0,1"];
    let arguments = [&eye[..], &plain, &more].concat();
    let done =
        dir.done(["render", "--size", "41x41", "--out", "out.png"].into_iter().chain(arguments));
    assert!(done.contains("41x41 pixels, n = 80"), "{done}");
    let (width, height, pixels) = pixels(&picture(&dir));
    assert_eq!((width, height), (41, 41));
    let at = |column: usize, row: usize| pixels[row * 41 + column];
    // cos γ is 1 but for half a pixel; W(80, 0) falls short of 1 by an ulp of 2⁻¹⁶ for each squaring.
    assert_eq!(at(20, 20), [255; 3]);
    assert_eq!(at(0, 0), [0, 0, 255]);
    // Symmetric, and darker outward; 8 pixels are about 0.43 of the radius: γ = 26°, cos⁸⁰γ = 0.0002.
    assert_eq!(at(18, 20), at(22, 20));
    assert_eq!(at(20, 17), at(20, 23));
    assert!(at(20, 20) > at(22, 20) && at(22, 20) > at(24, 20));
    assert_eq!(at(28, 20), [0; 3]);
}

/// A formula reflects a share of the light. With light and viewer in front of the sphere, N·L, N·V and N·H are the same cosine, which is 1
/// in the middle, and V·H is 1 everywhere.
#[test]
fn a_formula_reflects_its_share_of_the_light() {
    let dir = Workspace::new();
    dir.write(
        "share.toml",
        "device = \"expression\"\nname = \"share\"\noperands.c = { from = 0, to = 1, to_included = true, fraction = 12 }\n\
         operands.f = { bits = 8, fraction = 8 }\nresults.r = { formula = \"f + (1 - f) * (1 - c)^5\", fraction = 12 }\n",
    );
    let eye = ["--camera", "0,0,100", "--fov", "1.25", "--light", "0,0,1", "--samples", "1"];
    let plain = ["--diffuse", "0", "--ambient", "0", "--specular", "1", "--background", "0,0,1"];
    let size = ["share.toml", "--size", "41x41", "--out", "out.png", "--force"];
    let pixel = |operands: &[&str], column: usize| {
        let given = operands.iter().flat_map(|operand| ["--operand", *operand]);
        let fixed = size.iter().chain(&eye).chain(&plain).copied();
        let mut through: Vec<[u8; 3]> = Vec::new();
        for engine in ["golden", "rust-hdl"] {
            let arguments = ["render"].into_iter().chain(fixed.clone());
            let done = dir.done(arguments.chain(given.clone()).chain(["--through", engine]));
            assert!(done.contains("41x41 pixels, ") && !done.contains("n ="), "{done}");
            through.push(pixels(&picture(&dir)).2[20 * 41 + column]);
        }
        assert_eq!(through[0], through[1], "{operands:?}");
        through[0]
    };
    // A quarter of the light, where the cosine is 1: 0.25 · 255 is 63.75.
    for cosine in ["c=nh", "c=nl", "c=nv", "c=vh", "c=1"] {
        assert_eq!(pixel(&["f=0.25", cosine], 20), [64; 3], "{cosine}");
    }
    // The picture is 2.18 radii wide. 16 of its 41 pixels are 0.851 radii, where cosines with N are 0.525. V·H is still 1, so that only the
    // light falls, to 0.25 · 0.525 · 255 = 33.5. With N·V, the share is 0.25 + 0.75 · 0.475⁵ = 0.268, which gives 35.9.
    let rim = pixel(&["f=0.25", "c=nv"], 36)[0];
    let flat = pixel(&["f=0.25", "c=vh"], 36)[0];
    assert!((33..=34).contains(&flat), "{flat}");
    assert!((35..=37).contains(&rim), "{rim}");
    let without = |operands: &[&str]| dir.glint(render(&[&["share.toml"], operands].concat()));
    without(&[]).refused(1, &["Glint cannot compute `c`", "nh, nl, nv or vh"]);
    without(&["--operand", "c=nh"]).refused(1, &["Glint cannot compute `f`"]);
    without(&["--operand", "c=xy"]).refused(2, &["a cosine of the scene is nh, nl, nv or vh"]);
    let beyond = ["--operand", "c=nh", "--operand", "f=2"];
    without(&beyond).refused(1, &["the domain of the operand is 0 to 0.99609375"]);
}

/// Lines of points along the spans of triangles, set up by the host.
#[test]
fn lines_run_along_triangles() {
    let dir = Workspace::with("quad.toml", "device = \"quad-cosine\"\n");
    dir.write("squared.toml", "device = \"cosine-squared\"\nlength.bits = 4\n");
    dir.write("bumps.png", bumps());
    // One large triangle whose normals turn from side to side: spans of up to 80 samples.
    dir.write(
        "large.obj",
        "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvn -0.2 0.1 1\nvn 0.2 0.1 1\nvn 0 0.3 1\nf 1//1 2//2 3//3\n",
    );
    for (config, largest) in [("quad.toml", 4.0), ("squared.toml", 26.0)] {
        let arguments = [config, "--compare", "--json", "--exponent", "20"];
        let mesh = ["--mesh", "large.obj", "--light", "0,0.2,1"];
        let run = dir.glint(render(&[&arguments[..], &mesh].concat())).good();
        let told = &run.json()["compare"];
        // Of 0.7·255: cos¹⁶(√(n/16)·δ) is within 0.6 % of cosⁿδ and cos² within 12 %. Angles that grow evenly
        // are less than 0.002 from those of the interpolated normals, which is a level where cos²⁰γ is steepest.
        assert!(number(told, "largest_difference") <= largest, "{told}");
        assert_within_bound(told);
    }
    let run = dir.glint(render(&["quad.toml", "--height", "bumps.png"]));
    run.refused(1, &["computes lines of points, and a height map cannot perturb lines"]);
}

#[test]
fn comparison_measures_the_picture() {
    let dir = Workspace::with("power.toml", COSINE_POWER);
    let run = dir.glint(render(&["power.toml", "--compare", "--json"])).good();
    let told = run.json();
    let (width, height, pixels) = pixels(&picture(&dir));
    // Captions stand in 22 rows below the pictures.
    assert_eq!((width, height), (3 * 48, 36 + 22));
    assert!(pixels[36 * 144..].iter().any(|pixel| pixel[0] > 200), "no letter");
    // Measured again in the picture.
    let column = |panel: usize, at: usize| pixels[at / 48 * 144 + panel * 48 + at % 48];
    let mut largest = 0;
    for at in 0..48 * 36 {
        let gain = told["compare"]["shown_times"].count();
        for channel in 0..3 {
            let difference = column(0, at)[channel].abs_diff(column(1, at)[channel]);
            largest = largest.max(difference);
            assert_eq!(u64::from(column(2, at)[channel]), u64::from(difference) * gain);
        }
    }
    assert_eq!(told["compare"]["largest_difference"], largest);
    // W(80, γ) with m = 16 is up to 0.018 from cos⁸⁰γ: 3 levels at k_s = 0.7, of two lights.
    assert!((1..=7).contains(&largest), "{told}");
    assert!(number(&told["compare"], "psnr") > 40.0, "{told}");
    assert_within_bound(&told["compare"]);
}

/// Operands are quantised, so that two lights at n = 80 are a few levels from f64; each is within the bound of the device.
#[test]
fn a_device_that_takes_normals_computes_all_of_the_light() {
    let text = "device = \"shading\"\nhighlight = \"blinn\"\n";
    let dir = Workspace::with("shading.toml", text);
    let arguments = ["shading.toml", "--compare", "--json", "--shape", "torus"];
    let told = dir.glint(render(&arguments)).good().json();
    assert!(told["compare"]["largest_difference"].count() <= 4, "{told}");
    assert!(number(&told["compare"], "psnr") > 50.0, "{told}");
    assert_within_bound(&told["compare"]);
}

/// A wavy sheet of a million triangles.
#[test]
fn a_million_triangles_are_read() {
    use std::fmt::Write;
    let (columns, rows) = (1001, 501);
    let mut text = String::new();
    for row in 0..rows {
        for column in 0..columns {
            let wave = (column * 7 + row * 13) % 100;
            let _ = writeln!(text, "v {column} {row} {}", f64::from(wave) / 25.0);
        }
    }
    for row in 0..rows - 1 {
        for column in 1..columns {
            let at = row * columns + column;
            let _ = writeln!(text, "f {at} {} {} {}", at + 1, at + columns + 1, at + columns);
        }
    }
    let dir = Workspace::with("sheet.obj", text);
    let run = dir.glint(render(&["--mesh", "sheet.obj", "--json"])).good();
    assert_eq!(run.json()["triangles"], 1_000_000);
}

#[test]
fn a_mesh_is_text() {
    let dir = Workspace::with("binary.obj", [0x76, 0x20, 0xff, 0xfe]);
    dir.glint(render(&["--mesh", "binary.obj"])).refused(1, &["the file is not UTF-8 text"]);
}

#[test]
fn unusable_height_maps_are_refused() {
    let dir = Workspace::with("text.png", "P2 1 1 255 0");
    let colour = png(ColorType::Rgb, BitDepth::Eight, 2, &[9; 12]);
    dir.write("rgb.png", &colour);
    dir.write("alpha.png", png(ColorType::GrayscaleAlpha, BitDepth::Eight, 2, &[9; 8]));
    let whole = png(ColorType::Grayscale, BitDepth::Sixteen, 4, &[9; 32]);
    dir.write("deep.png", &whole);
    dir.write("cut.png", &whole[..whole.len() - 20]);
    dir.write("wide.png", png(ColorType::Grayscale, BitDepth::Eight, 8193, &[0; 8193]));
    dir.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    dir.write("rough.toml", "device = \"rough\"\n");
    let before = dir.files();
    for (file, message) in [
        ("missing.png", "No such file"),
        ("text.png", "the file is not a PNG file"),
        ("rgb.png", "the picture is in colour; a height map must be grey"),
        ("alpha.png", "the picture is grey with transparency"),
        ("cut.png", "the PNG file is not complete"),
        ("wide.png", "the picture has 8193x1 pixels; at most 8192x8192"),
    ] {
        let run = dir.glint(render(&["--height", file]));
        run.refused(1, &["the height map", file, message]);
    }
    let run = dir.glint(render(&["--height", "deep.png", "--mesh", "bare.obj"]));
    run.refused(2, &["texture coordinates (`vt`) at every corner"]);
    assert!(before == dir.files());
    dir.done(render(&["rough.toml", "--height", "deep.png"]));
    // Steeper than 30°, the domain's largest dγ.
    dir.write("bumps.png", bumps());
    let run =
        dir.glint(render(&["rough.toml", "--height", "bumps.png", "--height-depth", "40"])).good();
    assert!(run.err.contains("the deviation exceeds the device's domain"), "{run:?}");
}
