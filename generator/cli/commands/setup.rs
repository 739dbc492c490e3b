//! `glint setup`: computes a device's operands from vectors or angles, as a host does before it starts the device.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::Args;
use csv::StringRecord;
use serde_json::{Map, Value, json};

use super::{Loaded, load_one, none_of, rows};
use crate::failure::Failure;
use crate::report::CommandReport;
use crate::{OutputOptions, say, tables, wrong_usage};
use glint_base::program::Program;
use glint_core::registry::Registry;
use glint_show::render::setup::{Arc, direction, half};
use glint_show::render::{self, Feed, Point, Vector};

/// The prefix of columns with real values, which `setup` writes and `eval` ignores.
pub const REAL: &str = "real_";

/// Compute a device's operands from vectors or angles, as a host does before it starts
///
/// For a device that computes scan lines, the command applies the formulas (2) to (5) and (8) to (16) of seed 000. The
/// normals N1, N2 and the half vectors H1, H2 at the ends of a line give gamma, P, lambda, A and C, and these give the angle
/// at the first point and the step of the angle. For a device that computes single points, the command computes the cosine
/// of the angle between N and H, and the other operands.
///
/// The output has each operand in its format in the configuration: as the integer that the port takes ("raw"), as the value
/// of this integer, and as the real number before rounding. `glint eval --batch` reads the output of --csv.
#[derive(Args)]
#[command(after_help = "\
Inputs of a line:
  normal_1, normal_2       N at its first and last point, of any length, as 0,0,1
  half_1, half_2           H at these two points
  light_1, view_1, ...     or the directions toward light and viewer; H is halfway between them
  theta_1, theta_2, gamma  or angles in degrees in place of vectors: from N1 to H1, from N2 to H2,
                           and from H1 to the H2 that a rotation of N2 into N1 gives
  points                   the number of points of the line, both ends included
  exponent                 n
  intensity                the light times k_s, 0 to 1 [default: 1]
Inputs of a point:
  normal                   N
  half                     H, or light and view
  perturbed                the normal of the rough surface, for devices with dgamma
  gamma, dgamma            or angles in degrees in place of vectors
  exponent                 n, if the device has this operand
  red, green, blue         the light times k_s, 0 to 1 [default: 1]

In a CSV file the first row has these names. A vector is one column, `0 0 1`, or three: normal_1_x,
normal_1_y, normal_1_z. Inputs on the command line apply to all rows.

Formulas (13) and (16) of seed 000 multiply by the square root of n/k. The device does this
multiplication itself, so the operands do not contain the factor. For a device without an exponent,
the command multiplies the angles by a of (11).

Examples:
  glint setup line.toml normal_1=0,0,1 half_1=1,0,3 normal_2=0,0,1 half_2=0,1,3 points=9 exponent=60
  glint setup line.toml theta_1=30 theta_2=60 gamma=90 points=91 exponent=8 intensity=0.8
  glint setup point.toml normal=0,0,1 light=1,1,2 view=0,0,1 exponent=20
  glint setup line.toml --batch lines.csv | glint eval line.toml --batch -
  glint setup line.toml exponent=60 --batch - --json < lines.csv

Exit codes: 0 operands were printed; 1 a file is not valid; 2 an argument is not valid.")]
pub struct Arguments {
    /// A configuration file
    config: PathBuf,
    /// The inputs, which are listed below
    #[arg(value_name = "INPUT=VALUE")]
    inputs: Vec<String>,
    /// Compute the operands of many points or lines: read inputs from a CSV file, or from standard input if the file is -.
    /// The first row has the names of the inputs. The operands are printed as CSV, or with --json as a list
    #[arg(long, value_name = "FILE.csv")]
    batch: Option<PathBuf>,
    /// Print CSV, for `glint eval --batch`
    #[arg(long, conflicts_with = "json")]
    csv: bool,
}

const AXES: [&str; 3] = ["x", "y", "z"];

#[derive(Clone, Copy)]
struct Input {
    name: &'static str,
    vector: bool,
}

/// The inputs of a device that computes lines: first the vectors, then the numbers, separated by blanks.
const OF_LINE: [&str; 2] = [
    "normal_1 half_1 light_1 view_1 normal_2 half_2 light_2 view_2",
    "theta_1 theta_2 gamma points exponent intensity",
];

const OF_POINT: [&str; 2] =
    ["normal perturbed half light view", "gamma dgamma exponent red green blue"];

