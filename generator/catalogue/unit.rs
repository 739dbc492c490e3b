//! The hardware description of the device `unit`: several functions behind one datapath, selected by an opcode.
//!
//! The planner ([`glint_plan::find_unit`]) merges the plans of the functions into one list of fixed-point operations. The
//! module `plan` builds the hardware of this list, in which the functions share the normaliser, the tables, the multiplier and
//! the shifters.

use glint_base::text;
use glint_config::{Config, Shared};
use glint_plan::{COMPARED, StatedResult, UnitEquality, UnitFunction, UnitPlan};
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::{About, CoreFunction, FunctionPort};

use crate::piecewise::WRITABLE_TABLE;
use crate::plan::{PlanOutput, describe_plan};

/// Builds the hardware. `planned` must be the plan of the functions that the configuration states. Each result has an output
/// port `<result>_out`.
pub fn describe(d: &Designer, config: &Config, planned: &UnitPlan) {
    d.about(about(planned));
    let is_pipelined = Shared::of(config).architecture == "pipelined";
    let mut outputs = Vec::new();
    for (name, _) in &planned.results {
        outputs.push(PlanOutput { name: format!("{name}_out"), doc: String::new() });
    }
    d.functions(planned.functions.iter().map(|it| core_function(it, planned, &outputs)).collect());
    describe_plan(d, &planned.operands, &planned.plan, &outputs, is_pipelined);
}

/// Returns the names and formats of a function's operands and results at the ports of the unit.
fn core_function(function: &UnitFunction, unit: &UnitPlan, outputs: &[PlanOutput]) -> CoreFunction {
    let UnitFunction { name, planned } = function;
    let mut operands = Vec::new();
    for (operand, port) in planned.statement.operands.iter().zip(&unit.operands[1..]) {
        operands.push(FunctionPort {
            port: port.name.clone(),
            name: operand.name.clone(),
            format: operand.format,
            doc: operand.doc.clone(),
        });
    }
    let mut results = Vec::new();
    let mut formulas = Vec::new();
    for (number, result) in planned.statement.results.iter().enumerate() {
        let bound = text::rounded_up(planned.bounds[number], 4);
        let formula = result.formula.python();
        results.push(FunctionPort {
            port: outputs[number].name.clone(),
            name: result.name.clone(),
            format: planned.plan.node(planned.plan.results()[number]).format,
            doc: format!("{formula}, with an error of at most {bound} units of the last place"),
        });
        formulas.push(formula);
    }
    CoreFunction { name: name.clone(), doc: formulas.join(", "), operands, results }
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
        let mut tables = plan.approximations().into_iter().filter_map(|it| it.polynomials.as_ref());
        if tables.any(|table| table.is_writable) {
            notes.push(format!("Opcode {opcode}: {WRITABLE_TABLE}").into());
        }
        let results = statement.results.iter().zip(&planned.results);
        for (number, (result, (port, _))) in results.enumerate() {
            let StatedResult { name, formula, .. } = result;
            let formula = formula.python();
            formulas.push(format!("{port} = {formula} for opcode {opcode}"));
            let format = plan.node(plan.results()[number]).format;
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
    for (opcode, equality) in planned.equalities.iter().enumerate() {
        if let UnitEquality::Open { node } = equality {
            notes.push(
                format!(
                    "Opcode {opcode}: Glint has not proved for all operands that the unit has the results of the function alone; the proof \
                     ends at the operation {node}. The results are equal for {COMPARED} operands."
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
