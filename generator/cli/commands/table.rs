//! `glint table`: finds the words with which the writable table of a core computes a different function, and proves their error.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::{Value, json};

use super::{Loaded, load_one};
use crate::report::CommandReport;
use crate::{OutputOptions, destination, say, wrong_usage};
use glint_base::config_error::ConfigError;
use glint_base::program::Program;
use glint_base::{identifier, input, text};
use glint_core::core::Core;
use glint_core::cosim::batch::{Engine, Golden, Points, RustHdl};
use glint_core::package::{TableImage, TableLayout, image_file, image_header};
use glint_core::registry::Registry;
use glint_keys::images::StatedImage;
use glint_rtl::verilog;

/// Find the words for another function in the writable table of a core, and prove their error
///
/// The datapath of the core stays as it is: the command fits coefficients of the same formats, and proves the error of the result at
/// every operand. Then it loads the words through the write port of the core in the built-in simulator, and compares the results with the
/// golden model. With --out, it then writes the image as a C header, as a binary file, and as memory files for a core that starts with it.
#[derive(Args)]
#[command(after_help = "\
Examples:
  glint table fog.toml \"exp(-3*x)\"                               does the table hold it, with which error?
  glint table fog.toml \"exp(-3*x)\" --name smoke --out build      also writes build/fog_table_smoke.h and other files
  glint table fog.toml squared                                   an image that the configuration names
  glint table sfu.toml fog \"exp(-3*d)\"                          the function fog of a unit, whose operand is d
  glint table fog.toml \"sqrt(x)\" --error 4                       allows a larger error")]
pub struct Arguments {
    /// A configuration with a table that can be written
    config: PathBuf,
    /// A formula of the operand, or the name of an image that the configuration states. With a unit, the name of the function can come first
    #[arg(value_name = "[FUNCTION] FORMULA", num_args = 1..=2, required = true)]
    formula: Vec<String>,
    /// The name of the image in the names of files and constants [default: the name in the configuration, or `image`]
    #[arg(long)]
    name: Option<String>,
    /// The allowed error in units of the last place of the result [default: result.error of the configuration]
    #[arg(long, value_name = "UNITS")]
    error: Option<f64>,
    /// Write the image into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also replace files with other contents
    #[arg(long, requires = "out")]
    force: bool,
}

/// The largest number of operands that the command simulates. In a larger domain, they are evenly spaced.
const MOST_SIMULATED: u64 = 1 << 16;

/// Finds the image, simulates it and writes it. Returns whether the simulated core, loaded with the image, equals the golden
/// model.
///
/// # Errors
///
/// Fails if the configuration has problems or no writable table. Fails if the table cannot hold the function with the allowed
/// error, or if a file cannot be written.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let one = load_one(registry, &arguments.config)?;
    let Some(layout) = TableLayout::of(&one.core.design) else {
        bail!(
            "{}: the core has no table that can be written; the device `function` has one with \
             approximation.tables = \"writable\", and a unit with images of a function",
            one.path
        );
    };
    let wanted = wanted_image(&one, arguments)?;
    let opened = one.core.opened.refitted(wanted.config);
    let core = Core::build(opened.map_err(|error| unheld(&wanted.formula, &error))?)?;
    ensure!(
        TableLayout::of(&core.design).as_ref() == Some(&layout),
        "the image needs another datapath, a mistake of Glint"
    );
    let image = core.table_image(&wanted.name, &wanted.formula);
    let simulated = simulate(&one.core, &core, &image)?;
    let holds = simulated.first_difference.is_none();
    let files = match &arguments.out {
        Some(out) if holds => write(out, arguments, &one, &layout, &image, &core)?,
        _ => Vec::new(),
    };
    output.report(&FittedImage { one: &one, layout, image, core: &core, simulated, files })?;
    Ok(holds)
}

/// Returns the error for a function that the table cannot hold. A line of carets marks the place in the formula.
fn unheld(formula: &str, error: &ConfigError) -> anyhow::Error {
    let mut text = format!("the table cannot hold `{formula}`: {}", error.message);
    if let Some(place) = error.place.as_ref().filter(|place| formula.is_char_boundary(place.start))
    {
        let before = formula[..place.start].chars().count();
        let width = formula.get(place.clone()).map_or(1, |marked| marked.chars().count().max(1));
        text += &format!("\n  {formula}\n  {}{}", " ".repeat(before), "^".repeat(width));
    }
    anyhow::anyhow!("{text}\n  = help: {}", error.remedy)
}

/// Returns the image that the arguments name, or an image with the formula of the arguments.
///
/// # Errors
///
/// Fails if the arguments name a function without a writable table. Fails if the allowed error is not between 0.5 and 1024 units,
/// or if the image's name is no identifier.
fn wanted_image(one: &Loaded, arguments: &Arguments) -> Result<StatedImage> {
    let opened = &one.core.opened;
    let (function, formula) = match &arguments.formula[..] {
        [function, formula] => (Some(function), formula),
        rest => (None, &rest[0]),
    };
    let written = opened.written_function().map(|(name, _)| name);
    if let Some(function) = function
        && written.as_ref() != Some(function)
    {
        match written {
            Some(written) => wrong_usage!(
                "the table of `{function}` cannot be written; the table of `{written}` can"
            ),
            None => wrong_usage!(
                "`{}` has no functions with names: give only a formula, in quotes if it has blanks",
                one.path
            ),
        }
    }
    let error = arguments.error;
    if let Some(error) = error.filter(|error| !(0.5..=1024.0).contains(error)) {
        wrong_usage!("--error {error} is not between 0.5 and 1024 units");
    }
    let stated = opened.stated_images().into_iter().find(|image| image.name == *formula);
    let (own_name, formula) = match stated {
        Some(image) => (image.name, image.formula),
        None => ("image".to_owned(), formula.clone()),
    };
    let name = arguments.name.clone().unwrap_or(own_name);
    if let Err(reason) = identifier::check(&name) {
        wrong_usage!("`{name}` cannot be the name of an image: {reason}");
    }
    let config = opened.image_config(&formula, error).context("a table that can be written")?;
    Ok(StatedImage { name, formula, config })
}