/// The inputs of a device, and the code that computes operands from them.
struct HostInputs<'a> {
    one: &'a Loaded,
    feed: Feed,
    line: bool,
    /// All inputs for a line or for a point. The device may ignore some of them.
    inputs: Vec<Input>,
}

/// The components of each input that the user gave; a number has only the first.
type Given = Vec<[Option<f64>; 3]>;

struct SetUp {
    /// The name of an intermediate quantity, its origin, its value and its unit.
    quantities: Vec<(&'static str, &'static str, f64, &'static str)>,
    raw: Vec<i64>,
    real: Vec<f64>,
}

/// Computes the operands of one line or point, or of all rows of a CSV file.
///
/// # Errors
/// Fails if the configuration has problems, if an input is unknown, missing or not valid. Fails if an operand would exceed its
/// domain, or if the CSV file cannot be read. Fails also for a device without operands to set up, such as `shading`.
pub fn run(registry: &Registry, output: OutputOptions, arguments: &Arguments) -> Result<bool> {
    let one = load_one(registry, &arguments.config)?;
    let host = HostInputs::new(&one)?;
    let mut given = vec![[None; 3]; host.inputs.len()];
    for setting in &arguments.inputs {
        let Some((name, text)) = setting.split_once('=') else {
            wrong_usage!("`{setting}` is not of the form input=value, for example exponent=20")
        };
        host.place(name)
            .and_then(|place| host.put(&mut given, place, text))
            .map_err(Failure::WrongUsage)?;
    }
    let Some(path) = &arguments.batch else {
        let set_up = host.set_up(&given).map_err(Failure::WrongUsage)?;
        if arguments.csv {
            host.print_csv(&[set_up])?;
        } else {
            output.report(&SingleSetUp { host: &host, set_up })?;
        }
        return Ok(true);
    };
    if *path == arguments.config {
        wrong_usage!("the configuration and --batch name the same file: give --batch another file");
    }
    let set_ups = rows::read(
        path,
        |headings| host.places(headings).map_err(anyhow::Error::msg),
        |places, record| host.set_up_row(&given, places, record),
    )?;
    output.report(&BatchSetUp { host: &host, set_ups })?;
    Ok(true)
}

struct SingleSetUp<'a> {
    host: &'a HostInputs<'a>,
    set_up: SetUp,
}

impl CommandReport for SingleSetUp<'_> {
    fn json(&self) -> Result<Value> {
        Ok(self.host.json(&self.set_up))
    }

    fn print(&self) -> Result<()> {
        self.host.print(&self.set_up);
        Ok(())
    }
}

struct BatchSetUp<'a> {
    host: &'a HostInputs<'a>,
    set_ups: Vec<SetUp>,
}

impl CommandReport for BatchSetUp<'_> {
    fn json(&self) -> Result<Value> {
        let mut rows = Vec::new();
        for set_up in &self.set_ups {
            rows.push(self.host.json(set_up));
        }
        Ok(json!({ "config": self.host.one.path, "rows": rows }))
    }

    fn print(&self) -> Result<()> {
        self.host.print_csv(&self.set_ups)
    }
}

impl<'a> HostInputs<'a> {
    fn new(one: &'a Loaded) -> Result<Self> {
        let contract = one.core.contract.as_ref();
        let feed = Feed::new(one.core.device().name, contract)?;
        ensure!(
            !feed.shades(),
            "the operands of `{}` are themselves vectors and colours, so there is nothing to compute: give \
             them to `eval`",
            one.core.device().name
        );
        let line = render::walks_lines(contract);
        let [vectors, numbers] = if line { OF_LINE } else { OF_POINT };
        let mut inputs = Vec::new();
        for name in vectors.split(' ') {
            inputs.push(Input { name, vector: true });
        }
        for name in numbers.split(' ') {
            inputs.push(Input { name, vector: false });
        }
        Ok(Self { one, feed, line, inputs })
    }

    fn concerns(&self, name: &str) -> bool {
        match name {
            "perturbed" | "dgamma" => self.feed.takes_deviation(),
            "exponent" => self.line || self.feed.takes_exponent(),
            _ => true,
        }
    }

