//! `glint setup`: computes a device's operands from vectors or angles, as a host does before it starts the device.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::Args;
use csv::StringRecord;
use serde_json::{Map, Value, json};

use super::{Loaded, load_one, none_of, rows};
use crate::failure::Failure;
use crate::{OutputOptions, say, tables, wrong_usage};
use glint_base::program::Program;
use glint_core::registry::Registry;
use glint_show::render::setup::{Arc, direction, half};
use glint_show::render::{self, Feed, Point, Vector};

/// The prefix of the columns in which `setup` writes real values. `eval` ignores these columns.
pub const REAL: &str = "real_";

/// Compute a device's operands from vectors or angles, as a host does before it starts
///
/// A device that walks scan lines takes the formulas (2) to (5) and (8) to (16) of seed 000: from normals N1, N2
/// and half vectors H1, H2 at the ends of a line, gamma, P, lambda, A and C, and of these the angle at the first point
/// and its step. A device that computes points takes the cosine of the angle between N and H, and its other operands.
///
/// The operands are in the formats of the configuration: an integer as the port takes it ("raw"), its value, and beside it
/// the real number that was rounded. As CSV they go straight into `glint eval --batch`.
#[derive(Args)]
#[command(after_help = "\
Inputs of a line:
  normal_1, normal_2       N at its first and last point, of any length, as 0,0,1
  half_1, half_2           H there
  light_1, view_1, ...     or the directions toward light and viewer, whose middle is H
  theta_1, theta_2, gamma  or angles in degrees in place of vectors: from N1 to H1, from N2 to H2,
                           and from H1 to H2 once N2 is turned into N1 and H2 with it
  points                   how many points the line has, both ends included
  exponent                 n
  intensity                the light times k_s, 0 to 1 [default: 1]
Inputs of a point:
  normal                   N
  half                     H, or light and view
  perturbed                the normal of the rough surface, for devices with dgamma
  gamma, dgamma            or angles in degrees in place of vectors
  exponent                 n, where the device takes it
  red, green, blue         the light times k_s, 0 to 1 [default: 1]

In a CSV file the first row has these names. A vector is one column, `0 0 1`, or three: normal_1_x,
normal_1_y, normal_1_z. Inputs on the command line hold for all rows.

Formulas (13) and (16) of the seed multiply by the root of n/k, which its device does itself: the
operands are without it. A device without an exponent takes its angles times a of (11).

Examples:
  glint setup line.toml normal_1=0,0,1 half_1=1,0,3 normal_2=0,0,1 half_2=0,1,3 points=9 exponent=60
  glint setup line.toml theta_1=30 theta_2=60 gamma=90 points=91 exponent=8 intensity=0.8
  glint setup point.toml normal=0,0,1 light=1,1,2 view=0,0,1 exponent=20
  glint setup line.toml --batch lines.csv | glint eval line.toml --batch -
  glint setup line.toml exponent=60 --batch - --json < lines.csv

Exit codes: 0 operands were printed; 1 a file is wrong; 2 an argument is.")]
pub struct Arguments {
    /// A configuration
    config: PathBuf,
    /// Inputs, see below
    #[arg(value_name = "INPUT=VALUE")]
    inputs: Vec<String>,
    /// Set up many: a CSV file with the names of inputs in its first row, or - for standard input. The operands are CSV,
    /// or with --json a list
    #[arg(long, value_name = "FILE.csv")]
    batch: Option<PathBuf>,
    /// Print CSV, for `glint eval --batch`
    #[arg(long, conflicts_with = "json")]
    csv: bool,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// An input: a vector, or a number.
#[derive(Clone, Copy)]
struct Input {
    name: &'static str,
    vector: bool,
}

/// The inputs of a line: vectors, and numbers.
const OF_LINE: [&str; 2] = [
    "normal_1 half_1 light_1 view_1 normal_2 half_2 light_2 view_2",
    "theta_1 theta_2 gamma points exponent intensity",
];

const OF_POINT: [&str; 2] =
    ["normal perturbed half light view", "gamma dgamma exponent red green blue"];

/// The inputs of a device, and the operands that they determine.
struct HostInputs<'a> {
    one: &'a Loaded,
    feed: Feed,
    line: bool,
    /// Some may not concern it.
    inputs: Vec<Input>,
}

