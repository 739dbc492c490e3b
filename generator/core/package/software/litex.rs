//! Generates `<name>_litex.py`, the core as a Python module for the SoC builder LiteX.
//!
//! The LiteX module connects the core by CSRs, by its two streams, or by its own registers on a bus.

use anyhow::{Result, bail};
use glint_base::fill;

use crate::package::bus::Bus;
use crate::package::emit_job::EmitJob;
use crate::package::file_kind::FileKind;
use crate::package::output_files::OutputFiles;
use crate::package::tops::{Face, Top, TopPort};
use glint_base::key_error::KeyError;
use glint_rtl::netlist::{Design, Role};
use glint_rtl::verilog::text::ascii;

/// A core that CSRs can drive: one computation of operands to results.
struct LitexCore<'a> {
    top: &'a Top,
    operands: Vec<LitexOperand>,
    results: Vec<&'a TopPort>,
    /// Other inputs, which stay low.
    idle: Vec<&'a TopPort>,
}

struct LitexOperand {
    name: String,
    strobe: String,
    width: u32,
}

/// A core between streams.
struct LitexStream<'a> {
    top: &'a Top,
    input: u32,
    output: u32,
    user: u32,
    /// `tlast` goes in, too.
    last: bool,
}

/// Adds the LiteX module of a core.
///
/// # Errors
/// Fails if CSRs cannot drive the core and it has no stream.
pub fn file(job: &EmitJob, tops: &[Top], files: &mut OutputFiles) -> Result<()> {
    let (name, design, is_line) = (job.name(), job.design, job.is_line());
    let find = |face: fn(Face) -> bool| tops.iter().find(|top| face(top.face));
    let stream = find(|face| face == Face::Stream).map(streamed);
    let core = if is_line || design.pipeline.is_some() {
        None
    } else {
        find(|face| face == Face::Core).map(|top| driven(design, top))
    };
    if core.is_none() && stream.is_none() {
        let what = if is_line { "walks lines" } else { "is a pipeline" };
        bail!(KeyError::new(
            "package.litex",
            format!(
                "`{name}` {what}, which registers of LiteX cannot drive: its module needs a stream"
            ),
            "set interface.stream = true, or remove it",
        ));
    }
    let registers = tops.iter().find_map(|top| match top.face {
        Face::Registers(bus) => Some((top, bus)),
        Face::Core | Face::Stream => None,
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
    let operands: Vec<LitexOperand> = design
        .inputs()
        .filter_map(|port| match port.role {
            Role::Operand { strobe } => Some(LitexOperand {
                name: name(port),
                strobe: design.net(strobe).name.clone(),
                width: design.width(port.net),
            }),
            _ => None,
        })
        .collect();
    let of_role = |role: Role| -> Vec<String> {
        design.ports.iter().filter(|port| port.role == role).map(name).collect()
    };
    let (results, start) = (of_role(Role::Result), of_role(Role::Start));
    let known = |port: &&TopPort| {
        let driven = operands.iter().any(|it| it.name == port.name || it.strobe == port.name);
        port.input && !driven && !start.contains(&port.name)
    };
    let idle = top.signals().filter(known).collect();
    let results = top.signals().filter(|port| results.contains(&port.name)).collect();
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

/// Returns the name of a class of Python, whatever the name: `CosinePower` for `cosine_power`.
fn camel(name: &str) -> String {
    let part = |part: &str| {
        let mut letters = part.chars();
        letters.next().map_or_else(String::new, |first| {
            first.to_ascii_uppercase().to_string() + letters.as_str()
        })
    };
    let joined: String = name.split('_').map(part).collect();
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
