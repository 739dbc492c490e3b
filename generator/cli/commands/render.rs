//! `glint render`: draws a picture whose highlights are bit-exact results of a device.

use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::load_one;
use crate::choice;
use crate::destination::Destination;
use crate::failure::{self, Failure};
use crate::report::CommandReport;
use crate::{Force, OutputOptions, TimeLimit, number, progress, say, wrong_usage};
use glint_base::{input, text};
use glint_core::core::Core;
use glint_core::cosim::batch::{Engine, Golden, RustHdl};
use glint_core::registry::Registry;
use glint_prove::batch::Verilog;
use glint_show::render::{
    self, BuiltIn, GivenOperand, Light, Material, Object, PictureDifference, Relief, Rendered,
    Scene, SceneCosine, Settings, Shape, Vector, View,
};
use glint_tools::VerilogSimulator;

/// The largest size of a file in bytes, about the size of the OBJ file of the largest mesh.
const LARGEST_FILE: u64 = 4 << 30;

/// Draw a picture whose highlights are bit-accurate results of the device
///
/// The command computes the geometry, the ambient and the diffuse light in f64. The device computes the specular term of
/// every sample and light; a device that takes normals (`shading`) computes the whole colour. Without a configuration, the
/// command uses the first device of `glint list` with its defaults. The same command gives the same bytes on every machine,
/// and with every engine of --through.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint render --out sphere.png
  glint render configs/cosine_power.toml --shape group --exponent 80 --samples 4 --out group.png
  glint render core.toml --mesh bunny.obj --light 1,2,3 --light -2,1,1,0.3,0.3,0.5 --out bunny.png
  glint render configs/rough.toml --height grain.png --out rough.png
  glint render core.toml --compare --out beside.png     device, Blinn in f64, and their difference
  glint render core.toml --through verilator --out same.png")]
pub struct Arguments {
    /// A configuration [default: the first device with its defaults]
    config: Option<PathBuf>,
    /// The PNG file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    force: Force,
    /// The engine that computes the specular term
    #[arg(long, value_enum, default_value_t = Through::Golden)]
    through: Through,
    /// Add the picture with Blinn's cos^n in f64, and a picture of the difference; print the largest difference and the PSNR
    #[arg(long)]
    compare: bool,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = size)]
    size: (u32, u32),
    /// Samples along each side of a pixel
    #[arg(long, value_name = "N", default_value_t = 2)]
    samples: u32,
    /// The object that is shown
    #[arg(long, value_parser = choice::shape(), default_value = "sphere", conflicts_with = "mesh")]
    shape: BuiltIn,
    /// Show the mesh of a Wavefront OBJ file; missing normals are computed
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// For a mesh without normals: edges with a larger angle stay sharp. 180 smooths all edges, and 0 smooths only edges
    /// between faces in one plane
    #[arg(long, value_name = "DEGREES", default_value_t = render::CREASE, requires = "mesh", value_parser = crease)]
    crease: f64,
    /// A height map (a grey PNG file) that perturbs the normals; a device with the operand dgamma gets the perturbation as
    /// dgamma
    #[arg(long, value_name = "FILE")]
    height: Option<PathBuf>,
    /// The height of white over black, in per cent of the radius of the object
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 1.0,
        allow_negative_numbers = true,
        requires = "height",
        value_parser = number
    )]
    height_depth: f64,
    /// How many times the height map is repeated
    #[arg(long, value_name = "TIMES", default_value_t = 4.0, requires = "height", value_parser = number)]
    height_repeat: f64,
    /// A light: the direction toward the light, and its colour; x points right, y up, z to the front. May be repeated
    /// [default: a white light from the upper left, and a weaker light from behind on the right]
    #[arg(long = "light", value_name = "X,Y,Z[,R,G,B]", allow_hyphen_values = true, value_parser = light)]
    lights: Vec<Light>,
    /// The specular exponent n [default: 80, or the largest that the device takes]
    #[arg(long, value_name = "N")]
    exponent: Option<u32>,
    /// What an operand gets that the scene does not give by its name: a number, or the cosine nh, nl, nv or vh between the normal N,
    /// the half vector H, and the directions L to the light and V to the viewer. The first result of a device without colours is
    /// the share of the light that is reflected, for example --operand c=vh --operand f=0.04 for `fresnel`
    #[arg(long = "operand", value_name = "NAME=VALUE", value_parser = operand)]
    operands: Vec<(String, GivenOperand)>,
    /// k_s, the share of the light in the specular term, which the device computes, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Material::usual(0).specular, value_parser = share)]
    specular: f64,
    /// The share of the light in the diffuse term, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Material::usual(0).diffuse, value_parser = share)]
    diffuse: f64,
    /// The share of the light in the ambient term, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Material::usual(0).ambient, value_parser = share)]
    ambient: f64,
    /// The colour of objects in ambient and diffuse light, each component 0 to 1
    #[arg(long, value_name = "R,G,B", value_parser = colour)]
    colour: Option<Vector>,
    /// The colour of the background
    #[arg(long, value_name = "R,G,B", default_value = "0.05,0.06,0.08", value_parser = colour)]
    background: Vector,
    /// The position of the camera [default: in front of the scene, a little above, so that everything is visible]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    camera: Option<Vector>,
    /// The point that the camera looks at [default: the middle of the scene]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector)]
    target: Option<Vector>,
    /// The vertical field of view, in degrees, 1 to 150
    #[arg(long, value_name = "DEGREES", default_value_t = render::FIELD, value_parser = field)]
    fov: f64,
    #[command(flatten)]
    time_limit: TimeLimit,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Through {
    /// The golden model
    Golden,
    /// The built-in simulator
    RustHdl,
    /// The emitted Verilog in Verilator
    Verilator,
}

