//! The native extension module of the Python package `glint`. The Python code of the package documents each function.

mod arrays;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context, Result, bail, ensure};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString};

use arrays::{OperandColumn, ResultColumns};
use glint::config::{ConfigSource, Problems};
use glint::core::Core;
use glint::cosim::batch::{Engine, Golden, Points, RustHdl};
use glint::golden::Contract;
use glint::hdl::netlist::CoreFunction;
use glint::package::words_of;
use glint::registry::{OpenedConfig, Registry};
use glint::render::{self, BuiltIn, Light, Material, Object, Scene, Settings, Vector, View};
use glint::synth::{TARGETS, Target};
use glint::tune::Cost;

/// A configuration with everything that is made of it.
#[pyclass(name = "Core", module = "glint._glint", frozen)]
struct PyCore {
    core: Arc<Core>,
}

/// A function of a unit, in its own formats.
#[pyclass(name = "UnitFunction", module = "glint._glint", frozen)]
struct PyUnitFunction {
    unit: Arc<Core>,
    opcode: usize,
    contract: Box<dyn Contract>,
}

/// Returns an error of Python with the causes of one of Rust, a line each.
fn wrong(error: anyhow::Error) -> PyErr {
    let causes: Vec<String> = error.chain().map(ToString::to_string).collect();
    PyValueError::new_err(causes.join("\n  caused by: "))
}

/// Returns a value of TOML.
fn toml(value: &Bound<'_, PyAny>) -> Result<String> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().to_string());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(serde_json::to_string(&text.to_string())?);
    }
    if let Ok(list) = value.cast::<PyList>() {
        let values = list.iter().map(|it| toml(&it)).collect::<Result<Vec<_>>>()?;
        return Ok(format!("[{}]", values.join(", ")));
    }
    if value.is_instance_of::<PyInt>() || value.is_instance_of::<PyFloat>() {
        return Ok(value.str()?.to_string());
    }
    if value.get_type().name()? == "Decimal" {
        return decimal(&value.str()?.to_string());
    }
    bail!("`{value}` is no value of a key: a number, a text, True, False or a list is wanted")
}

/// Returns the digits of a `decimal.Decimal` as a number of TOML, which has digits on both sides of its point.
fn decimal(digits: &str) -> Result<String> {
    let parsed: f64 = digits.parse().with_context(|| format!("`{digits}` is no number"))?;
    ensure!(parsed.is_finite(), "`{digits}` is no finite number");
    let has_point = digits.contains(['.', 'e', 'E']);
    Ok(if has_point { digits.to_owned() } else { format!("{digits}.0") })
}

