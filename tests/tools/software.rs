//! Tests the emitted model in C: it compiles without warnings, and computes the results of the golden model. `tests/kinds.toml`
//! says which cores a run takes.
//!
//! The same holds for the functions in C and Python that set up a line of points.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use glint::core::Core;
use glint::golden::{Contract, Operand};
use glint::hdl::netlist::{Port, Role};
use glint::render::setup::Arc;
use glint::render::{Feed, Vector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

use crate::common::cores::{Emitted, configuration_with};
use crate::common::files::{put, read, replaced};
use crate::common::sample::sampled_by_name;
use crate::common::tools::ran;

/// Points that are compared of each configuration.
const POINTS: usize = 1_000_000;

/// Intervals of a line, at most, so that there are many lines.
const LONGEST: i64 = 300;

const SOFTWARE: &str = "\n[package]\nsoftware = true\n";

/// The pipelines among them.
const PIPELINES: &str = "blinn_pipelined cosine_power_pipelined gauss_pipelined lyon_pipelined \
    quadratic_pipelined rough_pipelined schlick_pipelined threshold_pipelined";

const DEFAULTS: &str = "blinn cosine_power cosine_squared gauss lyon quad_cosine quadratic rough \
    schlick threshold";

/// As a driver's author would have it, and stricter.
const FLAGS: &str =
    "-std=c99 -O2 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsanitize=undefined";

/// Returns the names that a run takes for a kind of check.
fn taken(kind: &str, names: &'static str) -> Vec<&'static str> {
    sampled_by_name(kind, names.split_ascii_whitespace(), |name| (*name).to_owned())
}

#[test]
fn the_model_is_the_golden_model_at_random_points() {
    let mut names = taken("models in C", DEFAULTS);
    names.extend(taken("models of pipelines in C", PIPELINES));
    names.into_par_iter().for_each(|name| {
        let model = Model::new(&format!("configs/{name}.toml"));
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let contract = model.core.contract.as_ref();
        let mut operands = Vec::new();
        let mut count = 0;
        while count < POINTS {
            let drawn = draw(contract, &mut random);
            count += results_of(contract, &drawn);
            operands.push(drawn);
        }
        model.compile();
        model.assert_equal(&operands);
    });
}

#[test]
fn the_model_is_the_golden_model_at_every_combination() {
    taken("reduced models in C", DEFAULTS).into_par_iter().for_each(|name| {
        let model = Model::new(&format!("configs/reduced/{name}.toml"));
        model.compile();
        let operands = model.core.contract.operands();
        let (low, high) = operands[0].domain;
        // Some have millions of combinations: a value of the first operand at a time.
        for first in low..=high {
            let mut combinations = vec![vec![first]];
            for operand in &operands[1..] {
                let (low, high) = operand.domain;
                let extended = combinations.into_iter().flat_map(|head: Vec<i64>| {
                    (low..=high).map(move |raw| head.iter().copied().chain([raw]).collect())
                });
                combinations = extended.collect();
            }
            model.assert_equal(&combinations);
        }
    });
}

#[test]
fn a_faulty_model_is_noticed() {
    let model = Model::new("configs/reduced/cosine_power.toml");
    let path = model.dir.path().join("cosine_power_reduced_model.c");
    put(&path, replaced(&read(&path), "results.red_out = ", "results.red_out = 1u ^ "));
    model.compile();
    let operands = vec![vec![40, 3, 1, 0, 1], vec![60, 2, 1, 1, 1], vec![55, 5, 1, 1, 0]];
    assert_ne!(model.run(&operands), model.expected(&operands));
}

#[test]
fn values_become_operands_as_formats_say() {
    let model = Model::new("configs/quad_cosine.toml");
    let values = [-1e30, -3.7, -2.0, -1.5, -0.25, -1e-9, 0.0, 1e-8, 0.75, 1.0, 1.999, 2.0, 7e7];
    let name = &model.core.config().name;
    let mut text = format!("#include <stdio.h>\n#include \"{name}_model.h\"\nint main(void) {{\n");
    let mut expected = String::new();
    for operand in model.core.contract.operands() {
        for value in values {
            let call = format!("{name}_{}_from({value:?})", operand.name);
            writeln!(text, "printf(\"%lld\\n\", (long long){call});").expect("text");
            writeln!(expected, "{}", operand.format.quantise(value)).expect("text");
        }
        // Not a number is the least, as in the formats.
        let call = format!("{name}_{}_from(0.0 / 0.0)", operand.name);
        writeln!(text, "printf(\"%lld\\n\", (long long){call});").expect("text");
        writeln!(expected, "{}", operand.format.min_raw()).expect("text");
    }
    text += "return 0; }\n";
    let dir = model.dir.path();
    fs::write(dir.join("conversions.c"), text).expect("written");
    let _ = fs::remove_file(dir.join("conversions"));
    let compile = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-o", "conversions", "conversions.c"];
    ran("cc", compile, dir);
    let printed = run_program(&dir.join("conversions"), dir);
    assert_eq!(printed, expected);
}

#[test]
fn the_example_in_python_computes_the_manifests_example() {
    ["quad_cosine", "rough"].par_iter().for_each(|name| {
        let model = Model::new(&format!("configs/{name}.toml"));
        let dir = model.dir.path();
        let text = read(dir.join(format!("{name}_model.py")));
        let library = format!("{name}_model.so");
        let source = format!("{name}_model.c");
        let compile = ["-std=c99", "-O2", "-shared", "-fPIC", "-o", &library, &source];
        assert!(text.contains(&format!("$ cc {}\n", compile.join(" "))), "{text}");
        ran("cc", compile, dir);
        let printed = ran("python", [format!("{name}_model.py")], dir);
        let example = model.core.example().expect("an example");
        let first: Vec<String> = example.outputs.iter().map(|it| it.raw.to_string()).collect();
        assert_eq!(printed.lines().next(), Some(first.join(" ").as_str()), "{printed}");
    });
}

/// A configuration with its model in C in a directory.
struct Model {
    core: Core,
    dir: tempfile::TempDir,
}

impl Model {
    fn new(config: &str) -> Self {
        let core = configuration_with(config, SOFTWARE);
        let dir = Emitted::new(&core, 1, 1).beside("software");
        Self { core, dir }
    }

    fn is_line(&self) -> bool {
        self.core.contract.length().is_some()
    }

    fn assert_equal(&self, operands: &[Vec<i64>]) {
        let (found, expected) = (self.run(operands), self.expected(operands));
        assert_eq!(found.len(), expected.len(), "{}: results", self.core.config().name);
        let differs = found.iter().zip(&expected).position(|(found, expected)| found != expected);
        if let Some(at) = differs {
            let outputs = self.core.contract.outputs().len();
            panic!(
                "{}: result {} is {}, not {}",
                self.core.config().name,
                at / outputs,
                found[at],
                expected[at]
            );
        }
    }

    /// Returns the golden model's results.
    fn expected(&self, operands: &[Vec<i64>]) -> Vec<i64> {
        let contract = self.core.contract.as_ref();
        let of_point = |operands: &Vec<i64>| {
            let mut results = Vec::new();
            for index in 0..results_of(contract, operands) {
                contract.results(operands, index as u64, &mut results);
            }
            results
        };
        operands.par_iter().flat_map_iter(of_point).collect()
    }

    /// Makes the program that [`Model::run`] runs.
    fn compile(&self) {
        let (name, dir) = (&self.core.config().name, self.dir.path());
        fs::write(dir.join("driver.c"), self.driver()).expect("written");
        let model = format!("{name}_model.c");
        let arguments = FLAGS.split(' ').chain(["-fno-sanitize-recover=all", "-o", "driver"]);
        let arguments: Vec<&str> = arguments.chain(["driver.c", &model]).collect();
        let compiled = ran("cc", &arguments, dir);
        assert_eq!(compiled, "", "{name}: words of the compiler");
    }

    /// Runs the model in C, and returns its results.
    fn run(&self, operands: &[Vec<i64>]) -> Vec<i64> {
        let dir = self.dir.path();
        let bytes: Vec<u8> = operands.iter().flatten().flat_map(|raw| raw.to_le_bytes()).collect();
        fs::write(dir.join("operands"), bytes).expect("written");
        run_program(&dir.join("driver"), dir);
        let bytes = fs::read(dir.join("results")).expect("results");
        let raw = |bytes: &[u8]| i64::from_le_bytes(bytes.try_into().expect("eight bytes"));
        bytes.chunks_exact(8).map(raw).collect()
    }

    /// Returns a program that reads operands and writes results, 64 bits each in the contract's order.
    fn driver(&self) -> String {
        let (name, contract) = (&self.core.config().name, self.core.contract.as_ref());
        let ports = self.core.design.inputs();
        let operand = |port: &&Port| matches!(port.role, Role::Operand { .. } | Role::Point);
        let count = ports.filter(operand).count();
        assert_eq!(count, contract.operands().len(), "{name}: every operand is the contract's");
        let mut text = format!(
            "#include <stdio.h>\n#include \"{name}_model.h\"\n\
             static {name}_results points[1 << 16];\n\
             int main(void) {{\n\
             FILE *in = fopen(\"operands\", \"rb\"), *out = fopen(\"results\", \"wb\");\n\
             int64_t raw[{count}];\n\
             while (fread(raw, sizeof raw, 1, in) == 1) {{\n\
             {name}_operands operands;\n"
        );
        for (at, operand) in contract.operands().iter().enumerate() {
            let kind = match (operand.format.signed, operand.format.width() <= 32) {
                (true, true) => "int32_t",
                (true, false) => "int64_t",
                (false, true) => "uint32_t",
                (false, false) => "uint64_t",
            };
            writeln!(text, "operands.{} = ({kind})raw[{at}];", operand.name).expect("text");
        }
        text += &if self.is_line() {
            format!("size_t count = {name}_model(operands, points, 1 << 16);\n")
        } else {
            format!("size_t count = 1;\npoints[0] = {name}_model(operands);\n")
        };
        text += "for (size_t at = 0; at < count; ++at) {\nint64_t result;\n";
        for output in contract.outputs() {
            writeln!(text, "result = (int64_t)points[at].{};", output.name).expect("text");
            text += "fwrite(&result, sizeof result, 1, out);\n";
        }
        text + "}\n}\nreturn fclose(out);\n}\n"
    }
}

fn run_program(program: &Path, dir: &Path) -> String {
    let program = program.to_str().expect("a path").to_owned();
    ran("env", [program], dir)
}

/// Returns how many results a computation has.
fn results_of(contract: &dyn Contract, operands: &[i64]) -> usize {
    let length = contract.length().map(|name| {
        let at = contract.operands().iter().position(|operand| operand.name == name);
        operands[at.expect("the length is an operand")] as usize + 1
    });
    length.unwrap_or(1)
}

/// Operands of the domain. Half of them are drawn so that f is spread over 0 … 1, as far as the device has an
/// angle and an exponent.
fn draw(contract: &dyn Contract, random: &mut ChaCha8Rng) -> Vec<i64> {
    let mut any = |operand: &Operand| {
        let (low, high) = operand.domain;
        let high =
            if Some(operand.name.as_str()) == contract.length() { high.min(LONGEST) } else { high };
        low + (random.next_u64() % (high - low + 1) as u64) as i64
    };
    let mut operands: Vec<i64> = contract.operands().iter().map(&mut any).collect();
    let mut uniform = || (f64::from(random.next_u32()) + 0.5) / f64::from(u32::MAX);
    if uniform() < 0.5 {
        let n = libm::floor(libm::pow(1000.0, uniform()));
        let f = uniform();
        let gamma = libm::acos(libm::pow(f, 1.0 / n));
        if let Some(control) = contract.highlight().and_then(|it| it.at(gamma, n)) {
            for (at, raw) in control.into_iter().enumerate() {
                // The others keep what was drawn.
                if raw != 0 && Some(contract.operands()[at].name.as_str()) != contract.length() {
                    operands[at] = raw;
                }
            }
        }
    }
    operands
}

/// Random lines through `glint setup`, the C and the Python: raw operands, bit for bit; some vectors are equal, opposite,
/// long, or almost so, and some lines are refused, by all three.
#[test]
fn lines_are_set_up_in_c_and_python_as_by_glint() {
    ["quad_cosine", "cosine_squared"].par_iter().for_each(|name| {
        let model = Model::new(&format!("configs/{name}.toml"));
        let dir = model.dir.path();
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut unit = || f64::from(random.next_u32()) / f64::from(u32::MAX);
        let lines: Vec<[f64; 15]> = (0..LINES).map(|at| line(at, &mut unit)).collect();

        let words = |line: &[f64; 15]| line.map(|number| format!("{number:?}")).join(" ");
        fs::write(dir.join("lines"), lines.iter().map(|it| words(it) + "\n").collect::<String>())
            .expect("written");
        for program in ["lines.c", "lines.py"] {
            let text = read(Path::new("tests/tools/software").join(program));
            put(dir.join(program), text.replace("NAME", name));
        }
        let setup = format!("{name}_setup.c");
        let arguments = FLAGS.split(' ').chain(["-fno-sanitize-recover=all", "-o", "set_up"]);
        let arguments: Vec<&str> = arguments.chain(["lines.c", &setup, "-lm"]).collect();
        assert_eq!(ran("cc", &arguments, dir), "", "{name}");
        run_program(&dir.join("set_up"), dir);
        ran("python", ["lines.py"], dir);
        let [in_c, in_python] = ["in_c", "in_python"].map(|file| read(dir.join(file)));

        let contract = model.core.contract.as_ref();
        let feed = Feed::new(model.core.device().name, contract).expect("operands of a line");
        let expected = lines.iter().map(|line| set_up(&feed, contract, line) + "\n");
        let expected: String = expected.collect();
        let refused = expected.matches("refused").count();
        assert!((LINES / 50..LINES / 4).contains(&refused), "{refused} are refused");
        for (what, found) in [("C", in_c), ("Python", in_python)] {
            let lines = found.lines().zip(expected.lines()).zip(&lines);
            for ((found, expected), line) in lines {
                assert_eq!(found, expected, "{name} in {what}: {line:?}");
            }
            assert_eq!(found.lines().count(), LINES, "{name} in {what}");
        }
    });
}

/// Lines that are set up.
const LINES: usize = 20_000;

/// N1, H1, N2, H2, then intensity, exponent and points.
fn line(at: usize, unit: &mut dyn FnMut() -> f64) -> [f64; 15] {
    let mut line: [f64; 15] = std::array::from_fn(|_| unit() - 0.5);
    let copy = |line: &mut [f64; 15], from: usize, to: usize, by: f64| {
        (0..3).for_each(|axis| line[to + axis] = by * line[from + axis]);
    };
    match at % 16 {
        // A flat surface; seen and lit from afar, but for rounding; far too long; opposite normals.
        0 => copy(&mut line, 0, 6, 1.0),
        1 => {
            copy(&mut line, 0, 6, 1.0);
            copy(&mut line, 3, 9, 1.0 + unit());
        }
        2 => {
            copy(&mut line, 0, 6, 1.0);
            copy(&mut line, 3, 9, 1.0);
            line[9] += 1e-8 * unit();
        }
        3 => (0..12).for_each(|at| line[at] *= 1e200),
        4 => copy(&mut line, 0, 6, -1.0),
        // Opposite half vectors, no direction.
        5 if unit() < 0.5 => {
            copy(&mut line, 0, 6, 1.0);
            copy(&mut line, 3, 9, -1.0);
        }
        5 => copy(&mut line, 0, 3, 0.0),
        // Highlights.
        6..=12 => (0..3).for_each(|axis| {
            line[6 + axis] = line[axis] + 0.3 * line[6 + axis];
            line[3 + axis] = line[axis] + 0.2 * line[3 + axis];
            line[9 + axis] = line[6 + axis] + 0.2 * line[9 + axis];
        }),
        _ => {}
    }
    line[12] = unit();
    line[13] = (1.0 + 999.0 * unit() * unit()).round();
    line[14] = (1.0 + 4110.0 * unit() * unit()).round();
    line
}

fn set_up(feed: &Feed, contract: &dyn Contract, line: &[f64; 15]) -> String {
    let v = |at: usize| Vector::new(line[at], line[at + 1], line[at + 2]);
    let refused = "refused".to_owned();
    let Ok(arc) = Arc::new(v(0), v(3), v(6), v(9)) else {
        return refused;
    };
    let line = arc.line(feed.full() * line[12], line[13] as u32, line[14] as u32 - 1);
    let real: Vec<f64> = feed.line_values(&line).collect();
    let Some(raw) = feed.line(&line).ok().filter(|_| feed.outside(&real).is_none()) else {
        return refused;
    };
    let named = contract.operands().iter().zip(raw);
    let mut named: Vec<String> =
        named.map(|(operand, raw)| format!("{} {raw}", operand.name)).collect();
    named.sort();
    named.join(" ")
}
