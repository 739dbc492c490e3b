//! Tests `glint setup`: its operands, passed through `glint eval`, give the pixels of a line that the test computes from the
//! geometry.

use std::fs::{self, File};

use serde_json::{Value, json};

use super::render::pixels;
use crate::common::json::Json;
use crate::workspace::{Run, Workspace};

fn setup(config: &str, inputs: &[&str]) -> Run {
    let dir = Workspace::with("core.toml", config);
    dir.glint(["setup", "core.toml"].iter().chain(inputs))
}

#[test]
fn a_difference_by_hand() {
    // The square of the difference is 2(1 − cos γ), from vectors as from the angle.
    let of = |run: &Run| -> f64 {
        let told = run.json();
        let part = |at: usize| told["operands"][at]["value"].number();
        (0..3).map(|at| part(at) * part(at)).sum()
    };
    let lyon = "device = \"lyon\"\n";
    for inputs in [&["gamma=40"][..], &["normal=1,0,0", "half=0.766044443,0.642787610,0"]] {
        let square = of(&setup(lyon, &[inputs, &["exponent=16", "--json"]].concat()));
        assert!((square - 2.0 * (1.0 - 40f64.to_radians().cos())).abs() < 1e-4, "{square}");
    }
}

/// CSV in, CSV out, through `eval`: every pixel of a row of a picture, whose vectors are found here from the geometry.
#[test]
fn set_up_and_evaluated_it_is_the_line_of_the_picture() {
    const WIDTH: usize = 31;
    let mesh = "v -9 -9 0\nv 9 -9 0\nv 0 18 0\nvn 0.3 0.1 1\nvn -0.2 0.05 1\nvn 0.1 -0.3 1\nf 1//1 2//2 3//3\n";
    for (device, light) in [("quad-cosine", [-0.1, 0.3, 3.0]), ("cosine-squared", [0.2, 0.5, 3.0])]
    {
        let dir = Workspace::with("core.toml", format!("device = \"{device}\"\n"));
        dir.write("flat.obj", mesh);
        let toward = light.map(|it: f64| it.to_string()).join(",");
        let size = format!("{WIDTH}x1");
        let picture = "render core.toml --out line.png --mesh flat.obj --samples 1 --fov 4 --camera 0,0,5 --target 0,0,0 \
                       --ambient 0 --diffuse 0 --specular 0.9 --exponent 37";
        let more = ["--light", &toward, "--size", &size];
        dir.done(picture.split(' ').chain(more));
        let png = fs::read(dir.at("line.png")).expect("a picture");
        let (_, _, drawn) = pixels(&png);

        // The pixel's place in the plane z = 0, the normal there, and the way to the eye at (0, 0, 5).
        let end = |column: usize| {
            let aside = (2.0 * column as f64 + 1.0) / WIDTH as f64 - 1.0;
            let x = 5.0 * aside * WIDTH as f64 * 2f64.to_radians().tan();
            // The weights of the corners: a third for the upper, and what is left by the place.
            let (upper, right) = (1.0 / 3.0, 1.0 / 3.0 + x / 18.0);
            let weights = [1.0 - upper - right, right, upper];
            let corners = [[0.3, 0.1, 1.0], [-0.2, 0.05, 1.0], [0.1, -0.3, 1.0]].map(unit);
            let normal =
                [0, 1, 2].map(|axis| (0..3).map(|at| weights[at] * corners[at][axis]).sum());
            (normal, [-x, 0.0, 5.0])
        };
        let text = |vector: [f64; 3]| vector.map(|it| it.to_string()).join(" ");
        let ((n1, v1), (n2, v2)) = (end(0), end(WIDTH - 1));
        dir.write(
            "lines.csv",
            format!(
                "normal_1,view_1,normal_2,view_2,points\n\n{},{},{},{},{WIDTH}\n",
                text(n1),
                text(v1),
                text(n2),
                text(v2)
            ),
        );
        let (one, two) = (format!("light_1={toward}"), format!("light_2={toward}"));
        let command =
            ["setup", "core.toml", "--batch", "lines.csv", "exponent=37", "intensity=0.9"];
        let operands = dir.done(command.iter().chain(&[one.as_str(), two.as_str()]));
        dir.write("operands.csv", &operands);
        let mut eval = dir.command();
        let input = File::open(dir.at("operands.csv")).expect("a file");
        let run = Run::of(
            eval.args(["eval", "core.toml", "--batch", "-", "--json"]).stdin(input).output(),
        );
        let told = run.good().json();
        let points = told["points"].list();
        let computed: Vec<&Value> =
            points.iter().map(|it| &it["outputs"]["intensity_out"]).collect();
        let shown: Vec<Value> = drawn.iter().map(|pixel| json!(pixel[0])).collect();
        assert_eq!(computed, shown.iter().collect::<Vec<_>>(), "{device}");
        let (least, most) =
            (drawn.iter().min().expect("pixels"), drawn.iter().max().expect("pixels"));
        assert!(most[0] - least[0] > 60, "a highlight: {drawn:?}");
        assert_eq!((&points[30]["point"], points.len()), (&json!(30), WIDTH));
    }
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = vector.iter().map(|it| it * it).sum::<f64>().sqrt();
    vector.map(|it| it / length)
}
