//! The hardware description of the device `unit`: several functions behind one datapath, selected by an opcode.
//!
//! The planner ([`glint_plan::find_unit`]) merges the plans of the functions into one list of fixed-point operations. The module
//! `plan` builds its hardware, in which the functions share the normaliser, the tables, the multiplier and the shifters.

use glint_base::text;
use glint_config::{Config, Shared};
use glint_plan::{StatedResult, UnitPlan};
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::{About, NamedValue};

use crate::plan::{PlanOutput, describe_plan};

/// `planned` must be the plan of the functions that the configuration states. Each result has an output port `<result>_out`.
pub fn describe(d: &Designer, config: &Config, planned: &UnitPlan) {
    d.about(about(planned));
    let is_pipelined = Shared::of(config).architecture == "pipelined";
    let mut outputs = Vec::new();
    for (name, _) in &planned.results {
        outputs.push(PlanOutput { name: format!("{name}_out"), doc: String::new() });
    }
    let width = planned.operands[0].format.width();
    for (opcode, function) in planned.functions.iter().enumerate() {
        let name = format!("FUNCTION_{}", function.name.to_uppercase());
        let results = function.planned.statement.results.iter();
        let formulas: Vec<String> = results.map(|result| result.formula.python()).collect();
        let doc = formulas.join(", ");
        d.named_value(NamedValue { name, value: opcode as u64, width, doc });
    }
    describe_plan(d, &planned.operands, &planned.plan, &outputs, is_pipelined);
}

fn about(planned: &UnitPlan) -> About {
    let mut formulas = Vec::new();
    let mut notes = Vec::new();
    for (opcode, function) in planned.functions.iter().enumerate() {
        let statement = &function.planned.statement;
        let mut operands = Vec::new();
        for (operand, port) in statement.operands.iter().zip(&planned.operands[1..]) {
            operands.push(format!("{} = {} in {}", port.name, operand.name, operand.format));
        }
        notes.push(format!("Opcode {opcode}, {}: {}.", function.name, operands.join(", ")).into());
        let plan = &function.planned.plan;
        let results = statement.results.iter().zip(&planned.results);
        for (number, (result, (port, _))) in results.enumerate() {
            let StatedResult { name, formula, .. } = result;
            let formula = formula.python();
            formulas.push(format!("{port} = {formula} for opcode {opcode}"));
            let format = plan.node(plan.results[number]).format;
            let bound = text::rounded_up(function.planned.bounds[number], 4);
            let proof = function.planned.proof.words();
            notes.push(
                format!(
                    "Opcode {opcode}: {port} is {name} in {format}, with an error of at most {bound} units of its last \
                     place: {proof}."
                )
                .into(),
            );
        }
    }
    let names: Vec<&str> =
        planned.functions.iter().map(|function| function.name.as_str()).collect();
    About {
        device: "unit".to_owned(),
        title: format!("{} behind one datapath, with proved error bounds", names.join(", ")),
        formula: formulas.join("; "),
        source: "The configuration".to_owned(),
        notes,
    }
}