    /// Returns the index of an input, and the component's index if `name` names a component, such as `normal_1_y`.
    fn place(&self, name: &str) -> Result<(usize, Option<usize>), String> {
        if let Some(index) = self.index(name)
            && self.concerns(name)
        {
            return Ok((index, None));
        }
        if let Some((vector, axis_name)) = name.rsplit_once('_')
            && let Some(axis) = AXES.iter().position(|it| *it == axis_name)
            && let Some(index) = self.index(vector)
            && self.concerns(vector)
            && self.inputs[index].vector
        {
            return Ok((index, Some(axis)));
        }
        let mut names = Vec::new();
        for input in &self.inputs {
            if self.concerns(input.name) {
                names.push(input.name);
            }
        }
        let device = self.one.core.device().name;
        Err(format!("there is no input `{name}` of `{device}`{}", none_of(name, "inputs", &names)))
    }

    /// Returns the input of each column of a CSV file, in the form of [`Self::place`].
    fn places(&self, headings: &StringRecord) -> Result<Vec<(usize, Option<usize>)>, String> {
        headings.iter().map(|heading| self.place(heading)).collect()
    }

    /// Returns an input's index, even if the device ignores it.
    fn index(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| input.name == name)
    }

    /// Parses the numbers for an input into `given`. Fails if the input already has a value.
    fn put(
        &self,
        given: &mut Given,
        (at, axis): (usize, Option<usize>),
        text: &str,
    ) -> Result<(), String> {
        let Input { name, vector } = self.inputs[at];
        let whole_vector = vector && axis.is_none();
        let numbers = if whole_vector { components(text) } else { vec![text] };
        if whole_vector && numbers.len() != 3 {
            return Err(format!(
                "input `{name}`: `{text}` is not three numbers, for example 0,0,1"
            ));
        }
        let first = axis.unwrap_or(0);
        for (offset, number) in numbers.into_iter().enumerate() {
            let value = match number.parse::<f64>() {
                Ok(value) if value.is_finite() => value,
                _ => return Err(format!("input `{name}`: `{number}` is not a finite number")),
            };
            if given[at][first + offset].replace(value).is_some() {
                return Err(format!("input `{name}` is given twice"));
            }
        }
        Ok(())
    }

    fn number(&self, given: &Given, name: &str) -> Option<f64> {
        given[self.index(name)?][0]
    }

    fn needed(&self, given: &Given, name: &str) -> Result<f64, String> {
        match self.number(given, name) {
            Some(number) => Ok(number),
            None => Err(format!("input `{name}` is missing; give it as {name}=…, or as a column")),
        }
    }

    fn whole(&self, given: &Given, name: &str, least: u32) -> Result<u32, String> {
        let value = self.needed(given, name)?;
        if value.fract() != 0.0 || !(f64::from(least)..=f64::from(u32::MAX)).contains(&value) {
            return Err(format!(
                "input `{name}` is {value}; give a whole number of at least {least}"
            ));
        }
        Ok(value as u32)
    }

    /// Returns a share of light, from 0 to 1. An input that the user does not give has the share 1.
    fn share(&self, given: &Given, name: &str) -> Result<f64, String> {
        let value = self.number(given, name).unwrap_or(1.0);
        if !(0.0..=1.0).contains(&value) {
            return Err(format!(
                "input `{name}` is {value}; give a share of the full light, from 0 to 1"
            ));
        }
        Ok(value)
    }

    /// Returns an angle in radians. The user gives it in degrees, from `low` to `high`.
    fn angle(&self, given: &Given, name: &str, (low, high): (f64, f64)) -> Result<f64, String> {
        let degrees = self.needed(given, name)?;
        if !(low..=high).contains(&degrees) {
            return Err(format!(
                "input `{name}` is {degrees} degrees; give an angle from {low} to {high} degrees"
            ));
        }
        Ok(degrees.to_radians())
    }

    fn vector(&self, given: &Given, name: &str) -> Result<Option<Vector>, String> {
        let Some(index) = self.index(name) else { return Ok(None) };
        let parts = given[index];
        match parts {
            [Some(x), Some(y), Some(z)] => Ok(Some(Vector::new(x, y, z))),
            [None, None, None] => Ok(None),
            _ => {
                let axis = AXES[parts.iter().position(Option::is_none).unwrap_or(0)];
                Err(format!("input `{name}` has no component {axis}; give all three components"))
            }
        }
    }

    /// Returns the normal and the half vector at a point, of any length. The array has the names of four inputs: the normal, the
    /// half vector, and the directions toward light and viewer. Fails if a vector is missing, or if the user gives a half vector
    /// and a light.
    fn pair(
        &self,
        given: &Given,
        [normal, of_half, light, view]: [&'static str; 4],
    ) -> Result<(Vector, Vector), String> {
        let half_vector = match (self.vector(given, of_half)?, self.vector(given, light)?) {
            (Some(half), None) => half,
            (Some(_), Some(_)) => {
                return Err(format!(
                    "`{of_half}` and `{light}` are both given: give only one of them"
                ));
            }
            (None, Some(toward_light)) => {
                let toward_viewer = self.needed_vector(given, view)?;
                half([light, view, "the sum of light and view"], toward_light, toward_viewer)
                    .map_err(|error| error.to_string())?
            }
            (None, None) => {
                return Err(missing_vector(of_half, &format!(", or `{light}` and `{view}`")));
            }
        };
        Ok((self.needed_vector(given, normal)?, half_vector))
    }

    fn needed_vector(&self, given: &Given, name: &str) -> Result<Vector, String> {
        let vector = self.vector(given, name)?;
        vector.ok_or_else(|| missing_vector(name, ""))
    }

    /// Returns whether the user gives angles in place of vectors. Fails if the user gives angles and vectors.
    fn by_angles(&self, given: &Given, angles: &[&str]) -> Result<bool, String> {
        let angle = angles.iter().find(|name| self.number(given, name).is_some());
        let mut vectors = self.inputs.iter().zip(given).filter(|(input, _)| input.vector);
        let vector = vectors.find(|(_, parts)| parts.iter().any(Option::is_some));
        match (angle, vector) {
            (Some(angle), Some((vector, _))) => Err(format!(
                "`{}` and `{angle}` are both given: give either vectors or angles",
                vector.name
            )),
            (angle, _) => Ok(angle.is_some()),
        }
    }

    /// Adds the cells of one row of a CSV file to the inputs `given` on the command line. An empty cell gives no value.
    fn set_up_row(
        &self,
        given: &Given,
        places: &[(usize, Option<usize>)],
        record: &StringRecord,
    ) -> Result<SetUp, String> {
        let mut of_row = given.clone();
        for (place, text) in places.iter().zip(record) {
            if !text.is_empty() {
                self.put(&mut of_row, *place, text)?;
            }
        }
        self.set_up(&of_row)
    }

    fn set_up(&self, given: &Given) -> Result<SetUp, String> {
        let set_up = if self.line { self.of_line(given)? } else { self.of_point(given)? };
        if let Some(at) = self.feed.outside(&set_up.real) {
            let operand = &self.one.core.contract.operands()[at];
            let (low, high) = operand.domain;
            return Err(format!(
                "operand `{}` would be {}, but {} accepts {} to {}; give other inputs, or set a wider domain \
                 or format in the configuration",
                operand.name,
                set_up.real[at],
                self.one.path,
                operand.format.to_f64(i128::from(low)),
                operand.format.to_f64(i128::from(high))
            ));
        }
        Ok(set_up)
    }

    fn of_line(&self, given: &Given) -> Result<SetUp, String> {
        let arc_result = if self.by_angles(given, &["theta_1", "theta_2", "gamma"])? {
            let half_turn = (0.0, 180.0);
            let theta_1 = self.angle(given, "theta_1", half_turn)?;
            let theta_2 = self.angle(given, "theta_2", half_turn)?;
            Arc::of_angles(theta_1, theta_2, self.angle(given, "gamma", half_turn)?)
        } else {
            let (n1, h1) = self.pair(given, ["normal_1", "half_1", "light_1", "view_1"])?;
            let (n2, h2) = self.pair(given, ["normal_2", "half_2", "light_2", "view_2"])?;
            Arc::new(n1, h1, n2, h2)
        };
        let arc = arc_result.map_err(|error| error.to_string())?;
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
        // A value that exceeds every format is reported with its name before it is saturated.
        let real: Vec<f64> = self.feed.line_values(&line).collect();
        let raw = self.feed.line(&line).map_err(|error| error.to_string())?;
        Ok(SetUp { quantities, raw, real })
    }

    fn of_point(&self, given: &Given) -> Result<SetUp, String> {
        let red = self.share(given, "red")?;
        let green = self.share(given, "green")?;
        let colour = Vector::new(red, green, self.share(given, "blue")?);
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
            Point {
                cos_gamma: libm::cos(gamma),
                cos_dgamma: libm::cos(dgamma),
                dgamma_negative: dgamma < 0.0,
                difference: from_z(-dgamma) - from_z(gamma),
                cos_shaded: libm::cos(gamma + dgamma),
                colour,
                ..Point::default()
            }
        } else {
            let (normal, half) = self.pair(given, ["normal", "half", "light", "view"])?;
            let perturbed = self.vector(given, "perturbed")?.unwrap_or(normal);
            render::point(
                unit_vector("normal", normal)?,
                unit_vector("perturbed", perturbed)?,
                unit_vector("half", half)?,
                colour,
            )
        };
        let gamma = libm::acos(point.cos_gamma).to_degrees();
        let mut quantities = vec![
            ("cos_gamma", "N . H", point.cos_gamma, ""),
            ("gamma", "angle from N to H", gamma, "degrees"),
        ];
        if self.feed.takes_deviation() {
            let size = libm::acos(point.cos_dgamma).to_degrees();
            let dgamma = if point.dgamma_negative { -size } else { size };
            quantities.push((
                "dgamma",
                "the angle that roughness adds to gamma",
                dgamma,
                "degrees",
            ));
        }
        let real = self.feed.values(&point, exponent).collect();
        let raw = self.feed.raw(&point, exponent).0.collect();
        Ok(SetUp { quantities, raw, real })
    }

    fn print(&self, set_up: &SetUp) {
        let mut quantities = Vec::new();
        for (name, formula, value, unit) in &set_up.quantities {
            // The number is rounded to nine decimals, for people.
            let rounded = (value * 1e9).round() / 1e9;
            quantities.push(vec![
                (*name).to_owned(),
                (*formula).to_owned(),
                format!("{rounded} {unit}"),
            ]);
        }
        tables::print("quantity | meaning, or formula of seed 000 | value", quantities);
        let mut operands = Vec::new();
        let mut settings = Vec::new();
        for (at, operand) in self.one.core.contract.operands().iter().enumerate() {
            let raw = set_up.raw[at];
            operands.push(vec![
                operand.name.clone(),
                operand.format.to_string(),
                raw.to_string(),
                operand.format.to_f64(i128::from(raw)).to_string(),
                set_up.real[at].to_string(),
            ]);
            settings.push(format!("{}=#{raw}", operand.name));
        }
        tables::print("operand | format | raw: | value: | before rounding:", operands);
        say!("{Program} eval {} {}", self.one.path, settings.join(" "));
    }

    fn json(&self, set_up: &SetUp) -> Value {
        let mut operands: Vec<Value> = Vec::new();
        for (at, operand) in self.one.core.contract.operands().iter().enumerate() {
            let raw = set_up.raw[at];
            operands.push(json!({
                "name": operand.name,
                "raw": raw,
                "value": operand.format.to_f64(i128::from(raw)),
                "real": set_up.real[at],
                "format": operand.format.to_string(),
            }));
        }
        let mut quantities = Map::new();
        for (name, _, value, _) in &set_up.quantities {
            quantities.insert((*name).to_owned(), json!(value));
        }
        json!({ "config": self.one.path, "quantities": quantities, "operands": operands })
    }

    fn print_csv(&self, set_ups: &[SetUp]) -> Result<()> {
        let operands = self.one.core.contract.operands();
        let mut headings: Vec<String> = Vec::new();
        headings.extend(operands.iter().map(|operand| operand.name.clone()));
        headings.extend(operands.iter().map(|operand| format!("{REAL}{}", operand.name)));
        let mut rows = vec![headings];
        for set_up in set_ups {
            let mut cells: Vec<String> = Vec::new();
            cells.extend(set_up.raw.iter().map(|raw| format!("#{raw}")));
            cells.extend(set_up.real.iter().map(f64::to_string));
            rows.push(cells);
        }
        tables::print_csv(rows)
    }
}

fn components(text: &str) -> Vec<&str> {
    let separated = text.split(|c: char| c == ',' || c == ';' || c.is_whitespace());
    separated.filter(|part| !part.is_empty()).collect()
}

/// Returns the message about a missing vector. `or` names inputs that may replace the vector.
fn missing_vector(name: &str, or: &str) -> String {
    format!("input `{name}` is missing; give it{or}, or angles in place of vectors")
}

fn unit_vector(name: &'static str, vector: Vector) -> Result<Vector, String> {
    direction(name, vector).map_err(|error| error.to_string())
}

/// Returns the unit vector in the direction `angle`, in radians, from the z axis toward the x axis.
fn from_z(angle: f64) -> Vector {
    Vector::new(libm::sin(angle), 0.0, libm::cos(angle))
}
