//! What is proved of the emitted Verilog itself, by k-induction.
//!
//! Both units carry the invariants that a proof stands on, in a section for formal tools alone. A wrapper
//! states what the manifest promises of the handshake, and a Yosys script makes the problem for
//! `yosys-smtbmc`: products and the datapath's ROMs are cut out, since no property depends on them.

use anyhow::Result;
use askama::Template;

use super::Timing;
use super::naming::Naming;
use super::rows::{Row, separated};
use super::text::{Names, literal, range};
use crate::netlist::{Design, RegisterKind, Sequence, Unit};

#[derive(Template)]
#[template(path = "formal.sv")]
struct Wrapper {
    name: String,
    module: String,
    depth: u32,
    /// The solver, as the command line of yosys-smtbmc has it.
    solver: &'static str,
    instance: String,
    age: String,
    age_range: String,
    age_one: String,
    /// Ports with their commas.
    ports: Vec<String>,
    outputs: Vec<String>,
    connections: Vec<String>,
    /// The program never waits for a second `start`: busy from start to done.
    straight: bool,
    exact: Option<Exact>,
}

/// When the events come, where that does not depend on the data.
struct Exact {
    valid: String,
    done: String,
    last: String,
}

#[derive(Template)]
#[template(path = "formal.ys")]
struct Script {
    name: String,
    instance: String,
    datapath: String,
    rtl: Vec<String>,
}

/// The lines of a unit's section for formal tools.
pub fn invariants(design: &Design, naming: &Naming, unit: Unit) -> Vec<String> {
    let mut names = naming.names.clone();
    let lines = match unit {
        Unit::Control => control(design),
        Unit::Datapath => datapath(design, &names.fresh("was_busy")),
    };
    lines
        .into_iter()
        .map(|line| format!("    {line}"))
        .collect()
}

/// From the first clock on, which has the initial set.
fn control(design: &Design) -> Vec<String> {
    let name = |register| design.net(design.register(register).q).name.as_str();
    let (address, run) = (name(design.control.address), name(design.control.run));
    let width = design.width(design.register(design.control.address).q);
    let last = literal(design.control.words.len() as u64 - 1, width);
    vec![
        "always @* if (!$initstate) begin".to_owned(),
        format!("    assert ({address} <= {last});  // no other word is reached"),
        format!(
            "    if (!{run}) assert ({address} == {});",
            literal(0, width)
        ),
        "end".to_owned(),
    ]
}

/// Operands are stable while the device is busy.
fn datapath(design: &Design, was_busy: &str) -> Vec<String> {
    let operands: Vec<&str> = design
        .registers
        .iter()
        .filter(|register| register.kind == RegisterKind::Operand)
        .map(|register| design.net(register.q).name.as_str())
        .collect();
    if operands.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![
        format!("reg {was_busy} = 1'b0;"),
        "always @(posedge clk) begin".to_owned(),
        format!("    {was_busy} <= !idle;"),
        format!("    if ({was_busy}) begin"),
    ];
    for operand in operands {
        lines.push(format!("        assert ({operand} == $past({operand}));"));
    }
    lines.extend(["    end".to_owned(), "end".to_owned()]);
    lines
}

/// Wrapper and script, as names and texts.
///
/// # Errors
/// A template that fails.
pub fn files(
    design: &Design,
    naming: &Naming,
    timing: &Timing,
    rtl: &[String],
) -> Result<Vec<(String, String)>> {
    let module = &design.name;
    let name = format!("{module}_formal");
    let mut names = Names::new(
        design
            .ports
            .iter()
            .map(|port| design.net(port.net).name.as_str()),
    );
    names.fresh("clk");
    let instance = names.fresh("dut");
    let exact = exact(timing);
    // An induction that is longer than a computation has seen its start.
    let depth = exact.as_ref().map_or(4, |(_, start)| start + 2);
    let age_width = exact
        .as_ref()
        .map_or(1, |(_, start)| u32::BITS - start.leading_zeros());
    let port_name = |net| design.net(net).name.clone();
    let mut ports = vec!["input  wire clk".to_owned()];
    for port in design.inputs() {
        let range = range(design.width(port.net));
        let space = if range.is_empty() { "" } else { " " };
        ports.push(format!("input  wire {range}{space}{}", port_name(port.net)));
    }
    let outputs: Vec<_> = design
        .outputs()
        .map(|port| {
            Row::port(
                "",
                "wire",
                design.width(port.net),
                false,
                &port_name(port.net),
                "",
            )
        })
        .collect();
    let connections = std::iter::once("clk".to_owned())
        .chain(design.ports.iter().map(|port| port_name(port.net)))
        .map(|name| format!(".{name}({name})"))
        .collect();
    let waits = design
        .control
        .words
        .iter()
        .any(|word| word.sequence == Sequence::WaitStart);
    let wrapper = Wrapper {
        name: name.clone(),
        module: module.clone(),
        depth,
        // A few steps with much state between them z3 solves at once when they are unrolled; many it
        // solves faster when they are not.
        solver: match exact {
            Some(_) => "-s z3",
            None => "--unroll -s z3",
        },
        instance: instance.clone(),
        age: names.fresh("age"),
        age_range: range(age_width),
        age_one: literal(1, age_width),
        ports: separated(ports),
        outputs: Row::declarations(&outputs),
        connections: separated(connections),
        straight: !waits,
        exact: exact.map(|(clocks, start)| Exact {
            valid: literal(u64::from(clocks[0]), age_width),
            done: literal(u64::from(clocks[1]), age_width),
            last: literal(u64::from(start) - 1, age_width),
        }),
    };
    let script = Script {
        name: name.clone(),
        instance,
        datapath: naming.instance(Unit::Datapath).to_owned(),
        rtl: rtl.to_vec(),
    };
    Ok(vec![
        (format!("{name}.sv"), super::render(&wrapper)?),
        (format!("{name}.ys"), super::render(&script)?),
    ])
}

/// The clocks of `valid` and `done`, and that of the next start, where all are known, and the result is
/// there in one clock.
fn exact(timing: &Timing) -> Option<([u32; 2], u32)> {
    let (valid, done) = (timing.start_to_valid?, timing.start_to_done?);
    Some(([valid, done], timing.start_to_start?))
}
