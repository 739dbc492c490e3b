//! Generates `<name>_litex.py`, the core as a Python module for the SoC builder LiteX.
//!
//! The file has up to three LiteX modules, and the user takes one of them. For a core `highlight` they are:
//!
//! - `HighlightCore`, with a CSR (a register that LiteX manages) for each operand and each result. A pipeline and a core that
//!   computes lines do not have this class.
//! - `HighlightStream`, with a sink for operands and a source for results, if the configuration asks for a stream.
//! - `HighlightRegisters`, a slave on a bus with the core's own registers, if the configuration asks for registers.

use anyhow::{Result, bail};
use glint_base::fill;

use crate::package::bus::Bus;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use crate::package::tops::{Face, Top, TopPort};
use glint_base::config_error::ConfigError;
use glint_rtl::netlist::{Design, Role};
use glint_rtl::verilog::text::ascii;

/// A core that computes one point after each `start`, with the ports that CSRs drive and read.
struct LitexCore<'a> {
    top: &'a Top,
    operands: Vec<LitexOperand>,
    results: Vec<LitexResult>,
    /// Other inputs, which stay low.
    idle: Vec<&'a TopPort>,
}

struct LitexResult {
    name: String,
    width: u32,
    /// The number of bits of the status register: a result with a sign is extended to 32 or 64 bits.
    status_width: u32,
}

struct LitexOperand {
    name: String,
    strobe: String,
    width: u32,
}

impl LitexResult {
    fn is_extended(&self) -> bool {
        self.status_width > self.width
    }
}

/// Widths are in bits.
struct LitexStream<'a> {
    top: &'a Top,
    input: u32,
    output: u32,
    user: u32,
    /// Whether the input stream has `tlast` too.
    last: bool,
}

/// Fails if the core is a pipeline or computes lines of points, and the configuration does not ask for a stream.
pub fn file(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    let (name, design, is_line) = (job.name(), job.design, job.is_line());
    let stream = tops.iter().find(|top| top.face == Face::Stream).map(streamed);
    let core = if is_line || design.pipeline.is_some() {
        None
    } else {
        tops.iter().find(|top| top.face == Face::Core).map(|top| driven(design, top))
    };
    if core.is_none() && stream.is_none() {
        let what = if is_line { "computes lines" } else { "is a pipeline" };
        bail!(ConfigError::new(
            "package.litex",
            format!(
                "`{name}` {what}, and registers of LiteX cannot drive such a core: the LiteX module needs a \
                 stream"
            ),
            "set interface.stream = true, or remove package.litex",
        ));
    }
    let registers = tops.iter().find_map(|top| match top.face {
        Face::Registers(bus) => Some((top, bus)),
        Face::Core | Face::Stream | Face::Processor(_) => None,
    });
    let text = fill!("litex.py" {
        name: &'a str,
        title: String = ascii(&design.about.title).replace('\\', "/").replace('"', "'"),
        regenerate: &'a str = job.regenerate(),
        // The names of the classes begin with it.
        class: String = camel(name),
        core: Option<LitexCore<'a>>,
        stream: Option<LitexStream<'a>>,
        registers: Option<(&'a Top, &'a Bus)>,
    })?;
    files.add(FileKind::Software, format!("{name}_litex.py"), text);
    Ok(())
}

fn driven<'a>(design: &Design, top: &'a Top) -> LitexCore<'a> {
    let name = |port: &glint_rtl::netlist::Port| design.net(port.net).name.clone();
    let (mut operands, mut result_ports, mut start_names) = (Vec::new(), Vec::new(), Vec::new());
    for port in &design.ports {
        match port.role {
            Role::Operand { strobe } => operands.push(LitexOperand {
                name: name(port),
                strobe: design.net(strobe).name.clone(),
                width: design.width(port.net),
            }),
            Role::Result => result_ports.push(port),
            Role::Start => start_names.push(name(port)),
            _ => {}
        }
    }
    let mut results = Vec::new();
    for port in result_ports {
        let width = design.width(port.net);
        let status_width = match design.net(port.net).format.signed {
            true if width <= 32 => 32,
            true => 64,
            false => width,
        };
        results.push(LitexResult { name: name(port), width, status_width });
    }
    let mut idle = Vec::new();
    for port in top.signals() {
        let driven = operands.iter().any(|it| it.name == port.name || it.strobe == port.name);
        if port.input && !driven && !start_names.contains(&port.name) {
            idle.push(port);
        }
    }
    LitexCore { top, operands, results, idle }
}

fn streamed(top: &Top) -> LitexStream<'_> {
    LitexStream {
        top,
        input: top.width("s_axis_tdata"),
        output: top.width("m_axis_tdata"),
        user: top.width("m_axis_tuser"),
        last: top.width("s_axis_tlast") > 0,
    }
}

/// Makes the name of a Python class: `cosine_power` gives `CosinePower`, and `_1` gives `Core1`.
fn camel(name: &str) -> String {
    let mut joined = String::new();
    for part in name.split('_') {
        let mut letters = part.chars();
        if let Some(first) = letters.next() {
            joined.push(first.to_ascii_uppercase());
            joined += letters.as_str();
        }
    }
    if joined.starts_with(|first: char| first.is_ascii_alphabetic()) {
        joined
    } else {
        format!("Core{joined}")
    }
}

#[cfg(test)]
mod tests {
    use super::camel;

    #[test]
    fn names_become_classes() {
        for (name, class) in [
            ("cosine_power", "CosinePower"),
            ("__x", "X"),
            ("_1", "Core1"),
            ("_", "Core"),
            ("rGB", "RGB"),
        ] {
            assert_eq!(camel(name), class);
        }
    }
}