/// The values of each input of a [`HostInputs`].
type Given = Vec<[Option<f64>; 3]>;

/// The operands that come out.
struct SetUp {
    /// Quantities of the formulas, in their order: a name, its origin, the number, its unit.
    quantities: Vec<(&'static str, &'static str, f64, &'static str)>,
    raw: Vec<i64>,
    real: Vec<f64>,
}

/// Runs `glint setup`: one line or point, or as many as a CSV file has.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let one = load_one(registry, &registry.schemas(), &arguments.config)?;
    let host = HostInputs::new(&one)?;
    let mut given = vec![[None; 3]; host.inputs.len()];
    for setting in &arguments.inputs {
        let Some((name, text)) = setting.split_once('=') else {
            wrong_usage!("`{setting}` is not input=value, as in exponent=20")
        };
        host.place(name)
            .and_then(|place| host.put(&mut given, place, text))
            .map_err(Failure::WrongUsage)?;
    }
    let Some(path) = &arguments.batch else {
        let set_up = host.set_up(&given).map_err(Failure::WrongUsage)?;
        match (arguments.csv, output.json) {
            (true, _) => host.print_csv(&[set_up])?,
            (_, true) => tables::print_json(&host.json(&set_up)),
            _ => host.print(&set_up),
        }
        return Ok(true);
    };
    if *path == arguments.config {
        wrong_usage!("configuration and --batch are one file");
    }
    let columns = |headings: &StringRecord| -> Result<Vec<(usize, Option<usize>)>> {
        let places = headings.iter().map(|heading| host.place(heading));
        places.collect::<Result<_, _>>().map_err(anyhow::Error::msg)
    };
    let set_ups = rows::read(path, columns, |columns, record| {
        let mut given = given.clone();
        for (place, text) in columns.iter().zip(record).filter(|(_, text)| !text.is_empty()) {
            host.put(&mut given, *place, text)?;
        }
        host.set_up(&given)
    })?;
    if output.json {
        let rows: Vec<Value> = set_ups.iter().map(|it| host.json(it)).collect();
        tables::print_json(&json!({ "config": one.path, "rows": rows }));
    } else {
        host.print_csv(&set_ups)?;
    }
    Ok(true)
}

impl<'a> HostInputs<'a> {
    fn new(one: &'a Loaded) -> Result<Self> {
        let contract = one.core.contract.as_ref();
        let feed = Feed::new(one.core.device.name, contract)?;
        ensure!(
            !feed.shades(),
            "the operands of `{}` are vectors and colours themselves: there is nothing to set up",
            one.core.device.name
        );
        let line = render::walks_lines(contract);
        let [vectors, numbers] = if line { OF_LINE } else { OF_POINT };
        let input = |vector| move |name| Input { name, vector };
        let inputs = vectors.split(' ').map(input(true));
        let inputs = inputs.chain(numbers.split(' ').map(input(false))).collect();
        Ok(Self { one, feed, line, inputs })
    }

    fn concerns(&self, name: &str) -> bool {
        match name {
            "perturbed" | "dgamma" => self.feed.takes_deviation(),
            "exponent" => self.line || self.feed.takes_exponent(),
            _ => true,
        }
    }

    /// Returns the index of an input. If `name` is the name of a vector's component, it returns the index of the
    /// component too. For example, `normal_1_y` gives the index of `normal_1`, and 1.
    fn place(&self, name: &str) -> Result<(usize, Option<usize>), String> {
        let all = &self.inputs;
        let at = |name: &str| all.iter().position(|it| it.name == name && self.concerns(name));
        if let Some(at) = at(name) {
            return Ok((at, None));
        }
        if let Some((vector, axis)) = name.rsplit_once('_')
            && let Some(axis) = AXES.iter().position(|it| *it == axis)
            && let Some(at) = at(vector).filter(|at| all[*at].vector)
        {
            return Ok((at, Some(axis)));
        }
        let names = all.iter().map(|it| it.name).filter(|it| self.concerns(it));
        let names: Vec<&str> = names.collect();
        let device = self.one.core.device.name;
        Err(format!("there is no input `{name}` of `{device}`{}", none_of(name, "inputs", &names)))
    }

