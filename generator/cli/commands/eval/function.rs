//! Evaluates a function of a unit by its own names and formats: `opcode=log2 x=2` in place of `opcode=4 a=512`.

use super::batch::BatchSubject;
use super::operands::{completed, given};
use super::{ResultComparison, SignalValue};
use crate::commands::none_of;
use glint_core::core::Core;
use glint_golden::Contract;
use glint_rtl::netlist::{CoreFunction, OPCODE};

/// A function that the user named, with its operands.
pub(super) struct NamedFunction<'d> {
    function: &'d CoreFunction,
    opcode: usize,
    contract: Box<dyn Contract>,
    given: Vec<Option<i64>>,
}

/// Returns the function that the setting `opcode=<name>` names. The remaining settings belong to its operands. Returns `None` if
/// the opcode is a number or not given, or if the core has no functions.
///
/// # Errors
/// Fails if no function has the name, if it has no such operand, or if a value does not fit its format.
pub(super) fn named_function<'d>(
    core: &'d Core,
    settings: &[String],
) -> Result<Option<NamedFunction<'d>>, String> {
    let functions = &core.design.functions;
    let prefix = format!("{OPCODE}=");
    let opcode = settings.iter().find_map(|setting| setting.strip_prefix(&prefix));
    let Some(name) = opcode.filter(|opcode| !functions.is_empty() && !is_number(opcode)) else {
        return Ok(None);
    };
    let Some(opcode) = functions.iter().position(|function| function.name == name) else {
        let names: Vec<&str> = functions.iter().map(|it| it.name.as_str()).collect();
        return Err(format!("there is no function `{name}`{}", none_of(name, "functions", &names)));
    };
    let Some(contract) = core.opened.function_contracts().into_iter().nth(opcode) else {
        // A device of one's own can have functions without contracts of their own.
        return Ok(None);
    };
    let mut own = settings.to_vec();
    own.retain(|setting| !setting.starts_with(&prefix));
    let given =
        given(contract.operands(), &own).map_err(|error| format!("function `{name}`: {error}"))?;
    Ok(Some(NamedFunction { function: &functions[opcode], opcode, contract, given }))
}

fn is_number(text: &str) -> bool {
    text.starts_with('#') || text.parse::<f64>().is_ok()
}

impl NamedFunction<'_> {
    /// Returns the settings for the core's ports, such as `opcode=4` and `a=#512`.
    pub(super) fn settings(&self) -> Vec<String> {
        let mut settings = vec![format!("{OPCODE}={}", self.opcode)];
        for (operand, raw) in self.function.operands.iter().zip(self.raw()) {
            settings.push(format!("{}=#{}", operand.port, operand.format.bits(raw.into())));
        }
        settings
    }

    fn raw(&self) -> Vec<i64> {
        completed(self.contract.as_ref(), &self.given)
    }

    pub(super) fn operands(&self) -> Vec<SignalValue> {
        let mut operands = Vec::new();
        for (operand, raw) in self.function.operands.iter().zip(self.raw()) {
            operands.push(SignalValue::new(operand.name.clone(), operand.format, raw.into()));
        }
        operands
    }

    /// Returns the function with the operands on the command line, for the computation of many points.
    pub(super) fn batch_subject(&self) -> BatchSubject<'_> {
        let results = self.function.results.iter().map(|result| result.name.clone()).collect();
        BatchSubject { contract: self.contract.as_ref(), given: &self.given, results }
    }

    pub(super) fn results(&self) -> Vec<ResultComparison> {
        let mut results = super::results(self.contract.as_ref(), &self.raw());
        for (result, own) in results.iter_mut().zip(&self.function.results) {
            result.name.clone_from(&own.name);
        }
        results
    }
}
