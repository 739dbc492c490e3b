//! Converts the columns of operands that Python passes, as values or as raw integers, and the columns of results that it gets
//! back.

use std::ops::Range;
use std::slice::ChunksExact;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

use glint::fixed::Format;
use glint::golden::{ANY_VALUE, Contract, nearer};

/// Points that one thread computes at a time.
const PIECE: usize = 1 << 12;

/// An operand column that Python passes: one number for all points, or an array with one number for each point.
///
/// Arrays are tried first: before NumPy 2.4, an array of one integer is an integer to Python as well.
#[derive(FromPyObject)]
pub enum OperandColumn<'py> {
    Integers(PyReadonlyArray1<'py, i64>),
    Values(PyReadonlyArray1<'py, f64>),
    Integer(i64),
    Value(f64),
}

/// The raw operands of many points, converted from Python.
pub struct OperandTable<'a> {
    columns: Vec<RawColumn<'a>>,
    points: usize,
}

/// A column.
enum RawColumn<'a> {
    All(i64),
    Integers(&'a [i64]),
    /// Values that are rounded to the format as they are read.
    Values(&'a [f64], Format),
}

impl<'a> OperandTable<'a> {
    /// Converts the columns from Python, one for each operand of the contract. `raw` says whether they are raw integers; otherwise
    /// they are values.
    ///
    /// # Errors
    /// Fails if columns have different lengths, or if the format of an operand cannot represent a number.
    pub fn new(
        contract: &dyn Contract,
        columns: &'a [OperandColumn<'_>],
        raw: bool,
    ) -> PyResult<Self> {
        let mut points = None;
        let mut taken = Vec::new();
        for (operand, column) in contract.operands().iter().zip(columns) {
            let format = operand.format;
            let refused = |at: Option<usize>, number: String| {
                let place = at.map_or_else(String::new, |at| format!(" at [{at}]"));
                let (low, high) = (format.min_raw(), format.max_raw());
                let limits = match raw {
                    true => format!("raw integers from {low} to {high}"),
                    false => format!("{} to {}", format.to_f64(low), format.to_f64(high)),
                };
                let name = &operand.name;
                PyValueError::new_err(format!(
                    "`{name}`{place} is {number}, and {format} has {limits}"
                ))
            };
            let limits = [format.min_raw(), format.max_raw()];
            // Of 64 bits without a sign, what an array of integers can hold.
            let [first, last] = limits.map(|it| it.clamp(i64::MIN.into(), i64::MAX.into()) as i64);
            let holds = |integer: i64| (first..=last).contains(&integer);
            let near = |value: f64| format.nearest_raw(value).is_some();
            let column = match column {
                OperandColumn::Integer(it) if raw && holds(*it) => RawColumn::All(*it),
                OperandColumn::Integer(it) if !raw && near(*it as f64) => {
                    RawColumn::All(format.quantise(*it as f64) as i64)
                }
                OperandColumn::Integer(it) => return Err(refused(None, it.to_string())),
                OperandColumn::Value(it) if !raw && near(*it) => {
                    RawColumn::All(format.quantise(*it) as i64)
                }
                OperandColumn::Value(it) => return Err(refused(None, it.to_string())),
                OperandColumn::Integers(array) if raw => {
                    let all = array.as_slice()?;
                    if !all.iter().fold(true, |all, it| all & holds(*it))
                        && let Some(at) = all.iter().position(|it| !holds(*it))
                    {
                        return Err(refused(Some(at), all[at].to_string()));
                    }
                    RawColumn::Integers(all)
                }
                OperandColumn::Values(array) if !raw => {
                    let all = array.as_slice()?;
                    if !all.iter().fold(true, |all, it| all & near(*it))
                        && let Some(at) = all.iter().position(|it| !near(*it))
                    {
                        return Err(refused(Some(at), all[at].to_string()));
                    }
                    RawColumn::Values(all, format)
                }
                _ => {
                    let wanted = if raw { "int64" } else { "float64" };
                    let message = format!("`{}`: an array of {wanted} is wanted", operand.name);
                    return Err(PyValueError::new_err(message));
                }
            };
            let count = match column {
                RawColumn::All(_) => None,
                RawColumn::Integers(all) => Some(all.len()),
                RawColumn::Values(all, _) => Some(all.len()),
            };
            if let (Some(count), Some(before)) = (count, points)
                && count != before
            {
                return Err(PyValueError::new_err(format!(
                    "`{}` has {count} numbers, an operand before it {before}",
                    operand.name
                )));
            }
            points = points.or(count);
            taken.push(column);
        }
        Ok(Self { columns: taken, points: points.unwrap_or(1) })
    }

    /// Returns the number of points in the table.
    pub fn len(&self) -> usize {
        self.points
    }

    /// Fills `rows` with the raw operands of some points, point after point.
    pub fn rows(&self, points: Range<usize>, rows: &mut Vec<i64>) {
        let width = self.columns.len();
        rows.resize(points.len() * width, 0);
        for (at, column) in self.columns.iter().enumerate() {
            let into = rows.iter_mut().skip(at).step_by(width);
            match column {
                RawColumn::All(it) => into.for_each(|raw| *raw = *it),
                RawColumn::Integers(all) => {
                    into.zip(&all[points.clone()]).for_each(|(raw, it)| *raw = *it);
                }
                RawColumn::Values(all, format) => {
                    let values = into.zip(&all[points.clone()]);
                    let (scale, most) = (1.0 / format.to_f64(1), format.max_raw() as i64);
                    values.for_each(|(raw, value)| *raw = nearest(value * scale).min(most));
                }
            }
        }
    }
}