    /// Stores the numbers that a text gives to an input, which must not have any yet. For example, a vector may be
    /// `0,0,1` or `0 0 1`.
    fn put(
        &self,
        given: &mut Given,
        (at, axis): (usize, Option<usize>),
        text: &str,
    ) -> Result<(), String> {
        let Input { name, vector } = self.inputs[at];
        let number = |text: &str| match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("input `{name}`: `{text}` is not a finite number")),
        };
        let split = |it: char| it == ',' || it == ';' || it.is_whitespace();
        let values: Vec<&str> = match (vector, axis) {
            (true, None) => text.split(split).filter(|part| !part.is_empty()).collect(),
            _ => vec![text],
        };
        if vector && axis.is_none() && values.len() != 3 {
            return Err(format!("input `{name}`: `{text}` is not three numbers, as 0,0,1"));
        }
        for (part, text) in (axis.unwrap_or(0)..).zip(values) {
            if given[at][part].replace(number(text)?).is_some() {
                return Err(format!("input `{name}` is given twice"));
            }
        }
        Ok(())
    }

    fn number(&self, given: &Given, name: &str) -> Option<f64> {
        let at = self.inputs.iter().position(|it| it.name == name)?;
        given[at][0]
    }

    /// Returns the number of an input, which the user must give. For example, without `points` a line fails.
    fn needed(&self, given: &Given, name: &str) -> Result<f64, String> {
        let missing = || format!("input `{name}` is missing; give it as {name}=…, or as a column");
        self.number(given, name).ok_or_else(missing)
    }

    /// Returns the whole number of an input, which the user must give and which cannot be below `least`.
    fn whole(&self, given: &Given, name: &str, least: u32) -> Result<u32, String> {
        let value = self.needed(given, name)?;
        if value.fract() != 0.0 || !(f64::from(least)..=f64::from(u32::MAX)).contains(&value) {
            return Err(format!("input `{name}` is {value}; it is a whole number from {least} on"));
        }
        Ok(value as u32)
    }

    /// Returns a share of the light, which must be from 0 to 1. An input that is not given is 1.
    fn share(&self, given: &Given, name: &str) -> Result<f64, String> {
        let value = self.number(given, name).unwrap_or(1.0);
        let inside = (0.0..=1.0).contains(&value);
        inside.then_some(value).ok_or_else(|| {
            format!("input `{name}` is {value}; it is a share of the full light, 0 to 1")
        })
    }

    /// Returns the angle of an input in radians. The user must give it in degrees: for example, 180 is π.
    fn angle(&self, given: &Given, name: &str, (low, high): (f64, f64)) -> Result<f64, String> {
        let degrees = self.needed(given, name)?;
        let inside = (low..=high).contains(&degrees);
        inside.then(|| degrees.to_radians()).ok_or_else(|| {
            format!("input `{name}` is {degrees} degrees; it lies between {low} and {high}")
        })
    }

    fn vector(&self, given: &Given, name: &str) -> Result<Option<Vector>, String> {
        let at = self.inputs.iter().position(|it| it.name == name);
        let parts = at.map_or([None; 3], |at| given[at]);
        match parts {
            [Some(x), Some(y), Some(z)] => Ok(Some(Vector::new(x, y, z))),
            [None, None, None] => Ok(None),
            _ => {
                let axis = AXES[parts.iter().position(Option::is_none).unwrap_or(0)];
                Err(format!("input `{name}` lacks its component {axis}"))
            }
        }
    }

    /// Returns the normal and the half vector, of any length. The names are the names of these two vectors, and of
    /// the directions toward light and viewer.
    fn pair(
        &self,
        given: &Given,
        [normal, of_half, light, view]: [&'static str; 4],
    ) -> Result<(Vector, Vector), String> {
        let missing = |name: &str, or: &str| {
            format!("input `{name}` is missing; give it{or}, or angles in place of vectors")
        };
        let toward = match (self.vector(given, of_half)?, self.vector(given, light)?) {
            (Some(half), None) => half,
            (Some(_), Some(_)) => return Err(format!("`{of_half}` and `{light}` are both given")),
            (None, Some(toward)) => {
                let view_vector = self.vector(given, view)?.ok_or_else(|| missing(view, ""))?;
                half([light, view, "the sum of light and view"], toward, view_vector)
                    .map_err(|error| error.to_string())?
            }
            (None, None) => return Err(missing(of_half, &format!(", or `{light}` and `{view}`"))),
        };
        let normal = self.vector(given, normal)?.ok_or_else(|| missing(normal, ""))?;
        Ok((normal, toward))
    }

    /// Returns whether angles are given. Fails if vectors are given too.
    fn by_angles(&self, given: &Given, angles: &[&str]) -> Result<bool, String> {
        let angle = angles.iter().find(|name| self.number(given, name).is_some());
        let mut vectors = self.inputs.iter().zip(given).filter(|(input, _)| input.vector);
        let vector = vectors.find(|(_, parts)| parts.iter().any(Option::is_some));
        match (angle, vector) {
            (Some(angle), Some((vector, _))) => Err(format!(
                "`{}` and `{angle}` are both given: vectors or angles, not both",
                vector.name
            )),
            (angle, _) => Ok(angle.is_some()),
        }
    }

    fn set_up(&self, given: &Given) -> Result<SetUp, String> {
        let set_up = if self.line { self.of_line(given)? } else { self.of_point(given)? };
        if let Some(at) = self.feed.outside(&set_up.real) {
            let operand = &self.one.core.contract.operands()[at];
            let value = |raw: i64| operand.format.to_f64(i128::from(raw));
            let (low, high) = operand.domain;
            return Err(format!(
                "operand `{}` would be {}, and {} takes {} to {}; give other inputs, or a wider domain or format in the \
                 configuration",
                operand.name,
                set_up.real[at],
                self.one.path,
                value(low),
                value(high)
            ));
        }
        Ok(set_up)
    }

    fn of_line(&self, given: &Given) -> Result<SetUp, String> {
        let arc = if self.by_angles(given, &["theta_1", "theta_2", "gamma"])? {
            let angle = |name| self.angle(given, name, (0.0, 180.0));
            Arc::of_angles(angle("theta_1")?, angle("theta_2")?, angle("gamma")?)
        } else {
            let (n1, h1) = self.pair(given, ["normal_1", "half_1", "light_1", "view_1"])?;
            let (n2, h2) = self.pair(given, ["normal_2", "half_2", "light_2", "view_2"])?;
            Arc::new(n1, h1, n2, h2)
        };
        let arc = arc.map_err(|error| error.to_string())?;
        let light = self.feed.full() * self.share(given, "intensity")?;
        let exponent = self.whole(given, "exponent", 0)?;
        let line = arc.line(light, exponent, self.whole(given, "points", 1)? - 1);
        let mut quantities = vec![
            ("theta_1", "angle from N1 to H1", arc.theta_1.to_degrees(), "degrees"),
            ("theta_2", "angle from N2 to H2", arc.theta_2.to_degrees(), "degrees"),
            ("gamma", "(4)", arc.gamma.to_degrees(), "degrees"),
            ("p", "(3)", arc.p(), ""),
            ("lambda", "(3)", arc.lambda.to_degrees(), "degrees"),
            ("a_cosine", "A in (3)", arc.peak, ""),
            ("c", "(5)", line.amplitude, "output units"),
            ("l", "(15)", f64::from(line.length), "intervals"),
            ("delta_zeta", "(14)", line.delta_zeta.to_degrees(), "degrees"),
            ("zeta_start", "(16)", line.zeta_start.to_degrees(), "degrees"),
        ];
        if !self.feed.takes_exponent() {
            quantities.push(("a", "(11) with k = 2", line.stretch(), ""));
        }
        // A value that fits no format is reported by its name before it saturates.
        let real: Vec<f64> = self.feed.line_values(&line).collect();
        let raw = self.feed.line(&line).map_err(|error| error.to_string())?;
        Ok(SetUp { quantities, raw, real })
    }

    fn of_point(&self, given: &Given) -> Result<SetUp, String> {
        let colour = ["red", "green", "blue"].map(|name| self.share(given, name));
        let [red, green, blue] = colour;
        let colour = Vector::new(red?, green?, blue?);
        let exponent = match self.feed.takes_exponent() {
            true => self.whole(given, "exponent", 0)?,
            false => 0,
        };
        let point = if self.by_angles(given, &["gamma", "dgamma"])? {
            let gamma = self.angle(given, "gamma", (0.0, 180.0))?;
            let dgamma = match self.number(given, "dgamma") {
                Some(_) => self.angle(given, "dgamma", (-90.0, 90.0))?,
                None => 0.0,
            };
            let along = |angle: f64| Vector::new(libm::sin(angle), 0.0, libm::cos(angle));
            Point {
                cos_gamma: libm::cos(gamma),
                cos_dgamma: libm::cos(dgamma),
                dgamma_negative: dgamma < 0.0,
                difference: along(-dgamma) - along(gamma),
                cos_shaded: libm::cos(gamma + dgamma),
                colour,
                ..Point::default()
            }
        } else {
            let (normal, half) = self.pair(given, ["normal", "half", "light", "view"])?;
            let perturbed = self.vector(given, "perturbed")?.unwrap_or(normal);
            let unit = |name, vector| direction(name, vector).map_err(|error| error.to_string());
            render::point(
                unit("normal", normal)?,
                unit("perturbed", perturbed)?,
                unit("half", half)?,
                colour,
            )
        };
        let degrees = |cosine: f64| libm::acos(cosine).to_degrees();
        let mut quantities = vec![
            ("cos_gamma", "N . H", point.cos_gamma, ""),
            ("gamma", "angle from N to H", degrees(point.cos_gamma), "degrees"),
        ];
        if self.feed.takes_deviation() {
            let dgamma = degrees(point.cos_dgamma);
            let dgamma = if point.dgamma_negative { -dgamma } else { dgamma };
            quantities.push(("dgamma", "what roughness adds to it", dgamma, "degrees"));
        }
        let real = self.feed.values(&point, exponent).collect();
        let raw = self.feed.raw(&point, exponent).0.collect();
        Ok(SetUp { quantities, raw, real })
    }

    fn print(&self, set_up: &SetUp) {
        let rows = set_up.quantities.iter().map(|(name, formula, value, unit)| {
            // Digits that a person reads.
            let value = (value * 1e9).round() / 1e9;
            vec![(*name).to_owned(), (*formula).to_owned(), format!("{value} {unit}")]
        });
        tables::print("quantity | of seed 000 | value", rows);
        let operands = self.one.core.contract.operands().iter();
        let rows = operands.zip(&set_up.raw).zip(&set_up.real).map(|((operand, raw), real)| {
            vec![
                operand.name.clone(),
                operand.format.to_string(),
                raw.to_string(),
                operand.format.to_f64(i128::from(*raw)).to_string(),
                real.to_string(),
            ]
        });
        tables::print("operand | format | raw: | value: | before rounding:", rows);
        let operands = self.one.core.contract.operands().iter().zip(&set_up.raw);
        let operands: Vec<String> =
            operands.map(|(operand, raw)| format!("{}=#{raw}", operand.name)).collect();
        say!("{Program} eval {} {}", self.one.path, operands.join(" "));
    }

    fn json(&self, set_up: &SetUp) -> Value {
        let operands = self.one.core.contract.operands().iter().zip(&set_up.raw).zip(&set_up.real);
        let operands: Vec<Value> = operands
            .map(|((operand, &raw), real)| {
                let value = operand.format.to_f64(i128::from(raw));
                json!({ "name": operand.name, "raw": raw, "value": value, "real": real, "format": operand.format.to_string() })
            })
            .collect();
        let quantities: Map<String, Value> =
            set_up.quantities.iter().map(|it| (it.0.to_owned(), json!(it.2))).collect();
        json!({ "config": self.one.path, "quantities": quantities, "operands": operands })
    }

    fn print_csv(&self, set_ups: &[SetUp]) -> Result<()> {
        let names = || self.one.core.contract.operands().iter().map(|operand| &operand.name);
        let headings = names().cloned().chain(names().map(|name| format!("{REAL}{name}")));
        let cells = |it: &SetUp| {
            let raw = it.raw.iter().map(|raw| format!("#{raw}"));
            raw.chain(it.real.iter().map(f64::to_string)).collect()
        };
        tables::print_csv(std::iter::once(headings.collect()).chain(set_ups.iter().map(cells)))
    }
}