struct SimulatedImage {
    operands: usize,
    is_every: bool,
    /// The raw operand, the simulated and the expected result at the first difference.
    first_difference: Option<[i64; 3]>,
}

/// Loads the image into the simulated core `base`, and compares its results with the contract of the core `with_image`.
fn simulate(base: &Core, with_image: &Core, image: &TableImage) -> Result<SimulatedImage> {
    let contract = with_image.contract.as_ref();
    let own = with_image.opened.written_contract();
    let operand = &own.operands()[0];
    let (first, last) = operand.domain;
    let step = (last.abs_diff(first) + 1).div_ceil(MOST_SIMULATED).max(1);
    let count = contract.operands().len();
    let mut points = Points::new(count);
    let mut operands = Vec::new();
    for raw in (first..=last).step_by(step as usize) {
        operands.push(raw);
        let point = match with_image.opened.written_function() {
            None => vec![raw],
            Some((_, opcode)) => {
                let mut point = vec![0; count];
                point[0] = opcode as i64;
                point[1] = operand.format.bits(raw.into()) as i64;
                point
            }
        };
        points.push(point, 1);
    }
    let mut simulated = RustHdl::new(&base.design, contract)?;
    simulated.load_table(&base.design, &image.words)?;
    let found = simulated.compute(&points)?;
    let expected = Golden(contract).compute(&points)?;
    let differs = found.iter().zip(&expected).position(|(found, expected)| found != expected);
    let outputs = contract.outputs().len();
    Ok(SimulatedImage {
        operands: operands.len(),
        is_every: step == 1,
        first_difference: differs.map(|at| [operands[at / outputs], found[at], expected[at]]),
    })
}

/// Writes the image, and returns the paths of the files.
///
/// # Errors
///
/// Fails without `--force` if a file already exists with other contents; then nothing is written.
fn write(
    out: &Path,
    arguments: &Arguments,
    one: &Loaded,
    layout: &TableLayout,
    image: &TableImage,
    core: &Core,
) -> Result<Vec<String>> {
    let name = &core.config().name;
    let path = input::label(&one.path);
    let mut command = format!("{Program} table {path} {:?} --name {}", image.formula, image.name);
    if let Some(error) = arguments.error {
        command += &format!(" --error {error}");
    }
    let header = image_header(name, &command, layout, image)?;
    let mut files: Vec<(String, Vec<u8>)> = vec![
        (image_file(name, &image.name), header.into_bytes()),
        (format!("{name}_table_{}.bin", image.name), layout.binary(image)),
    ];
    for (memory, contents) in verilog::writable_memories(&core.design)? {
        let own = format!("{name}_{}_{memory}.mem", image.name);
        files.push((own, contents.into_bytes()));
    }
    if !arguments.force {
        for (file, contents) in &files {
            let path = out.join(file);
            let is_same = std::fs::read(&path).map_or(!path.exists(), |found| found == *contents);
            ensure!(
                is_same,
                "`{}` is there already with other contents: choose another --out or --name, or replace it with --force",
                path.display()
            );
        }
    }
    let mut paths = Vec::new();
    for (file, contents) in files {
        let path = out.join(file);
        destination::replace(&path, contents)?;
        paths.push(path.display().to_string().replace('\\', "/"));
    }
    Ok(paths)
}

struct FittedImage<'a> {
    one: &'a Loaded,
    layout: TableLayout,
    image: TableImage,
    core: &'a Core,
    simulated: SimulatedImage,
    files: Vec<String>,
}

impl CommandReport for FittedImage<'_> {
    fn json(&self) -> Result<Value> {
        let Self { one, layout, image, simulated, files, .. } = self;
        let parts = layout.parts.iter().map(|(port, format)| json!([port, format.to_string()]));
        Ok(json!({
            "ok": simulated.first_difference.is_none(),
            "config": one.path,
            "image": image.name,
            "formula": image.formula,
            "bound_in_units": image.bound,
            "layout": format!("{:016x}", layout.digest),
            "parts": parts.collect::<Vec<Value>>(),
            "words": image.words,
            "simulated_operands": simulated.operands,
            "simulated_every_operand": simulated.is_every,
            "files": files,
        }))
    }

    fn print(&self) -> Result<()> {
        let Self { one, layout, image, simulated, files, core } = self;
        say!("{}: the table holds {}", one.path, image.formula);
        let error = text::rounded_up(image.bound, 4);
        let limit = core.opened.written_contract().bounds().governing().limit;
        say!(
            "  error: at most {error} units of the last place, below the allowed {limit}, proved at every operand"
        );
        let mut parts = Vec::new();
        for (port, format) in &layout.parts {
            parts.push(format!("{port} {format}"));
        }
        say!(
            "  table: {} words of {} bits ({})",
            layout.words,
            layout.word_bits(),
            parts.join(", ")
        );
        let which = if simulated.is_every { "every operand" } else { "evenly spaced operands" };
        match simulated.first_difference {
            None => say!(
                "  loaded in the built-in simulator: {which} ({}) equals the golden model",
                text::grouped(simulated.operands as u64)
            ),
            Some([operand, found, expected]) => say!(
                "  loaded in the built-in simulator: at the raw operand {operand}, the core gives {found}, and the golden model \
                 {expected}"
            ),
        }
        for file in files {
            say!("  {file}");
        }
        Ok(())
    }
}
