//! Generates the host's part of a device that computes a line of points, in C and in Python.
//!
//! The host starts such a device once for a whole line. The generated functions compute the operands of the line from the
//! vectors or angles at its two ends. The functions use the formulas of `render::setup`, and tests compare the results. A
//! device with other operands has no such functions.

use anyhow::Result;
use glint_base::fill;

use super::model::CField;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_base::fixed::exp2;
use glint_rtl::netlist::Role;
use glint_rtl::verilog::text::constant_name;

/// The device must have all of these operands; only `exponent` may be missing.
const KNOWN: [&str; 5] = ["delta_zeta", "zeta_start", "exponent", "length", "amplitude"];

struct LineSetup<'a> {
    name: &'a str,
    prefix: String,
    regenerate: &'a str,
    /// `zeta_start` and `delta_zeta`.
    angles: Vec<CField>,
    /// The domain of `exponent`. Without this operand, the functions multiply the angles by √(n/2).
    exponent: Option<(i64, i64)>,
    longest: i64,
    /// The largest amplitude, which full light has, as a real number. `amplitude_scale` is 2^F for the F fraction bits of its
    /// format.
    full: f64,
    amplitude_scale: String,
    /// The largest absolute value of an angle along the line, in right angles, after its multiplication by √(n/2) for a device
    /// without exponent. This limit leaves one right angle of the format for rounding errors that add up along the line.
    room: f64,
    order: Vec<String>,
}

impl LineSetup<'_> {
    /// Returns the number of raw values of an angle's format, which cover a full turn.
    fn turn(&self, angle: &CField) -> String {
        exp2(angle.format.width() as i32).to_string()
    }
}

/// Adds the C and Python functions. Adds nothing if the device computes no lines, or if it has other operands than [`KNOWN`].
///
/// # Errors
/// Fails if a template fails.
pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let (name, inputs) = (job.name(), job.inputs);
    let design = inputs.sequential.as_ref().unwrap_or(job.design);
    let ports = design.inputs().filter(|port| matches!(port.role, Role::Operand { .. }));
    let fields: Vec<CField> = ports.map(|port| CField::new(design, port)).collect();
    let accuracy = inputs.accuracy.as_ref().filter(|accuracy| accuracy.length.is_some());
    let Some(accuracy) = accuracy else {
        return Ok(());
    };
    let field = |name: &str| fields.iter().find(|field| field.name == name);
    let domain = |name: &str| {
        let mut domains = accuracy.domain.iter();
        domains.find(|(operand, _)| operand == name).map(|(_, domain)| *domain)
    };
    let known = fields.iter().all(|field| KNOWN.contains(&field.name.as_str()));
    let all = [field("zeta_start"), field("delta_zeta"), field("amplitude")];
    let ([Some(start), Some(delta), Some(amplitude)], Some((_, longest)), Some((_, full)), true) =
        (all, domain("length"), domain("amplitude"), known)
    else {
        return Ok(());
    };
    let line = &LineSetup {
        name,
        prefix: constant_name(name),
        regenerate: job.regenerate(),
        angles: vec![start.clone(), delta.clone()],
        exponent: domain("exponent"),
        longest,
        full: amplitude.format.to_f64(i128::from(full)),
        amplitude_scale: amplitude.scale(),
        room: exp2(start.format.int) - 1.0,
        order: fields.iter().map(|field| field.name.clone()).collect(),
    };
    for (ending, text) in [
        ("h", fill!("setup.h" { line: &'a LineSetup<'a> })?),
        ("c", fill!("setup.c" { line: &'a LineSetup<'a> })?),
        ("py", fill!("setup.py" { line: &'a LineSetup<'a> })?),
    ] {
        files.add(FileKind::Software, format!("{name}_setup.{ending}"), text);
    }
    Ok(())
}