#[pymethods]
impl PyCore {
    /// Reads the text of a TOML file.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let made = || {
            let registry = Registry::shipped();
            Self::build(registry.parse("glint.Core", text))
        };
        made().map_err(wrong)
    }

    /// Reads a TOML file, or takes a device with keys.
    #[new]
    #[pyo3(signature = (path, device, keys))]
    fn new(
        path: Option<PathBuf>,
        device: Option<&str>,
        keys: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        Self::made(path, device, keys).map_err(wrong)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.core.config().name
    }

    #[getter]
    fn device(&self) -> &str {
        self.core.device().name
    }

    /// Returns the core with another function of x in its writable table, with an error below `error` units if it is given.
    fn image(&self, formula: &str, error: Option<f64>) -> PyResult<Self> {
        let made = || -> Result<Self> {
            let config = self.core.opened.image_config(formula, error);
            let config = config.with_context(|| {
                let name = &self.core.config().name;
                format!("`{name}` has no table that can be written (docs/tables.md)")
            })?;
            let core = Core::build(self.core.opened.refitted(config)?)?;
            Ok(Self { core: Arc::new(core) })
        };
        made().map_err(wrong)
    }

    /// Returns the words of the writable table, the raw coefficients of each address; none without such a table.
    fn table(&self) -> Vec<Vec<i64>> {
        words_of(&self.core.design)
    }

    /// Returns the operands: name, fraction bits, integer bits, sign, domain in raw integers, colour, a sentence.
    fn operands<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        operand_facts(py, self.core.contract.as_ref())
    }

    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let outputs = self.core.contract.outputs();
        outputs.iter().map(|output| port(py, &output.name, output.format)).collect()
    }

    /// Returns the operand that says how many results a computation has.
    #[getter]
    fn length(&self) -> Option<&str> {
        self.core.contract.length()
    }

    /// Returns the bound of each output in units of the output's last place, whether the bounds are proved, and the terms of the
    /// bound that is nearest to its limit.
    fn bound<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        bound_facts(py, self.core.contract.as_ref(), self.core.device().proved)
    }

    /// Returns the functions of a unit with their names, in the order of their opcodes.
    fn functions(&self) -> Vec<(String, PyUnitFunction)> {
        let mut functions = Vec::new();
        let contracts = self.core.opened.function_contracts();
        for (opcode, contract) in contracts.into_iter().enumerate() {
            let name = self.core.design.functions[opcode].name.clone();
            let unit = self.core.clone();
            functions.push((name, PyUnitFunction { unit, opcode, contract }));
        }
        functions
    }

    /// Clocks from a start, or a point taken, to its first results, and to the next.
    fn clocks(&self) -> PyResult<(Option<u32>, Option<u32>)> {
        if let Some(pipeline) = &self.core.design.pipeline {
            return Ok((Some(pipeline.stages.len() as u32), Some(pipeline.interval as u32)));
        }
        let timing = self.core.timing().map_err(wrong)?;
        Ok((timing.start_to_valid, timing.start_to_start))
    }

    fn toml(&self) -> String {
        self.core.config().to_toml(&(self.core.device().schema)())
    }

    /// Verilog and memory files by name.
    fn verilog(&self, py: Python<'_>) -> PyResult<BTreeMap<String, String>> {
        let files = py.detach(|| self.core.verilog()).map_err(wrong)?;
        Ok(files.into_iter().collect())
    }

    /// Rows of the schedule: the stages of a pipeline, or the microprogram.
    fn schedule<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let design = &self.core.design;
        let Some(pipeline) = &design.pipeline else {
            let of = |(at, it): (usize, &glint::hdl::netlist::Microinstruction)| {
                let row = PyDict::new(py);
                row.set_item("address", at)?;
                row.set_item("microinstruction", &it.name)?;
                Ok(row)
            };
            return design.control.microprogram.iter().enumerate().map(of).collect();
        };
        let of = |(at, it): (usize, &glint::hdl::netlist::Stage)| {
            let row = PyDict::new(py);
            let computes: Vec<&str> = pipeline.computed(design, at).map(|(name, _)| name).collect();
            row.set_item("stage", at)?;
            row.set_item("microinstructions", &it.microinstructions)?;
            row.set_item("computes", computes)?;
            row.set_item("logic_ns", it.logic_ns)?;
            row.set_item("slack_ns", it.slack_ns)?;
            row.set_item("register_bits", it.register_bits)?;
            Ok(row)
        };
        pipeline.stages.iter().enumerate().map(of).collect()
    }

    /// Returns an estimate of what a family's chip takes, and the clock in MHz.
    fn estimate<'py>(&self, py: Python<'py>, target: &str) -> PyResult<Bound<'py, PyDict>> {
        let named = |it: &&Target| it.family().is_some_and(|it| it.name() == target);
        let target = TARGETS.iter().find(named).ok_or_else(|| {
            let names = glint::target::FAMILIES.map(|it| it.name()).join(", ");
            PyValueError::new_err(format!("there is no target `{target}`; targets: {names}"))
        })?;
        let cost = Cost::new(&self.core.design, *target);
        let it = PyDict::new(py);
        it.set_item("luts", cost.luts.round() as u64)?;
        it.set_item("dsps", cost.dsps)?;
        it.set_item("block_rams", cost.block_rams)?;
        it.set_item("rom_bits", cost.rom_bits)?;
        it.set_item("mhz", cost.mhz)?;
        Ok(it)
    }

    /// Returns the outputs of many points: `what` is `golden`, `exact` or `error`. A column of operands each, in the order of
    /// [`PyCore::operands`]; of values, or of raw integers.
    fn compute<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<OperandColumn<'py>>,
        what: &str,
        raw: bool,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        computed(py, self.core.contract.as_ref(), &columns, what, raw)
    }

    /// As [`PyCore::compute`], by the simulated netlist, or the golden model: raw outputs, result after result. Of a device
    /// that walks lines, all results of a line.
    fn run<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<OperandColumn<'py>>,
        simulated: bool,
        raw: bool,
    ) -> PyResult<Vec<Bound<'py, PyArray1<i64>>>> {
        let contract = self.core.contract.as_ref();
        let operands = arrays::OperandTable::new(contract, &columns, raw)?;
        let length =
            contract.operands().iter().position(|it| Some(it.name.as_str()) == contract.length());
        let count = columns.len();
        let out = py.detach(|| -> Result<Vec<i64>> {
            let mut points = Points::new(count);
            let mut rows = Vec::new();
            operands.rows(0..operands.len(), &mut rows);
            for point in rows.chunks_exact(count) {
                let results = length.map_or(1, |length| point[length].max(0) as usize + 1);
                points.push(point.iter().copied(), results);
            }
            match simulated {
                true => RustHdl::new(&self.core.design, contract)?.compute(&points),
                false => Golden(contract).compute(&points),
            }
        });
        let out = out.map_err(wrong)?;
        let width = contract.outputs().len();
        let column = |at: usize| out.iter().skip(at).step_by(width).copied().collect::<Vec<i64>>();
        Ok((0..width).map(|at| PyArray1::from_vec(py, column(at))).collect())
    }

    /// Golden model against simulation on every clock; the first difference in words.
    fn cosim(&self, py: Python<'_>, points: u64, seed: u64) -> PyResult<Option<String>> {
        let outcome =
            py.detach(|| self.core.lockstep(seed)?.run(points, &|_| ())).map_err(wrong)?;
        Ok(outcome.mismatch.map(|it| it.to_string()))
    }

    /// Returns a picture through the golden model: rows of pixels from the top, red, green and blue.
    fn render<'py>(
        &self,
        py: Python<'py>,
        size: (u32, u32),
        exponent: Option<u32>,
        samples: u32,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let core = &self.core;
        let exponent = exponent.unwrap_or_else(|| render::usual_exponent(core.contract.as_ref()));
        let drawn = || -> Result<Vec<u8>> {
            let settings = Settings {
                size,
                samples,
                view: View { eye: None, target: None, field: render::FIELD },
                material: Material::usual(exponent),
                background: render::BACKGROUND,
                compare: false,
                operands: Vec::new(),
            };
            let objects: Vec<Object> = Scene::built_in(BuiltIn::Sphere, None::<Vector>, false)?;
            let scene = Scene { objects, lights: Light::usual(), relief: None };
            let golden = &mut Golden(core.contract.as_ref());
            let rendered = render::render(core, golden, &scene, &settings, &mut |_| ())?;
            Ok(rendered.picture.pixels.into_iter().flatten().collect())
        };
        let pixels = py.detach(drawn).map_err(wrong)?;
        PyArray1::from_vec(py, pixels).reshape([size.1 as usize, size.0 as usize, 3])
    }
}

