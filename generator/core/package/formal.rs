//! Generates formal properties of a sequential core, which Yosys and an SMT solver prove by k-induction.
//!
//! The generated wrapper asserts the handshake that the manifest promises, for example the clock in which `done` is high. The
//! emitted Verilog of the core has the invariants that the proof needs, in a section that only formal tools read. A Yosys script
//! prepares the problem for `yosys-smtbmc`. The script replaces multipliers and ROMs of the datapath by free values, since no
//! property depends on them.

use anyhow::Result;
use glint_base::fill;

use super::emit_job::EmitJob;
use super::file_kind::FileKind;
use super::output_files::OutputFiles;
use crate::observation::Computation;
use glint_rtl::netlist::HandshakeTiming;
use glint_rtl::netlist::termination::{self, Left};
use glint_rtl::netlist::{Design, Driver, NetId, Op, Partition, RegId, Role, Sequence, TABLE_LOAD};
use glint_rtl::verilog::naming::Naming;
use glint_rtl::verilog::rows::{Row, connections, separated};
use glint_rtl::verilog::text::{Names, literal, range};

/// The smallest depth of the induction, in clocks, for a core whose number of clocks depends on the data.
const UNROLLED: u32 = 8;

/// The register of the wrapper that counts the clocks since `start`.
struct Age {
    name: String,
    width: u32,
}

impl Age {
    fn literal(&self, clocks: u32) -> String {
        literal(u64::from(clocks), self.width)
    }
}

struct AgeView {
    name: String,
    range: String,
    one: String,
}

/// The clocks in which `valid` and `done` are high, counted from `start`, and the largest age of a computation, as Verilog
/// literals. Only a core whose clocks do not depend on the data has them.
struct EventClocks {
    valid: String,
    done: String,
    last: String,
}

/// The data for the proof that every computation ends in time, for a core whose clocks depend on the data.
struct Bounded {
    /// The Verilog declarations that make inner nets of the core visible to the proof.
    inside: Vec<String>,
    address: String,
    most: String,
    latest: Vec<Latest>,
    /// Whether `valid` is high in the clock of `done` of every computation.
    ends_with_result: bool,
    /// The clock of the first result as a Verilog literal, if `valid` is high from then on in every clock to `done`.
    first: Option<String>,
}

/// An upper limit of the age at which a computation ends, while one microinstruction is executed. `label` is its address as a
/// Verilog literal.
struct Latest {
    label: String,
    /// The latest age at which the computation ends, as a Verilog expression. For example, the age plus a counter plus 3
    /// clocks.
    end: String,
}

/// The parameters of the Yosys commands that prepare a proof, for `yosys-smtbmc` or for SymbiYosys.
pub(super) struct Script<'a> {
    pub(super) name: &'a str,
    /// The cells whose ROMs the proof replaces by free values, as a selection of Yosys.
    pub(super) within: &'a str,
    /// Whether the registers of the core have initial values in the proof.
    pub(super) initial: bool,
}

impl Script<'_> {
    /// Adds the Verilog `wrapper`, the script for Yosys, and the task for SymbiYosys. `depth` is the depth of the induction in
    /// clocks.
    pub(super) fn files(
        &self,
        wrapper: String,
        depth: u32,
        engine: &str,
        files: &mut OutputFiles,
    ) -> Result<()> {
        let Self { name, within, initial } = *self;
        let rtl = files.local_paths(&[FileKind::CoreVerilog]);
        let memories = files.local_paths(&[FileKind::Memory]);
        let script = fill!("formal.ys" {
            name: &'a str, within: &'a str, rtl: &'a [String] = &rtl, initial: bool,
        })?;
        let task = fill!("formal.sby" {
            name: &'a str, within: &'a str, depth: u32, engine: &'a str, rtl: Vec<String>, memories: Vec<String>,
        })?;
        files.add_system_verilog(FileKind::CoreProof, vec![name.to_owned()], wrapper);
        files.add(FileKind::CoreProofScript, format!("{name}.ys"), script);
        files.add(FileKind::CoreProofScript, format!("{name}.sby"), task);
        Ok(())
    }
}

