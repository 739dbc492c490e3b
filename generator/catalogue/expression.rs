//! The hardware description of the device `expression`, which computes formulas of several operands.
//!
//! A configuration states the formulas, such as `a / b` or `sqrt(x*x + y*y)`. The planner ([`glint_plan`]) translates them into
//! a list of fixed-point operations, and the module `plan` builds the hardware.

use glint_base::text;
use glint_config::{Config, Shared};
use glint_keys::expression::{Keys, result_doc, result_entry};
use glint_plan::ProvedPlan;
use glint_rtl::dsl::Designer;
use glint_rtl::netlist::About;

use crate::plan::{PlanOutput, describe_plan};

/// Builds the hardware. `planned` must be the plan of the configuration's formulas. Each result has a port `<result>_out`.
pub fn describe(d: &Designer, config: &Config, planned: &ProvedPlan) {
    let keys = Keys::of(config);
    d.about(about(&keys, planned));
    let is_pipelined = Shared::of(config).architecture == "pipelined";
    let mut outputs = Vec::new();
    for result in &planned.statement.results {
        let doc = result_doc(&keys, &result.name);
        outputs.push(PlanOutput { name: format!("{}_out", result.name), doc });
    }
    describe_plan(d, &planned.statement.operands, &planned.plan, &outputs, is_pipelined);
}

fn about(keys: &Keys, planned: &ProvedPlan) -> About {
    let mut formulas = Vec::new();
    for record in &keys.parts.0 {
        formulas.push(format!("{} = {}", record.name, record.text("formula").unwrap_or_default()));
    }
    let mut notes = Vec::new();
    for record in &keys.results.0 {
        let name = &record.name;
        let results = planned.statement.results.iter().zip(&planned.bounds);
        let own: Vec<f64> = results
            .filter(|(result, _)| result_entry(keys, &result.name).name == *name)
            .map(|(_, bound)| *bound)
            .collect();
        formulas.push(format!("{name} = {}", record.text("formula").unwrap_or_default()));
        let promise = match record.text("where") {
            Some(promise) => format!(" where {promise}"),
            None => String::new(),
        };
        let bound = text::rounded_up(own.iter().copied().fold(0.0, f64::max), 4);
        let subject = match own.len() {
            1 => name.clone(),
            count => format!("each of the {count} numbers of {name}"),
        };
        let proof = planned.proof.words();
        notes.push(
            format!(
                "The error of {subject} is at most {bound} units of its last place{promise}: {proof}."
            )
            .into(),
        );
        let is_own = |number: usize| {
            result_entry(keys, &planned.statement.results[number].name).name == *name
        };
        if planned.ordered.iter().any(|list| is_own(list.start)) {
            notes.push(
                format!(
                    "The numbers of {name} have the order of their values: if one value is larger than another, its result \
                     is not smaller{promise}. This is proved."
                )
                .into(),
            );
        }
    }
    let names: Vec<&str> = keys.results.0.iter().map(|record| record.name.as_str()).collect();
    About {
        device: "expression".to_owned(),
        title: format!("{}, with a proved error bound", names.join(" and ")),
        formula: formulas.join("; "),
        source: "The configuration".to_owned(),
        notes,
    }
}