impl PyCore {
    fn made(path: Option<PathBuf>, device: Option<&str>, keys: &Bound<'_, PyDict>) -> Result<Self> {
        let registry = Registry::shipped();
        let read = match (path, device) {
            (Some(path), None) if keys.is_empty() => registry.read(&path),
            (None, Some(name)) => {
                let device = registry.device(name);
                let module = device.map_or_else(|| "core".to_owned(), |it| (it.schema)().module());
                let mut text = format!("device = {name:?}\n");
                if !keys.contains("name")? {
                    text += &format!("name = {module:?}\n");
                }
                for (key, value) in keys {
                    text += &format!(
                        "{key} = {}\n",
                        toml(&value).with_context(|| format!("key `{key}`"))?
                    );
                }
                registry.parse("glint.Core", &text)
            }
            _ => bail!(
                "give a TOML file, or device=… with keys: Core(\"core.toml\"), Core(device=\"lyon\")"
            ),
        };
        Self::build(read)
    }

    /// Builds the core of a configuration that was read, or fails with its problems.
    fn build(read: Result<(OpenedConfig, ConfigSource), Problems>) -> Result<Self> {
        let (opened, source) = read?;
        let core = Core::build(opened).map_err(|error| match source.located(error) {
            Ok(problems) => problems.into(),
            Err(error) => error,
        })?;
        Ok(Self { core: Arc::new(core) })
    }
}

#[pymethods]
impl PyUnitFunction {
    /// As [`PyCore::operands`], with the name of the port of each operand.
    fn operands<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let operands = operand_facts(py, self.contract.as_ref())?;
        for (facts, operand) in operands.iter().zip(&self.function().operands) {
            facts.set_item("port", &operand.port)?;
        }
        Ok(operands)
    }

    /// The results by their names in the function, with the names of their ports.
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let mut outputs = Vec::new();
        for result in &self.function().results {
            let facts = port(py, &result.name, result.format)?;
            facts.set_item("port", &result.port)?;
            outputs.push(facts);
        }
        Ok(outputs)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.function().name
    }

    #[getter]
    fn opcode(&self) -> usize {
        self.opcode
    }

    /// As [`PyCore::bound`], by the names of the results.
    fn bound<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let facts = bound_facts(py, self.contract.as_ref(), true)?;
        let outputs = PyDict::new(py);
        let bounds = self.contract.bounds();
        for (result, bound) in self.function().results.iter().zip(&bounds.outputs) {
            outputs.set_item(&result.name, bound.units)?;
        }
        facts.set_item("outputs", outputs)?;
        Ok(facts)
    }

    /// As [`PyCore::compute`].
    fn compute<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<OperandColumn<'py>>,
        what: &str,
        raw: bool,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        computed(py, self.contract.as_ref(), &columns, what, raw)
    }

    /// Computes the raw results by simulation of the unit's netlist.
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<OperandColumn<'py>>,
        raw: bool,
    ) -> PyResult<Vec<Bound<'py, PyArray1<i64>>>> {
        let table = arrays::OperandTable::new(self.contract.as_ref(), &columns, raw)?;
        let results = py.detach(|| self.simulated(&table)).map_err(wrong)?;
        Ok(results.into_iter().map(|column| PyArray1::from_vec(py, column)).collect())
    }
}