/// Returns the number of registers between the signal that sets `valid` and the port `valid`, or 0 without `valid`.
fn valid_delay(design: &Design) -> u32 {
    let Some(valid) = design.port(|role| role == Role::Valid) else { return 0 };
    let mut at = valid.net;
    let mut clocks = 0;
    for _ in &design.nets {
        at = match design.net(at).driver {
            Driver::Op(Op::Relabel(of)) => of,
            Driver::Register(id) => {
                clocks += 1;
                design.register(id).data.unwrap_or(at)
            }
            _ => break,
        };
    }
    clocks
}

pub fn files(job: &EmitJob, files: &mut OutputFiles) -> Result<()> {
    let EmitJob { design, inputs, naming, .. } = *job;
    let (timing, module) = (&inputs.timing, job.name());
    let name = format!("{module}_formal");
    let mut names = Names::of_ports(design);
    let instance = names.fresh("dut");
    let exact_clocks = exact(timing);
    let remaining = match exact_clocks {
        Some(_) => None,
        None => termination::remaining(design).zip(termination::latest_done(design)),
    };
    let depth = match &exact_clocks {
        // An induction that is longer than a computation includes the computation's start.
        Some((_, start)) => start + 2,
        // The induction must be longer than the row of registers before `valid`, so that it knows their outputs.
        None => UNROLLED.max(valid_delay(design) + 3),
    };
    let largest_age = match (&exact_clocks, &remaining) {
        (Some((_, start)), _) => Some(*start),
        // The remaining clocks are added to the age.
        (None, Some((_, most))) => Some(2 * most),
        (None, None) => None,
    };
    let age = largest_age.map(|largest| Age {
        name: names.fresh("age"),
        width: u32::BITS - largest.leading_zeros(),
    });
    let waits = design.control.microprogram.iter().any(|it| it.sequence == Sequence::WaitStart);
    // z3 proves a long induction faster without unrolled steps. With them, it is faster for a short induction over much state.
    // It is also faster for a device that accepts `start` in the last clock of a computation.
    let unroll = exact_clocks.is_none() || design.control.overlaps;
    let exact = exact_clocks.zip(age.as_ref()).map(|((clocks, start), age)| EventClocks {
        valid: age.literal(clocks[0]),
        done: age.literal(clocks[1]),
        last: age.literal(start - 1),
    });
    let bounded = remaining.zip(age.as_ref()).map(|((left, most), age)| Bounded {
        // With a distance of 1, every clock from the first result on shows a result.
        first: match timing.valid_to_valid {
            Some(1) => timing.start_to_valid.map(|first| age.literal(first)),
            _ => None,
        },
        ends_with_result: !inputs.computations.is_empty()
            && inputs.computations.iter().all(Computation::ends_with_result),
        ..bounded_view(design, naming, &instance, &mut names, (&left, most), age)
    });
    let within = format!("{instance}.{}.*", naming.instance(Partition::Datapath));
    let unit = naming.instance(Partition::Datapath);
    let table_load = design.find(TABLE_LOAD).map(|_| format!("\\{instance}.{unit}.{TABLE_LOAD} "));
    let wrapper = fill!("formal.sv" {
        name: &'a str = &name,
        module: &'a str,
        depth: u32,
        // The solver, as the command line of yosys-smtbmc has it.
        solver: &'a str = if unroll { "--unroll -s z3" } else { "-s z3" },
        instance: String,
        ports: Vec<String> = separated(inputs_of(design)),
        outputs: Vec<String> = outputs_of(design),
        connections: Vec<String> = connections(design),
        // The path of the net that is 1 while a word of the table is loaded.
        table_load: Option<String>,
        // Whether the microprogram never waits for a second `start`, so that `busy` is high from `start` to `done`.
        straight: bool = !waits,
        // Whether the core also accepts `start` in the clock of `done`.
        overlaps: bool = design.control.overlaps,
        exact: Option<EventClocks>,
        bounded: Option<Bounded>,
        age: Option<AgeView> = age.as_ref().map(|age| AgeView {
            range: range(age.width),
            one: age.literal(1),
            name: age.name.clone(),
        }),
    })?;
    let script = Script { name: &name, within: &within, initial: naming.style.initial };
    script.files(wrapper, depth, if unroll { "smtbmc --unroll z3" } else { "smtbmc z3" }, files)
}