/// Draws the picture and writes it.
///
/// # Errors
///
/// Fails if the configuration has problems, if an option or an input file is not valid. Fails if Verilator is missing, or if the
/// picture cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let (name, core) = core(registry, arguments.config.as_deref())?;
    let settings = settings(&core, arguments)?;
    if let Some(extension) = arguments.out.extension()
        && !extension.eq_ignore_ascii_case("png")
    {
        wrong_usage!(
            "--out {}: the picture is a PNG file; give a name that ends in .png",
            arguments.out.display()
        );
    }
    let scene = scene(arguments, render::walks_lines(core.contract.as_ref()))?;
    render::check(&settings, &scene).map_err(|error| Failure::WrongUsage(error.to_string()))?;
    let destination = Destination::fresh(&arguments.out, arguments.force.force)?;
    let bar = progress::bar(output, u64::from(settings.size.1), "rows rendered");
    bar.tick();
    let contract = core.contract.as_ref();
    let mut engine: Box<dyn Engine> = match arguments.through {
        Through::Golden => Box::new(Golden(contract)),
        Through::RustHdl => Box::new(RustHdl::new(&core.design, contract)?),
        Through::Verilator => {
            let (simulator, limit) = (VerilogSimulator::Verilator, arguments.time_limit.get());
            Box::new(Verilog::new(simulator, &core.design, contract, core.verilog()?, limit)?)
        }
    };
    let rendered = render::render(&core, engine.as_mut(), &scene, &settings, &mut |rows| {
        bar.set_position(rows);
    })?;
    bar.finish_and_clear();
    destination.write(rendered.whole(core.device().name).png()?)?;
    let report = RenderedPicture::new(arguments, &name, &core, &scene, &settings, &rendered);
    output.report(&report)?;
    Ok(true)
}

/// Returns the core of the configuration, and a name for messages. Without a configuration, uses the first device with its
/// defaults.
fn core(registry: &Registry, config: Option<&Path>) -> Result<(String, Core)> {
    if let Some(path) = config {
        let one = load_one(registry, path)?;
        return Ok((one.path, one.core));
    }
    let device = registry.devices().first();
    let device = *device.context("there is no device")?;
    let core = Core::new(device, device.defaults())?;
    Ok((format!("the defaults of `{}`", device.name), core))
}

fn settings(core: &Core, arguments: &Arguments) -> Result<Settings> {
    let (least, most) = render::exponents(core.contract.as_ref()).unwrap_or((0, i64::MAX));
    let exponent =
        arguments.exponent.unwrap_or_else(|| render::usual_exponent(core.contract.as_ref()));
    if !(least..=most).contains(&i64::from(exponent)) {
        wrong_usage!(
            "--exponent {exponent}: `{}` accepts exponents from {least} to {most}",
            core.config().name
        );
    }
    Ok(Settings {
        size: arguments.size,
        samples: arguments.samples,
        view: View { eye: arguments.camera, target: arguments.target, field: arguments.fov },
        material: Material {
            ambient: arguments.ambient,
            diffuse: arguments.diffuse,
            specular: arguments.specular,
            exponent,
        },
        background: arguments.background,
        compare: arguments.compare,
        operands: arguments.operands.clone(),
    })
}