impl PyUnitFunction {
    fn function(&self) -> &CoreFunction {
        &self.unit.design.functions[self.opcode]
    }

    /// Returns a column of raw results for each result.
    fn simulated(&self, table: &arrays::OperandTable) -> Result<Vec<Vec<i64>>> {
        let unit = self.unit.contract.as_ref();
        let function = self.function();
        let mut rows = Vec::new();
        table.rows(0..table.len(), &mut rows);
        let mut points = Points::new(unit.operands().len());
        for row in rows.chunks_exact(function.operands.len()) {
            let mut words = vec![0; unit.operands().len()];
            words[0] = self.opcode as i64;
            for ((word, operand), raw) in words[1..].iter_mut().zip(&function.operands).zip(row) {
                *word = operand.format.bits((*raw).into()) as i64;
            }
            points.push(words, 1);
        }
        let words = RustHdl::new(&self.unit.design, unit)?.compute(&points)?;
        let mut columns = Vec::new();
        for (place, result) in function.results.iter().enumerate() {
            let of_result = words.iter().skip(place).step_by(unit.outputs().len());
            let raw = of_result.map(|word| result.format.raw(result.format.bits((*word).into())));
            columns.push(raw.map(|raw| raw as i64).collect());
        }
        Ok(columns)
    }
}

/// Returns the operands of a contract: name, format, domain in raw integers, colour, a sentence.
fn operand_facts<'py>(
    py: Python<'py>,
    contract: &dyn Contract,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let of = |operand: &glint::golden::Operand| {
        let it = port(py, &operand.name, operand.format)?;
        it.set_item("domain", operand.domain)?;
        it.set_item("colour", operand.colour)?;
        it.set_item("doc", &operand.doc)?;
        Ok(it)
    };
    contract.operands().iter().map(of).collect()
}

/// Returns the bound of each output, whether the bounds are proved, and the terms of the bound that is nearest to its limit.
fn bound_facts<'py>(
    py: Python<'py>,
    contract: &dyn Contract,
    proved: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let bounds = contract.bounds();
    let bound = bounds.governing();
    let it = PyDict::new(py);
    let outputs = PyDict::new(py);
    for bound in &bounds.outputs {
        outputs.set_item(&bound.output, bound.units)?;
    }
    it.set_item("outputs", outputs)?;
    it.set_item("proved", proved)?;
    let terms = bound.terms.iter().map(|term| (term.key, term.what, term.units));
    it.set_item("terms", terms.collect::<Vec<_>>())?;
    Ok(it)
}

/// Computes many points as [`PyCore::compute`] states.
fn computed<'py>(
    py: Python<'py>,
    contract: &dyn Contract,
    columns: &[OperandColumn<'py>],
    what: &str,
    raw: bool,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let points = arrays::OperandTable::new(contract, columns, raw)?;
    let computed = py.detach(|| match what {
        "exact" => ResultColumns::exact(contract, &points),
        "error" => ResultColumns::errors(contract, &points),
        _ => ResultColumns::golden(contract, &points, raw),
    });
    Ok(computed.into_arrays(py))
}

/// Returns a dictionary with `name`, `signed`, `width` and `fraction` of a port.
fn port<'py>(
    py: Python<'py>,
    name: &str,
    format: glint::fixed::Format,
) -> PyResult<Bound<'py, PyDict>> {
    let it = PyDict::new(py);
    it.set_item("name", name)?;
    it.set_item("signed", format.signed)?;
    it.set_item("width", format.width())?;
    it.set_item("fraction", format.frac)?;
    Ok(it)
}

/// Returns the name and the one-line summary of each shipped device.
#[pyfunction]
fn devices() -> Vec<(&'static str, &'static str)> {
    Registry::shipped().devices().iter().map(|it| (it.name, it.summary)).collect()
}

/// Runs a command line, the program's name first; its exit code.
#[pyfunction]
fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> Option<u8> {
    let code = py.detach(|| glint::cli::run_with("glint", &Registry::shipped(), arguments));
    (0..=u8::MAX).find(|it| ExitCode::from(*it) == code)
}

#[pymodule]
fn _glint(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<PyCore>()?;
    module.add_class::<PyUnitFunction>()?;
    module.add_function(wrap_pyfunction!(devices, module)?)?;
    module.add_function(wrap_pyfunction!(run_command, module)?)
}