/// Returns the Verilog ports of a formal wrapper whose values a solver chooses.
pub(super) fn inputs_of(design: &Design) -> Vec<String> {
    let mut inputs = vec!["input  wire clk".to_owned()];
    for port in design.inputs() {
        let net = design.net(port.net);
        let range = range(net.format.width());
        let space = if range.is_empty() { "" } else { " " };
        inputs.push(format!("input  wire {range}{space}{}", net.name));
    }
    inputs
}

pub(super) fn outputs_of(design: &Design) -> Vec<String> {
    let mut rows = Vec::new();
    for port in design.outputs() {
        let net = design.net(port.net);
        rows.push(Row::port("", "wire", net.format.width(), false, &net.name, ""));
    }
    Row::declarations(&rows)
}

/// Returns the data for the proof that every computation ends. No microinstruction may have an age and remaining clocks
/// (`left`) whose sum exceeds `most`, the largest number of clocks of a computation.
fn bounded_view(
    design: &Design,
    naming: &Naming,
    instance: &str,
    names: &mut Names,
    (left, most): (&[Left], u32),
    age: &Age,
) -> Bounded {
    // Makes an inner net of the core readable under the name `name`. Yosys joins the two nets when it flattens the design.
    let mut inside = Vec::new();
    let mut seen = |partition: Partition, net: NetId, name: String| {
        let range = range(design.width(net));
        let path = format!("{instance}.{}.{}", naming.instance(partition), design.net(net).name);
        inside.push(format!("(* hierconn *) wire {range} \\{path} ;"));
        inside.push(format!("wire {range} {name} = \\{path} ;"));
    };
    let address = design.register(design.control.address).q;
    let executed = names.fresh("word");
    seen(Partition::Control, address, executed.clone());
    let mut counters: Vec<(RegId, String)> = Vec::new();
    for counter in left.iter().filter_map(|left| left.counter) {
        if counters.iter().all(|(other, _)| *other != counter) {
            let q = design.register(counter).q;
            let name = names.fresh(&design.net(q).name);
            seen(Partition::Datapath, q, name.clone());
            counters.push((counter, name));
        }
    }
    let address_width = design.width(address);
    let mut latest = Vec::new();
    for (at, left) in left.iter().enumerate() {
        let mut end = age.name.clone();
        if let Some((_, name)) = counters.iter().find(|(id, _)| left.counter == Some(*id)) {
            end += &format!(" + {name}");
        }
        if left.clocks != 0 {
            end += &format!(" + {}", age.literal(left.clocks as u32));
        }
        latest.push(Latest { label: literal(at as u64, address_width), end });
    }
    Bounded {
        latest,
        address: executed,
        most: age.literal(most),
        first: None,
        ends_with_result: false,
        inside,
    }
}

/// Returns the clocks of `valid` and `done`, and the number of clocks from one start to the next. Returns `None` if one of
/// these depends on the data.
fn exact(timing: &HandshakeTiming) -> Option<([u32; 2], u32)> {
    let (valid, done) = (timing.start_to_valid?, timing.start_to_done?);
    // The next computation may start in the clock of `done`, but the age counts every computation to its last clock.
    Some(([valid, done], timing.start_to_start?.max(done + 1)))
}