/// Returns the scene. With `coarse`, built-in shapes consist of large triangles, for a device that computes lines of points.
fn scene(arguments: &Arguments, coarse: bool) -> Result<Scene> {
    let objects = match &arguments.mesh {
        Some(path) => {
            let cannot = || format!("the mesh `{}` cannot be used", path.display());
            let bytes = read(path).with_context(cannot)?;
            let text = String::from_utf8(bytes)
                .map_err(|_| anyhow!("the file is not UTF-8 text, and an OBJ file must be text"))
                .with_context(cannot)?;
            vec![Object {
                shape: Shape::Mesh(
                    render::obj::parse(&text, arguments.crease).with_context(cannot)?,
                ),
                colour: arguments.colour.unwrap_or(render::COLOUR),
            }]
        }
        None => Scene::built_in(arguments.shape, arguments.colour, coarse)?,
    };
    let mut scene = Scene {
        objects,
        lights: match arguments.lights[..] {
            [] => Light::usual(),
            _ => arguments.lights.clone(),
        },
        relief: None,
    };
    if let Some(path) = &arguments.height {
        for (option, value) in [
            ("--height-depth", arguments.height_depth),
            ("--height-repeat", arguments.height_repeat),
        ] {
            // This limit is far larger than anything visible, and far below an overflow.
            if !(-1e6..=1e6).contains(&value) {
                wrong_usage!("{option} {value}: give a number from -1000000 to 1000000");
            }
        }
        let cannot = || format!("the height map `{}` cannot be used", path.display());
        let bytes = read(path).with_context(cannot)?;
        let depth = scene.extent().1 * arguments.height_depth / 100.0;
        let relief = Relief::decode(&bytes, depth, arguments.height_repeat);
        scene.relief = Some(relief.with_context(cannot)?);
    }
    Ok(scene)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input::open(path)?.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST_FILE {
        bail!("the file has more than {LARGEST_FILE} bytes");
    }
    Ok(bytes)
}

struct RenderedPicture<'a> {
    arguments: &'a Arguments,
    name: &'a str,
    core: &'a Core,
    settings: &'a Settings,
    rendered: &'a Rendered,
    triangles: usize,
    degenerate: usize,
}

impl<'a> RenderedPicture<'a> {
    fn new(
        arguments: &'a Arguments,
        name: &'a str,
        core: &'a Core,
        scene: &Scene,
        settings: &'a Settings,
        rendered: &'a Rendered,
    ) -> Self {
        let (mut triangles, mut degenerate) = (0, 0);
        for object in &scene.objects {
            if let Shape::Mesh(mesh) = &object.shape {
                triangles += mesh.triangles.len();
                degenerate += mesh.degenerate;
            }
        }
        Self { arguments, name, core, settings, rendered, triangles, degenerate }
    }

    fn path(&self) -> String {
        self.arguments.out.display().to_string()
    }