/// The results of many points, a column for each output.
pub enum ResultColumns {
    Integers(Vec<Vec<i64>>),
    Values(Vec<Vec<f64>>),
}

impl ResultColumns {
    /// Computes the results of all points with the golden model. `raw` asks for raw integers; otherwise the results are values.
    pub fn golden(contract: &dyn Contract, operands: &OperandTable, raw: bool) -> Self {
        let results = |points: ChunksExact<i64>, out: &mut Vec<i64>| {
            points.for_each(|point| contract.results(point, 0, out));
        };
        if raw {
            return Self::Integers(each(contract, operands, results));
        }
        let units = units(contract);
        Self::Values(each(contract, operands, |points, out| {
            let mut raw = Vec::with_capacity(points.len() * units.len());
            results(points, &mut raw);
            out.extend(raw.iter().zip(units.iter().cycle()).map(|(&raw, unit)| raw as f64 * unit));
        }))
    }

    /// Computes the exact results of all points with the formula, also where the contract promises nothing. NaN denotes a formula
    /// without a value.
    pub fn exact(contract: &dyn Contract, operands: &OperandTable) -> Self {
        Self::Values(each(contract, operands, |points, out| {
            for point in points {
                contract.formula_values(point, 0, out);
            }
        }))
    }

    /// Computes the distances of the golden model's results from the formula, in units of the last bit of each output.
    /// NaN denotes an output for which the contract promises nothing.
    pub fn errors(contract: &dyn Contract, operands: &OperandTable) -> Self {
        let units = units(contract);
        Self::Values(each(contract, operands, |points, out| {
            let (mut raw, mut exact) = (Vec::new(), Vec::new());
            for point in points {
                raw.clear();
                exact.clear();
                contract.results(point, 0, &mut raw);
                contract.exact(point, 0, &mut exact);
                let all = raw.iter().zip(&exact).zip(&units);
                out.extend(all.map(|((&raw, exact), unit)| match *exact {
                    ANY_VALUE => f64::NAN,
                    sides => nearer(raw as f64, sides.map(|it| it / unit)),
                }));
            }
        }))
    }

    /// Converts each column to a NumPy array.
    pub fn into_arrays(self, py: Python<'_>) -> Vec<Bound<'_, PyAny>> {
        match self {
            Self::Integers(all) => {
                all.into_iter().map(|it| PyArray1::from_vec(py, it).into_any()).collect()
            }
            Self::Values(all) => {
                all.into_iter().map(|it| PyArray1::from_vec(py, it).into_any()).collect()
            }
        }
    }
}

/// Returns the nearest integer, ties upward, as [`Format::quantise`] does; without a call of `floor`, which processors without
/// SSE4.1 need.
#[inline]
fn nearest(value: f64) -> i64 {
    let towards_zero = value as i64;
    let rest = value - towards_zero as f64;
    towards_zero + i64::from(rest >= 0.5) - i64::from(rest < -0.5)
}

/// Returns the values of the last places of the outputs.
fn units(contract: &dyn Contract) -> Vec<f64> {
    contract.outputs().iter().map(|it| it.format.to_f64(1)).collect()
}

/// Returns a column for each output of what `of` appends for points: a number for each output, point after point.
fn each<T: Copy + Default + Send>(
    contract: &dyn Contract,
    operands: &OperandTable,
    of: impl Fn(ChunksExact<i64>, &mut Vec<T>) + Sync,
) -> Vec<Vec<T>> {
    let (inputs, width) = (operands.columns.len(), contract.outputs().len());
    // Each has memory that is not yet touched, which a copy of another would touch.
    let mut columns: Vec<Vec<T>> =
        (0..width).map(|_| vec![T::default(); operands.points]).collect();
    // The same piece of every column.
    let mut pieces: Vec<Vec<&mut [T]>> = Vec::new();
    for column in &mut columns {
        for (at, piece) in column.chunks_mut(PIECE).enumerate() {
            match pieces.get_mut(at) {
                Some(columns) => columns.push(piece),
                None => pieces.push(vec![piece]),
            }
        }
    }
    let buffers = || (Vec::new(), Vec::new());
    pieces.into_par_iter().enumerate().for_each_init(buffers, |(rows, made), (at, columns)| {
        let count = columns.first().map_or(0, |it| it.len());
        operands.rows(at * PIECE..at * PIECE + count, rows);
        made.clear();
        of(rows.chunks_exact(inputs), made);
        for (output, column) in columns.into_iter().enumerate() {
            let made = made.iter().skip(output).step_by(width);
            column.iter_mut().zip(made).for_each(|(into, made)| *into = *made);
        }
    });
    columns
}
