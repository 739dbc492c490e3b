//! Writes assertions on which the proof of the handshake relies. For example, the control unit of `rough` asserts that
//! `word_address` is 0 while `run` is 0.

use super::naming::Naming;
use super::text::literal;
use crate::netlist::{Design, Partition, RegisterKind};

/// Returns assertions about the control unit or the datapath. The caller must put them between `` `ifdef FORMAL `` and ``
/// `endif ``, so that only formal tools read them.
pub fn invariants(design: &Design, naming: &Naming, partition: Partition) -> Vec<String> {
    let mut names = naming.names.clone();
    let lines = match partition {
        Partition::Control => control(design),
        Partition::Datapath => datapath(design, &names.fresh("was_busy")),
    };
    lines.into_iter().map(|line| format!("    {line}")).collect()
}

/// Returns the assertions on the sequencer. The assertions hold in every clock but the first, in which the design is reset.
fn control(design: &Design) -> Vec<String> {
    let name = |register| design.net(design.register(register).q).name.as_str();
    let (address, run) = (name(design.control.address), name(design.control.run));
    let width = design.width(design.register(design.control.address).q);
    let last = literal(design.control.microprogram.len() as u64 - 1, width);
    let mut lines = vec![
        "always @* if (!$initstate) begin".to_owned(),
        format!("    assert ({address} <= {last});  // the address stays in the microprogram"),
        format!("    if (!{run}) assert ({address} == {});", literal(0, width)),
    ];
    if design.control.overlaps {
        lines.push(
            "    assert (idle == (!busy || done));  // start is accepted only then".to_owned(),
        );
    }
    lines.push("end".to_owned());
    lines
}

/// Returns the assertion that no operand register changes in the clock after one in which the device was busy (`idle` was 0).
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