    fn through(&self) -> String {
        let through = self.arguments.through.to_possible_value();
        through.map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl CommandReport for RenderedPicture<'_> {
    fn json(&self) -> Result<Value> {
        let Self { arguments, name, core, settings, rendered, .. } = *self;
        let (width, height) = settings.size;
        let comparison = rendered.comparison.as_ref().map(|comparison| {
            let PictureDifference { largest, psnr, gain, .. } = comparison.difference;
            json!({
                "largest_difference": largest,
                "psnr": psnr,
                "shown_times": gain,
                "largest_error_of_the_formula_in_units": comparison.units,
                "bound_in_units": core.contract.bounds().governing().units,
            })
        });
        Ok(json!({
            "ok": true,
            "config": arguments.config.as_ref().map(|_| name),
            "device": core.device().name,
            "out": self.path(),
            "through": self.through(),
            "width": width,
            "height": height,
            "samples": settings.samples,
            "exponent": settings.material.exponent,
            "points": rendered.points,
            "triangles": self.triangles,
            "degenerate_triangles": self.degenerate,
            "deviations_beyond_the_domain": rendered.beyond,
            "compare": comparison,
        }))
    }

    fn print(&self) -> Result<()> {
        let Self { name, core, settings, rendered, degenerate, .. } = *self;
        let (width, height) = settings.size;
        let (path, through) = (self.path(), self.through());
        let has_exponent = render::exponents(core.contract.as_ref()).is_some();
        let exponent = match has_exponent || settings.operands.is_empty() {
            true => format!("n = {}, ", settings.material.exponent),
            false => String::new(),
        };
        say!(
            "{path}: {width}x{height} pixels, {exponent}{} points of {name} through {through}",
            text::grouped(rendered.points)
        );
        if degenerate > 0 {
            failure::warn(&format!("{degenerate} triangles have no area and were left out"));
        }
        if rendered.beyond > 0 {
            failure::warn(&format!(
                "at {} points the deviation exceeds the device's domain, and was limited to the domain",
                text::grouped(rendered.beyond)
            ));
        }
        if let Some(comparison) = &rendered.comparison {
            let difference = &comparison.difference;
            let psnr = match difference.psnr {
                Some(psnr) => format!("PSNR {psnr:.2} dB"),
                None => "no difference".to_owned(),
            };
            say!(
                "  from left to right: the device, Blinn in f64, their difference times {}",
                difference.gain
            );
            say!(
                "  against Blinn: largest difference {} of 255, {psnr} over the lit pixels",
                difference.largest
            );
            say!(
                "  against its own formula: largest error {:.3} units (bound {})",
                comparison.units,
                core.contract.bounds().words()
            );
        }
        Ok(())
    }
}

/// Parses a width and a height, such as `640x480`.
fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X']);
    let sides = sides.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    sides.ok_or_else(|| "expected WxH in pixels, for example 640x480".to_owned())
}

/// Parses finite numbers that are separated by commas.
fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|word| match word.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("`{word}` is not a finite number")),
        })
        .collect()
}

/// Parses a setting such as `alpha2=0.04` or `c=nh`. The value must be one finite number, or a cosine's name.
fn operand(text: &str) -> Result<(String, GivenOperand), String> {
    let (name, value) =
        text.split_once('=').ok_or("expected NAME=VALUE, for example alpha2=0.04 or c=nh")?;
    let name = name.trim().to_owned();
    if let Some(cosine) = SceneCosine::named(value.trim()) {
        return Ok((name, GivenOperand::Cosine(cosine)));
    }
    let of_scene = "; a cosine of the scene is nh, nl, nv or vh";
    match numbers(value).map_err(|message| message + of_scene)?.as_slice() {
        &[value] => Ok((name, GivenOperand::Value(value))),
        _ => Err(format!("expected one number{of_scene}")),
    }
}

fn vector(text: &str) -> Result<Vector, String> {
    match numbers(text)?.as_slice() {
        &[x, y, z] => Ok(Vector::new(x, y, z)),
        _ => Err("expected three numbers, x,y,z".to_owned()),
    }
}

fn colour(text: &str) -> Result<Vector, String> {
    of_light(vector(text)?)
}

/// Checks that the three components are from 0 to 1.
fn of_light(colour: Vector) -> Result<Vector, String> {
    let is_colour = colour.0.iter().all(|part| (0.0..=1.0).contains(part));
    is_colour.then_some(colour).ok_or_else(|| "a colour is three numbers from 0 to 1".to_owned())
}

fn light(text: &str) -> Result<Light, String> {
    let numbers = numbers(text)?;
    let (direction, colour) = match *numbers.as_slice() {
        [x, y, z] => (Vector::new(x, y, z), [1.0; 3]),
        [x, y, z, r, g, b] => (Vector::new(x, y, z), [r, g, b]),
        _ => return Err("a light is a direction x,y,z, or x,y,z,r,g,b with its colour".to_owned()),
    };
    let colour = of_light(Vector(colour))?;
    let direction = direction.unit();
    Ok(Light { direction: direction.ok_or("0,0,0 is not a direction")?, colour })
}

/// Parses a number from `low` to `high`, both included. `wanted` is the message for any other text.
fn between(text: &str, low: f64, high: f64, wanted: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| (low..=high).contains(number));
    number.ok_or_else(|| wanted.to_owned())
}

fn share(text: &str) -> Result<f64, String> {
    between(text, 0.0, 1.0, "a share is a number from 0 to 1")
}

fn crease(text: &str) -> Result<f64, String> {
    between(text, 0.0, 180.0, "an angle from 0 to 180 degrees")
}

fn field(text: &str) -> Result<f64, String> {
    between(text, 1.0, 150.0, "an angle from 1 to 150 degrees")
}
