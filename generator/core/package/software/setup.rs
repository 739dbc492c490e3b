//! Generates the host's part of a device that computes a line of points, in C and in Python.
//!
//! The host starts such a device once for a whole line. A device with other operands than these formulas give has no such
//! functions. The generated functions compute the operands of a line from the vectors or angles at its two ends. The functions
//! use the same formulas as `render::setup`, and tests compare the results.

use anyhow::Result;
use glint_base::fill;

use super::model::CField;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use glint_base::fixed::exp2;
use glint_rtl::netlist::Role;
use glint_rtl::verilog::text::constant_name;

/// The operands that the generated functions can compute. The device must have all of them; only `exponent` may be missing.
const KNOWN: [&str; 5] = ["delta_zeta", "zeta_start", "exponent", "length", "amplitude"];

/// The data for the templates of the three files.
struct LineSetup<'a> {
    name: &'a str,
    prefix: String,
    regenerate: &'a str,
    /// `zeta_start` and `delta_zeta`.
    angles: Vec<CField>,
    /// The domain of the operand `exponent`. Without this operand, the functions multiply the angles by √(n/2).
    exponent: Option<(i64, i64)>,
    /// The largest number of intervals of a line.
    longest: i64,
    /// The largest amplitude, which full light has, as a real number. `amplitude_scale` is 2^F for the F fraction bits of
    /// the amplitude's format.
    full: f64,
    amplitude_scale: String,
    /// The largest absolute value that an angle along the line may have, in right angles, after its multiplication by √(n/2) for
    /// a device without exponent. The limit leaves one right angle of the format for rounding errors that add up along the line.
    room: f64,
    order: Vec<String>,
}

impl LineSetup<'_> {
    /// Returns the number of raw values of an angle's format as a C literal, 2^width. These values cover a full turn.
    fn turn(&self, angle: &CField) -> String {
        exp2(angle.format.width() as i32).to_string()
    }
}

/// Adds the C and Python functions that compute the operands of a line. Adds nothing if the device computes no line of points, or
/// if it has other operands than the formulas give.
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
